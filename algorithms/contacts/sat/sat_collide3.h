// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/clip/clip_facing3.h"
#include "algorithms/contacts/patch/reduction.h"
#include "algorithms/contacts/sat/sat_axes3.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

struct Scratch3 {
  Storage3 first, second;
  std::vector<Real> along;
  ClipScratch3 clip;
  ClosestScratch3 closest;
  Patch3 patch;
};

/// Clips a reference face with the facing face of the other core, along n (n_12, unit). Returns whether a point lies as
/// deep as `separation`, the smallest separation along n. The face most against n need not touch the support vertex (a
/// bevel elsewhere may be better aligned), hence a second attempt with the faces around it.
inline bool clipAgainst(const Core3& c1, const Core3& c2, bool firstIsReference, int face, const Vec<3>& n,
                        Real separation, const PlacedPair<3>& pair, Scratch3& s) {
  const Core3 &ref = firstIsReference ? c1 : c2, &inc = firstIsReference ? c2 : c1;
  if (!ref.hasArea(face)) return false;
  const Reference3 reference{ref, face, firstIsReference ? n : Vec<3>(-n), firstIsReference};
  auto& points = s.patch.points;
  s.patch.normal = n;
  points.clear();
  const auto good = [&] { return s.patch.reaches(separation + pair.tolerance, separation > 0); };
  if (inc.faceCount() == 0) {
    clipSegment(reference, inc, pair, s.clip, points);
    return good();
  }
  const int facing = faceAlong(inc, -reference.outward);
  clipFace(reference, inc, facing, pair, s.clip, points);
  if (good()) return true;
  const int around = faceAlong(inc, -reference.outward, vertexAlong(inc, -reference.outward));
  if (around == facing || around < 0) return false;
  points.clear();
  clipFace(reference, inc, around, pair, s.clip, points);
  return good();
}

/// Two segments: their closest points, and if they cross or overlap, the direction across both.
inline void collideSegments(const Core3& c1, const Core3& c2, const PlacedPair<3>& pair, Patch3& out) {
  ClosestEdges3 e{0, 0};
  const SegmentPair3 x = segmentPair(c1, 0, c2, 0);
  e.squared = closestOfSegments(x, e.s, e.t);
  const Real distance = std::sqrt(e.squared);
  if (distance > pair.limit) return;
  out.normal = normalOfSegments(x, e, pair);
  touchEdges(c1, c2, e, pair, out);
}

