// SPDX-License-Identifier: Zlib
// A scene file (TOML, experiments/scenes/*.toml) and what it builds. docs/manual.md describes the format.
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

inline constexpr double kMaxDt = 10;  // longest step that a scene or a sweep may ask for (s)

/// A number; or text, of the one parameter that is: `joint`, a kind of joint with its parameters.
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

/// Its name, where it is text, is also that of its stage: a star in an axis of that name is every joint kind.
inline constexpr const char* kJointParameter = "joint";

/// A parameter of every scene: how far bodies start from where the file puts them (m and rad), by the seed.
inline constexpr const char* kPerturbParameter = "perturb";
/// m and rad: the most it may be. Such a start is still that of the same scene: less than the size of its bodies.
inline constexpr double kMostPerturbed = 0.1;

struct SceneParameter {
  std::string name, meaning;
  ParameterValue value;
  double lo = 0, hi = 0;  // of a number
};

/// The scene is right, and so is the kind that its parameter `joint` holds, but it cannot join these bodies so: a rod
/// between two points that meet. A hole in a table of kinds, not a mistake.
struct UnsupportedJoint : UserError {
  using UserError::UserError;
};

class SceneFile {
 public:
  /// Throw UserError with file and line.
  static SceneFile load(const std::string& path);
  static SceneFile parse(std::string bytes, const std::string& path);
  /// With a script (experiments/scripts/*.toml), which plays in the scene. An empty path: without one.
  static SceneFile load(const std::string& path, const std::string& scriptPath);
  static SceneFile parse(std::string bytes, const std::string& path, std::string scriptBytes,
                         const std::string& scriptPath);

  const std::string& name() const;
  const std::string& summary() const;
  const std::string& path() const;
  const std::string& scriptPath() const;  // empty: without one
  const std::string& scriptText() const;
  /// Its bytes, those of the files that it names, and its script's: what a trial's key is made of.
  std::string content() const;
  const std::vector<int>& dimensions() const;
  const std::vector<SceneParameter>& parameters() const;
  const SceneParameter* parameter(std::string_view name) const;  // nullptr: there is none
  bool has(int dimension) const;
  /// Every parameter, with `given` in place of defaults. Throws UserError for unknown names, values out of range, and
  /// text where a number is meant; what kind of joint a text is, `build` and the planner ask.
  ParameterValues values(const ParameterValues& given) const;
  std::uint64_t defaultSeed() const;
  const Features& needs() const;

  /// Expands the file: every block, repeat and script step becomes one body. Throws UserError, UnsupportedJoint.
  template <int D>
  SceneSpec<D> build(const ParameterValues& given, std::uint64_t seed) const;

  struct Parsed;

 private:
  std::shared_ptr<const Parsed> m_parsed;
};

/// Bodies that ever come, by kind: "dynamic", "fixed", "dynamic sphere", "pinned", "pivot", "force spring", ...
template <int D>
std::map<std::string, int> census(const SceneSpec<D>& scene);

/// The features of a scene as text, sorted: "cache,friction,rotation". Inverse of featuresFromText.
std::string featuresText(const Features& features);
/// Throws UserError with the valid names.
Features featuresFromText(std::string_view text);

}}  // namespace lpc::LPC_PRECISION
