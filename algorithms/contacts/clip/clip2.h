// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/clip/core2.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

struct Patch2 {
  Vec<2> normal = Vec<2>::Zero();  // n_12, unit, in frame 1
  int count = 0;
  IndexedArray<PatchPoint<2>, 2> points;

  Real deepest() const {
    if (count == 0) return std::numeric_limits<Real>::infinity();
    return count == 1 ? points[0].separation : std::min(points[0].separation, points[1].separation);
  }
};

/// Writes single numbers and never copies the struct: see Xy.
inline void write(PatchPoint<2>& to, const Xy& p1, const Xy& p2, Real separation, std::uint64_t feature) {
  p1.to(to.p1), p2.to(to.p2), to.separation = separation, to.feature = feature;
}

/// Clips edges that face each other along n to the two ends of their common interval. The feature number is that of the
/// two vertices at this end, whichever of them cuts. A vertex that slides over the other's end therefore keeps its
/// number, also when the reference edge changes.
inline void clipEdges(const Edge2& e1, const Edge2& e2, const Xy& n, const PlacedPair<2>& pair, Patch2& out) {
  n.to(out.normal), out.count = 0;
  // Edge 1 runs along t; edge 2, which faces it, against t.
  const Xy t = n.left();
  const Real lo1 = dot(t, e1.a), hi1 = dot(t, e1.b), lo2 = dot(t, e2.b), hi2 = dot(t, e2.a);
  const Real lo = std::max(lo1, lo2), hi = std::min(hi1, hi2);
  if (hi < lo) return;
  const auto at = [](const Xy& from, const Xy& to, Real first, Real last, Real where) {
    if (where == first || !(last > first)) return from;
    if (where == last) return to;
    return from + (where - first) / (last - first) * (to - from);
  };
  const auto put = [&](Real where, int i1, int i2) {
    const Xy p1 = at(e1.a, e1.b, lo1, hi1, where), p2 = at(e2.b, e2.a, lo2, hi2, where);
    const Real separation = dot(p2 - p1, n);
    if (!(separation <= pair.limit)) return;
    write(out.points[out.count++], p1, p2, separation, featureNumber(featureCode(i1), featureCode(i2)));
  };
  if (hi - lo <= pair.rounding) {  // a single point
    const auto heightAt = [&](Real where) {
      return dot(at(e2.b, e2.a, lo2, hi2, where) - at(e1.a, e1.b, lo1, hi1, where), n);
    };
    return heightAt(hi) < heightAt(lo) ? put(hi, e1.ib, e2.ia) : put(lo, e1.ia, e2.ib);
  }
  put(lo, e1.ia, e2.ib), put(hi, e1.ib, e2.ia);
}

/// The closest points of two edges that do not cross: one contact point. The normal is the vector between them, or
/// `axis` if the cores are not apart.
inline void closestOfEdges(const Edge2& e1, const Edge2& e2, const Xy& axis, bool apart, const PlacedPair<2>& pair,
                           Patch2& out) {
  out.count = 0;
  Real best = std::numeric_limits<Real>::infinity();
  Xy p1{0, 0}, p2{0, 0};
  std::uint64_t feature = 0;
  const auto onSegment = [](const Xy& p, const Edge2& e, bool& nearB) {
    const Xy d = e.b - e.a;
    const Real length2 = dot(d, d), along = dot(p - e.a, d);
    nearB = 2 * along > length2;
    if (!(along > 0)) return e.a;
    if (along >= length2) return e.b;
    return e.a + along / length2 * d;
  };
  const auto offer = [&](const Xy& on1, const Xy& on2, int i1, int i2) {
    const Xy between = on2 - on1;
    const Real d2 = dot(between, between);
    if (d2 < best) best = d2, p1 = on1, p2 = on2, feature = featureNumber(featureCode(i1), featureCode(i2));
  };
  for (bool end : {false, true}) {
    bool nearB = false;
    const Xy& v1 = end ? e1.b : e1.a;
    const Xy on2 = onSegment(v1, e2, nearB);
    offer(v1, on2, end ? e1.ib : e1.ia, nearB ? e2.ib : e2.ia);
    const Xy& v2 = end ? e2.b : e2.a;
    const Xy on1 = onSegment(v2, e1, nearB);
    offer(on1, v2, nearB ? e1.ib : e1.ia, end ? e2.ib : e2.ia);
  }
  const Real distance = std::sqrt(best);
  // Below rounding distance the direction between the closest points is noise; the separating axis is not.
  const Xy between = p2 - p1;
  const Xy n = apart && distance > pair.rounding ? between / distance : axis;
  n.to(out.normal);
  const Real separation = dot(between, n);
  if (separation <= pair.limit) write(out.points[out.count++], p1, p2, separation, feature);
}

}}}  // namespace lpc::LPC_PRECISION::contacts
