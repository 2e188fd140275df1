// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/clip/core3.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

/// A corner of the clipped face. Its two edges: edge k of the incident face, or ~j for edge j of the reference face.
struct ClipVertex3 {
  Triple p;
  int in, out;
};

struct Side3 {
  Triple m;  // unit, outward
  Real offset;
  Triple from, edge;  // the corner where it begins, and the vector to the next
};

struct Patch3 {
  Vec<3> normal = Vec<3>::Zero();  // n_12, unit, in frame 1
  std::vector<PatchPoint<3>> points;

  /// Whether one of the points is within `bound`. For cores that are `apart` the closest points themselves must be:
  /// those of a corner beside the reference face are not one above the other.
  bool reaches(Real bound, bool apart) const {
    for (const PatchPoint<3>& p : points) {
      const bool above = !apart && p.separation <= 0;
      if (p.separation <= bound && (above || (p.p2 - p.p1).squaredNorm() <= bound * bound)) return true;
    }
    return false;
  }
};

struct ClipScratch3 {
  IndexedVector<ClipVertex3> corners;  // all corners made so far
  IndexedVector<int> from, to;         // loops of the face: indices into `corners`
  std::vector<Real> beyond;            // distance of each beyond a side, m
  // Of the reference face:
  IndexedVector<Side3> sides;
  Triple normal, outward;
  Real cosine = 1;  // between the two normals
};

/// The reference face as clipping sees it; points are projected onto it along `outward`, which need not be its normal.
struct Reference3 {
  const Core3& core;
  int face;
  Vec<3> outward;
  bool first;  // it belongs to shape 1

  int size() const { return core.faceSize(face); }
  int vertex(int k) const { return core.loop(core.face(face).begin + (k < size() ? k : 0)); }
  /// Fills the scratch: the face, and the planes through its edges along `outward`.
  void fill(ClipScratch3& s) const {
    const int begin = core.face(face).begin, count = size();
    s.sides.resize(static_cast<std::size_t>(count));
    s.normal = Triple(core.n[face]), s.outward = Triple(outward), s.cosine = dot(s.normal, s.outward);
    Triple from(core.v[core.loop(begin)]);
    for (int j = 0; j < count; ++j) {
      const Triple to(core.v[core.loop(begin + (j + 1 < count ? j + 1 : 0))]), edge = to - from;
      Triple m = cross(edge, s.outward);
      const Real length = norm(m);
      if (length > 0) m = {m.x / length, m.y / length, m.z / length};
      s.sides[j] = {m, dot(m, from), from, edge};
      from = to;
    }
  }
  std::uint32_t edgeCode(int j) const { return featureCode(vertex(j), vertex(j + 1)); }
  /// Code of the vertex between two of its edges, or of the first edge if they do not meet.
  std::uint32_t cornerCode(int j, int k) const {
    const int m = size();
    if (k == (j + 1) % m) return featureCode(vertex(k));
    if (j == (k + 1) % m) return featureCode(vertex(j));
    return edgeCode(j);
  }
};

/// The point of the reference face's plane below p, and p's height above it along `outward`.
inline Triple under(const ClipScratch3& s, const Triple& p, Real& height) {
  height = dot(s.normal, p - s.sides[0].from) / s.cosine;
  return p - height * s.outward;
}
inline Triple nearestOnRim(const ClipScratch3& s, const Triple& p) {
  Triple best = p;
  Real least = std::numeric_limits<Real>::infinity();
  for (const Side3& side : s.sides) {
    const Triple& d = side.edge;
    const Real length2 = dot(d, d);
    const Real t = length2 > 0 ? std::clamp(dot(p - side.from, d) / length2, Real(0), Real(1)) : Real(0);
    const Triple q = side.from + t * d, way = p - q;
    const Real distance2 = dot(way, way);
    if (distance2 < least) best = q, least = distance2;
  }
  return best;
}

