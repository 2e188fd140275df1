// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/patch/contact_patch.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

/// A point, a segment or a box, by its half extents; flat boxes included.
template <int D>
bool isBox(const ShapeView<D>& s) {
  switch (s.core()) {
    case CoreClass::point:
    case CoreClass::segment:
    case CoreClass::box:
      return true;
    case CoreClass::hull:
    case CoreClass::curved:
    case CoreClass::plane:
      break;
  }
  return false;
}

/// Half extents of such a core.
template <int D>
Vec<D> coreHalf(const ShapeView<D>& s) {
  LPC_ASSERT(isBox(s));
  return s.half;
}

/// Shape 1 is a sphere, shape 2 `isBox`: closed form. Returns the number of points, 0 or 1.
template <int D>
int collidePointBox(const PlacedPair<D>& pair, Vec<D>& n, PatchPoint<D>& out) {
  const Vec<D> half = coreHalf(pair.view2());
  const Vec<D> c = -(pair.X_12.q.inverse() * pair.X_12.p);  // the sphere's centre in frame 2
  const Vec<D> nearest = c.cwiseMax(-half).cwiseMin(half);
  const Vec<D> outward = c - nearest;
  Real distance = outward.norm();
  Vec<D> n_21, p2 = nearest;
  if (distance > pair.rounding) {
    n_21 = outward / distance;
  } else {  // centre in the core, or on it within rounding: out through the nearest face
    int axis = 0;
    for (int k = 1; k < D; ++k) {
      if (half[k] - std::abs(c[k]) < half[axis] - std::abs(c[axis])) axis = k;
    }
    n_21 = Vec<D>::Zero();
    n_21[axis] = c[axis] < 0 ? Real(-1) : Real(1);
    p2[axis] = n_21[axis] * half[axis];
    distance = std::abs(c[axis]) - half[axis];
  }
  if (!(distance <= pair.limit)) return 0;
  n = -(pair.X_12.q * n_21);
  out = {Vec<D>::Zero(), pair.X_12 * p2, distance, featureNumber(featureCode(0), kNoFeature)};
  return 1;
}

}}}  // namespace lpc::LPC_PRECISION::contacts
