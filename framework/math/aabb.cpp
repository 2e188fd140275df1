// SPDX-License-Identifier: Zlib
#include "framework/math/aabb.h"

#include <algorithm>

namespace lpc { inline namespace LPC_PRECISION {

// Bounds are compared before they are subtracted, so that t = 0 agrees with Aabb::overlaps.
template <int D>
Real castBox(const Aabb<D>& box, const Vec<D>& displacement, Real maxT, const Aabb<D>& target) {
  Real enter = 0, leave = maxT;
  for (int k = 0; k < D; ++k) {
    const Real d = displacement[k];
    const bool before = box.hi[k]<target.lo[k], behind = box.lo[k]> target.hi[k];
    if (before || behind) {
      const Real gap = before ? target.lo[k] - box.hi[k] : target.hi[k] - box.lo[k];
      const Real t = gap / d;
      if (!(t >= 0)) return -1;  // moves away; or d = 0, when t is an infinity of either sign
      if (t > enter) enter = t;
    }
    if (d > 0) leave = std::min(leave, (target.hi[k] - box.lo[k]) / d);
    if (d < 0) leave = std::min(leave, (target.lo[k] - box.hi[k]) / d);
  }
  return enter <= leave && enter < std::numeric_limits<Real>::infinity() ? enter : Real(-1);
}

template <int D>
Real castRay(const Aabb<D>& box, const Vec<D>& p, const Vec<D>& direction, Real maxT) {
  return castBox(Aabb<D>{p, p}, direction, maxT, box);
}

template Real castBox(const Aabb<2>&, const Vec<2>&, Real, const Aabb<2>&);
template Real castBox(const Aabb<3>&, const Vec<3>&, Real, const Aabb<3>&);
template Real castRay(const Aabb<2>&, const Vec<2>&, const Vec<2>&, Real);
template Real castRay(const Aabb<3>&, const Vec<3>&, const Vec<3>&, Real);

}}  // namespace lpc::LPC_PRECISION
