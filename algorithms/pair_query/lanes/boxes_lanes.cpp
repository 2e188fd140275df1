// SPDX-License-Identifier: Zlib
// Boxes, as in SatBoxes (sat_boxes3.h explains each step). Pairs with features that meet in more than a point are left
// to the scalar code: their closest point is the middle of a polygon.
#include "algorithms/pair_query/lanes/pair_lanes.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL)
#define HWY_TARGET_INCLUDE "algorithms/pair_query/lanes/boxes_lanes.cpp"
#include <hwy/foreach_target.h>

#include "algorithms/pair_query/lanes/touching_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lpc { inline namespace LPC_PRECISION { namespace pair_query { namespace HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR
class BoxLanes {
 public:
  HWY_INLINE BoxLanes(const LanePairs& in, QueryNeed need) : m_in(in), m_need(need) {
    const Lane none = all(-std::numeric_limits<Real>::infinity());
    m_widest = m_bound = none;
    m_axis = m_tests = all(0);
    m_n = {{all(0), all(0), all(0)}};
    m_short = hn::Not(none == none);
    m_left = hn::Not(in.halfA[0] > all(0));  // flat boxes lack edges along their flat axes
    for (int k = 0; k < 3; ++k) {
      m_left = hn::Or(m_left, hn::Not(hn::And(in.halfA[k] > all(0), in.halfB[k] > all(0))));
    }
  }