inline void satCollide(const PlacedPair<3>& pair, Scratch3& s, WorkDone& work) {
  Patch3& out = s.patch;
  out.points.clear();
  const ShapeView<3>&s1 = pair.view1(), &s2 = pair.view2();
  if (s1.core() == CoreClass::point && isBox(s2)) {
    PatchPoint<3> p;
    if (collidePointBox(pair, out.normal, p)) out.points.push_back(p);
    return;
  }
  Axes3 axes;
  const bool boxes = s1.core() == CoreClass::box && s2.core() == CoreClass::box;
  if (boxes) {
    work[WorkCount::axisTests] += 15;
    if (!boxAxes(s1.half, s2.half, pair.X_12.p, pair.X_12.q.matrix(), pair.limit, axes)) return;
  }
  const Core3 c1 = makeCore3(s1, nullptr, s.first), c2 = makeCore3(s2, &pair.X_12, s.second);
  if (c1.faceCount() == 0 && c2.faceCount() == 0) {
    collideSegments(c1, c2, pair, out);
    return;
  }
  if (!boxes) {
    work[WorkCount::axisTests] += static_cast<std::uint64_t>(c1.faceCount() + c2.faceCount());
    axes.face2 = bestFace(c2, c1, pair.limit);
    if (axes.face2.separation > pair.limit) return;
    axes.face1 = bestFace(c1, c2, pair.limit);
    if (axes.face1.separation > pair.limit) return;
    const Real least = axes.best() - pair.tolerance;  // smaller separations cannot beat a face
    axes.edges = bestEdges(c1, c2, least, pair.limit, pair.rounding, s.along, work);
    if (axes.edges.separation > pair.limit) return;
  }
  // Shape 1's face is preferred unless shape 2's is clearly better, and faces unless an edge pair is clearly better, so
  // that equal axes do not alternate.
  const Real best = axes.best();
  if (!(best > -std::numeric_limits<Real>::infinity())) return;  // sums of sizes are not finite
  const auto near = [&](Real separation) { return separation + pair.tolerance >= best; };
  const auto tryFirst = [&] {
    return near(axes.face1.separation) &&
           clipAgainst(c1, c2, true, axes.face1.face, c1.n[axes.face1.face], best, pair, s);
  };
  const auto trySecond = [&] {
    return near(axes.face2.separation) &&
           clipAgainst(c1, c2, false, axes.face2.face, -c2.n[axes.face2.face], best, pair, s);
  };
  if (tryFirst() || trySecond()) return;
  out.points.clear();
  if (axes.edges.edge1 >= 0 && near(axes.edges.separation)) {
    const SegmentPair3 x = segmentPair(c1, axes.edges.edge1, c2, axes.edges.edge2);
    ClosestEdges3 e{axes.edges.edge1, axes.edges.edge2};
    const Real distance = std::sqrt(closestOfSegments(x, e.s, e.t));
    // Closest points inside both edges; otherwise the cores are apart and corners are nearer, or they overlap and
    // rounding clamps.
    if (best <= 0 || distance <= axes.edges.separation + pair.tolerance) {
      out.normal = axes.edges.normal;
      const Vec<3> p1 = x.a1 + e.s * (x.b1 - x.a1), p2 = x.a2 + e.t * (x.b2 - x.a2);
      const auto &e1 = c1.edge(e.edge1), &e2 = c2.edge(e.edge2);
      out.points.push_back(
          {p1, p2, (p2 - p1).dot(out.normal), featureNumber(featureCode(e1.v0, e1.v1), featureCode(e2.v0, e2.v1))});
      return;
    }
  }
  const bool edgesLead = axes.edges.separation >= best, firstLeads = axes.face1.separation >= best;
  out.normal = edgesLead ? axes.edges.normal : firstLeads ? c1.n[axes.face1.face] : Vec<3>(-c2.n[axes.face2.face]);
  if (best > 0) {
    const ClosestEdges3 e = closestEdges(c1, c2, out.normal, best, s.closest);
    const Real distance = std::sqrt(e.squared);
    if (distance > pair.limit) return;
    const SegmentPair3 x = segmentPair(c1, e.edge1, c2, e.edge2);
    const Vec<3> p1 = x.a1 + e.s * (x.b1 - x.a1), p2 = x.a2 + e.t * (x.b2 - x.a2);
    const Vec<3> n = distance > pair.rounding ? Vec<3>((p2 - p1) / distance) : out.normal;
    clipFacing(c1, c2, n, {p1, p2, (p2 - p1).dot(n), closestFeature(c1, c2, e)}, pair, s.clip, out);
    return;
  }
  for (const bool around : {false, true}) {  // a triangle's side is the reference: the other's face may be clipped
    if (firstLeads ? c1.hasArea(axes.face1.face) : c2.hasArea(axes.face2.face)) break;
    out.points.clear();
    clipFacesAlong(c1, c2, out.normal, around, pair, s.clip, out);
    if (out.reaches(best + pair.tolerance, false)) return;
  }
  out.points.clear();
  const Reference3 reference{firstLeads ? c1 : c2, firstLeads ? axes.face1.face : axes.face2.face,
                             firstLeads ? out.normal : Vec<3>(-out.normal), firstLeads};
  addForemost(reference, firstLeads ? c2 : c1, best, pair, s.clip, out.points);
}

inline std::span<PatchPoint<3>> patchPoints(Scratch3& s, Real tolerance, Reduction rule) {
  reducePatch(rule, s.patch.normal, tolerance, s.patch.points);
  return s.patch.points;
}
inline const Vec<3>& patchNormal(const Scratch3& s) { return s.patch.normal; }

}}}  // namespace lpc::LPC_PRECISION::contacts
