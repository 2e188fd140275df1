// SPDX-License-Identifier: Zlib
// Planes of several triangles at a time, by the instruction set of the machine: square roots and divisions are most of
// the cost of a polytope's face.
#pragma once

#include <array>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// Up to kFan triangles around an apex, each one's second corner the next one's first, with coordinates in separate
/// rows. Their planes have the same bits on every instruction set and with Triple.
struct FacePlanes {
  static constexpr int kFan = 8;
  using Row = std::array<Real, kFan>;

  std::array<std::array<Real, kFan + 1>, 3> ring{};  // triangle i: ring i, ring i + 1, apex
  std::array<Real, 3> apex{};
  std::array<Row, 3>
      outward{};  // unit where `square` is neither 0, nor infinite, nor beyond kSafeSquare; else unusable
  Row square{};   // of the normal (b - a) x (c - a) of a triangle a b c
  Row offset{};   // the largest of outward . a, b and c

  /// Computes the first `count`.
  void find(int count);
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
