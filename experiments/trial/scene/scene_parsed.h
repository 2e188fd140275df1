// SPDX-License-Identifier: Zlib
// Internals of a SceneFile; only the sources that read scenes include it.
#pragma once

#include <array>
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

/// The files of a scene's shapes by name, with their content at load time.
struct SceneMesh {
  std::string bytes;
  MeshFile mesh;
};
using SceneMeshes = std::map<std::string, SceneMesh>;

struct SceneFile::Parsed {
  std::string path, bytes, name, summary;
  std::string scriptPath, scriptBytes;  // empty: no script
  toml::table script;
  std::string saved;  // bytes of the saved world that the scene starts from; empty: none
  std::vector<int> dimensions;
  std::vector<SceneParameter> parameters;
  std::uint64_t seed = 1;
  PhysicsModel model;
  toml::table table;
  SceneMeshes meshes;
};

/// Reads the meshes of all shape tables with a `file`. Throws UserError with the position of the table.
SceneMeshes readMeshes(const toml::table& scene, const std::string& path);

inline constexpr double kLargest = std::numeric_limits<double>::max();

/// Reads the file of the key `saved`. Throws UserError with its position if the file is not a saved world, or of a
/// dimension that the scene lacks.
std::string readSaved(TableReader& top, const SceneFile::Parsed& scene);
/// Starts the scene from that world: its settings and its bodies. A world of the other precision is left to a program
/// that can read it.
template <int D>
void startFromSaved(TableReader& top, const SceneFile::Parsed& parsed, SceneSpec<D>& scene);

/// Throws UserError with the valid names.
void setModelFlag(PhysicsModel& model, const std::string& name);

/// Names of numbers that the scene language itself sets.
inline constexpr const char* kSetNames[] = {"dimension", "k", "part", "step"};

/// Largest number of each in a scene: bodies, shapes, points, joints, forces, events and turns of loops, over all
/// blocks. The largest scenes of the field have some 100,000 bodies; more is a typing error.
inline constexpr long kMostOfEach = 1000000;

/// Largest number of parameters, loop indices and `let`s together: each expression is compiled with all of them.
inline constexpr std::size_t kMostNames = 100;
inline constexpr const char* kTooManyNames = "more than 100 parameters, indices and 'let's together";

/// Numbers and vectors of one scene file: a TOML number, or an expression in a string.
class SceneNumbers {
 public:
  SceneNumbers(std::string file, std::uint64_t seed, const SceneMeshes& of)
      : expressions(seed), meshes(of), m_file(std::move(file)) {}

  /// During its lifetime blocks are read only for their errors: expressions are parsed but have no value and draw no
  /// random number, and results are discarded.
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

  /// Counts `n` more of `what` at that position; throws if the scene then exceeds kMostOfEach.
  void count(const toml::node& place, std::string_view what, long n = 1);

  /// Always finite, also as a Real.
  double number(const toml::node& node);
  double number(TableReader& table, const std::string& key, double fallback);
  /// Both ends are valid.
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
  /// By file, scale and `hull`.
  std::map<std::tuple<std::string, std::array<double, 3>, bool>, std::shared_ptr<const Polytope<3>>> hulls;

 private:
  std::string m_file;
  std::map<std::string_view, long> m_counts;
  bool m_rehearsing = false;
};

inline Rot<2> rotationOf(const Ang<2>& vector) { return Rot<2>::angle(vector[0]); }
inline Rot<3> rotationOf(const Ang<3>& vector) { return Rot<3>::vector(vector); }
/// Like readAngular for an angle, which is limited to kLargestAngle.
template <int D>
Ang<D> readAngle(TableReader& table, SceneNumbers& numbers, const std::string& key);
/// Reads `angle`, or `rotation`: cosine and sine, in 3D a quaternion (w, x, y, z). The numbers of `rotation` are used
/// unchanged, so that a program reads back its own bits.
template <int D>
Rot<D> readRotation(TableReader& table, SceneNumbers& numbers);
/// Reads the key `type`; dynamic without it.
BodyType readBodyType(TableReader& body);
/// A number is a rotation about z; a list of three is a rotation vector, of which 2D uses the third. Zero if the key is
/// missing.
template <int D>
Ang<D> readAngular(TableReader& table, SceneNumbers& numbers, const std::string& key);