/// A corner beside the face, within tolerance, has its closest point on the rim: the two points are then not exactly
/// one above the other, but both lie on their shapes.
inline void addClipped(bool refIsFirst, const ClipScratch3& s, const Triple& p, std::uint32_t refCode,
                       std::uint32_t incCode, Real limit, std::vector<PatchPoint<3>>& out) {
  Real height = 0;
  Triple base = under(s, p, height);
  bool beside = false;
  for (const Side3& side : s.sides) beside = beside || dot(side.m, p) > side.offset;
  if (beside) base = nearestOnRim(s, base);
  height = dot(s.outward, p - base);
  if (!(height <= limit)) return;
  PatchPoint<3>& added = out.emplace_back();
  base.store(refIsFirst ? added.p1 : added.p2), p.store(refIsFirst ? added.p2 : added.p1);
  added.separation = height;
  added.feature = refIsFirst ? featureNumber(refCode, incCode) : featureNumber(incCode, refCode);
}

/// Clips an edge of `inc` between two vertices against the side planes of the reference face, with tolerances as for a
/// face. If both are one vertex, the result is a point; its number needs no tolerance to be stable.
inline void clipEdge(const Reference3& ref, const Core3& inc, const IndexedArray<int, 2>& vertices,
                     const PlacedPair<3>& pair, ClipScratch3& scratch, std::vector<PatchPoint<3>>& out) {
  const int ends = vertices[0] == vertices[1] ? 1 : 2;
  const Real tolerance = ends == 1 ? Real(0) : pair.tolerance;
  Real t[2] = {0, 1};
  int cutBy[2] = {-1, -1};
  const Triple a(inc.v[vertices[0]]), b(inc.v[vertices[1]]);
  ref.fill(scratch);
  for (int j = 0; j < ref.size(); ++j) {
    const Side3& side = scratch.sides[j];
    const Real da = dot(side.m, a) - side.offset, db = dot(side.m, b) - side.offset;
    if (da > tolerance && db > tolerance) return;
    // An end within the tolerance is kept even if the other one is cut off.
    const Real cut1 = db < 0 ? da / (da - db) : Real(1), cut2 = da < 0 ? da / (da - db) : Real(0);
    if (da > tolerance && cut1 > t[0]) t[0] = cut1, cutBy[0] = j;
    if (db > tolerance && cut2 < t[1]) t[1] = cut2, cutBy[1] = j;
  }
  if (t[0] > t[1]) return;
  for (int end = 0; end < ends; ++end) {
    const int cut = cutBy[end];
    const int vertex = vertices[end];
    const Triple p = cut < 0 ? Triple(inc.v[vertex]) : a + t[end] * (b - a);
    addClipped(ref.first, scratch, p, cut < 0 ? kNoFeature : ref.edgeCode(cut), featureCode(vertex), pair.limit, out);
  }
}

/// For a core without faces: a segment, or a point.
inline void clipSegment(const Reference3& ref, const Core3& inc, const PlacedPair<3>& pair, ClipScratch3& scratch,
                        std::vector<PatchPoint<3>>& out) {
  clipEdge(ref, inc, {0, inc.vertexCount - 1}, pair, scratch, out);
}

