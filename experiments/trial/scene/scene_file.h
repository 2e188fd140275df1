// SPDX-License-Identifier: Zlib
// A scene file (TOML, experiments/scenes/*.toml) and what it builds. docs/reference_scenes.md describes the format.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "framework/math/check.h"
#include "framework/scene/scene_spec.h"

namespace lpc { inline namespace LPC_PRECISION {

inline constexpr double kMaxDt = 10;  // longest step of a scene or a sweep (s)

/// A number; or the text of the parameter `joint`, a kind of joint with its parameters.
struct ParameterValue {
  double number = 0;
  std::string text;  // empty: a number

  ParameterValue() = default;
  ParameterValue(double value) : number(value) {}
  ParameterValue(std::string value) : text(std::move(value)) {}
  bool isText() const { return !text.empty(); }
};
void to_json(nlohmann::json& out, const ParameterValue& value);
void from_json(const nlohmann::json& in, ParameterValue& value);

using ParameterValues = std::map<std::string, ParameterValue>;

/// The parameter's name is also that of its stage: a star in an axis of that name stands for every joint kind.
inline constexpr const char* kJointParameter = "joint";

/// A parameter of every scene: how far bodies start from the poses in the file (m and rad), at random by the seed.
inline constexpr const char* kPerturbParameter = "perturb";
/// m and rad: its largest value, smaller than the bodies, so that the scene remains recognisable.
inline constexpr double kMostPerturbed = 0.1;

struct SceneParameter {
  std::string name, meaning;
  ParameterValue value;
  double lo = 0, hi = 0;  // of a number
};

/// The scene is valid, and so is the kind in its parameter `joint`, but that kind cannot join these bodies: a rod
/// between two coinciding points. A gap in a table of kinds, not an error of the file.
struct UnsupportedJoint : UserError {
  using UserError::UserError;
};

class SceneFile {
 public:
  /// Throw UserError with file and line.
  static SceneFile load(const std::string& path);
  static SceneFile parse(std::string bytes, const std::string& path);
  /// With a script (experiments/scripts/*.toml), which runs in the scene. Empty path: no script.
  static SceneFile load(const std::string& path, const std::string& scriptPath);
  static SceneFile parse(std::string bytes, const std::string& path, std::string scriptBytes,
                         const std::string& scriptPath);

  const std::string& name() const;
  const std::string& summary() const;
  const std::string& path() const;
  const std::string& scriptPath() const;  // empty: no script
  const std::string& scriptText() const;
  /// The bytes of the file, of the files that it names, and of its script: part of a trial's key.
  std::string content() const;
  const std::vector<int>& dimensions() const;
  const std::vector<SceneParameter>& parameters() const;
  const SceneParameter* parameter(std::string_view name) const;  // nullptr: unknown
  bool has(int dimension) const;
  /// Every parameter, with `given` in place of defaults. Throws UserError for unknown names, values out of range, and
  /// text in place of a number. `build` and the planner check the kind of joint.
  ParameterValues values(const ParameterValues& given) const;
  std::uint64_t defaultSeed() const;
  const PhysicsModel& model() const;

  /// Expands the file: every block, repeat and script step becomes one body. Throws UserError, UnsupportedJoint.
  template <int D>
  SceneSpec<D> build(const ParameterValues& given, std::uint64_t seed) const;

  struct Parsed;

 private:
  std::shared_ptr<const Parsed> m_parsed;
};

/// Number of bodies ever added, by kind: "dynamic", "fixed", "dynamic sphere", "pinned", "pivot", "force spring", ...
template <int D>
std::map<std::string, int> census(const SceneSpec<D>& scene);

/// The model of a scene as text, sorted: "cache,friction,rotation". Inverse of modelFromText.
std::string modelText(const PhysicsModel& model);
/// Throws UserError with the valid names.
PhysicsModel modelFromText(std::string_view text);

}}  // namespace lpc::LPC_PRECISION
