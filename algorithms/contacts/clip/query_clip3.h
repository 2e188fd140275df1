// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/clip/clip_facing3.h"
#include "algorithms/contacts/patch/reduction.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

struct QueryClipScratch3 {
  Storage3 first, second;
  ClipScratch3 clip;
  Patch3 patch;
};

/// Clips the faces that face each other along the unit n_12 of a query.
inline std::span<PatchPoint<3>> clipAlong(const PlacedPair<3>& pair, const Vec<3>& n, const PatchPoint<3>& witness,
                                          Reduction rule, QueryClipScratch3& s, WorkDone& work) {
  const ShapeView<3>&s1 = pair.view1(), &s2 = pair.view2();
  Patch3& out = s.patch;
  out.normal = n;
  out.points.clear();
  const Core3 c1 = makeFacing3(s1, nullptr, n, s.first, work), c2 = makeFacing3(s2, &pair.X_12, -n, s.second, work);
  if (c1.edgeCount() == 0 || c2.edgeCount() == 0) {
    out.points.push_back(witness);
    return out.points;
  }
  clipFacing(c1, c2, n, witness, pair, s.clip, out);
  reducePatch(rule, n, pair.tolerance, out.points);
  return out.points;
}

}}}  // namespace lpc::LPC_PRECISION::contacts
