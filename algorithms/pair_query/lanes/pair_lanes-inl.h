// SPDX-License-Identifier: Zlib
// Shared by the kernels for many pairs at once: one pair per SIMD lane, in 3D, once for each instruction set. Each
// function repeats its scalar version in the same order, so that a lane has the same bits: no fused multiply-adds, and
// sums of three start where Eigen's do. Where the scalar version would take a rare branch, the lane is left to it.
#if defined(LPC_PAIR_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LPC_PAIR_LANES_INL_H
#undef LPC_PAIR_LANES_INL_H
#else
#define LPC_PAIR_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>

#include "algorithms/pair_query/tolerances.h"
#include "framework/stage/stage_narrowphase.h"

#if HWY_TARGET != HWY_SCALAR  // one lane: that is the scalar code
HWY_BEFORE_NAMESPACE();
namespace lpc { inline namespace LPC_PRECISION { namespace pair_query { namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::ScalableTag<Real>;
using Two = hn::CappedTag<Real, 2>;
using Four = hn::CappedTag<Real, 4>;
using Lane = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;
inline constexpr std::size_t kLanes = HWY_MAX_BYTES / sizeof(Real);

struct Lane3 {
  Lane v[3];
  Lane& operator[](int k) { return v[k]; }
  const Lane& operator[](int k) const { return v[k]; }
};
struct Turn {
  Lane v[3][3];  // by row
};

HWY_INLINE Lane all(Real x) { return hn::Set(Tag(), x); }
HWY_INLINE Lane choose(Mask m, Lane yes, Lane no) { return hn::IfThenElse(m, yes, no); }
HWY_INLINE Lane3 choose(Mask m, const Lane3& yes, const Lane3& no) {
  return {{choose(m, yes[0], no[0]), choose(m, yes[1], no[1]), choose(m, yes[2], no[2])}};
}
HWY_INLINE bool any(Mask m) { return !hn::AllFalse(Tag(), m); }

/// Sums as Eigen does, with entries that it takes two at a time (in f64) and one by one.
HWY_INLINE Lane sum(Lane a, Lane b, Lane c) { return sizeof(Real) == 8 ? (a + b) + c : a + (b + c); }
HWY_INLINE Lane sumOneByOne(Lane a, Lane b, Lane c) { return a + (b + c); }

HWY_INLINE Lane3 operator+(const Lane3& a, const Lane3& b) { return {{a[0] + b[0], a[1] + b[1], a[2] + b[2]}}; }
HWY_INLINE Lane3 operator-(const Lane3& a, const Lane3& b) { return {{a[0] - b[0], a[1] - b[1], a[2] - b[2]}}; }
HWY_INLINE Lane3 operator-(const Lane3& a) { return {{hn::Neg(a[0]), hn::Neg(a[1]), hn::Neg(a[2])}}; }
HWY_INLINE Lane3 operator*(Lane s, const Lane3& a) { return {{s * a[0], s * a[1], s * a[2]}}; }
HWY_INLINE Lane3 operator/(const Lane3& a, Lane s) { return {{a[0] / s, a[1] / s, a[2] / s}}; }
HWY_INLINE Lane3 abs(const Lane3& a) { return {{hn::Abs(a[0]), hn::Abs(a[1]), hn::Abs(a[2])}}; }
HWY_INLINE Lane dot(const Lane3& a, const Lane3& b) { return sum(a[0] * b[0], a[1] * b[1], a[2] * b[2]); }
HWY_INLINE Lane3 column(const Turn& r, int j) { return {{r.v[0][j], r.v[1][j], r.v[2][j]}}; }
HWY_INLINE Lane3 row(const Turn& r, int i) { return {{r.v[i][0], r.v[i][1], r.v[i][2]}}; }

HWY_INLINE Lane3 turned(const Turn& r, const Lane3& a) {
  return {{sum(r.v[0][0] * a[0], r.v[0][1] * a[1], r.v[0][2] * a[2]),
           sum(r.v[1][0] * a[0], r.v[1][1] * a[1], r.v[1][2] * a[2]),
           sumOneByOne(r.v[2][0] * a[0], r.v[2][1] * a[1], r.v[2][2] * a[2])}};
}
HWY_INLINE Lane3 turnedBack(const Turn& r, const Lane3& a) {
  return {{dot(column(r, 0), a), dot(column(r, 1), a), dot(column(r, 2), a)}};
}

HWY_INLINE Lane clamp(Lane x, Lane lo, Lane hi) { return choose(x < lo, lo, choose(hi < x, hi, x)); }
HWY_INLINE Lane larger(Lane a, Lane b) { return choose(a < b, b, a); }
HWY_INLINE Lane3 withSignOf(const Lane3& half, const Lane3& n) {
  const Lane zero = hn::Zero(Tag());
  return {{choose(n[0] >= zero, half[0], hn::Neg(half[0])), choose(n[1] >= zero, half[1], hn::Neg(half[1])),
           choose(n[2] >= zero, half[2], hn::Neg(half[2]))}};
}

/// Copies in as few pieces as the registers allow: two stores are not forwarded to one load.
HWY_INLINE void copyFour(const Real* from, Real* to) {
  for (std::size_t k = 0; k < 4; k += hn::Lanes(Four())) hn::StoreU(hn::LoadU(Four(), from + k), Four(), to + k);
}

/// Squares of safe size for a direct square root: makeUnit of core_pair.h.
HWY_INLINE Mask isSafeSquare(Lane square) { return hn::And(square > all(kSafeSquare), square < all(1 / kSafeSquare)); }

/// As many pairs as there are lanes, transposed.
struct LanePairs {
  Lane radiusA, radiusB;
  Lane3 halfA, halfB, p;
  Turn r;
  Lane scale;

