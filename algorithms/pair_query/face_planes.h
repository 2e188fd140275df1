// SPDX-License-Identifier: Zlib
// The planes of several triangles at a time, by the instruction set that the machine has: square roots and divisions
// are most of what a face of a polytope costs.
#pragma once

#include <array>

#include "framework/space.h"

namespace lpc::inline LPC_PRECISION::pair_query {

/// Up to kFan triangles a b c, each coordinate in a row of its own, and their planes, with the same numbers from every
/// instruction set and from Triple.
struct FacePlanes {
  static constexpr int kFan = 8;
  using Row = std::array<Real, kFan>;

  std::array<Row, 3> a{}, b{}, c{};
  std::array<Row, 3>
      outward{};  // unit where `square` is neither 0, nor infinite, nor beyond kSafeSquare; else unusable
  Row square{};   // of the normal (b - a) x (c - a)
  Row offset{};   // the largest of outward . a, b and c

  /// Of the first `count`.
  void find(int count);
};

}  // namespace lpc::inline LPC_PRECISION::pair_query
