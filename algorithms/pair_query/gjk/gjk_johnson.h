// SPDX-License-Identifier: Zlib
// The point of a simplex nearest to the origin by Johnson's sub-algorithm (Gilbert, Johnson, Keerthi 1988): for each
// subset of the points, cofactors tell whether the projection of the origin lies between them. A recursion over
// products of points, the same in every dimension, and as ill-conditioned as the square of the problem.
#pragma once

#include <bit>

#include "algorithms/pair_query/gjk/gjk_simplex3.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// Returns true if the simplex contains the origin; `best` is then untouched. A nearly flat simplex contains nothing.
template <int D>
bool nearestByJohnson(const Simplex<D>& s, NearestFeature<D>& best) {
  constexpr unsigned kSubsets = 1u << (D + 1);
  const auto n = static_cast<unsigned>(s.count), all = (1u << n) - 1;
  IndexedArray<IndexedArray<Real, D + 1>, D + 1> product{};
  Real size2 = 0;
  for (unsigned i = 0; i < n; ++i) {
    for (unsigned j = 0; j < n; ++j) product[i][j] = s.w[i].dot(s.w[j]);
    size2 = std::max(size2, product[i][i]);
  }
  const auto holds = [](unsigned set, unsigned i) { return ((set >> i) & 1u) != 0; };
  std::array<IndexedArray<Real, D + 1>, kSubsets> cofactor{};
  std::array<bool, kSubsets> between{};
  for (unsigned set = 1; set <= all; ++set) {  // after all of its own subsets
    between[set] = true;
    for (unsigned i = 0; i < n; ++i) {
      if (!holds(set, i)) continue;
      const unsigned rest = set & ~(1u << i);
      Real& sum = cofactor[set][i];
      sum = rest == 0 ? Real(1) : Real(0);
      const auto k = static_cast<unsigned>(std::countr_zero(rest));
      for (unsigned j = 0; j < n && rest != 0; ++j) {
        if (holds(rest, j)) sum += cofactor[rest][j] * (product[j][k] - product[j][i]);
      }
      between[set] = between[set] && sum > 0;
    }
  }
  const auto total = [&](unsigned set) {
    Real sum = 0;
    for (unsigned i = 0; i < n; ++i) sum += holds(set, i) ? cofactor[set][i] : Real(0);
    return sum;
  };
  if (n == D + 1 && between[all]) {
    Real full = kAttainedRounding;  // the square of the volume that a simplex of this size may have
    for (int k = 0; k < D; ++k) full *= size2;
    if (total(all) > full) return true;
  }
  // The cofactors decide which points. The position computed from them would have only half of the digits.
  const auto offer = [&](unsigned set) {
    IndexedArray<const Vec<D>*, D> on{};
    std::size_t count = 0;
    for (unsigned i = 0; i < n; ++i) {
      if (holds(set, i)) on[count++] = &s.w[i];
    }
    if (count == 1) return best.offer(*on[0], {on[0]});
    if (count == 2) return best.offer(footOnLine<D>(*on[0], *on[1]), {on[0], on[1]});
    if constexpr (D == 3) {
      Vec<3> normal = (*on[1] - *on[0]).cross(*on[2] - *on[0]);
      if (makeUnit<3>(normal)) best.offer(footOnPlane(*on[0], *on[1], *on[2], normal), {on[0], on[1], on[2]});
    }
  };
  const unsigned proper = n == D + 1 ? all - 1 : all;
  for (unsigned set = 1; set <= proper; ++set) {
    bool nearest = between[set];
    for (unsigned j = 0; j < n && nearest; ++j) nearest = holds(set, j) || !(cofactor[set | 1u << j][j] > 0);
    if (nearest) {
      offer(set);
      return false;
    }
  }
  // Rounding has left none: take the best of the subsets that contain the origin's projection.
  for (unsigned set = 1; set <= proper; ++set) {
    if (between[set]) offer(set);
  }
  return false;
}

}}}  // namespace lpc::LPC_PRECISION::pair_query