/// The [parameters] of a scene, in file order.
std::vector<SceneParameter> readParameters(TableReader& top);
/// Adds the parameters of its script. Their names must differ, since a script does not know those of the scene.
void addScriptParameters(TableReader& script, SceneFile::Parsed& scene);

/// Adds the position of the block to errors of a kind or its parameters.
template <class Make>
auto atBlock(const TableReader& block, const Make& make) {
  try {
    return make();
  } catch (const UserError& e) {
    block.fail(e.what());
  }
}
/// In a rehearsal it may belong to the other dimension.
const Registered& kindOf(StageKind stage, const std::string& name, const SceneNumbers& numbers, int dimension);
/// Reads the `kind` of a block with its `parameters`.
Spec readKind(TableReader& block, SceneNumbers& numbers, StageKind stage, int dimension);

/// Reads the rule under that key, if present. Throws UserError with the valid names.
void readMixRule(TableReader& table, const std::string& key, MixRule& rule);

/// One [[joint]] block at one turn of its loops, without its bodies. Invalid joints are errors of the block, except if
/// the kind is `chosen`, the text of the scene's parameter `joint`: then UnsupportedJoint.
template <int D>
JointDef<D> readJoint(TableReader& joint, SceneNumbers& numbers, const std::string& chosen);

/// The longest run, in steps.
inline constexpr long kMaxSteps = 1000000000;

/// One [[force]] block at one turn of its loops, without its bodies.
template <int D>
ForceDef<D> readForce(TableReader& block, SceneNumbers& numbers);
/// Reads when the block's force starts and ends, and checks it against its bodies at their poses in the file.
template <int D>
void placeForce(TableReader& block, SceneNumbers& numbers, const SceneSpec<D>& scene,
                typename SceneSpec<D>::Force& force);

/// Largest deviation of a given face normal from that of the corners' hull (1). Larger: a normal of another face
/// passes. Smaller: rounded normals of slivers are refused.
inline constexpr Real kGivenNormal = Real(1e-2);
/// The hull of the corners with these normals, one for each face in order. A program thus reads back its own bits,
/// although rounding may choose other normals when the hull is computed again. Throws UserError.
std::shared_ptr<const Polytope<3>> hullWithNormals(std::span<const Vec<3>> corners, std::span<const Vec<3>> normals);
/// Reads a polytope from `file`.
template <int D>
Shape<D> readHull(TableReader& shape, SceneNumbers& numbers, Real rounding);
/// Reads `points`. In 3D, 2D points with a `depth` become a prism: one file describes the scene in both dimensions.
template <int D>
std::vector<Vec<D>> readPoints(TableReader& shape, SceneNumbers& numbers);
/// Reads a mesh from `file`, or from `points` and `triangles`.
template <int D>
Shape<D> readSurface(TableReader& shape, SceneNumbers& numbers);

/// One [[body]] block at one turn of its loops. [defaults] fill in what a shape omits, and the settings what these
/// omit.
template <int D>
BodyDef<D> readBody(TableReader& body, SceneNumbers& numbers, const toml::table* defaults, const Settings& settings);

/// Perturbs every dynamic body: each coordinate by up to `amount` (m) and each angle by up to `amount` (rad). The
/// random numbers come from a separate stream, so that `rand` is unchanged. A pinned body only turns; a body that
/// cannot rotate is only shifted, also if the scene has no rotation. Joints are made at the perturbed poses, from
/// anchors in the world, so none starts with an error.
template <int D>
void perturb(SceneSpec<D>& scene, double amount, std::uint64_t seed);

}}  // namespace lpc::LPC_PRECISION
