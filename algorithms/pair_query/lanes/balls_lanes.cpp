// SPDX-License-Identifier: Zlib
// Balls, as in ClosedForm::balls.
#include "algorithms/pair_query/lanes/pair_lanes.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL)
#define HWY_TARGET_INCLUDE "algorithms/pair_query/lanes/balls_lanes.cpp"
#include <hwy/foreach_target.h>

#include "algorithms/pair_query/lanes/pair_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lpc { inline namespace LPC_PRECISION { namespace pair_query { namespace HWY_NAMESPACE {

std::uint64_t balls(std::span<const PairView<3>> pairs, [[maybe_unused]] std::span<PairAnswer<3>> answers) {
  std::uint64_t left = 0;
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const std::size_t n = hn::Lanes(Tag());
  for (; i + n <= pairs.size(); i += n) {
    const LanePairs in(&pairs[i]);
    const Lane square = dot(in.p, in.p);
    LaneAnswers out;
    out.normal = in.p / hn::Sqrt(square);
    out.distance = dot(out.normal, in.p) - in.radiusA - in.radiusB;
    out.pA = in.radiusA * out.normal;
    out.pB = in.p - in.radiusB * out.normal;
    out.store(&answers[i], QueryStatus::converged);
    left |= othersThan(hn::And(isSafeSquare(square), hn::IsFinite(out.distance))) << i;
  }
#endif
  for (; i < pairs.size(); ++i) left |= std::uint64_t{1} << i;
  return left;
}

}}}}  // namespace lpc::LPC_PRECISION::pair_query::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {
HWY_EXPORT(balls);
std::uint64_t ballsInLanes(std::span<const PairView<3>> pairs, std::span<PairAnswer<3>> answers) {
  return HWY_DYNAMIC_DISPATCH(balls)(pairs, answers);
}
}}}  // namespace lpc::LPC_PRECISION::pair_query
#endif
