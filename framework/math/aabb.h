// SPDX-License-Identifier: Zlib
#pragma once

#include <limits>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Axis-aligned box in the world, closed: boxes that only touch do overlap. A default box is empty and overlaps no
/// finite box.
template <int D>
struct Aabb {
  Vec<D> lo = Vec<D>::Constant(std::numeric_limits<Real>::infinity());
  Vec<D> hi = Vec<D>::Constant(-std::numeric_limits<Real>::infinity());

  static Aabb everywhere() {
    const Real infinite = std::numeric_limits<Real>::infinity();
    return {Vec<D>::Constant(-infinite), Vec<D>::Constant(infinite)};
  }
  bool overlaps(const Aabb& b) const {
    return (lo.array() <= b.hi.array()).all() && (b.lo.array() <= hi.array()).all();
  }
  bool contains(const Vec<D>& p) const { return (lo.array() <= p.array()).all() && (p.array() <= hi.array()).all(); }
  bool contains(const Aabb& b) const {
    return (lo.array() <= b.lo.array()).all() && (b.hi.array() <= hi.array()).all();
  }
  Aabb merged(const Aabb& b) const { return {lo.cwiseMin(b.lo), hi.cwiseMax(b.hi)}; }
  Aabb grown(Real margin) const { return {lo.array() - margin, hi.array() + margin}; }
  Vec<D> center() const { return Real(0.5) * (lo + hi); }
};

/// Parameter at which a ray enters a box. Negative when the ray does not hit the box within maxT.
template <int D>
Real castRay(const Aabb<D>& box, const Vec<D>& p, const Vec<D>& direction, Real maxT);

/// First t, 0 <= t <= maxT, at which `box` moved by t * displacement touches `target`; negative when there is none. A
/// larger target that contains `target` never gives a later t, even with rounding: each step of the computation is
/// monotone. Trees rely on this.
template <int D>
Real castBox(const Aabb<D>& box, const Vec<D>& displacement, Real maxT, const Aabb<D>& target);

}}  // namespace lpc::LPC_PRECISION
