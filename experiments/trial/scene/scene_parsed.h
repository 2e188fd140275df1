// SPDX-License-Identifier: Zlib
// What is inside a SceneFile; only the sources of scene reading see it.
#pragma once

#include <limits>
#include <map>
#include <string_view>
#include <tuple>

#include "experiments/parse/expression.h"
#include "experiments/parse/toml_reader.h"
#include "experiments/trial/formats/mesh_file.h"
#include "experiments/trial/scene/scene_file.h"
#include "framework/world/settings.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The files that a scene's shapes name, by that name, as they were when the scene was loaded.
struct SceneMesh {
  std::string bytes;
  MeshFile mesh;
};
using SceneMeshes = std::map<std::string, SceneMesh>;

struct SceneFile::Parsed {
  std::string path, bytes, name, summary;
  std::string scriptPath, scriptBytes;  // empty: without one
  toml::table script;
  std::string saved;  // bytes of the world that it begins with; empty: none
  std::vector<int> dimensions;
  std::vector<SceneParameter> parameters;
  std::uint64_t seed = 1;
  Features needs;
  toml::table table;
  SceneMeshes meshes;
};

/// The meshes of all tables that are a shape with a `file`. Throws UserError with the place of who names it.
SceneMeshes readMeshes(const toml::table& scene, const std::string& path);

inline constexpr double kLargest = std::numeric_limits<double>::max();

/// Of the key `saved`. Throws UserError with its place for a file that is no saved world, or one of no dimension that
/// the scene has.
std::string readSaved(TableReader& top, const SceneFile::Parsed& scene);
/// Begins the scene with that world: its settings, and its bodies as they are. One of the other precision is left to
/// who can read it.
template <int D>
void startFromSaved(TableReader& top, const SceneFile::Parsed& parsed, SceneSpec<D>& scene);

/// Throws UserError with the valid names.
void setFeature(Features& features, const std::string& name);

/// Names of numbers that the scene language sets itself.
inline constexpr const char* kSetNames[] = {"dimension", "k", "part", "step"};

/// The most that a scene may have of each: bodies, shapes, points, joints, forces, events and turns of loops, all its
/// blocks together. The largest scenes of the field have some 100,000 bodies, so that more is a slip of the pen.
inline constexpr long kMostOfEach = 1000000;

/// The most parameters, loop indices and `let`s together: each expression is compiled with all of them.
inline constexpr std::size_t kMostNames = 100;
inline constexpr const char* kTooManyNames = "more than 100 parameters, indices and 'let's together";

/// Numbers and vectors of one scene file: a TOML number, or an expression in a string.
class SceneNumbers {
 public:
  SceneNumbers(std::string file, std::uint64_t seed, const SceneMeshes& of)
      : expressions(seed), meshes(of), m_file(std::move(file)) {}

  /// While it lives, a block is only read for its mistakes: expressions are, but have no values and draw nothing, and
  /// what is made of numbers is nobody's.
  class Rehearsal {
   public:
    explicit Rehearsal(SceneNumbers& numbers) : m_numbers(numbers), m_before(numbers.m_rehearsing) {
      m_numbers.m_rehearsing = true;
    }
    ~Rehearsal() { m_numbers.m_rehearsing = m_before; }
    Rehearsal(const Rehearsal&) = delete;
    Rehearsal& operator=(const Rehearsal&) = delete;

   private:
    SceneNumbers& m_numbers;
    bool m_before;
  };
  bool rehearsing() const { return m_rehearsing; }

  /// `n` more of `what` come at that place: refused when the scene then has more than kMostOfEach.
  void count(const toml::node& place, std::string_view what, long n = 1);

  /// Always finite, as a Real too.
  double number(const toml::node& node);
  double number(TableReader& table, const std::string& key, double fallback);
  /// Both ends count as valid.
  double between(const toml::node& node, const std::string& key, double lo, double hi);
  double between(TableReader& table, const std::string& key, double fallback, double lo, double hi);
  long whole(TableReader& table, const std::string& key, long fallback, long lo, long hi);
  /// Two or three numbers; a missing third is 0. All are evaluated in both dimensions, so that both draw the same
  /// random numbers.
  template <int D>
  Vec<D> vector(const toml::node& node);
  template <int D>
  Vec<D> vector(TableReader& table, const std::string& key);

  Expressions expressions;
  const SceneMeshes& meshes;
  std::map<std::tuple<std::string, double, bool>, std::shared_ptr<const Polytope<3>>> hulls;  // by file, scale, `hull`

