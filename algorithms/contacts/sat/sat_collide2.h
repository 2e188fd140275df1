// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/clip/clip2.h"
#include "algorithms/contacts/patch/reduction.h"
#include "algorithms/contacts/sat/sat_axes2.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

struct Scratch2 {
  Storage2 first, second;
  Patch2 patch;
};

/// Clips the reference edge, given by its polygon and number, with the other polygon's facing edge.
inline void clipAgainst(const Core2& c1, const Core2& c2, bool firstIsReference, int edge, const PlacedPair<2>& pair,
                        Patch2& out) {
  const Xy n = firstIsReference ? Xy(c1.n[edge]) : -Xy(c2.n[edge]);
  const int edge1 = firstIsReference ? edge : edgeAlong(c1, n);
  const int edge2 = firstIsReference ? edgeAlong(c2, -n) : edge;
  clipEdges(edgeOf(c1, edge1), edgeOf(c2, edge2), n, pair, out);
}

/// Separating axes, then clipping. In 2D the largest separation over all edge normals belongs to an edge next to the
/// nearest vertex: -h is concave, so on the circle of directions it decreases on both sides of its maximum. Hence the
/// closest points of that edge and its facing edge are the closest points of the polygons.
inline void satCollide(const PlacedPair<2>& pair, Scratch2& scratch, WorkDone& work) {
  Patch2& out = scratch.patch;
  out.count = 0;
  const ShapeView<2>&s1 = pair.view1(), &s2 = pair.view2();
  const bool boxes = isBox(s1) && isBox(s2), point = s1.core() == CoreClass::point;
  if (boxes && point) {
    out.count = collidePointBox(pair, out.normal, out.points[0]);
    return;
  }
  Axis2 axis1, axis2;
  if (boxes) {
    work[WorkCount::axisTests] += 4;
    bestEdgesOfBoxes(coreHalf(s1), coreHalf(s2), pair.X_12, axis1, axis2);
    if (std::max(axis1.separation, axis2.separation) > pair.limit) return;
  }
  const Core2 c1 = makeCore2(s1, nullptr, scratch.first);
  const Core2 c2 = makeCore2(s2, &pair.X_12, scratch.second);
  if (!boxes) {
    if (!point) axis1 = bestEdge(c1, c2, pair.limit);
    work[WorkCount::axisTests] += static_cast<std::uint64_t>(c1.count);
    if (axis1.separation > pair.limit) return;
    axis2 = bestEdge(c2, c1, pair.limit);
    work[WorkCount::axisTests] += static_cast<std::uint64_t>(c2.count);
    if (axis2.separation > pair.limit) return;
  }
  const bool firstIsBest = axis1.separation >= axis2.separation;
  const Real separation = std::max(axis1.separation, axis2.separation);
  // Shape 1's edge is preferred unless shape 2's is clearly better, so that equal edges do not alternate.
  const bool firstIsReference = axis1.separation + pair.tolerance >= axis2.separation;
  clipAgainst(c1, c2, firstIsReference, firstIsReference ? axis1.edge : axis2.edge, pair, out);
  const auto good = [&] { return out.deepest() <= separation + pair.tolerance; };
  if (good()) return;
  if (firstIsBest != firstIsReference) {
    clipAgainst(c1, c2, firstIsBest, firstIsBest ? axis1.edge : axis2.edge, pair, out);
    if (good()) return;
  }
  // Two corners: no edge faces the other's nearest point.
  const Xy n = firstIsBest ? Xy(c1.n[axis1.edge]) : -Xy(c2.n[axis2.edge]);
  const Edge2 e1 = edgeOf(c1, firstIsBest ? axis1.edge : edgeAlong(c1, n));
  const Edge2 e2 = edgeOf(c2, firstIsBest ? edgeAlong(c2, -n) : axis2.edge);
  // Overlapping cores reach this line only by rounding, at an edge's very end.
  closestOfEdges(e1, e2, n, separation > 0, pair, out);
}

inline std::span<PatchPoint<2>> patchPoints(Scratch2& s, Real, Reduction) {
  return {s.patch.points.data(), s.patch.points.data() + s.patch.count};
}
inline const Vec<2>& patchNormal(const Scratch2& s) { return s.patch.normal; }

}}}  // namespace lpc::LPC_PRECISION::contacts
