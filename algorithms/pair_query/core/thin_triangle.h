// SPDX-License-Identifier: Zlib
// A point or a segment against a triangle: there are so few candidate directions that all are tested, unless the
// closest points prove the distance at once.
#pragma once

#include "algorithms/pair_query/core/core_pair.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// The vector from the nearest point of a segment on the x axis, `lA` (m) long on both sides of the origin, to that of
/// a segment around p along the unit vector u, `lB` long on both sides. For parallel segments: in the middle of their
/// common interval.
template <int D>
Vec<D> segmentGap(const Vec<D>& p, const Vec<D>& u, Real lA, Real lB) {
  // A lies on its own x axis: the components of u across it have no cancellation.
  const Real across2 = u.template tail<D - 1>().squaredNorm();
  const Real shift = -p.template tail<D - 1>().dot(u.template tail<D - 1>());
  const auto overlapMiddle = [&] {  // for parallel segments: the middle of their common interval, as a position on B
    const Real x = (std::max(-lA, p[0] - lB) + std::min(lA, p[0] + lB)) / 2;
    return std::clamp(u[0] > 0 ? x - p[0] : p[0] - x, -lB, lB);
  };
  Real tB = across2 > 0 ? std::clamp(shift / across2, -lB, lB) : overlapMiddle();
  const Real tA = std::clamp(p[0] + tB * u[0], -lA, lA);
  tB = std::clamp((tA * Vec<D>::Unit(0) - p).dot(u), -lB, lB);
  Vec<D> v = p + tB * u;
  v[0] -= std::clamp(v[0], -lA, lA);
  return v;
}

/// Takes the direction of the signed distance of A's core, a point or a segment, from B's, a triangle.
inline void thinTriangle(const CorePair<3>& pair, BestAxis<3>& best, WorkDone& work) {
  const Real l = pair.a.core() == CoreClass::point ? Real(0) : pair.a.half[0];
  const auto& corners = pair.b.hull->vertices;
  std::array<Vec<3>, 3> w;
  for (std::size_t k = 0; k < 3; ++k) w[k] = pair.p + pair.r * corners[k];
  const Vec<3> normal = pair.r * pair.b.hull->faces[0].normal;
  best.tryDirection(pair, normal, work);
  best.tryDirection(pair, -normal, work);

  struct Side {
    Vec<3> middle, along;  // along: unit
    Real half;
  };
  std::array<Side, 3> sides;
  // A vector between two interior points has rounding along the lines, because their ends are far away: the
  // components along the lines are removed.
  const auto attempt = [&](const Vec<3>& v, const Side& side) {
    best.tryDirection(pair, v, work);
    Vec<3> upright = v;
    removeAlong<3>(upright, side.along);
    best.tryDirection(pair, upright, work);
    if (l > 0) best.tryDirection(pair, Vec<3>(0, v[1], v[2]), work);
  };
  Vec<3> shortest = Vec<3>::Constant(std::numeric_limits<Real>::infinity());
  std::size_t nearest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec<3>&from = w[k], &to = w[(k + 1) % 3];
    Vec<3> along = to - from;
    const Real length = along.norm();
    along /= length;
    sides[k] = {(from + to) / 2, along, length / 2};
    const Vec<3> v = segmentGap<3>(sides[k].middle, along, l, length / 2);
    if (v.squaredNorm() < shortest.squaredNorm()) shortest = v, nearest = k;
  }
  attempt(shortest, sides[nearest]);
  if (best.bound >= shortest.norm() - kBoundRounding * pair.scale) return;
  for (std::size_t k = 0; k < 3; ++k) {
    const Side& side = sides[k];
    if (l > 0) {
      const Vec<3> common(0, -side.along[2], side.along[1]);
      best.tryDirection(pair, common, work);
      best.tryDirection(pair, -common, work);
    }
    // If segments are nearly parallel, rounding decides which of their points are nearest, but not the ends.
    for (const Real end : {-l, l}) {
      const Vec<3> toSide = side.middle - end * Vec<3>::Unit(0);
      attempt(toSide + std::clamp(-toSide.dot(side.along), -side.half, side.half) * side.along, side);
    }
    attempt({w[k][0] - std::clamp(w[k][0], -l, l), w[k][1], w[k][2]}, side);
  }
}

}}}  // namespace lpc::LPC_PRECISION::pair_query
