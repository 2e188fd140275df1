// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/core2.h"

namespace lpc::inline LPC_PRECISION::contacts {

/// The best edge normal of one polygon, and how far the other one lies beyond it (m).
struct Axis2 {
  int edge = 0;
  Real separation = -std::numeric_limits<Real>::infinity();
};

inline Axis2 bestEdge(const Core2& p, const Core2& q, Real limit) {
  Axis2 best;
  for (int i = 0; i < p.count; ++i) {
    const Vec<2> n = p.n[i];
    Real low = n.dot(q.v[0]);
    for (int k = 1; k < q.count; ++k) low = std::min(low, n.dot(q.v[k]));
    const Real s = low - n.dot(p.v[i]);
    if (s > best.separation) best = {i, s};
    if (s > limit) break;
  }
  return best;
}

/// The same for two boxes, flat ones included, in closed form. Edges as in makeCore2: -y, +x, +y, -x.
inline void bestEdgesOfBoxes(const Vec<2>& half1, const Vec<2>& half2, const Pose<2>& X_12, Axis2& axis1,
                             Axis2& axis2) {
  const Real c = std::abs(X_12.q.c), s = std::abs(X_12.q.s);
  const Vec<2>& p1 = X_12.p;
  const Vec<2> p2 = X_12.q.inverse() * p1;
  const Real x1 = std::abs(p1[0]) - (half1[0] + c * half2[0] + s * half2[1]);
  const Real y1 = std::abs(p1[1]) - (half1[1] + s * half2[0] + c * half2[1]);
  const Real x2 = std::abs(p2[0]) - (half2[0] + c * half1[0] + s * half1[1]);
  const Real y2 = std::abs(p2[1]) - (half2[1] + s * half1[0] + c * half1[1]);
  axis1 = y1 >= x1 ? Axis2{p1[1] > 0 ? 2 : 0, y1} : Axis2{p1[0] > 0 ? 1 : 3, x1};
  axis2 = y2 >= x2 ? Axis2{p2[1] > 0 ? 0 : 2, y2} : Axis2{p2[0] > 0 ? 3 : 1, x2};
}

}  // namespace lpc::inline LPC_PRECISION::contacts
