// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <tuple>

#include "framework/problem/contact.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The manifolds of the first pair of shapes, one for each pair of convex parts; they are adjacent.
template <class M>
std::span<M> firstPair(std::span<M> manifolds) {
  std::size_t n = 1;
  while (n < manifolds.size() && manifolds[n].shapeKey() == manifolds[0].shapeKey()) ++n;
  return manifolds.first(n);
}

template <int D>
Real smallestSeparation(std::span<const Manifold<D>> pair) {
  Real s = pair[0].points[0].separation;
  for (const Manifold<D>& m : pair) {
    for (int i = 0; i < m.count; ++i) s = std::min(s, m.points[i].separation);
  }
  return s;
}

/// What a step must know of a pair of shapes that had contacts in the last step. The manifolds themselves may be
/// updated in place.
struct PastPair {
  std::int32_t bodyA = -1, shapeA = -1, bodyB = -1, shapeB = -1;
  Real separation = 0;  // m, the smallest of all points
  Real friction = 0, restitution = 0;
  std::uint8_t begun = 0, ignored = 0;

  PastPair() = default;
  /// From the manifolds of the pair.
  template <int D>
  explicit PastPair(std::span<const Manifold<D>> pair)
      : bodyA(pair[0].bodyA),
        shapeA(pair[0].shapeA),
        bodyB(pair[0].bodyB),
        shapeB(pair[0].shapeB),
        separation(smallestSeparation<D>(pair)),
        friction(pair[0].friction),
        restitution(pair[0].restitution),
        begun(pair[0].begun),
        ignored(pair[0].ignored) {}

  auto shapeKey() const { return std::tuple(bodyA, shapeA, bodyB, shapeB); }
};

}}  // namespace lpc::LPC_PRECISION
