// SPDX-License-Identifier: Zlib
#include "algorithms/solver/lanes/contact_lanes.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL)
#define HWY_TARGET_INCLUDE "algorithms/solver/lanes/contact_lanes.cpp"
#include <hwy/foreach_target.h>

#include "algorithms/solver/lanes/body_lines-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lpc { inline namespace LPC_PRECISION { namespace solver { namespace HWY_NAMESPACE {

// The numbers of one manifold in each lane.
template <int D, class T>
struct Numbers {
  using V = hn::Vec<T>;
  using F = BlockLayout<D>;
  Real* at;

  HWY_INLINE V get(int f) const { return hn::LoadU(T(), at + static_cast<std::size_t>(f) * hn::Lanes(T())); }
  HWY_INLINE void set(int f, V x) const { hn::StoreU(x, T(), at + static_cast<std::size_t>(f) * hn::Lanes(T())); }
  HWY_INLINE Numbers point(int k) const {
    return {at + static_cast<std::size_t>(F::kManifold + k * F::kPoint) * hn::Lanes(T())};
  }
  template <int N>
  HWY_INLINE LaneVec<N, T> vec(int f) const {
    LaneVec<N, T> v;
    for (int k = 0; k < N; ++k) v[k] = get(f + k);
    return v;
  }
};

template <int D, class T>
struct Sides {
  using V = hn::Vec<T>;
  using F = BlockLayout<D>;
  static constexpr int kAng = F::kAng;
  LaneBody<D, T> a, b;
  V invMassA, invMassB;
  LaneInertia<kAng, T> invIA, invIB;

  HWY_INLINE Sides(const Numbers<D, T>& m, const std::int32_t* offsets, const Real* lines) {
    a.load(lines, offsets), b.load(lines, offsets + hn::Lanes(T()));
    invMassA = m.get(F::kInvMassA), invMassB = m.get(F::kInvMassB);
    for (int k = 0; k < kAng * kAng; ++k) invIA.v[k] = m.get(F::kInvIA + k), invIB.v[k] = m.get(F::kInvIB + k);
  }
  HWY_INLINE void store(const std::int32_t* offsets, Real* lines) const {
    a.store(lines, offsets + 2 * hn::Lanes(T())), b.store(lines, offsets + 3 * hn::Lanes(T()));
  }

  template <bool kTurns>
  HWY_INLINE V velocity(const LaneVec<D, T>& d, const LaneVec<kAng, T>& armA, const LaneVec<kAng, T>& armB) const {
    V v = dot(d, b.v() - a.v());
    if constexpr (kTurns) v = v + (dot(armB, b.w()) - dot(armA, a.w()));
    return v;
  }
  template <bool kTurns>
  HWY_INLINE void apply(const LaneVec<D, T>& d, const LaneVec<kAng, T>& armA, const LaneVec<kAng, T>& armB, V impulse) {
    a.setV(a.v() - (impulse * invMassA) * d);
    b.setV(b.v() + (impulse * invMassB) * d);
    if constexpr (kTurns) {
      a.setW(a.w() - impulse * (invIA * armA));
      b.setW(b.w() + impulse * (invIB * armB));
    }
  }
};

template <int D, class T>
HWY_INLINE LaneVec<kAngDim<D>, T> armOf(const Numbers<D, T>& p, int direction, int side) {
  constexpr int kAng = kAngDim<D>;
  return p.template vec<kAng>(BlockLayout<D>::kArms + (2 * direction + side) * kAng);
}

