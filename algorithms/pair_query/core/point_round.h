// SPDX-License-Identifier: Zlib
// A point against a solid of revolution with a straight outline: a cylinder or a cone. Only the point's position along
// the axis and its distance from it matter; in these coordinates the solid is a convex polygon.
#pragma once

#include "algorithms/pair_query/core/core_pair.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// One line of the outline, from `begin` to `end`, as (position along the axis, distance from it) (m), with the outward
/// unit normal.
struct OutlineEdge {
  Vec<2> begin, end, normal;

  Real above(const Vec<2>& q) const { return normal.dot(q - begin); }
  /// From the nearest point of the line to q.
  Vec<2> toPoint(const Vec<2>& q) const {
    const Vec<2> along = end - begin;
    return q - begin - std::clamp((q - begin).dot(along) / along.squaredNorm(), Real(0), Real(1)) * along;
  }
};

/// Takes the direction of the signed distance of A's core, a point, from B's, a cylinder or a cone.
inline void pointRound(const CorePair<3>& pair, BestAxis<3>& best, WorkDone& work) {
  const Real h = pair.b.half[0], r = pair.b.half[1];
  std::array<OutlineEdge, 3> edges = {
      {{{-h, 0}, {-h, r}, {-1, 0}}, {{-h, r}, {h, r}, {0, 1}}, {{h, r}, {h, 0}, {1, 0}}}};
  std::size_t count = 3;
  if (pair.b.kind == ShapeKind::cone) {  // its base at -h, its tip at h
    const Vec<2> out(r, 2 * h);
    edges[1] = {{-h, r}, {h, 0}, out / out.norm()};
    count = 2;
  }
  const Vec<3> inB = -(pair.r.transpose() * pair.p);
  Vec<3> across(0, inB[1], inB[2]);
  const Vec<2> q(inB[0], across.norm());
  if (!makeUnit<3>(across)) across = Vec<3>::Unit(1);  // on the axis: every direction across it is correct
  const auto attempt = [&](const Vec<2>& d) {
    best.tryDirection(pair, -(pair.r * Vec<3>(d[0] * Vec<3>::Unit(0) + d[1] * across)), work);
  };
  std::size_t highest = 0, nearest = 0;
  for (std::size_t i = 1; i < count; ++i) {
    if (edges[i].above(q) > edges[highest].above(q)) highest = i;
    if (edges[i].toPoint(q).squaredNorm() < edges[nearest].toPoint(q).squaredNorm()) nearest = i;
  }
  const bool outside = edges[highest].above(q) > 0;
  if (outside) attempt(edges[nearest].toPoint(q));
  // Near the surface the vector to it is mostly rounding; the normals of the lines are not.
  if (!outside || best.bound < edges[nearest].toPoint(q).norm() - kBoundRounding * pair.scale) {
    for (std::size_t i = 0; i < count; ++i) attempt(edges[i].normal);
  }
}

}}}  // namespace lpc::LPC_PRECISION::pair_query
