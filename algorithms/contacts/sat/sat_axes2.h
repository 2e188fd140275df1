// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/clip/core2.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

/// The best edge normal of one polygon, and how far the other one lies beyond it (m).
struct Axis2 {
  int edge = 0;
  Real separation = -std::numeric_limits<Real>::infinity();
};

inline Axis2 bestEdge(const Core2& p, const Core2& q, Real limit) {
  Axis2 best;
  for (int i = 0; i < p.count; ++i) {
    const Xy n = p.n[i];
    Real low = dot(n, q.v[0]);
    for (int k = 1; k < q.count; ++k) low = std::min(low, dot(n, q.v[k]));
    const Real s = low - dot(n, p.v[i]);
    if (s > best.separation) best = {i, s};
    if (s > limit) break;
  }
  return best;
}

/// The same for two boxes, flat ones included, in closed form. Edges as in makeCore2: -y, +x, +y, -x.
inline void bestEdgesOfBoxes(const Xy& half1, const Xy& half2, const Pose<2>& X_12, Axis2& axis1, Axis2& axis2) {
  const Real c = std::abs(X_12.q.c), s = std::abs(X_12.q.s);
  const Xy p1 = X_12.p, p2 = turnedBack(X_12.q, p1);
  const Real x1 = std::abs(p1.x()) - (half1.x() + c * half2.x() + s * half2.y());
  const Real y1 = std::abs(p1.y()) - (half1.y() + s * half2.x() + c * half2.y());
  const Real x2 = std::abs(p2.x()) - (half2.x() + c * half1.x() + s * half1.y());
  const Real y2 = std::abs(p2.y()) - (half2.y() + s * half1.x() + c * half1.y());
  axis1 = y1 >= x1 ? Axis2{p1.y() > 0 ? 2 : 0, y1} : Axis2{p1.x() > 0 ? 1 : 3, x1};
  axis2 = y2 >= x2 ? Axis2{p2.y() > 0 ? 0 : 2, y2} : Axis2{p2.x() > 0 ? 3 : 1, x2};
}

}}}  // namespace lpc::LPC_PRECISION::contacts
