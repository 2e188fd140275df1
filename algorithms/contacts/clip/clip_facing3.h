// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/clip/closest3.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

/// One attempt: `around` restricts the faces to those that touch the support vertices.
inline void clipFacesAlong(const Core3& c1, const Core3& c2, const Vec<3>& n, bool around, const PlacedPair<3>& pair,
                           ClipScratch3& scratch, Patch3& out) {
  const auto choose = [&](const Core3& c, const Vec<3>& d) { return faceAlong(c, d, around ? vertexAlong(c, d) : -1); };
  const int f1 = choose(c1, n), f2 = choose(c2, -n);
  const Real a1 = f1 < 0 ? Real(-1) : c1.n[f1].dot(n), a2 = f2 < 0 ? Real(-1) : -c2.n[f2].dot(n);
  const Real clips1 = f1 >= 0 && c1.hasArea(f1) ? a1 : Real(-1), clips2 = f2 >= 0 && c2.hasArea(f2) ? a2 : Real(-1);
  const bool first = clips1 + kClearlyBetter >= clips2;
  if ((first ? clips1 : clips2) < kSteep) return;
  const Reference3 reference{first ? c1 : c2, first ? f1 : f2, first ? n : Vec<3>(-n), first};
  const Core3& incident = first ? c2 : c1;
  if (incident.faceCount() == 0) {
    clipSegment(reference, incident, pair, scratch, out.points);
  } else if ((first ? a2 : a1) > 0) {
    clipFace(reference, incident, first ? f2 : f1, pair, scratch, out.points);
  }
}

/// Contact points along a normal that need not be a face normal: clips the faces that face each other along n (n_12,
/// unit). Adds `witness`, the closest points, if no clipped point is as deep. Parallel edges give two points, because a
/// corner beside the reference face by less than the tolerance is kept.
inline void clipFacing(const Core3& c1, const Core3& c2, const Vec<3>& n, const PatchPoint<3>& witness,
                       const PlacedPair<3>& pair, ClipScratch3& scratch, Patch3& out) {
  out.normal = n;
  out.points.clear();
  const auto deepEnough = [&] { return out.reaches(witness.separation + pair.tolerance, witness.separation > 0); };
  if (c1.faceCount() == 0 && c2.faceCount() == 0) {
    ClosestEdges3 e{0, 0};
    closestOfSegments(segmentPair(c1, 0, c2, 0), e.s, e.t);
    touchEdges(c1, c2, e, pair, out);
  } else if (c1.edgeCount() > 0) {
    for (const bool around : {false, true}) {
      out.points.clear();
      clipFacesAlong(c1, c2, n, around, pair, scratch, out);
      if (deepEnough()) break;
    }
  }
  if (!deepEnough()) out.points.push_back(witness);
}

}}}  // namespace lpc::LPC_PRECISION::contacts
