// SPDX-License-Identifier: Zlib
// Rounded segments, as in ClosedForm::segmentSegment. Parallel segments, and segments that meet along a common
// interval, are left to the scalar code.
#include <bit>

#include "algorithms/pair_query/lanes/pair_lanes.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL)
#define HWY_TARGET_INCLUDE "algorithms/pair_query/lanes/segments_lanes.cpp"
#include <hwy/foreach_target.h>

#include "algorithms/pair_query/lanes/touching_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lpc { inline namespace LPC_PRECISION { namespace pair_query { namespace HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR
class SegmentLanes {
 public:
  HWY_INLINE explicit SegmentLanes(const PairView<3>* pairs) : m_in(pairs), m_u(column(m_in.r, 0)) {}

  /// Tries the direction of the difference of the closest points; the mask has the lanes in which it suffices.
  HWY_INLINE Mask takeDifference(QueryNeed need) {
    const Lane zero = hn::Zero(Tag()), lA = m_in.halfA[0], lB = m_in.halfB[0];
    const Lane3 &p = m_in.p, &u = m_u;
    const Lane across2 = u[1] * u[1] + u[2] * u[2], shift = hn::Neg(p[1] * u[1] + p[2] * u[2]);
    Lane tB = clamp(shift / across2, hn::Neg(lB), lB);
    const Lane tA = clamp(p[0] + tB * u[0], hn::Neg(lA), lA);
    tB = clamp(sumOneByOne((tA - p[0]) * u[0], (tA * zero - p[1]) * u[1], (tA * zero - p[2]) * u[2]), hn::Neg(lB), lB);
    m_v = difference(tB);
    const Lane square = dot(m_v, m_v), length = hn::Sqrt(square), slack = all(kBoundRounding) * m_in.scale;
    m_n = m_v / length, m_bound = m_in.bound(m_n), m_tests = all(1);
    m_known = hn::And(across2 > zero, isSafeSquare(square));
    Mask enough = m_bound >= length - slack;
    if (need == QueryNeed::boolean) {
      const Lane radii = m_in.radiusA + m_in.radiusB;
      enough = hn::Or(enough, hn::Or(m_bound > radii, length + slack < radii));
    }
    return hn::And(m_known, enough);
  }

  /// Tries all other directions of segmentSegment; the mask has the lanes in which all could be tried.
  HWY_INLINE Mask tryOthers() {
    const Lane zero = hn::Zero(Tag()), lA = m_in.halfA[0], lB = m_in.halfB[0];
    const Lane3 ownAxis = {{all(1), zero, zero}};
    tryPerpendicular(ownAxis), tryPerpendicular(m_u);
    const Lane3 common = {{zero, hn::Neg(m_u[2]), m_u[1]}};
    tryDirection(common), tryDirection(-common);
    tryDirection(difference(hn::Neg(lB))), tryDirection(difference(lB));
    for (const Lane end : {hn::Neg(lA), lA}) {
      const Lane3 toB = m_in.p - end * ownAxis;
      tryDirection(toB + clamp(hn::Neg(dot(toB, m_u)), hn::Neg(lB), lB) * m_u);
    }
    return m_known;
  }

  HWY_INLINE Mask answer(QueryNeed need, LaneAnswers& out) const {
    if (need == QueryNeed::closestPoints) {
      const Mask found = TouchingLanes<1>(m_in, m_n).find(m_bound, out);
      return hn::And(found, hn::IsFinite(out.distance));
    }
    const Lane zero = hn::Zero(Tag());
    out.normal = m_n;
    out.distance = m_bound - (m_in.radiusA + m_in.radiusB);
    out.pA = out.pB = {{zero, zero, zero}};
    return hn::IsFinite(out.distance);
  }
  Lane tests() const { return m_tests; }

