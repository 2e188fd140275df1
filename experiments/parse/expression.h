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

/// rad: the largest angle either way that a scene may name. Beyond it, sinCos is no sine.
inline constexpr double kLargestAngle = 1e5;

/// Arithmetic in scene files: `base - i`, `sin(angle) * k`, `rand(-1, 1)`, `i < 3 ? 0 : 1`. Computed in double in both
/// precisions, and with the project's own sine, so that a scene is the same on every machine.
///
/// Functions: sin cos sqrt abs floor ceil min max mod rand(lo, hi) harmonic(n); constant pi. rand draws from one stream
/// that the seed starts: the order in which expressions are evaluated is part of a scene.
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
  /// Throws UserError for what is no name, and for that of a function or constant.
  static void checkName(const std::string& name);
  /// Whether `rand` gave a number that the seed decided.
  bool drew() const { return m_drew; }

  /// Throws UserError that quotes the text and names what is known.
  double evaluate(const std::string& text);
  /// Throws UserError where `evaluate` would whatever the values are. Draws nothing.
  void check(const std::string& text);

  /// What `read` draws is drawn again by whoever comes next.
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
