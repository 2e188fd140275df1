// SPDX-License-Identifier: Zlib
// Two bounded cores (the shapes without their rounding) in A's frame, and the one bound on which
// all answers of this folder rest. With M = { b - a } and a unit vector n,
//
//   L(n) = min over M of n . m = -h_A(n) - h_B(-n)   <=   phi = max over unit d of L(d),
//
// where phi is the signed distance of the cores, apart or penetrating. So every unit vector whatever, an axis made of
// noise included, gives a proved lower bound: a method can only miss the best axis, never win with a wrong one. Methods
// collect candidate directions, keep the best bound, and report that bound itself as the distance.
#pragma once

#include <algorithm>
#include <limits>

#include "algorithms/pair_query/tolerances.h"
#include "framework/stage_narrowphase.h"
#include "framework/support_map.h"

namespace lpc::inline LPC_PRECISION::pair_query {

/// Makes v a unit vector, whatever its length (no overflow, no underflow); false for zero and NaN.
template <int D>
bool makeUnit(Vec<D>& v) {
  const Real largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return false;
  v /= largest;
  v /= v.norm();
  return true;
}

/// Removes from n, twice because once leaves the rounding of a long v behind, its part along the unit vector e.
template <int D>
void removeAlong(Vec<D>& n, const Vec<D>& e) {
  n -= n.dot(e) * e;
  n -= n.dot(e) * e;
}

/// Largest |coordinate| of the core in its own frame (m); of a plane 0.
template <int D>
Real coreReach(const ShapeView<D>& shape) {
  switch (shape.core()) {
    case CoreClass::point:
    case CoreClass::segment:
    case CoreClass::box:
    case CoreClass::curved:
    case CoreClass::plane:
      return shape.half.maxCoeff();
    case CoreClass::hull:
      break;
  }
  Real reach = 0;
  for (const Vec<D>& v : shape.hull->vertices) reach = std::max(reach, v.cwiseAbs().maxCoeff());
  return reach;
}

template <int D>
struct CorePair {
  ShapeView<D> a, b;
  Vec<D> p;        // p_AB
  Mat<D> r;        // R_AB
  Real scale = 0;  // m; coordinates are rounded to about kEpsilon * scale

  CorePair(const PairBatch<D>& batch, int i) {
    const auto n = static_cast<std::size_t>(i);
    a.kind = batch.kindA, a.radius = batch.radiusA[n], a.hull = batch.hullA[n], a.curved = batch.curvedA[n];
    b.kind = batch.kindB, b.radius = batch.radiusB[n], b.hull = batch.hullB[n], b.curved = batch.curvedB[n];
    for (int d = 0; d < D; ++d) {
      const auto k = static_cast<std::size_t>(d);
      a.half[d] = batch.halfA[k][n], b.half[d] = batch.halfB[k][n], p[d] = batch.p[k][n];
      for (int e = 0; e < D; ++e) r(d, e) = batch.r[static_cast<std::size_t>(D * d + e)][n];
    }
    scale = std::max({coreReach(a), coreReach(b), p.cwiseAbs().maxCoeff()});
  }

  Real radii() const { return a.radius + b.radius; }
  /// The point of M that lies least far along n.
  Vec<D> support(const Vec<D>& n) const {
    return (p + r * coreSupport(b, Vec<D>(-(r.transpose() * n)))) - coreSupport(a, n);
  }
  /// L(n); n must be unit.
  Real bound(const Vec<D>& n) const {
    const Vec<D> back = -(r.transpose() * n);
    return (n.dot(p) - coreSupport(b, back).dot(back)) - coreSupport(a, n).dot(n);
  }
};

/// The best direction so far.
template <int D>
struct BestAxis {
  Vec<D> n = Vec<D>::Zero();
  Real bound = -std::numeric_limits<Real>::infinity();

  /// NaN is not taken.
  void take(const Vec<D>& direction, Real value) {
    if (value > bound) n = direction, bound = value;
  }
  /// Tests one more direction, of any length but zero.
  void tryDirection(const CorePair<D>& pair, Vec<D> direction, WorkDone& work) {
    if (!makeUnit<D>(direction)) return;
    ++work[WorkCount::axisTests];
    take(direction, pair.bound(direction));
  }
};

}  // namespace lpc::inline LPC_PRECISION::pair_query
