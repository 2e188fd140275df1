// SPDX-License-Identifier: Zlib
// Closest points of many pairs of boxes and segments at once: TouchingBoxes and TouchingPoint::place, one pair per
// lane.
#if defined(LPC_TOUCHING_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LPC_TOUCHING_LANES_INL_H
#undef LPC_TOUCHING_LANES_INL_H
#else
#define LPC_TOUCHING_LANES_INL_H
#endif

#include "algorithms/pair_query/lanes/pair_lanes-inl.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace lpc { inline namespace LPC_PRECISION { namespace pair_query { namespace HWY_NAMESPACE {

/// kAxes: number of axes along which the cores extend, 1 for segments.
template <int kAxes>
class TouchingLanes {
 public:
  HWY_INLINE TouchingLanes(const LanePairs& pair, const Lane3& n) : m_pair(pair), m_n(n) {
    m_band = all(kFeatureBand) * pair.scale;
  }

  /// Writes the answers that have the bound along n; the mask has the lanes with closest points.
  HWY_INLINE Mask find(Lane bound, LaneAnswers& out) const {
    const LanePairs& in = m_pair;
    const Lane3 back = -turnedBack(in.r, m_n);
    const Lane3 onA = withSignOf(in.halfA, m_n), onB = withSignOf(in.halfB, back);
    const Feature a = feature(in.halfA, m_n), b = feature(in.halfB, back);
    const Lane3 inA = in.p + turned(in.r, onB);  // B's corner
    Lane3 common = onA;
    Mask found = hn::And(a.corner, meets(in.halfB, b, onB, turnedBack(in.r, onA - in.p), back));
    const Mask ofB = hn::AndNot(a.corner, b.corner);
    if (any(ofB)) {
      common = choose(ofB, inA, common);
      found = hn::Or(found, hn::And(ofB, meets(in.halfA, a, onA, inA, m_n)));
    }
    const Mask edges = hn::And(a.edge, b.edge);
    if (any(edges)) found = hn::Or(found, hn::And(edges, crossing(a, onA, b, onB, inA, edges, common)));
    common = common - dot(common, m_n) * m_n;
    place(common, bound, out);
    return found;
  }

 private:
  struct Feature {
    Mask free[3];  // the axes along which it extends
    Mask corner, edge;
  };
  HWY_INLINE Feature feature(const Lane3& half, const Lane3& n) const {
    const Lane zero = hn::Zero(Tag());
    Feature f;
    for (int k = 0; k < kAxes; ++k) {
      f.free[k] = hn::And(half[k] > zero, all(2) * hn::Abs(n[k]) * half[k] <= m_band);
    }
    if constexpr (kAxes == 1) {
      f.corner = hn::Not(f.free[0]), f.edge = f.free[0];
    } else {
      const Mask some = hn::Or(f.free[0], f.free[1]), both = hn::And(f.free[0], f.free[1]);
      f.corner = hn::Not(hn::Or(some, f.free[2]));
      f.edge = hn::AndNot(both, hn::Xor(some, f.free[2]));
    }
    return f;
  }
  HWY_INLINE Mask meets(const Lane3& half, const Feature& f, Lane3 corner, const Lane3& q, const Lane3& n) const {
    for (int k = 0; k < kAxes; ++k) corner[k] = choose(f.free[k], clamp(q[k], hn::Neg(half[k]), half[k]), corner[k]);
    corner = corner - q;
    corner = corner - dot(corner, n) * n;
    return dot(corner, corner) <= m_band * m_band;
  }
  // The component, or column, along the free axis of an edge.
  static HWY_INLINE Lane along(const Feature& f, const Lane3& v) {
    if constexpr (kAxes == 1) return v[0];
    return choose(f.free[0], v[0], choose(f.free[1], v[1], v[2]));
  }
  HWY_INLINE Mask crossing(const Feature& a, const Lane3& onA, const Feature& b, const Lane3& onB, const Lane3& from,
                           Mask edges, Lane3& common) const {
    const LanePairs& in = m_pair;
    const Lane3 u = {{along(b, row(in.r, 0)), along(b, row(in.r, 1)), along(b, row(in.r, 2))}};
    const Lane cosine = along(a, u), sine2 = dot(u, u) - cosine * cosine;
    const Lane3 w = from - onA;
    const Lane alongA = along(a, w), alongB = dot(w, u);
    const Lane t = (alongA * cosine - alongB) / sine2, s = alongA + t * cosine;
    const Lane placeA = along(a, onA) + s, placeB = along(b, onB) + t;
    Mask found = hn::And(sine2 > all(kCrossingSine * kCrossingSine), hn::Abs(placeA) <= along(a, in.halfA));
    found = hn::And(found, hn::Abs(placeB) <= along(b, in.halfB));
    Lane3 place = onA;
    for (int k = 0; k < kAxes; ++k) place[k] = choose(a.free[k], placeA, place[k]);
    const Lane3 gap = from + t * u - place;
    const Lane3 miss = gap - dot(gap, m_n) * m_n;
    place = place + miss / all(2);
    common = choose(edges, place, common);
    return hn::And(found, dot(miss, miss) <= m_band * m_band);
  }
  HWY_INLINE void place(const Lane3& common, Lane bound, LaneAnswers& out) const {
    const Lane zero = hn::Zero(Tag());
    Lane3 foremost = withSignOf(m_pair.halfA, m_n);  // coreSupport: a segment has no extent across it
    for (int k = kAxes; k < 3; ++k) foremost[k] = zero;
    out.normal = m_n;
    out.distance = bound - (m_pair.radiusA + m_pair.radiusB);
    out.pA = common + (dot(foremost, m_n) + m_pair.radiusA) * m_n;
    out.pB = out.pA + out.distance * m_n;
  }

  const LanePairs& m_pair;
  const Lane3& m_n;
  Lane m_band;
};

}}}}  // namespace lpc::LPC_PRECISION::pair_query::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#endif
