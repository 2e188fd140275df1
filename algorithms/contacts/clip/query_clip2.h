// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/clip/clip2.h"
#include "algorithms/contacts/patch/reduction.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

struct QueryClipScratch2 {
  Storage2 first, second;
  Patch2 patch;
};

/// Clips the edges that face each other along the unit n_12 of a query; `witness`, the closest points, is used if no
/// clipped point is as deep.
inline std::span<PatchPoint<2>> clipAlong(const PlacedPair<2>& pair, const Vec<2>& n, const PatchPoint<2>& witness,
                                          Reduction, QueryClipScratch2& s, WorkDone& work) {
  const ShapeView<2>&s1 = pair.view1(), &s2 = pair.view2();
  Patch2& out = s.patch;
  out.count = 0;
  const Core2 c1 = makeFacing2(s1, nullptr, n, s.first, work), c2 = makeFacing2(s2, &pair.X_12, -n, s.second, work);
  if (s1.core() != CoreClass::point && c1.count > 1 && c2.count > 1) {
    clipEdges(edgeOf(c1, edgeAlong(c1, n)), edgeOf(c2, edgeAlong(c2, -n)), n, pair, out);
  }
  if (!(out.deepest() <= witness.separation + pair.tolerance)) {
    out.count = 1;
    out.points[0] = witness;
  }
  return {out.points.data(), out.points.data() + out.count};
}

}}}  // namespace lpc::LPC_PRECISION::contacts
