// SPDX-License-Identifier: Zlib
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "framework/math/random.h"
#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// rad: the largest angle, of either sign, in a scene. Beyond it, sinCos is not a sine.
inline constexpr double kLargestAngle = 1e5;

/// Arithmetic in scene files: `base - i`, `sin(angle) * k`, `rand(-1, 1)`, `i < 3 ? 0 : 1`. Computed in double in both
/// precisions, with the project's own sine, so that a scene is the same on every machine.
///
/// Functions: sin cos sqrt abs floor ceil min max mod rand(lo, hi) harmonic(n); constant pi. rand draws from one stream
/// started by the seed, so the order of evaluation is part of a scene.
class Expressions {
 public:
  explicit Expressions(std::uint64_t seed);
  ~Expressions();
  Expressions(const Expressions&) = delete;
  Expressions& operator=(const Expressions&) = delete;

  void setGlobal(const std::string& name, double value);
  /// Locals (loop indices, `let`) hide nothing: a name is either global or local.
  void setLocal(const std::string& name, double value);
  void forgetLocals();
  bool knows(const std::string& name) const;
  /// Throws UserError if the text is not a name, or is the name of a function or constant.
  static void checkName(const std::string& name);
  /// Whether `rand` was called with a result that depends on the seed.
  bool drew() const { return m_drew; }

  /// Throws UserError that quotes the text and lists the known names.
  double evaluate(const std::string& text);
  /// Throws UserError if `evaluate` would for any values. Draws no random number.
  void check(const std::string& text);

  /// Restores the random stream after `read`.
  template <class Read>
  void aside(const Read& read) {
    const Random random = m_random;
    const bool drew = m_drew;
    read();
    m_random = random, m_drew = drew;
  }

 private:
  struct Compiled;
  double valueOf(const std::string& text);
  std::map<std::string, double> m_globals, m_locals;  // nodes do not move: parsers keep their addresses
  std::map<std::string, std::unique_ptr<Compiled>> m_compiled;
  Random m_random;
  bool m_drew = false;
};

}}  // namespace lpc::LPC_PRECISION
