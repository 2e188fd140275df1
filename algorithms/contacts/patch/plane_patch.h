// SPDX-License-Identifier: Zlib
// Contacts with a plane, the same for every generator: each corner of the other core within the margin of the plane is
// a contact, and of these the ones with the largest span are kept.
#pragma once

#include "algorithms/contacts/patch/reduction.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

template <int D>
bool hasPlane(const PlacedPair<D>& pair) {
  return pair.view1().core() == CoreClass::plane || pair.view2().core() == CoreClass::plane;
}

template <int D>
struct PlaneScratch {
  std::vector<Vec<D>> corners;
  std::vector<PatchPoint<D>> points;
};

/// The corners of a bounded core that may touch a plane with normal -down (both in the core's frame).
template <int D>
void cornersToPlane(const ShapeView<D>& s, const Vec<D>& down, std::vector<Vec<D>>& out, WorkDone& work) {
  out.clear();
  switch (s.core()) {
    case CoreClass::point:
      out.push_back(Vec<D>::Zero());
      return;
    case CoreClass::segment:
      out.push_back(-s.half), out.push_back(s.half);
      return;
    case CoreClass::box:
      for (int bits = 0; bits < 1 << D; ++bits) {
        Vec<D> v;
        for (int k = 0; k < D; ++k) v[k] = (bits >> k) & 1 ? s.half[k] : -s.half[k];
        out.push_back(v);
      }
      return;
    case CoreClass::hull:
      out.assign(s.hull->vertices.begin(), s.hull->vertices.end());
      return;
    case CoreClass::curved: {
      work[WorkCount::supportCalls] += 2;
      // The lowest point of a tilted face may lie between its corners.
      const Vec<D> lowest = s.curved->support(down);
      s.curved->supportFace(down, out);
      Real deepest = -std::numeric_limits<Real>::infinity();
      for (const Vec<D>& v : out) deepest = std::max(deepest, v.dot(down));
      if (out.size() > 1 && lowest.dot(down) > deepest) out.push_back(lowest);
      return;
    }
    case CoreClass::plane:
      return;  // two planes never meet: both are fixed
  }
}

/// Fills scratch.points and returns n_12. Depths that differ by less than the pair's tolerance count as equal.
template <int D>
Vec<D> planePatch(const PlacedPair<D>& pair, Reduction rule, PlaneScratch<D>& scratch, WorkDone& work) {
  const ShapeView<D>&s1 = pair.view1(), &s2 = pair.view2();
  const bool planeSecond = s2.core() == CoreClass::plane;
  const ShapeView<D>& body = planeSecond ? s1 : s2;
  // Out of the half-space, in frame 1.
  const Vec<D> up = planeSecond ? Vec<D>(pair.X_12.q * Vec<D>(Vec<D>::Unit(1))) : Vec<D>(Vec<D>::Unit(1));
  const Vec<D> origin = planeSecond ? pair.X_12.p : Vec<D>(Vec<D>::Zero());
  const Vec<D> upInBody = planeSecond ? up : Vec<D>(pair.X_12.q.inverse() * up);
  cornersToPlane<D>(body, -upInBody, scratch.corners, work);
  scratch.points.clear();
  for (std::size_t i = 0; i < scratch.corners.size(); ++i) {
    const Vec<D> corner = planeSecond ? scratch.corners[i] : pair.X_12 * scratch.corners[i];
    const Real separation = up.dot(corner - origin);
    if (!(separation <= pair.limit)) continue;
    const Vec<D> under = corner - separation * up;
    const std::uint32_t code = featureCode(static_cast<int>(i));
    scratch.points.push_back(planeSecond ? PatchPoint<D>{corner, under, separation, featureNumber(code, kNoFeature)}
                                         : PatchPoint<D>{under, corner, separation, featureNumber(kNoFeature, code)});
  }
  const Vec<D> n = planeSecond ? Vec<D>(-up) : up;
  reducePatch(rule, n, pair.tolerance, scratch.points);
  return n;
}

}}}  // namespace lpc::LPC_PRECISION::contacts