 private:
  std::string m_file;
  std::map<std::string_view, long> m_counts;
  bool m_rehearsing = false;
};

inline Rot<2> rotationOf(const Ang<2>& vector) { return Rot<2>::angle(vector[0]); }
inline Rot<3> rotationOf(const Ang<3>& vector) { return Rot<3>::vector(vector); }
/// As readAngular, of an angle and no speed: up to kLargestAngle.
template <int D>
Ang<D> readAngle(TableReader& table, SceneNumbers& numbers, const std::string& key);
/// By `angle`, or by `rotation`: cosine and sine, in 3D a quaternion (w, x, y, z), whose numbers are taken as they are,
/// so that what a program writes is what it has, to the last bit.
template <int D>
Rot<D> readRotation(TableReader& table, SceneNumbers& numbers);
/// Of the key `type`; dynamic without it.
BodyType readBodyType(TableReader& body);
/// A number turns about z, in the plane of 2D; a list of three is a rotation vector, of which 2D sees the third. Zero
/// where the key is missing.
template <int D>
Ang<D> readAngular(TableReader& table, SceneNumbers& numbers, const std::string& key);

/// The [parameters] of a scene, in the order of its file.
std::vector<SceneParameter> readParameters(TableReader& top);
/// Those of its script join them: of other names, since a script knows none of the scene's.
void addScriptParameters(TableReader& script, SceneFile::Parsed& scene);

/// What is wrong with a kind or its parameters is told with the place of the block.
template <class Make>
auto atBlock(const TableReader& block, const Make& make) {
  try {
    return make();
  } catch (const UserError& e) {
    block.fail(e.what());
  }
}
/// In a rehearsal it may be one of the other dimension.
const Registered& kindOf(StageKind stage, const std::string& name, const SceneNumbers& numbers, int dimension);
/// The `kind` of a block with its `parameters`.
Spec readKind(TableReader& block, SceneNumbers& numbers, StageKind stage, int dimension);

/// The rule of that key, where it is given. Throws UserError with the valid names.
void readMixRule(TableReader& table, const std::string& key, MixRule& rule);

/// One [[joint]] block at one turn of its loops, without its bodies. What makes no joint is an error of the block; but
/// UnsupportedJoint where the kind is `chosen`, the text of the scene's parameter of kinds.
template <int D>
JointDef<D> readJoint(TableReader& joint, SceneNumbers& numbers, const std::string& chosen);

/// The longest run, in steps.
inline constexpr long kMaxSteps = 1000000000;

/// One [[force]] block at one turn of its loops, without its bodies.
template <int D>
ForceDef<D> readForce(TableReader& block, SceneNumbers& numbers);
/// When that block's force comes and goes, and whether it can be between its bodies as the file places them.
template <int D>
void placeForce(TableReader& block, SceneNumbers& numbers, const SceneSpec<D>& scene,
                typename SceneSpec<D>::Force& force);

/// How far a face's normal, as a scene gives it, may be from the one that the hull of the corners has (1). Larger: a
/// normal of another face passes. Smaller: those of slivers, which are made of rounding, are refused.
inline constexpr Real kGivenNormal = Real(1e-2);
/// The hull of the corners with these normals, one for each face in its order: what a program writes has so, to the
/// last bit, those that it had, though rounding may choose others when the hull is sought again. Throws UserError.
std::shared_ptr<const Polytope<3>> hullWithNormals(std::span<const Vec<3>> corners, std::span<const Vec<3>> normals);
/// A polytope by `file`.
template <int D>
Shape<D> readHull(TableReader& shape, SceneNumbers& numbers, Real rounding);
/// Points and triangles by `file`, in metres; none in a rehearsal.
MeshFile readMesh(TableReader& shape, SceneNumbers& numbers);

/// One [[body]] block at one turn of its loops. What a shape does not say [defaults] do, and what they do not say the
/// settings.
template <int D>
BodyDef<D> readBody(TableReader& body, SceneNumbers& numbers, const toml::table* defaults, const Settings& settings);

/// Moves every dynamic body from where the file puts it: each coordinate by up to `amount` (m) and each angle by up to
/// `amount` (rad), drawn from a stream of its own, so that `rand` gives the same numbers with and without. A pinned
/// body only turns; what does not rotate is only shifted, also where the scene has rotation off. Joints are made at the
/// poses that the bodies then have, from anchors in the world, so none starts with an error.
template <int D>
void perturb(SceneSpec<D>& scene, double amount, std::uint64_t seed);

}}  // namespace lpc::LPC_PRECISION