 private:
  HWY_INLINE Lane3 difference(Lane onB) const {
    Lane3 v = m_in.p + onB * m_u;
    v[0] = v[0] - clamp(v[0], hn::Neg(m_in.halfA[0]), m_in.halfA[0]);
    return v;
  }
  HWY_INLINE void tryDirection(const Lane3& direction) {
    const Lane square = dot(direction, direction);
    m_known = hn::And(m_known, isSafeSquare(square));
    m_tests = m_tests + all(1);
    const Lane3 n = direction / hn::Sqrt(square);
    const Lane bound = m_in.bound(n);
    const Mask better = bound > m_bound;
    m_n = choose(better, n, m_n), m_bound = choose(better, bound, m_bound);
  }
  HWY_INLINE void tryPerpendicular(const Lane3& e) {
    Lane3 v = m_v - dot(m_v, e) * e;
    v = v - dot(v, e) * e;
    tryDirection(v);
    // tangents() of space.h
    const Lane one = all(1), sign = choose(e[2] >= hn::Zero(Tag()), one, all(-1));
    const Lane a = all(-1) / (sign + e[2]), b = e[0] * e[1] * a;
    const Lane3 first = {{one + sign * e[0] * e[0] * a, sign * b, hn::Neg(sign) * e[0]}};
    const Lane3 second = {{b, sign + e[1] * e[1] * a, hn::Neg(e[1])}};
    tryDirection(first), tryDirection(-first);
    tryDirection(second), tryDirection(-second);
  }

  LanePairs m_in;
  Lane3 m_u, m_v, m_n;
  Lane m_bound, m_tests;
  Mask m_known;
};

// Few pairs need more than one direction, but twenty times the work: they are collected, so that all lanes are busy.
// The last group may be incomplete, and then repeats its first pair.
std::uint64_t searchSegments(std::span<const PairView<3>> pairs, std::uint64_t asked, QueryNeed need,
                             std::span<PairAnswer<3>> answers, WorkDone& work) {
  const std::size_t n = hn::Lanes(Tag());
  std::uint64_t left = 0;
  PairView<3> some[kLanes];
  PairAnswer<3> found[kLanes];
  std::size_t place[kLanes];
  HWY_ALIGN Real tests[kLanes];
  while (asked != 0) {
    std::size_t count = 0;
    for (; count < n && asked != 0; ++count, asked &= asked - 1) {
      place[count] = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero64(asked));
      some[count] = pairs[place[count]];
    }
    for (std::size_t i = count; i < n; ++i) some[i] = some[0];
    SegmentLanes lanes(some);
    lanes.takeDifference(need);
    LaneAnswers out;
    const Mask tried = lanes.tryOthers();
    const std::uint64_t without = othersThan(hn::And(tried, lanes.answer(need, out)));
    out.store(found, QueryStatus::converged);
    hn::Store(lanes.tests(), Tag(), tests);
    for (std::size_t i = 0; i < count; ++i) {
      if ((without >> i) & 1) {
        left |= std::uint64_t{1} << place[i];
      } else {
        answers[place[i]] = found[i];
        work[WorkCount::axisTests] += static_cast<std::uint64_t>(static_cast<int>(tests[i]));
      }
    }
  }
  return left;
}
#endif

std::uint64_t segments(std::span<const PairView<3>> pairs, [[maybe_unused]] QueryNeed need,
                       [[maybe_unused]] std::span<PairAnswer<3>> answers, [[maybe_unused]] WorkDone& work) {
  std::uint64_t left = 0;
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const std::size_t n = hn::Lanes(Tag());
  std::uint64_t unproved = 0;
  for (; i + n <= pairs.size(); i += n) {
    SegmentLanes lanes(&pairs[i]);
    LaneAnswers out;
    const Mask enough = lanes.takeDifference(need);
    unproved |= othersThan(enough) << i;
    left |= othersThan(hn::Or(hn::Not(enough), lanes.answer(need, out))) << i;
    out.store(&answers[i], QueryStatus::converged);
  }
  const std::uint64_t asked = i < 64 ? (std::uint64_t{1} << i) - 1 : ~std::uint64_t{0};
  work[WorkCount::axisTests] += static_cast<std::uint64_t>(std::popcount(asked & ~unproved & ~left));
  left |= searchSegments(pairs, unproved, need, answers, work);
#endif
  for (; i < pairs.size(); ++i) left |= std::uint64_t{1} << i;
  return left;
}

}}}}  // namespace lpc::LPC_PRECISION::pair_query::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {
HWY_EXPORT(segments);
std::uint64_t segmentsInLanes(std::span<const PairView<3>> pairs, QueryNeed need, std::span<PairAnswer<3>> answers,
                              WorkDone& work) {
  return HWY_DYNAMIC_DISPATCH(segments)(pairs, need, answers, work);
}
}}}  // namespace lpc::LPC_PRECISION::pair_query
#endif
