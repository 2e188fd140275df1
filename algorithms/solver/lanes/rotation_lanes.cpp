// SPDX-License-Identifier: Zlib
#include "algorithms/solver/lanes/rotation_lanes.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL)
#define HWY_TARGET_INCLUDE "algorithms/solver/lanes/rotation_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lpc { inline namespace LPC_PRECISION { namespace solver { namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Wide = hn::ScalableTag<double>;  // sine and cosine are computed in double in either precision
using Tag = hn::Rebind<Real, Wide>;
using Double = hn::Vec<Wide>;
using Lane = hn::Vec<Tag>;
inline constexpr std::size_t kLanes = HWY_MAX_BYTES / sizeof(double);

template <class V>  // a template, so that only one branch is compiled
HWY_INLINE Double wide(V x) {
  if constexpr (sizeof(Real) == sizeof(double)) {
    return x;
  } else {
    return hn::PromoteTo(Wide(), x);
  }
}
template <class V>
HWY_INLINE Lane narrow(V x) {
  if constexpr (sizeof(Real) == sizeof(double)) {
    return x;
  } else {
    return hn::DemoteTo(Tag(), x);
  }
}

/// lpc::sinCos() for angles below an eighth of a turn; returns false if one is larger.
HWY_INLINE bool sinCosOfSmall(Double x, Double& s, Double& c) {
  const Wide tag;
  const Double one = hn::Set(tag, 1),
               quarters = hn::Floor(x * hn::Set(tag, 0.63661977236758134308) + hn::Set(tag, 0.5));
  if (!hn::AllTrue(tag, quarters == hn::Zero(tag))) return false;
  const Double r2 = x * x;
  s = c = one;
  for (int n = 16; n >= 2; n -= 2) {
    s = one - s * r2 / hn::Set(tag, static_cast<double>(n * (n + 1)));
    c = one - c * r2 / hn::Set(tag, static_cast<double>(n * (n - 1)));
  }
  s = s * x;
  return true;
}

/// A number of each body: number k of the item of type T.
template <class T>
HWY_INLINE Lane gather(std::span<T> items, const std::int32_t* bodies, std::size_t k) {
  HWY_ALIGN Real x[kLanes];
  for (std::size_t i = 0; i < hn::Lanes(Tag()); ++i) {
    x[i] = reinterpret_cast<const Real*>(&items[static_cast<std::size_t>(bodies[i])])[k];
  }
  return hn::Load(Tag(), x);
}
template <int N>
HWY_INLINE void normalize(Lane* q) {
  Lane square = q[0] * q[0];
  for (int k = 1; k < N; ++k) square = square + q[k] * q[k];
  const Lane length = hn::Sqrt(square);
  for (int k = 0; k < N; ++k) q[k] = q[k] / length;
}

HWY_INLINE bool turnGroup(std::span<Pose<2>> pose, std::span<const Motion<2>> motion, const std::int32_t* bodies,
                          Real dt, Lane* q) {
  const Lane w = gather(motion, bodies, 2);
  Double s, c;
  if (!sinCosOfSmall(wide(hn::Set(Tag(), dt) * w), s, c)) return false;
  const Lane turnC = narrow(c), turnS = narrow(s), oldC = gather(pose, bodies, 2), oldS = gather(pose, bodies, 3);
  q[0] = turnC * oldC - turnS * oldS, q[1] = turnS * oldC + turnC * oldS;
  normalize<2>(q);
  const hn::Mask<Tag> turns = w * w > hn::Zero(Tag());
  q[0] = hn::IfThenElse(turns, q[0], oldC), q[1] = hn::IfThenElse(turns, q[1], oldS);
  return true;
}
HWY_INLINE bool turnGroup(std::span<Pose<3>> pose, std::span<const Motion<3>> motion, const std::int32_t* bodies,
                          Real dt, Lane* q) {
  const Wide tag;
  Lane w[3], old[4];
  Double turn[3];
  for (std::size_t k = 0; k < 3; ++k) {
    w[k] = gather(motion, bodies, 3 + k);
    turn[k] = wide(hn::Set(Tag(), dt) * w[k]);
  }
  for (std::size_t k = 0; k < 4; ++k) old[k] = gather(pose, bodies, 3 + k);
  const Double n = hn::Sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]);
  Double s, c;
  if (!sinCosOfSmall(n / hn::Set(tag, 2), s, c)) return false;
  const Double k = hn::IfThenElse(n > hn::Zero(tag), s / n, hn::Set(tag, 0.5));
  Lane t[4] = {narrow(c), narrow(k * turn[0]), narrow(k * turn[1]), narrow(k * turn[2])};
  normalize<4>(t);
  q[0] = t[0] * old[0] - t[1] * old[1] - t[2] * old[2] - t[3] * old[3];
  q[1] = t[0] * old[1] + t[1] * old[0] + t[2] * old[3] - t[3] * old[2];
  q[2] = t[0] * old[2] - t[1] * old[3] + t[2] * old[0] + t[3] * old[1];
  q[3] = t[0] * old[3] + t[1] * old[2] - t[2] * old[1] + t[3] * old[0];
  normalize<4>(q);
  const Lane x = w[0] * w[0], y = w[1] * w[1], z = w[2] * w[2];
  const hn::Mask<Tag> turns = (sizeof(Real) == 8 ? (x + y) + z : x + (y + z)) > hn::Zero(Tag());
  for (int i = 0; i < 4; ++i) q[i] = hn::IfThenElse(turns, q[i], old[i]);
  return true;
}

