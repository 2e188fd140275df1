// SPDX-License-Identifier: Zlib
// Boxes, as SatBoxes has them (sat_boxes.h says why each step is there). Pairs whose features meet in more than a point
// are left: their witness is the middle of a polygon.
#include "algorithms/pair_query/pair_lanes.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL)
#define HWY_TARGET_INCLUDE "algorithms/pair_query/boxes_lanes.cpp"
#include <hwy/foreach_target.h>

#include "algorithms/pair_query/touching_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lpc::inline LPC_PRECISION::pair_query::HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR
class BoxLanes {
 public:
  HWY_INLINE explicit BoxLanes(const LanePairs& in) : m_in(in) {
    const Lane none = all(-std::numeric_limits<Real>::infinity());
    m_widest = m_bound = none;
    m_axis = m_tests = all(0);
    m_n = m_edge = {{all(0), all(0), all(0)}};
    m_left = hn::Not(in.halfA[0] > all(0));  // flat boxes have no edges along what they lack
    for (int k = 0; k < 3; ++k) {
      m_left = hn::Or(m_left, hn::Not(hn::And(in.halfA[k] > all(0), in.halfB[k] > all(0))));
    }
  }

  /// The best bound; lanes that are left have none.
  HWY_INLINE void run() {
    const LanePairs& in = m_in;
    const Turn& r = in.r;
    Turn flat;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) flat.v[i][j] = hn::Abs(r.v[i][j]);
    }
    for (int k = 0; k < 3; ++k) {
      const Lane reachB =
          sumOneByOne(flat.v[k][0] * in.halfB[0], flat.v[k][1] * in.halfB[1], flat.v[k][2] * in.halfB[2]);
      offer(hn::Abs(in.p[k]) - (in.halfA[k] + reachB), k);
      offer(hn::Abs(dot(column(r, k), in.p)) - (in.halfB[k] + dot(column(flat, k), in.halfA)), 3 + k);
    }
    m_tests = all(6);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) offerEdge(flat, i, j);
    }
    takeWidest();
    const Mask apart = m_bound > all(-kBoundRounding) * in.scale;
    if (any(apart)) tryCorners(apart);
  }

  Lane bound() const { return m_bound; }
  const Lane3& normal() const { return m_n; }
  Lane tests() const { return m_tests; }
  Mask left() const { return m_left; }

 private:
  HWY_INLINE void offer(Lane gap, int axis) {
    const Mask wider = gap > m_widest;
    m_widest = choose(wider, gap, m_widest), m_axis = choose(wider, all(static_cast<Real>(axis)), m_axis);
  }
  // The common normal of edge i of A and j of B, any length, as Eigen's product has it with a unit vector.
  HWY_INLINE Lane3 across(int i, int j) const {
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    const Lane zero = hn::Zero(Tag());
    const Turn& r = m_in.r;
    Lane3 n;
    n[i] = zero * r.v[l][j] - zero * r.v[k][j];
    n[k] = zero * r.v[i][j] - r.v[l][j];
    n[l] = r.v[k][j] - zero * r.v[i][j];
    return n;
  }
  HWY_INLINE void offerEdge(const Turn& flat, int i, int j) {
    const LanePairs& in = m_in;
    const Turn& r = in.r;
    const int k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, n = (j + 2) % 3;
    const Lane zero = hn::Zero(Tag());
    const Lane length2 = r.v[k][j] * r.v[k][j] + r.v[l][j] * r.v[l][j];
    const Mask crossed = length2 > all(kParallelSine * kParallelSine);
    m_tests = m_tests + hn::IfThenElseZero(crossed, all(1));
    const Mask close = hn::And(crossed, length2 < all(kShortNormal * kShortNormal));
    if (any(close)) {
      const Lane3 axis = across(i, j);
      take(axis / hn::Sqrt(dot(axis, axis)), close);
    }
    const Lane along = hn::Abs(r.v[k][j] * in.p[l] - r.v[l][j] * in.p[k]);
    const Lane reach = in.halfA[k] * flat.v[l][j] + in.halfA[l] * flat.v[k][j] + in.halfB[m] * flat.v[i][n] +
                       in.halfB[n] * flat.v[i][m];
    const Lane gap = along - reach;
    const Mask narrower = hn::And(gap < zero, hn::Or(m_widest >= zero, gap * gap > m_widest * m_widest * length2));
    const Mask offered = hn::AndNot(hn::Or(narrower, close), crossed);
    if (!any(offered)) return;
    const Lane distance = gap / hn::Sqrt(length2);
    const Mask wider = hn::And(offered, distance > m_widest);
    m_widest = choose(wider, distance, m_widest), m_axis = choose(wider, all(6), m_axis);
    m_edge = choose(wider, across(i, j), m_edge);
  }

  HWY_INLINE void take(const Lane3& n, Mask offered) {
    const LanePairs& in = m_in;
    const Lane along = dot(n, in.p);
    const Lane reach = dot(in.halfA, abs(n)) + dot(in.halfB, abs(turnedBack(in.r, n)));
    takeIfBetter(choose(along < hn::Zero(Tag()), -n, n), hn::Abs(along) - reach, offered);
  }
  HWY_INLINE void takeIfBetter(const Lane3& n, Lane bound, Mask offered) {
    const Mask better = hn::And(offered, bound > m_bound);
    m_n = choose(better, n, m_n), m_bound = choose(better, bound, m_bound);
  }
  HWY_INLINE void takeWidest() {
    const Lane one = all(1), zero = hn::Zero(Tag());
    Lane3 n = m_edge / hn::Sqrt(dot(m_edge, m_edge));
    for (int k = 0; k < 3; ++k) {
      n = choose(m_axis == all(static_cast<Real>(3 + k)), column(m_in.r, k), n);
      Lane3 unit = {{zero, zero, zero}};
      unit[k] = one;
      n = choose(m_axis == all(static_cast<Real>(k)), unit, n);
    }
    take(n, m_axis >= zero);
  }

  // f(mask, v, ofA) for each corner that may be within `most`, of the asked lanes; f renews `most`.
  template <class F>
  HWY_INLINE void forCorners(Mask asked, Lane& most, F&& f) const {
    const LanePairs& in = m_in;
    const Lane proved = m_bound, two = all(2);
    const Lane3 n = m_n, back = -turnedBack(in.r, n);
    for (const bool ofA : {true, false}) {
      const Lane3 &half = ofA ? in.halfA : in.halfB, &other = ofA ? in.halfB : in.halfA, &along = ofA ? n : back;
      const Lane3 corner = withSignOf(half, along);
      Lane3 q[8];
      Lane lag[8];
      q[0] = ofA ? turnedBack(in.r, corner - in.p) : in.p + turned(in.r, corner);
      lag[0] = hn::Zero(Tag());
      for (int bits = 0; bits < 8; ++bits) {
        if (bits > 0) {
          const int top = bits >= 4 ? 2 : bits >= 2 ? 1 : 0, rest = bits - (1 << top);
          lag[bits] = lag[rest] + two * half[top] * hn::Abs(along[top]);
          q[bits] = q[rest] - two * corner[top] * (ofA ? row(in.r, top) : column(in.r, top));
        }
        const Mask near = hn::AndNot(proved + lag[bits] > most, asked);
        if (!any(near)) continue;
        Lane3 v;
        for (int k = 0; k < 3; ++k) {
          const Lane x = q[bits][k], low = choose(x < hn::Neg(other[k]), hn::Neg(other[k]), x);
          v[k] = choose(other[k] < low, other[k], low) - x;
        }
        f(near, v, ofA);
      }
    }
  }
  HWY_INLINE Lane3 toB(const Lane3& v, bool ofA) const { return ofA ? turned(m_in.r, v) : -v; }
  HWY_INLINE void tryDirection(Mask asked, const Lane3& direction) {
    const Lane square = dot(direction, direction);
    m_left = hn::Or(m_left, hn::AndNot(isSafeSquare(square), asked));
    m_tests = m_tests + hn::IfThenElseZero(asked, all(1));
    const Lane3 n = direction / hn::Sqrt(square);
    takeIfBetter(n, m_in.bound(n), asked);
  }

  HWY_INLINE void tryCorners(Mask apart) {
    const Lane infinity = all(std::numeric_limits<Real>::infinity()), slack = all(kBoundRounding) * m_in.scale;
    Lane least2 = infinity, most = infinity;
    Lane3 nearest = {{all(0), all(0), all(0)}};
    forCorners(apart, most, [&](Mask near, const Lane3& v, bool ofA) HWY_ATTR {
      const Lane length2 = dot(v, v);
      const Mask nearer = hn::And(near, length2 < least2);
      if (!any(nearer)) return;
      least2 = choose(nearer, length2, least2), nearest = choose(nearer, toB(v, ofA), nearest);
      most = choose(nearer, hn::Sqrt(length2) + slack, most);
    });
    tryDirection(apart, nearest);
    const Lane least = hn::Sqrt(least2);
    const Mask tied = hn::AndNot(m_bound >= least - slack, apart);
    if (!any(tied)) return;
    Lane tie = least + all(kTiePart) * least + all(kTieRounding) * m_in.scale;
    forCorners(tied, tie, [&](Mask near, const Lane3& v, bool ofA) HWY_ATTR {
      const Mask asked = hn::And(near, hn::Sqrt(dot(v, v)) <= tie);
      if (any(asked)) tryDirection(asked, toB(v, ofA));
    });
  }

  const LanePairs& m_in;
  Lane m_widest, m_axis;  // 0 to 2: A's, 3 to 5: B's, 6: m_edge
  Lane3 m_edge;
  Lane m_bound, m_tests;
  Lane3 m_n;
  Mask m_left;
};