template <int D, bool kTurns, class T>
HWY_INLINE void sweepFriction(const Numbers<D, T>& p, const LaneVec<D, T>* t, hn::Vec<T> friction, Sides<D, T>& s) {
  using F = BlockLayout<D>;
  using V = hn::Vec<T>;
  const T tag;
  const V limit = friction * p.get(F::kImpulse), slide = p.get(F::kSlide);
  LaneVec<kAngDim<D>, T> armA[D - 1], armB[D - 1];
  V v[D - 1], old[D - 1], impulse[D - 1], down[D - 1];
  for (int d = 0; d < D - 1; ++d) {
    armA[d] = armOf<D>(p, d + 1, 0), armB[d] = armOf<D>(p, d + 1, 1);
    v[d] = s.template velocity<kTurns>(t[d], armA[d], armB[d]);
    old[d] = p.get(F::kImpulse + 1 + d);
    down[d] = old[d] - slide * v[d];
  }
  if constexpr (D == 2) {
    const hn::Mask<T> slides = down[0] * down[0] > limit * limit;
    const V low = hn::Neg(limit);
    const V clamped = hn::IfThenElse(down[0] < low, low, hn::IfThenElse(limit < down[0], limit, down[0]));
    impulse[0] = hn::IfThenElse(slides, clamped, down[0]);
  } else {
    const V s00 = p.get(F::kStick), s01 = p.get(F::kStick + 1), s11 = p.get(F::kStick + 2);
    const V stick0 = old[0] - (s00 * v[0] + s01 * v[1]), stick1 = old[1] - (s01 * v[0] + s11 * v[1]);
    const hn::Mask<T> slides = (stick0 * stick0 + stick1 * stick1) > limit * limit;
    impulse[0] = stick0, impulse[1] = stick1;
    if (!hn::AllFalse(tag, slides)) {
      const V squared = down[0] * down[0] + down[1] * down[1];
      const hn::Mask<T> inside = squared <= limit * limit;
      const V scale = limit / hn::Sqrt(squared);
      for (int d = 0; d < 2; ++d) {
        impulse[d] = hn::IfThenElse(slides, hn::IfThenElse(inside, down[d], down[d] * scale), impulse[d]);
      }
    }
  }
  for (int d = 0; d < D - 1; ++d) {
    s.template apply<kTurns>(t[d], armA[d], armB[d], impulse[d] - old[d]);
    p.set(F::kImpulse + 1 + d, impulse[d]);
  }
}

template <int D, bool kTurns, class T>
HWY_INLINE void sweepBlock(T tag, const ContactBlock& block, Real* numbers, const std::int32_t* offsets, Real* lines,
                           const BlockSweep& law) {
  using F = BlockLayout<D>;
  using V = hn::Vec<T>;
  const Numbers<D, T> m{numbers + block.at};
  Sides<D, T> s(m, offsets + block.index, lines);
  const V zero = hn::Zero(tag), one = hn::Set(tag, 1);
  const auto n = m.template vec<D>(F::kNormal);
  const hn::Mask<T> bothMove = hn::And(s.invMassA > zero, s.invMassB > zero);
  const auto ofPair = [&](Real both, Real fixed)
                          HWY_ATTR { return hn::IfThenElse(bothMove, hn::Set(tag, both), hn::Set(tag, fixed)); };
  const V rate = ofPair(law.contact.rate, law.contactFixed.rate);
  const V massScale = ofPair(law.contact.massScale, law.contactFixed.massScale);
  const V impulseScale = ofPair(law.contact.impulseScale, law.contactFixed.impulseScale);
  const V h = hn::Set(tag, law.h), slop = hn::Set(tag, law.slop), fastest = hn::Set(tag, -law.maxSpeed);
  for (int k = 0; k < block.count; ++k) {
    const Numbers<D, T> p = m.point(k);
    const V goal = p.get(F::kGoal), old = p.get(F::kImpulse), mass = p.get(F::kMass);
    V bias = hn::Neg(goal), ofMass = massScale, ofImpulse = zero;
    if (!law.targets) {
      const hn::Mask<T> apart = goal > zero;
      const V above = goal + slop, depth = hn::IfThenElse(zero < above, zero, above);
      const V wanted = rate * depth, speed = hn::IfThenElse(wanted < fastest, fastest, wanted);
      bias = hn::IfThenElse(apart, goal / h, hn::IfThenElseZero(rate > zero, speed));
      const hn::Mask<T> rigid = law.softGaps ? hn::Xor(apart, apart) : apart;
      ofMass = hn::IfThenElse(rigid, one, massScale), ofImpulse = hn::IfThenElse(rigid, zero, impulseScale);
    }
    const auto armA = armOf<D>(p, 0, 0), armB = armOf<D>(p, 0, 1);
    const V v = s.template velocity<kTurns>(n, armA, armB);
    const V wanted = (old - (ofMass * mass) * (v + bias)) - ofImpulse * old;
    const V impulse = hn::IfThenElse(wanted < zero, zero, wanted);
    p.set(F::kImpulse, impulse);
    if (!law.targets) {
      const V most = p.get(F::kMaxImpulse);
      p.set(F::kMaxImpulse, hn::IfThenElse(most < impulse, impulse, most));
    }
    s.template apply<kTurns>(n, armA, armB, impulse - old);
  }
  if (block.hasFriction) {
    LaneVec<D, T> t[D - 1];
    for (int d = 0; d < D - 1; ++d) t[d] = m.template vec<D>(F::kTangents + d * D);
    const V friction = m.get(F::kFriction);
    for (int k = 0; k < block.count; ++k) sweepFriction<D, kTurns>(m.point(k), t, friction, s);
  }
  s.store(offsets + block.index, lines);
}