template <int D>
void turn(std::span<Pose<D>> pose, std::span<const Motion<D>> motion, std::span<const std::int32_t> bodies, Real dt) {
  static_assert(sizeof(Pose<2>) == 4 * sizeof(Real) && sizeof(Pose<3>) == 7 * sizeof(Real));
  static_assert(sizeof(Motion<2>) == 3 * sizeof(Real) && sizeof(Motion<3>) == 6 * sizeof(Real));
  constexpr std::size_t kNumbers = D == 2 ? 2 : 4;
  const auto oneByOne = [&](std::span<const std::int32_t> some) {
    for (const std::int32_t slot : some) {
      const auto body = static_cast<std::size_t>(slot);
      const Ang<D>& w = motion[body].w;
      if (w.squaredNorm() > 0) pose[body].q = integrateRotation(pose[body].q, Ang<D>(dt * w));
    }
  };
  const std::size_t n = hn::Lanes(Tag());
  std::size_t i = 0;
  for (; n > 1 && i + n <= bodies.size(); i += n) {
    Lane q[kNumbers];
    if (!turnGroup(pose, motion, &bodies[i], dt, q)) {
      oneByOne(bodies.subspan(i, n));
      continue;
    }
    HWY_ALIGN Real to[kNumbers][kLanes];
    for (std::size_t k = 0; k < kNumbers; ++k) hn::Store(q[k], Tag(), to[k]);
    for (std::size_t lane = 0; lane < n; ++lane) {
      Real* const out = reinterpret_cast<Real*>(&pose[static_cast<std::size_t>(bodies[i + lane])].q);
      for (std::size_t k = 0; k < kNumbers; ++k) out[k] = to[k][lane];
    }
  }
  oneByOne(bodies.subspan(i));
}

void turn2(std::span<Pose<2>> pose, std::span<const Motion<2>> motion, std::span<const std::int32_t> bodies, Real dt) {
  turn<2>(pose, motion, bodies, dt);
}
void turn3(std::span<Pose<3>> pose, std::span<const Motion<3>> motion, std::span<const std::int32_t> bodies, Real dt) {
  turn<3>(pose, motion, bodies, dt);
}

}}}}  // namespace lpc::LPC_PRECISION::solver::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lpc { inline namespace LPC_PRECISION { namespace solver {
HWY_EXPORT(turn2);
HWY_EXPORT(turn3);
void turnBodies(std::span<Pose<2>> pose, std::span<const Motion<2>> motion, std::span<const std::int32_t> bodies,
                Real dt) {
  HWY_DYNAMIC_DISPATCH(turn2)(pose, motion, bodies, dt);
}
void turnBodies(std::span<Pose<3>> pose, std::span<const Motion<3>> motion, std::span<const std::int32_t> bodies,
                Real dt) {
  HWY_DYNAMIC_DISPATCH(turn3)(pose, motion, bodies, dt);
}
}}}  // namespace lpc::LPC_PRECISION::solver
#endif
