// SPDX-License-Identifier: Zlib
// Two bounded cores (the shapes without their rounding radii) in A's frame, and the bound on which all answers of this
// folder rest. With M = { b - a } and a unit vector n,
//
// L(n) = min over M of n . m = -h_A(n) - h_B(-n)   <=   phi = max over unit d of L(d),
//
// where phi is the signed distance of the cores, apart or penetrating. Every unit vector, even one made of rounding,
// therefore gives a proved lower bound: a method can miss the best axis but never win with a wrong one. Methods collect
// candidate directions, keep the best bound, and report that bound as the distance.
#pragma once

#include <algorithm>
#include <limits>

#include "algorithms/pair_query/core/hull_climb.h"
#include "algorithms/pair_query/core/hull_support.h"
#include "algorithms/pair_query/trace/watch.h"
#include "framework/shape/support_map.h"
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// Normalises v, whatever its length (no overflow, no underflow); false for zero and NaN.
template <int D>
bool makeUnit(Vec<D>& v) {
  Real square = v.squaredNorm();
  if (!(square > kSafeSquare && square < 1 / kSafeSquare)) {
    const Real largest = v.cwiseAbs().maxCoeff();
    if (!(largest > 0)) return false;
    v /= largest;
    square = v.squaredNorm();
  }
  v /= std::sqrt(square);
  return true;
}

/// Removes from n its component along the unit vector e, twice, because one pass leaves the rounding of a long v.
template <int D>
void removeAlong(Vec<D>& n, const Vec<D>& e) {
  n -= n.dot(e) * e;
  n -= n.dot(e) * e;
}

/// coreSupport; for a hull with many vertices either several at a time or by a climb from the last result. All ways
/// return the same vertex.
template <int D>
Vec<D> farthest(const ShapeView<D>& shape, const Vec<D>& d, int* hint = nullptr, int* climb = nullptr) {
  if constexpr (D == 3) {
    if (shape.core() == CoreClass::hull && shape.hull->vertices.size() >= kManyVertices) {
      if (climb && shape.hull->vertices.size() >= kClimbVertices) {
        if (const int top = climbToFarthest(*shape.hull, d, *climb); top >= 0) {
          *climb = top;
          if (hint) *hint = top;
          return shape.hull->vertices[top];
        }
      }
      const std::size_t best = farthestVertex(shape.hull->vertices, d);
      if (hint) *hint = static_cast<int>(best);
      return shape.hull->vertices[best];
    }
  }
  return coreSupport(shape, d, hint);
}

template <int D>
struct CorePair {
  const ShapeView<D>&a, &b;             // references: the shapes must outlive this
  Vec<D> p;                             // p_AB
  Mat<D> r;                             // R_AB
  Real scale;                           // m; coordinates are rounded to about kEpsilon * scale
  std::array<int, 2>* climb = nullptr;  // vertices from which climbs on A and B start; null: brute force
  HullPair* hulls = nullptr;  // two hulls, for searches with many supports without a climb; null: one vertex at a time

  explicit CorePair(const PairView<D>& pair) : a(pair.a), b(pair.b), p(pair.X_AB.p), r(pair.X_AB.q.matrix()), scale(0) {
    for (int k = 0; k < D; ++k) scale = std::max({scale, a.half[k], b.half[k], std::abs(p[k])});
  }
  /// Other shapes at the same poses and scale.
  CorePair withShapes(const ShapeView<D>& first, const ShapeView<D>& second) const {
    return CorePair(first, second, p, r, scale);
  }

  Real radii() const { return a.radius + b.radius; }
  /// The point of M with the smallest projection on n.
  Vec<D> support(const Vec<D>& n) const {
    if constexpr (D == 3) {
      if (hulls) return hulls->support(p, r, n).point;
    }
    return (p + r * farthest(b, Vec<D>(-(r.transpose() * n)), nullptr, climbOnB())) -
           farthest(a, n, nullptr, climbOnA());
  }
  /// L(n); n must be unit.
  Real bound(const Vec<D>& n) const {
    if (a.core() <= CoreClass::box && b.core() <= CoreClass::box) {  // their own mirror images
      return n.dot(p) - a.half.dot(n.cwiseAbs()) - b.half.dot((r.transpose() * n).cwiseAbs());
    }
    const Vec<D> back = -(r.transpose() * n);
    return (n.dot(p) - farthest(b, back, nullptr, climbOnB()).dot(back)) - farthest(a, n, nullptr, climbOnA()).dot(n);
  }
  int* climbOnA() const { return climb ? climb->data() : nullptr; }
  int* climbOnB() const { return climb ? climb->data() + 1 : nullptr; }

 private:
  CorePair(const ShapeView<D>& first, const ShapeView<D>& second, const Vec<D>& place, const Mat<D>& turn, Real size)
      : a(first), b(second), p(place), r(turn), scale(size) {}
};

/// The best direction so far.
template <int D>
struct BestAxis {
  Vec<D> n = Vec<D>::Zero();
  Real bound = -std::numeric_limits<Real>::infinity();

  /// NaN is rejected.
  void take(const Vec<D>& direction, Real value) {
    if (value > bound) n = direction, bound = value;
  }
  /// Tests another direction, of any nonzero length.
  template <class Watch = NoWatch>
  void tryDirection(const CorePair<D>& pair, Vec<D> direction, WorkDone& work, const Watch& watch = {}) {
    if (!makeUnit<D>(direction)) return;
    ++work[WorkCount::axisTests];
    const Real value = pair.bound(direction);
    take(direction, value);
    watch([&](auto& t) { t.axis(pair, direction, value, *this, "between the nearest features"); });
  }
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