template <int D, bool kTurns, class T>
HWY_INLINE void applyBlock(T, const ContactBlock& block, Real* numbers, const std::int32_t* offsets, Real* lines) {
  using F = BlockLayout<D>;
  const Numbers<D, T> m{numbers + block.at};
  Sides<D, T> s(m, offsets + block.index, lines);
  LaneVec<D, T> directions[D];
  for (int d = 0; d < D; ++d) directions[d] = m.template vec<D>(F::kNormal + d * D);
  static_assert(F::kTangents == F::kNormal + D);
  for (int k = 0; k < block.count; ++k) {
    const Numbers<D, T> p = m.point(k);
    for (int d = 0; d < (block.hasFriction ? D : 1); ++d) {
      s.template apply<kTurns>(directions[d], armOf<D>(p, d, 0), armOf<D>(p, d, 1), p.get(F::kImpulse + d));
    }
  }
  s.store(offsets + block.index, lines);
}

template <int D, bool kTurns, class T>
HWY_INLINE void velocityBlock(T, const ContactBlock& block, Real* numbers, const std::int32_t* offsets,
                              const Real* lines, int field) {
  using F = BlockLayout<D>;
  const Numbers<D, T> m{numbers + block.at};
  const Sides<D, T> s(m, offsets + block.index, lines);
  const auto n = m.template vec<D>(F::kNormal);
  for (int k = 0; k < block.count; ++k) {
    const Numbers<D, T> p = m.point(k);
    p.set(field, s.template velocity<kTurns>(n, armOf<D>(p, 0, 0), armOf<D>(p, 0, 1)));
  }
}

template <int D, class T>
HWY_INLINE void measureBlock(T, const ContactBlock& block, Real* numbers, const std::int32_t* offsets,
                             const Real* lines) {
  using F = BlockLayout<D>;
  const Numbers<D, T> m{numbers + block.at};
  LaneBody<D, T> a, b;
  a.load(lines, offsets + block.index), b.load(lines, offsets + block.index + hn::Lanes(T()));
  const LaneVec<D, T> between = (m.template vec<D>(F::kBetween) + b.v()) - a.v(), n = m.template vec<D>(F::kNormal);
  for (int k = 0; k < block.count; ++k) {
    const Numbers<D, T> p = m.point(k);
    const auto fromA = turned(a, p.template vec<D>(F::kLocalA)), fromB = turned(b, p.template vec<D>(F::kLocalB));
    p.set(F::kGoal, dot((between + fromB) - fromA, n));
  }
}

// Rot::operator*, cross() and makeRow() in lanes.
template <class T>
HWY_INLINE LaneVec<1, T> cross(const LaneVec<2, T>& a, const LaneVec<2, T>& b) {
  return {{a[0] * b[1] - a[1] * b[0]}};
}
template <class T>
HWY_INLINE void setTangents(const LaneVec<2, T>& n, LaneVec<2, T>* t) {
  t[0] = {{hn::Neg(n[1]), n[0]}};
}
template <class T>
HWY_INLINE void setTangents(const LaneVec<3, T>& n, LaneVec<3, T>* t) {
  const auto one = hn::Set(T(), 1);
  const auto sign = hn::IfThenElse(n[2] >= hn::Zero(T()), one, hn::Neg(one));
  const auto a = hn::Neg(one) / (sign + n[2]);
  const auto b = n[0] * n[1] * a;
  t[0] = {{one + sign * n[0] * n[0] * a, sign * b, hn::Neg(sign) * n[0]}};
  t[1] = {{b, sign + n[1] * n[1] * a, hn::Neg(n[1])}};
}