  /// Finds the best bound; lanes that are left to the scalar code have none.
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
    offerAllEdges(flat, kEdges);
    takeWidest();
    Mask apart = m_bound > all(-kBoundRounding) * in.scale;
    if (m_need == QueryNeed::boolean) apart = hn::And(apart, m_bound <= in.radiusA + in.radiusB);
    if (any(apart)) apart = hn::AndNot(hn::AndNot(m_short, attained()), apart);
    if (any(apart)) tryCorners(apart);
  }

  Lane bound() const { return m_bound; }
  const Lane3& normal() const { return m_n; }
  Lane tests() const { return m_tests; }
  Mask left() const { return m_left; }

 private:
  static constexpr std::make_integer_sequence<int, 9> kEdges{};

  HWY_INLINE void offer(Lane gap, int axis) {
    const Mask wider = gap > m_widest;
    m_widest = choose(wider, gap, m_widest), m_axis = choose(wider, all(static_cast<Real>(axis)), m_axis);
  }
  // The common normal of edge i of A and j of B, of any length, computed as Eigen's product with a unit vector.
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
  // Edge e / 3 of A and e % 3 of B. The indices must be compile-time constants: the compiler does not unroll a loop
  // over nine by itself.
  template <int e>
  HWY_INLINE void measureEdges(const Turn& flat) {
    constexpr int i = e / 3, j = e % 3, k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, n = (j + 2) % 3;
    const LanePairs& in = m_in;
    const Turn& r = in.r;
    m_length2[e] = r.v[k][j] * r.v[k][j] + r.v[l][j] * r.v[l][j];
    const Lane along = hn::Abs(r.v[k][j] * in.p[l] - r.v[l][j] * in.p[k]);
    const Lane reach = in.halfA[k] * flat.v[l][j] + in.halfA[l] * flat.v[k][j] + in.halfB[m] * flat.v[i][n] +
                       in.halfB[n] * flat.v[i][m];
    m_gap[e] = along - reach;
    m_distance[e] = m_gap[e] / hn::Sqrt(m_length2[e]);
  }
  template <int e>
  HWY_INLINE void offerEdges() {
    const Lane length2 = m_length2[e], gap = m_gap[e], distance = m_distance[e], zero = hn::Zero(Tag());
    const Mask crossed = length2 > all(kParallelSine * kParallelSine);
    m_tests = m_tests + hn::IfThenElseZero(crossed, all(1));
    const Mask close = hn::And(crossed, length2 < all(kShortNormal * kShortNormal));
    m_short = hn::Or(m_short, close);
    if (any(close)) {
      const Lane3 axis = across(e / 3, e % 3);
      take(axis / hn::Sqrt(dot(axis, axis)), close);
    }
    const Mask narrower = hn::And(gap < zero, hn::Or(m_widest >= zero, gap * gap > m_widest * m_widest * length2));
    const Mask wider = hn::AndNot(hn::Or(narrower, close), hn::And(crossed, distance > m_widest));
    m_widest = choose(wider, distance, m_widest), m_axis = choose(wider, all(static_cast<Real>(6 + e)), m_axis);
  }
  // All square roots precede the first comparison: interleaved, they would wait for each other.
  template <int... e>
  HWY_INLINE void offerAllEdges(const Turn& flat, std::integer_sequence<int, e...>) {
    (measureEdges<e>(flat), ...);
    (offerEdges<e>(), ...);
  }
  template <int... e>
  HWY_INLINE Lane3 widestOfEdges(std::integer_sequence<int, e...>) const {
    Lane3 n = {{hn::Zero(Tag()), hn::Zero(Tag()), hn::Zero(Tag())}};
    ((n = choose(m_axis == all(static_cast<Real>(6 + e)), across(e / 3, e % 3), n)), ...);
    return n / hn::Sqrt(dot(n, n));
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
    Lane3 n = {{zero, zero, zero}};
    if (any(m_axis >= all(6))) n = widestOfEdges(kEdges);
    for (int k = 0; k < 3; ++k) {
      n = choose(m_axis == all(static_cast<Real>(3 + k)), column(m_in.r, k), n);
      Lane3 unit = {{zero, zero, zero}};
      unit[k] = one;
      n = choose(m_axis == all(static_cast<Real>(k)), unit, n);
    }
    take(n, m_axis >= zero);
  }

  HWY_INLINE Mask axisIs(int number) const { return m_axis == all(static_cast<Real>(number)); }
  HWY_INLINE Mask attained() const {
    const LanePairs& in = m_in;
    const Lane3 back = -turnedBack(in.r, m_n);
    const Lane3 onA = withSignOf(in.halfA, m_n), onB = withSignOf(in.halfB, back);
    const Lane3 from = in.p + turned(in.r, onB), inB = turnedBack(in.r, onA - in.p);
    Mask aboveA[3], aboveB[3];
    for (int k = 0; k < 3; ++k) {
      aboveA[k] = hn::Abs(from[k]) <= in.halfA[k], aboveB[k] = hn::Abs(inB[k]) <= in.halfB[k];
    }
    Mask out = hn::Not(m_n[0] == m_n[0]);
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      out = hn::Or(out, hn::And(axisIs(k), hn::And(aboveA[l], aboveA[m])));
      out = hn::Or(out, hn::And(axisIs(3 + k), hn::And(aboveB[l], aboveB[m])));
    }
    const Mask edges = m_axis >= all(6);
    if (!any(edges)) return out;
    // Edge i of A, j of B.
    const Mask i0 = m_axis < all(9), i1 = m_axis < all(12);
    const Lane number = m_axis - choose(i0, all(6), choose(i1, all(9), all(12)));
    const Mask j0 = number == all(0), j1 = number == all(1);
    const auto ofA = [&](const Lane3& v) HWY_ATTR { return choose(i0, v[0], choose(i1, v[1], v[2])); };
    const auto ofB = [&](const Lane3& v) HWY_ATTR { return choose(j0, v[0], choose(j1, v[1], v[2])); };
    const Lane3 u = {{ofB(row(in.r, 0)), ofB(row(in.r, 1)), ofB(row(in.r, 2))}}, w = from - onA;
    const Lane cosine = ofA(u), sine2 = dot(u, u) - cosine * cosine, alongA = ofA(w), alongB = dot(w, u);
    const Lane t = (alongA * cosine - alongB) / sine2, s = alongA + t * cosine;
    Mask cross = hn::And(edges, sine2 > all(kCrossingSine * kCrossingSine));
    cross = hn::And(cross, hn::Abs(ofA(onA) + s) <= ofA(in.halfA));
    return hn::Or(out, hn::And(cross, hn::Abs(ofB(onB) + t) <= ofB(in.halfB)));
  }

  // A box's corners in the other's frame, with their distance `lag` (m) behind the support corner along the best axis.
  struct Corners {
    Lane3 q[8];
    Lane lag[8];
    Lane3 low, high;  // of the other box

    /// Vector from the corner to the nearest point of the other box.
    HWY_INLINE Lane3 toOther(int c) const {
      Lane3 v;
      for (int k = 0; k < 3; ++k) {
        const Lane x = q[c][k], raised = choose(x < low[k], low[k], x);
        v[k] = choose(high[k] < raised, high[k], raised) - x;
      }
      return v;
    }
  };
  HWY_INLINE Corners corners(bool ofA) const {
    const LanePairs& in = m_in;
    const Lane two = all(2);
    const Lane3& half = ofA ? in.halfA : in.halfB;
    const Lane3 along = ofA ? m_n : -turnedBack(in.r, m_n), corner = withSignOf(half, along);
    Corners c;
    c.high = ofA ? in.halfB : in.halfA, c.low = -c.high;
    c.q[0] = ofA ? turnedBack(in.r, corner - in.p) : in.p + turned(in.r, corner);
    c.lag[0] = hn::Zero(Tag());
    for (int k = 0; k < 3; ++k) {
      const Lane behind = two * half[k] * hn::Abs(along[k]);
      const Lane3 edge = two * corner[k] * (ofA ? row(in.r, k) : column(in.r, k));
      for (int i = 0; i < 1 << k; ++i) {
        c.q[i + (1 << k)] = c.q[i] - edge, c.lag[i + (1 << k)] = c.lag[i] + behind;
      }
    }
    return c;
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
    Lane least2[2] = {infinity, infinity};
    Lane3 nearest[2] = {};
    for (const int side : {0, 1}) {
      const Corners c = corners(side == 0);
      for (int i = 0; i < 8; ++i) {
        const Lane3 v = c.toOther(i);
        const Lane length2 = dot(v, v);
        const Mask nearer = length2 < least2[side];
        least2[side] = choose(nearer, length2, least2[side]), nearest[side] = choose(nearer, v, nearest[side]);
      }
    }
    const Mask ofB = least2[1] < least2[0];
    tryDirection(apart, choose(ofB, toB(nearest[1], false), toB(nearest[0], true)));
    const Lane least = hn::Sqrt(choose(ofB, least2[1], least2[0]));
    const Mask tied = hn::AndNot(m_bound >= least - slack, apart);
    if (any(tied)) tryTied(tied, least + all(kTiePart) * least + all(kTieRounding) * m_in.scale);
  }
  HWY_INLINE void tryTied(Mask tied, Lane tie) {
    const Lane proved = m_bound;
    const Corners both[2] = {corners(true), corners(false)};  // along the best axis so far
    for (const int side : {0, 1}) {
      for (int i = 0; i < 8; ++i) {
        const Mask near = hn::AndNot(proved + both[side].lag[i] > tie, tied);
        if (!any(near)) continue;
        const Lane3 v = both[side].toOther(i);
        const Mask asked = hn::And(near, hn::Sqrt(dot(v, v)) <= tie);
        if (any(asked)) tryDirection(asked, toB(v, side == 0));
      }
    }
  }

  const LanePairs& m_in;
  QueryNeed m_need;
  Lane m_widest, m_axis;  // axes numbered as in SatBoxes
  Lane m_gap[9], m_length2[9], m_distance[9];
  Lane m_bound, m_tests;
  Lane3 m_n;
  Mask m_left, m_short;
};

HWY_INLINE std::uint64_t answerBoxes(const PairView<3>* pairs, QueryNeed need, PairAnswer<3>* answers, WorkDone& work) {
  const LanePairs in(pairs);
  BoxLanes boxes(in, need);
  boxes.run();
  LaneAnswers out;
  Mask answered = hn::Not(boxes.left());
  if (need == QueryNeed::closestPoints) {
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

}}}}  // namespace lpc::LPC_PRECISION::pair_query::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {
HWY_EXPORT(boxes);
std::uint64_t boxesInLanes(std::span<const PairView<3>> pairs, QueryNeed need, std::span<PairAnswer<3>> answers,
                           WorkDone& work) {
  return HWY_DYNAMIC_DISPATCH(boxes)(pairs, need, answers, work);
}
}}}  // namespace lpc::LPC_PRECISION::pair_query
#endif
