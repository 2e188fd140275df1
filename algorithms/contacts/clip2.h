// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/core2.h"

namespace lpc::inline LPC_PRECISION::contacts {

struct Patch2 {
  Vec<2> normal = Vec<2>::Zero();  // n_12, unit, in frame 1
  int count = 0;
  std::array<PatchPoint<2>, 2> points;

  Real deepest() const {
    Real s = std::numeric_limits<Real>::infinity();
    for (int i = 0; i < count; ++i) s = std::min(s, points[static_cast<std::size_t>(i)].separation);
    return s;
  }
  void add(const PatchPoint<2>& p, Real limit) {
    if (p.separation <= limit) points[static_cast<std::size_t>(count++)] = p;
  }
};

/// Where the edges face each other as seen along n: the two ends of their common interval. The feature number is that
/// of the two vertices at this end, whichever of them is the one that cuts: a vertex that slides over the other's end
/// changes nothing, and neither does a change of the reference edge.
inline void clipEdges(const Edge2& e1, const Edge2& e2, const Vec<2>& n, const PlacedPair<2>& pair, Patch2& out) {
  out.normal = n, out.count = 0;
  // Edge 1 runs along t, edge 2, which faces it, against t.
  const Vec<2> t(-n[1], n[0]);
  const Real lo1 = t.dot(e1.a), hi1 = t.dot(e1.b), lo2 = t.dot(e2.b), hi2 = t.dot(e2.a);
  const Real lo = std::max(lo1, lo2), hi = std::min(hi1, hi2);
  if (hi < lo) return;
  const auto at = [](const Vec<2>& from, const Vec<2>& to, Real first, Real last, Real where) -> Vec<2> {
    if (where == first || !(last > first)) return from;
    if (where == last) return to;
    return from + (where - first) / (last - first) * (to - from);
  };
  const auto point = [&](Real where, int i1, int i2) {
    const Vec<2> p1 = at(e1.a, e1.b, lo1, hi1, where), p2 = at(e2.b, e2.a, lo2, hi2, where);
    return PatchPoint<2>{p1, p2, (p2 - p1).dot(n), featureNumber(featureCode(i1), featureCode(i2))};
  };
  const PatchPoint<2> low = point(lo, e1.ia, e2.ib), high = point(hi, e1.ib, e2.ia);
  if (hi - lo <= pair.rounding) {  // one place
    out.add(high.separation < low.separation ? high : low, pair.limit);
    return;
  }
  out.add(low, pair.limit), out.add(high, pair.limit);
}

/// The nearest points of two edges that do not cross; one contact point. The normal is the way from one to the other,
/// or `axis` when the cores are not apart.
inline void closestOfEdges(const Edge2& e1, const Edge2& e2, const Vec<2>& axis, bool apart, const PlacedPair<2>& pair,
                           Patch2& out) {
  out.count = 0;
  Real best = std::numeric_limits<Real>::infinity();
  PatchPoint<2> point{};
  const auto onSegment = [](const Vec<2>& p, const Edge2& e, bool& nearB) -> Vec<2> {
    const Vec<2> d = e.b - e.a;
    const Real length2 = d.squaredNorm(), along = (p - e.a).dot(d);
    nearB = 2 * along > length2;
    if (!(along > 0)) return e.a;
    if (along >= length2) return e.b;
    return e.a + along / length2 * d;
  };
  const auto offer = [&](const Vec<2>& p1, const Vec<2>& p2, int i1, int i2) {
    const Real d2 = (p2 - p1).squaredNorm();
    if (d2 < best) {
      best = d2;
      point = {p1, p2, 0, featureNumber(featureCode(i1), featureCode(i2))};
    }
  };
  for (bool end : {false, true}) {
    bool nearB = false;
    const Vec<2>& v1 = end ? e1.b : e1.a;
    const Vec<2> on2 = onSegment(v1, e2, nearB);
    offer(v1, on2, end ? e1.ib : e1.ia, nearB ? e2.ib : e2.ia);
    const Vec<2>& v2 = end ? e2.b : e2.a;
    const Vec<2> on1 = onSegment(v2, e1, nearB);
    offer(on1, v2, nearB ? e1.ib : e1.ia, end ? e2.ib : e2.ia);
  }
  const Real distance = std::sqrt(best);
  // Nearer than rounding, the direction between the witnesses is noise; the separating axis is not.
  out.normal = apart && distance > pair.rounding ? Vec<2>((point.p2 - point.p1) / distance) : axis;
  point.separation = (point.p2 - point.p1).dot(out.normal);
  out.add(point, pair.limit);
}

}  // namespace lpc::inline LPC_PRECISION::contacts