// prepareFriction() in lanes. `mass`: those of the tangents; arms and turns: of the first and of the last tangent.
template <class T>
HWY_INLINE void setFriction(const Numbers<2, T>& p, const hn::Vec<T>* mass, const LaneVec<1, T>&, const LaneVec<1, T>&,
                            const LaneVec<1, T>&, const LaneVec<1, T>&) {
  p.set(BlockLayout<2>::kSlide, mass[0]);
}
template <class T>
HWY_INLINE void setFriction(const Numbers<3, T>& p, const hn::Vec<T>* mass, const LaneVec<3, T>& armA,
                            const LaneVec<3, T>& armB, const LaneVec<3, T>& turnA, const LaneVec<3, T>& turnB) {
  using F = BlockLayout<3>;
  using V = hn::Vec<T>;
  const V zero = hn::Zero(T()), one = hn::Set(T(), 1), half = hn::Set(T(), Real(0.5));
  const hn::Mask<T> movable = hn::And(mass[0] > zero, mass[1] > zero);
  const V ss = one / mass[0], tt = one / mass[1], st = dot(armA, turnA) + dot(armB, turnB);
  const V mean = half * (ss + tt), difference = half * (ss - tt);
  const V slide = one / (mean + hn::Sqrt(difference * difference + st * st)), determinant = ss * tt - st * st;
  const hn::Mask<T> full = determinant > mean * mean * hn::Set(T(), Real(1e-6));
  p.set(F::kSlide, hn::IfThenElseZero(movable, slide));
  p.set(F::kStick, hn::IfThenElseZero(movable, hn::IfThenElse(full, tt / determinant, slide)));
  p.set(F::kStick + 1, hn::IfThenElseZero(hn::And(movable, full), hn::Neg(st) / determinant));
  p.set(F::kStick + 2, hn::IfThenElseZero(movable, hn::IfThenElse(full, ss / determinant, slide)));
}

template <int D, class T>
HWY_INLINE void prepareBlock(T tag, const ContactBlock& block, ContactBlocks<D>& c, const Real* manifolds,
                             Real warmStart) {
  using F = BlockLayout<D>;
  using V = hn::Vec<T>;
  constexpr int kAng = F::kAng, kFixedScale = kFixedLine<D> / kLine<D>;
  constexpr int kPointStride = sizeof(ContactPoint<D>) / sizeof(Real);
  const auto inReals = [](std::size_t bytes) { return bytes / sizeof(Real); };
  const std::size_t n = hn::Lanes(tag);
  const std::int32_t* const offsets = c.offsets.data() + block.index;
  const std::int32_t* const from = offsets + 4 * n;
  const V zero = hn::Zero(tag), one = hn::Set(tag, 1), half = hn::Set(tag, Real(0.5));
  const Numbers<D, T> m{c.numbers() + block.at};
  LaneBody<D, T> a, b;
  a.load(c.pose.data(), offsets), b.load(c.pose.data(), offsets + n);
  V fixed[2][kFixedLine<D>];
  for (std::size_t side = 0; side < 2; ++side) {
    for (int k = 0; k < kFixedLine<D>; k += 4) {
      loadFour<kFixedScale>(tag, c.fixed.data() + k, offsets + side * n, fixed[side] + k);
    }
  }
  LaneInertia<kAng, T> invI[2];
  for (int side = 0; side < 2; ++side) {
    m.set(side == 0 ? F::kInvMassA : F::kInvMassB, fixed[side][D]);
    for (int k = 0; k < kAng * kAng; ++k) {
      invI[side].v[k] = fixed[side][D + 1 + k];
      m.set((side == 0 ? F::kInvIA : F::kInvIB) + k, invI[side].v[k]);
    }
  }
  for (int k = 0; k < D; ++k) m.set(F::kBetween + k, fixed[1][k] - fixed[0][k]);
  const V invMassSum = fixed[0][D] + fixed[1][D];

  static_assert(offsetof(Manifold<D>, friction) == offsetof(Manifold<D>, normal) + D * sizeof(Real));
  static_assert(offsetof(ContactPoint<D>, localB) == offsetof(ContactPoint<D>, localA) + D * sizeof(Real));
  V numbers[8];
  loadFour(tag, manifolds + inReals(offsetof(Manifold<D>, normal)), from, numbers);
  LaneVec<D, T> directions[D];
  for (int k = 0; k < D; ++k) directions[0][k] = numbers[k];
  setTangents(directions[0], directions + 1);
  m.set(F::kFriction, numbers[D]);
  for (int d = 0; d < D; ++d) {
    for (int k = 0; k < D; ++k) m.set(F::kNormal + d * D + k, directions[d][k]);
  }
  const LaneVec<D, T> centers = b.v() - a.v();
  for (int k = 0; k < block.count; ++k) {
    const Real* const point = manifolds + inReals(offsetof(Manifold<D>, points)) + k * kPointStride;
    const Numbers<D, T> p = m.point(k);
    for (int i = 0; i < 2 * D; i += 4) {
      loadFour(tag, point + inReals(offsetof(ContactPoint<D>, localA)) + i, from, numbers + i);
    }
    LaneVec<D, T> localA, localB;
    for (int i = 0; i < D; ++i) localA[i] = numbers[i], localB[i] = numbers[D + i];
    for (int i = 0; i < 2 * D; ++i) p.set(F::kLocalA + i, numbers[i]);
    const LaneVec<D, T> fromA = turned(a, localA), fromB = turned(b, localB), gap = (centers + fromB) - fromA;
    p.set(F::kGoal, dot(gap, directions[0]));
    const LaneVec<D, T> rA = fromA + half * gap, rB = fromB - half * gap;
    LaneVec<kAng, T> armA[D], armB[D], turnA[D], turnB[D];
    V mass[D];
    for (int d = 0; d < (block.hasFriction ? D : 1); ++d) {
      armA[d] = cross(rA, directions[d]), armB[d] = cross(rB, directions[d]);
      turnA[d] = invI[0] * armA[d], turnB[d] = invI[1] * armB[d];
      const V response = (invMassSum + dot(armA[d], turnA[d])) + dot(armB[d], turnB[d]);
      mass[d] = hn::IfThenElseZero(response > zero, one / response);
      for (int i = 0; i < kAng; ++i) {
        p.set(F::kArms + 2 * d * kAng + i, armA[d][i]), p.set(F::kArms + (2 * d + 1) * kAng + i, armB[d][i]);
      }
    }
    p.set(F::kMass, mass[0]);
    if (block.hasFriction) setFriction(p, mass + 1, armA[D - 2], armB[D - 2], turnA[D - 1], turnB[D - 1]);
    loadFour(tag, point + inReals(offsetof(ContactPoint<D>, impulse)), from, numbers);
    const V scale = hn::Set(tag, warmStart), start = scale * numbers[0];
    const bool warm = warmStart > 0;
    p.set(F::kImpulse, warm ? hn::IfThenElse(start < zero, zero, start) : zero);
    for (int d = 1; d < D; ++d) p.set(F::kImpulse + d, warm && block.hasFriction ? scale * numbers[d] : zero);
    p.set(F::kMaxImpulse, zero), p.set(F::kVelocity, zero), p.set(F::kLoad, zero);
  }
}

