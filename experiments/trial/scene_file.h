// SPDX-License-Identifier: Zlib
// A scene file (TOML, experiments/scenes/*.toml) and what it builds. docs/manual.md describes the format.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "framework/scene_spec.h"

namespace lpc::inline LPC_PRECISION {

inline constexpr double kMaxDt = 10;  // longest step that a scene or a sweep may ask for (s)

struct SceneParameter {
  std::string name, meaning;
  double value = 0, lo = 0, hi = 0;
};

using ParameterValues = std::map<std::string, double>;

class SceneFile {
 public:
  /// Throw UserError with file and line.
  static SceneFile load(const std::string& path);
  static SceneFile parse(std::string bytes, const std::string& path);

  const std::string& name() const;
  const std::string& summary() const;
  const std::string& path() const;
  const std::string& bytes() const;
  const std::vector<int>& dimensions() const;
  const std::vector<SceneParameter>& parameters() const;
  bool has(int dimension) const;
  /// Every parameter, with `given` in place of defaults. Throws UserError for unknown names and values out of range.
  ParameterValues values(const ParameterValues& given) const;
  std::uint64_t defaultSeed() const;
  const Features& needs() const;

  /// Expands the file: every block, repeat and script step becomes one body. Throws UserError.
  template <int D>
  SceneSpec<D> build(const ParameterValues& given, std::uint64_t seed) const;

  struct Parsed;

 private:
  std::shared_ptr<const Parsed> m_parsed;
};

/// Bodies that ever come, by kind: "dynamic", "fixed", "dynamic sphere", "pinned", "pivot", "spring", ...
template <int D>
std::map<std::string, int> census(const SceneSpec<D>& scene);

/// The features of a scene as text, sorted: "cache,friction,rotation". Inverse of featuresFromText.
std::string featuresText(const Features& features);
/// Throws UserError with the valid names.
Features featuresFromText(std::string_view text);

}  // namespace lpc::inline LPC_PRECISION
