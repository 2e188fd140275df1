// SPDX-License-Identifier: Zlib
// Rounded segments, as ClosedForm::segmentSegment has them. What the difference of the nearest points does not prove,
// and segments that are parallel, are left.
#include "algorithms/pair_query/pair_lanes.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL)
#define HWY_TARGET_INCLUDE "algorithms/pair_query/segments_lanes.cpp"
#include <hwy/foreach_target.h>

#include "algorithms/pair_query/touching_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lpc::inline LPC_PRECISION::pair_query::HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR
// The mask is of the lanes that are answered.
HWY_INLINE Mask answerSegments(const LanePairs& in, QueryNeed need, LaneAnswers& out) {
  const Lane zero = hn::Zero(Tag());
  const Lane3& p = in.p;
  const Lane3 u = column(in.r, 0);
  const Lane lA = in.halfA[0], lB = in.halfB[0];
  const Lane across2 = u[1] * u[1] + u[2] * u[2], shift = hn::Neg(p[1] * u[1] + p[2] * u[2]);
  Lane tB = clamp(shift / across2, hn::Neg(lB), lB);
  const Lane tA = clamp(p[0] + tB * u[0], hn::Neg(lA), lA);
  tB = clamp(sumOneByOne((tA - p[0]) * u[0], (tA * zero - p[1]) * u[1], (tA * zero - p[2]) * u[2]), hn::Neg(lB), lB);
  Lane3 v = p + tB * u;
  v[0] = v[0] - clamp(v[0], hn::Neg(lA), lA);
  const Lane square = dot(v, v), length = hn::Sqrt(square);
  const Lane3 n = v / length;
  const Lane bound = in.bound(n);
  Mask answered = hn::And(across2 > zero, isSafeSquare(square));
  answered = hn::And(answered, bound >= length - all(kBoundRounding) * in.scale);
  if (need == QueryNeed::witnesses) {
    answered = hn::And(answered, TouchingLanes<1>(in, n).find(bound, out));
  } else {
    out.normal = n;
    out.distance = bound - (in.radiusA + in.radiusB);
    out.pA = out.pB = {{zero, zero, zero}};
  }
  return hn::And(answered, hn::IsFinite(out.distance));
}
#endif

std::uint64_t segments(std::span<const PairView<3>> pairs, [[maybe_unused]] QueryNeed need,
                       [[maybe_unused]] std::span<PairAnswer<3>> answers) {
  std::uint64_t left = 0;
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const std::size_t n = hn::Lanes(Tag());
  for (; i + n <= pairs.size(); i += n) {
    const LanePairs in(&pairs[i]);
    LaneAnswers out;
    left |= othersThan(answerSegments(in, need, out)) << i;
    out.store(&answers[i], QueryStatus::converged);
  }
#endif
  for (; i < pairs.size(); ++i) left |= std::uint64_t{1} << i;
  return left;
}

}  // namespace lpc::inline LPC_PRECISION::pair_query::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lpc::inline LPC_PRECISION::pair_query {
HWY_EXPORT(segments);
std::uint64_t segmentsInLanes(std::span<const PairView<3>> pairs, QueryNeed need, std::span<PairAnswer<3>> answers) {
  return HWY_DYNAMIC_DISPATCH(segments)(pairs, need, answers);
}
}  // namespace lpc::inline LPC_PRECISION::pair_query
#endif