  HWY_INLINE explicit LanePairs(const PairView<3>* pairs) {
    // Loads four consecutive numbers of each pair, then transposes them into lanes.
    static_assert(offsetof(ShapeView<3>, half) == offsetof(ShapeView<3>, radius) + sizeof(Real));
    static_assert(offsetof(Pose<3>, q) == 3 * sizeof(Real) && sizeof(Pose<3>) == 7 * sizeof(Real));
    HWY_ALIGN Real four[4][4 * kLanes];
    const std::size_t n = hn::Lanes(Tag());
    for (std::size_t i = 0; i < n; ++i) {
      const PairView<3>& pair = pairs[i];
      copyFour(&pair.a.radius, &four[0][4 * i]);
      copyFour(&pair.b.radius, &four[1][4 * i]);
      copyFour(&pair.X_AB.p[0], &four[2][4 * i]);
      copyFour(&pair.X_AB.q.w, &four[3][4 * i]);
    }
    Lane w, x, y, z;
    hn::LoadInterleaved4(Tag(), four[0], radiusA, halfA[0], halfA[1], halfA[2]);
    hn::LoadInterleaved4(Tag(), four[1], radiusB, halfB[0], halfB[1], halfB[2]);
    hn::LoadInterleaved4(Tag(), four[2], p[0], p[1], p[2], w);
    hn::LoadInterleaved4(Tag(), four[3], w, x, y, z);
    const Lane one = all(1), two = all(2);
    r = {{{one - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y)},
          {two * (x * y + w * z), one - two * (x * x + z * z), two * (y * z - w * x)},
          {two * (x * z - w * y), two * (y * z + w * x), one - two * (x * x + y * y)}}};
    scale = all(0);
    const Lane3 far = abs(p);
    for (int k = 0; k < 3; ++k) scale = larger(larger(larger(scale, halfA[k]), halfB[k]), far[k]);
  }

  /// L(n) of core_pair.h.
  HWY_INLINE Lane bound(const Lane3& n) const {
    return dot(n, p) - dot(halfA, abs(n)) - dot(halfB, abs(turnedBack(r, n)));
  }
};

struct LaneAnswers {
  Lane distance;
  Lane3 normal, pA, pB;

  HWY_INLINE void store(PairAnswer<3>* answers, QueryStatus status) const {
    static_assert(offsetof(PairAnswer<3>, normal) == offsetof(PairAnswer<3>, distance) + sizeof(Real));
    static_assert(offsetof(PairAnswer<3>, pB) == offsetof(PairAnswer<3>, distance) + 7 * sizeof(Real));
    HWY_ALIGN Real first[4 * kLanes], second[4 * kLanes], third[2 * kLanes];
    hn::StoreInterleaved4(distance, normal[0], normal[1], normal[2], Tag(), first);
    hn::StoreInterleaved4(pA[0], pA[1], pA[2], pB[0], Tag(), second);
    hn::StoreInterleaved2(pB[1], pB[2], Tag(), third);
    const std::size_t n = hn::Lanes(Tag());
    for (std::size_t i = 0; i < n; ++i) {
      answers[i].status = status;
      Real* numbers = &answers[i].distance;
      copyFour(&first[4 * i], numbers);
      copyFour(&second[4 * i], numbers + 4);
      hn::StoreU(hn::LoadU(Two(), &third[2 * i]), Two(), numbers + 8);
    }
  }
};

/// Bit i: lane i is not in the mask.
HWY_INLINE std::uint64_t othersThan(Mask m) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Tag(), m, bits);
  std::uint64_t in = 0;
  for (std::size_t i = 0; i < sizeof bits; ++i) in |= std::uint64_t{bits[i]} << (8 * i);
  return ~in & ((std::uint64_t{1} << hn::Lanes(Tag())) - 1);
}

}}}}  // namespace lpc::LPC_PRECISION::pair_query::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#endif