HWY_INLINE std::uint64_t answerBoxes(const PairView<3>* pairs, QueryNeed need, PairAnswer<3>* answers, WorkDone& work) {
  const LanePairs in(pairs);
  BoxLanes boxes(in);
  boxes.run();
  LaneAnswers out;
  Mask answered = hn::Not(boxes.left());
  if (need == QueryNeed::witnesses) {
    answered = hn::And(answered, TouchingLanes<3>(in, boxes.normal()).find(boxes.bound(), out));
  } else {
    out.normal = boxes.normal();
    out.distance = boxes.bound() - (in.radiusA + in.radiusB);
    out.pA = out.pB = {{all(0), all(0), all(0)}};
  }
  answered = hn::And(answered, hn::IsFinite(out.distance));
  out.store(answers, QueryStatus::converged);
  HWY_ALIGN Real tests[kLanes];
  hn::Store(hn::IfThenElseZero(answered, boxes.tests()), Tag(), tests);
  for (std::size_t i = 0; i < hn::Lanes(Tag()); ++i) {
    work[WorkCount::axisTests] += static_cast<std::uint64_t>(static_cast<int>(tests[i]));
  }
  return othersThan(answered);
}
#endif

std::uint64_t boxes(std::span<const PairView<3>> pairs, [[maybe_unused]] QueryNeed need,
                    [[maybe_unused]] std::span<PairAnswer<3>> answers, [[maybe_unused]] WorkDone& work) {
  std::uint64_t left = 0;
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const std::size_t n = hn::Lanes(Tag());
  for (; i + n <= pairs.size(); i += n) left |= answerBoxes(&pairs[i], need, &answers[i], work) << i;
#endif
  for (; i < pairs.size(); ++i) left |= std::uint64_t{1} << i;
  return left;
}

}  // namespace lpc::inline LPC_PRECISION::pair_query::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lpc::inline LPC_PRECISION::pair_query {
HWY_EXPORT(boxes);
std::uint64_t boxesInLanes(std::span<const PairView<3>> pairs, QueryNeed need, std::span<PairAnswer<3>> answers,
                           WorkDone& work) {
  return HWY_DYNAMIC_DISPATCH(boxes)(pairs, need, answers, work);
}
}  // namespace lpc::inline LPC_PRECISION::pair_query
#endif