/// Sutherland-Hodgman clipping: the part of face `incFace` of `inc` inside the side planes of the reference face. A
/// corner less than the pair's tolerance outside is kept. Otherwise equal faces on each other would get new corners
/// with every rounding, and lose their impulses.
inline void clipFace(const Reference3& ref, const Core3& inc, int incFace, const PlacedPair<3>& pair,
                     ClipScratch3& scratch, std::vector<PatchPoint<3>>& out) {
  const int begin = inc.face(incFace).begin, size = inc.faceSize(incFace);
  if (size == 2) {  // a side of a triangle
    return clipEdge(ref, inc, {inc.loop(begin), inc.loop(begin + 1)}, pair, scratch, out);
  }
  ref.fill(scratch);
  // Plain pointers into large enough arrays: `push_back` took longer than the arithmetic.
  scratch.corners.resize(static_cast<std::size_t>(size)), scratch.from.resize(scratch.corners.size());
  for (int k = 0; k < size; ++k) {
    scratch.corners[k] = {Triple(inc.v[inc.loop(begin + k)]), k == 0 ? size - 1 : k - 1, k};
    scratch.from[k] = k;
  }
  const Real tolerance = pair.tolerance;
  int count = size, made = size;
  for (int j = 0; j < ref.size() && count > 0; ++j) {
    const Side3& side = scratch.sides[j];
    scratch.beyond.resize(static_cast<std::size_t>(count));
    const int* from = scratch.from.data();
    Real* beyond = scratch.beyond.data();
    bool inside = true;
    for (int i = 0; i < count; ++i) {
      beyond[i] = dot(side.m, scratch.corners[from[i]].p) - side.offset;
      inside &= beyond[i] <= tolerance;
    }
    if (inside) continue;
    // Each corner is kept or not, and a new one may precede it.
    scratch.to.resize(static_cast<std::size_t>(2 * count));
    scratch.corners.resize(static_cast<std::size_t>(made + count));
    int* to = scratch.to.data();
    ClipVertex3* corners = scratch.corners.data();
    int left = 0, last = count - 1;
    for (int i = 0; i < count; last = i, ++i) {
      const Real dp = beyond[last], dq = beyond[i];
      const bool leaves = dp < 0 && dq > tolerance, enters = dp > tolerance && dq < 0;
      if (leaves || enters) {
        const ClipVertex3 &p = corners[from[last]], &q = corners[from[i]];
        ClipVertex3& x = corners[made];
        x.p = p.p + dp / (dp - dq) * (q.p - p.p);
        x.in = leaves ? p.out : ~j, x.out = leaves ? ~j : p.out;
        to[left++] = made++;
      }
      if (dq <= tolerance) to[left++] = from[i];
    }
    std::swap(scratch.from, scratch.to);
    count = left;
  }
  const auto incVertex = [&](int k) { return inc.loop(begin + (k < size ? k : 0)); };
  for (int i = 0; i < count; ++i) {
    const ClipVertex3& c = scratch.corners[scratch.from[i]];
    std::uint32_t refCode = kNoFeature, incCode = kNoFeature;
    if (c.in >= 0 && c.out >= 0) {
      incCode = featureCode(incVertex(c.out));
    } else if (c.in < 0 && c.out < 0) {
      refCode = ref.cornerCode(~c.in, ~c.out);
    } else {
      const int k = std::max(c.in, c.out);
      refCode = ref.edgeCode(~std::min(c.in, c.out));
      incCode = featureCode(incVertex(k), incVertex(k + 1));
    }
    addClipped(ref.first, scratch, c.p, refCode, incCode, pair.limit, out);
  }
}

/// For an empty clip of overlapping cores, which only rounding at a face's rim causes: adds the support vertex of
/// `inc`; among equals the one least far outside the reference face.
inline void addForemost(const Reference3& ref, const Core3& inc, Real separation, const PlacedPair<3>& pair,
                        ClipScratch3& scratch, std::vector<PatchPoint<3>>& out) {
  int best = -1;
  Real least = std::numeric_limits<Real>::infinity();
  ref.fill(scratch);
  for (int v = 0; v < inc.vertexCount; ++v) {
    const Triple p(inc.v[v]);
    Real height = 0, outside = 0;
    under(scratch, p, height);
    if (height > separation + pair.tolerance) continue;
    for (const Side3& side : scratch.sides) outside = std::max(outside, dot(side.m, p) - side.offset);
    if (outside < least) best = v, least = outside;
  }
  if (best >= 0) addClipped(ref.first, scratch, Triple(inc.v[best]), kNoFeature, featureCode(best), pair.limit, out);
}

}}}  // namespace lpc::LPC_PRECISION::contacts