using OneLane = hn::CappedTag<Real, 1>;
using AllLanes = hn::ScalableTag<Real>;

template <class F>
HWY_INLINE void forBlocks(const std::vector<ContactBlock>& blocks, const F& f) {
  for (const ContactBlock& block : blocks) {
    if (block.lanes == 1) {
      f(OneLane(), block);
    } else {
      f(AllLanes(), block);
    }
  }
}

template <int D>
void sweepAll(ContactBlocks<D>& c, const BlockSweep& law) {
  Real *numbers = c.numbers(), *lines = c.motion.data();
  const std::int32_t* offsets = c.offsets.data();
  if (law.rotation) {
    forBlocks(c.blocks, [&](auto tag, const ContactBlock& block)
                            HWY_ATTR { sweepBlock<D, true>(tag, block, numbers, offsets, lines, law); });
  } else {
    forBlocks(c.blocks, [&](auto tag, const ContactBlock& block)
                            HWY_ATTR { sweepBlock<D, false>(tag, block, numbers, offsets, lines, law); });
  }
}
template <int D>
void applyAll(ContactBlocks<D>& c, bool rotation) {
  Real *numbers = c.numbers(), *lines = c.motion.data();
  const std::int32_t* offsets = c.offsets.data();
  if (rotation) {
    forBlocks(c.blocks, [&](auto tag, const ContactBlock& block)
                            HWY_ATTR { applyBlock<D, true>(tag, block, numbers, offsets, lines); });
  } else {
    forBlocks(c.blocks, [&](auto tag, const ContactBlock& block)
                            HWY_ATTR { applyBlock<D, false>(tag, block, numbers, offsets, lines); });
  }
}
template <int D>
void velocityAll(ContactBlocks<D>& c, int field, bool rotation) {
  forBlocks(c.blocks, [&](auto tag, const ContactBlock& block) HWY_ATTR {
    if (rotation) {
      velocityBlock<D, true>(tag, block, c.numbers(), c.offsets.data(), c.motion.data(), field);
    } else {
      velocityBlock<D, false>(tag, block, c.numbers(), c.offsets.data(), c.motion.data(), field);
    }
  });
}
template <int D>
void measureAll(ContactBlocks<D>& c) {
  forBlocks(c.blocks, [&](auto tag, const ContactBlock& block)
                          HWY_ATTR { measureBlock<D>(tag, block, c.numbers(), c.offsets.data(), c.pose.data()); });
}

