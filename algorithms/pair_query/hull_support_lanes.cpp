// SPDX-License-Identifier: Zlib
#include "algorithms/pair_query/hull_support.h"
#include "framework/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL)
#define HWY_TARGET_INCLUDE "algorithms/pair_query/hull_support_lanes.cpp"
#include "hwy/foreach_target.h"
// After the one that includes this file again and again.
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace lpc::inline LPC_PRECISION::pair_query {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMostLanes = kManyVertices / 2;
using Tag = hn::CappedTag<Real, kMostLanes>;
using Lanes = hn::Vec<Tag>;

// Of each lane the first vertex that is farthest, with its index as a number (a float holds 2^24 of them).
struct Farthest {
  Lanes far, index;
};

// The first of the two where they are equally far.
HWY_INLINE Farthest farther(const Farthest& first, const Farthest& second) {
  const auto more = hn::Gt(second.far, first.far);
  return {hn::IfThenElse(more, second.far, first.far), hn::IfThenElse(more, second.index, first.index)};
}

std::size_t farthestOf(const Real* HWY_RESTRICT vertices, std::size_t count, Real dx, Real dy, Real dz) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Lanes alongX = hn::Set(d, dx), alongY = hn::Set(d, dy), alongZ = hn::Set(d, dz);
  const auto at = [&](std::size_t i, Lanes index) HWY_ATTR {
    Lanes x, y, z;
    hn::LoadInterleaved3(d, vertices + 3 * i, x, y, z);
    x = hn::Mul(x, alongX), y = hn::Mul(y, alongY), z = hn::Mul(z, alongZ);
    // Added in the order in which Vec::dot adds them, in either precision.
    return Farthest{sizeof(Real) == 8 ? hn::Add(hn::Add(x, y), z) : hn::Add(x, hn::Add(y, z)), index};
  };
  // Two runs, so that one comparison need not wait for the one before it. The last vertices may be looked at twice:
  // they are no farther the second time.
  const Lanes step = hn::Set(d, static_cast<Real>(2 * lanes));
  Lanes even = hn::Iota(d, 0), odd = hn::Iota(d, static_cast<Real>(lanes));
  Farthest low = at(0, even), high = at(lanes, odd);
  std::size_t i = 2 * lanes;
  for (; i + 2 * lanes <= count; i += 2 * lanes) {
    even = hn::Add(even, step), odd = hn::Add(odd, step);
    low = farther(low, at(i, even)), high = farther(high, at(i + lanes, odd));
  }
  if (i + lanes <= count) low = farther(low, at(i, hn::Add(even, step)));
  if (i < count) high = farther(high, at(count - lanes, hn::Iota(d, static_cast<Real>(count - lanes))));
  HWY_ALIGN Real far[2 * kMostLanes], index[2 * kMostLanes];
  hn::Store(low.far, d, far), hn::Store(low.index, d, index);
  hn::Store(high.far, d, far + lanes), hn::Store(high.index, d, index + lanes);
  Real most = far[0], best = index[0];
  for (std::size_t k = 1; k < 2 * lanes; ++k) {
    const bool more = (far[k] > most) | ((far[k] == most) & (index[k] < best));
    most = more ? far[k] : most, best = more ? index[k] : best;
  }
  return static_cast<std::size_t>(best);
}

}  // namespace HWY_NAMESPACE
}  // namespace lpc::inline LPC_PRECISION::pair_query
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lpc::inline LPC_PRECISION::pair_query {

HWY_EXPORT(farthestOf);
std::size_t farthestVertex(const std::vector<Vec<3>>& vertices, const Vec<3>& d) {
  LPC_ASSERT(vertices.size() >= kManyVertices);
  return HWY_DYNAMIC_DISPATCH(farthestOf)(vertices.data()->data(), vertices.size(), d[0], d[1], d[2]);
}

}  // namespace lpc::inline LPC_PRECISION::pair_query
#endif
