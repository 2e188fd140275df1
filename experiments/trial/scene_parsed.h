// SPDX-License-Identifier: Zlib
// What is inside a SceneFile; only the sources of scene reading see it.
#pragma once

#include <limits>

#include "experiments/parse/expression.h"
#include "experiments/parse/toml_reader.h"
#include "experiments/trial/scene_file.h"

namespace lpc::inline LPC_PRECISION {

struct SceneFile::Parsed {
  std::string path, bytes, name, summary;
  std::vector<int> dimensions;
  std::vector<SceneParameter> parameters;
  std::uint64_t seed = 1;
  Features needs;
  toml::table table;
};

inline constexpr double kLargest = std::numeric_limits<double>::max();

/// Numbers and vectors of one scene file: a TOML number, or an expression in a string.
class SceneNumbers {
 public:
  SceneNumbers(std::string file, std::uint64_t seed) : expressions(seed), m_file(std::move(file)) {}

  /// Always finite.
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

 private:
  std::string m_file;
};

inline Rot<2> rotationOf(const Ang<2>& vector) { return Rot<2>::angle(vector[0]); }
inline Rot<3> rotationOf(const Ang<3>& vector) { return Rot<3>::vector(vector); }
/// A number turns about z, in the plane of 2D; a list of three is a rotation vector, of which 2D sees the third. Zero
/// where the key is missing.
template <int D>
Ang<D> readAngular(TableReader& table, SceneNumbers& numbers, const std::string& key);

/// The [parameters] of a scene, in the order of its file.
std::vector<SceneParameter> readParameters(TableReader& top);

/// One [[joint]] block at one turn of its loops, without its bodies. What makes no joint is an error of the block; but
/// UnsupportedJoint where the kind is `chosen`, the text of the scene's parameter of kinds.
template <int D>
JointDef<D> readJoint(TableReader& joint, SceneNumbers& numbers, const std::string& chosen);

/// One [[body]] block at one turn of its loops.
template <int D>
BodyDef<D> readBody(TableReader& body, SceneNumbers& numbers, const toml::table* defaults);

/// Moves every dynamic body from where the file puts it: each coordinate by up to `amount` (m) and each angle by up to
/// `amount` (rad), drawn from a stream of its own, so that `rand` gives the same numbers with and without. A pinned
/// body only turns; what does not rotate is only shifted, also where the scene has rotation off. Joints are made at the
/// poses that the bodies then have, from anchors in the world, so none starts with an error.
template <int D>
void perturb(SceneSpec<D>& scene, double amount, std::uint64_t seed);

}  // namespace lpc::inline LPC_PRECISION