template <int D>
void prepareAll(ContactBlocks<D>& c, const Real* manifolds, Real warmStart) {
  forBlocks(c.blocks, [&](auto tag, const ContactBlock& block)
                          HWY_ATTR { prepareBlock<D>(tag, block, c, manifolds, warmStart); });
}

void prepare2(ContactBlocks<2>& c, const Real* manifolds, Real warmStart) { prepareAll(c, manifolds, warmStart); }
void prepare3(ContactBlocks<3>& c, const Real* manifolds, Real warmStart) { prepareAll(c, manifolds, warmStart); }
void sweep2(ContactBlocks<2>& c, const BlockSweep& law) { sweepAll(c, law); }
void sweep3(ContactBlocks<3>& c, const BlockSweep& law) { sweepAll(c, law); }
void apply2(ContactBlocks<2>& c, bool rotation) { applyAll(c, rotation); }
void apply3(ContactBlocks<3>& c, bool rotation) { applyAll(c, rotation); }
void velocity2(ContactBlocks<2>& c, int field, bool rotation) { velocityAll(c, field, rotation); }
void velocity3(ContactBlocks<3>& c, int field, bool rotation) { velocityAll(c, field, rotation); }
void measure2(ContactBlocks<2>& c) { measureAll(c); }
void measure3(ContactBlocks<3>& c) { measureAll(c); }
int lanesOfTarget() { return static_cast<int>(hn::Lanes(AllLanes())); }

}}}}  // namespace lpc::LPC_PRECISION::solver::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lpc { inline namespace LPC_PRECISION { namespace solver {
HWY_EXPORT(prepare2);
HWY_EXPORT(prepare3);
HWY_EXPORT(sweep2);
HWY_EXPORT(sweep3);
HWY_EXPORT(apply2);
HWY_EXPORT(apply3);
HWY_EXPORT(velocity2);
HWY_EXPORT(velocity3);
HWY_EXPORT(measure2);
HWY_EXPORT(measure3);
HWY_EXPORT(lanesOfTarget);
void prepareBlocks(ContactBlocks<2>& c, IndexedSpan<const Manifold<2>> manifolds, Real warmStart) {
  HWY_DYNAMIC_DISPATCH(prepare2)(c, reinterpret_cast<const Real*>(manifolds.data()), warmStart);
}
void prepareBlocks(ContactBlocks<3>& c, IndexedSpan<const Manifold<3>> manifolds, Real warmStart) {
  HWY_DYNAMIC_DISPATCH(prepare3)(c, reinterpret_cast<const Real*>(manifolds.data()), warmStart);
}
void sweepBlocks(ContactBlocks<2>& c, const BlockSweep& law) { HWY_DYNAMIC_DISPATCH(sweep2)(c, law); }
void sweepBlocks(ContactBlocks<3>& c, const BlockSweep& law) { HWY_DYNAMIC_DISPATCH(sweep3)(c, law); }
void applyBlocks(ContactBlocks<2>& c, bool rotation) { HWY_DYNAMIC_DISPATCH(apply2)(c, rotation); }
void applyBlocks(ContactBlocks<3>& c, bool rotation) { HWY_DYNAMIC_DISPATCH(apply3)(c, rotation); }
void velocityBlocks(ContactBlocks<2>& c, int field, bool rotation) {
  HWY_DYNAMIC_DISPATCH(velocity2)(c, field, rotation);
}
void velocityBlocks(ContactBlocks<3>& c, int field, bool rotation) {
  HWY_DYNAMIC_DISPATCH(velocity3)(c, field, rotation);
}
void measureBlocks(ContactBlocks<2>& c) { HWY_DYNAMIC_DISPATCH(measure2)(c); }
void measureBlocks(ContactBlocks<3>& c) { HWY_DYNAMIC_DISPATCH(measure3)(c); }
int contactLanes() { return HWY_DYNAMIC_DISPATCH(lanesOfTarget)(); }
}}}  // namespace lpc::LPC_PRECISION::solver
#endif
