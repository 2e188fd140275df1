// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/core3.h"

namespace lpc::inline LPC_PRECISION::contacts {

/// A corner of the clipped face. The edges that meet in it are edge k of the incident face, or ~j for edge j of the
/// reference face.
struct ClipVertex3 {
  Vec<3> p;
  int in, out;
};

struct Side3 {
  Vec<3> m;  // unit, outward
  Real offset;
};

struct Patch3 {
  Vec<3> normal = Vec<3>::Zero();  // n_12, unit, in frame 1
  std::vector<PatchPoint<3>> points;

  /// Is one of the points within `bound`? Of cores that are `apart` the witnesses themselves must be: those of a corner
  /// beside the reference face are not one above the other.
  bool reaches(Real bound, bool apart) const {
    for (const PatchPoint<3>& p : points) {
      const bool above = !apart && p.separation <= 0;
      if (p.separation <= bound && (above || (p.p2 - p.p1).squaredNorm() <= bound * bound)) return true;
    }
    return false;
  }
};

struct ClipScratch3 {
  std::vector<ClipVertex3> from, to;
  std::vector<Side3> sides;
};

/// The reference face as clipping sees it; `outward` is the direction along which points are projected onto it, not
/// necessarily its normal.
struct Reference3 {
  const Core3& core;
  int face;
  Vec<3> outward;
  bool first;  // it belongs to shape 1

  int size() const { return core.faceSize(face); }
  int vertex(int k) const { return core.loop(core.face(face).begin + (k < size() ? k : 0)); }
  /// The planes through the face's edges along `outward`.
  void fillSides(std::vector<Side3>& sides) const {
    sides.clear();
    for (int j = 0; j < size(); ++j) {
      const Vec<3>& v = core.v[vertex(j)];
      Vec<3> m = (core.v[vertex(j + 1)] - v).cross(outward);
      const Real length = m.norm();
      if (length > 0) m /= length;
      sides.push_back({m, m.dot(v)});
    }
  }
  /// The point of the face's plane that lies under p, and p's height above it along `outward`.
  Vec<3> under(const Vec<3>& p, Real& height) const {
    const Vec<3>& n = core.n[face];
    height = n.dot(p - core.v[vertex(0)]) / n.dot(outward);
    return p - height * outward;
  }
  Vec<3> nearestOnRim(const Vec<3>& p) const {
    Vec<3> best = p;
    Real least = std::numeric_limits<Real>::infinity();
    for (int j = 0; j < size(); ++j) {
      const Vec<3>& a = core.v[vertex(j)];
      const Vec<3> d = core.v[vertex(j + 1)] - a;
      const Real length2 = d.squaredNorm();
      const Real t = length2 > 0 ? std::clamp((p - a).dot(d) / length2, Real(0), Real(1)) : Real(0);
      const Vec<3> q = a + t * d;
      const Real distance2 = (p - q).squaredNorm();
      if (distance2 < least) best = q, least = distance2;
    }
    return best;
  }
  std::uint32_t edgeCode(int j) const { return featureCode(vertex(j), vertex(j + 1)); }
  /// Of the vertex between two of its edges, or of the first edge when they do not meet.
  std::uint32_t cornerCode(int j, int k) const {
    const int m = size();
    if (k == (j + 1) % m) return featureCode(vertex(k));
    if (j == (k + 1) % m) return featureCode(vertex(j));
    return edgeCode(j);
  }
};

/// A corner that lies beside the face, within tolerance, has its witness on the rim: the two are then not quite one
/// above the other, but both lie on their shapes.
inline void addClipped(const Reference3& ref, std::span<const Side3> sides, const Vec<3>& p, std::uint32_t refCode,
                       std::uint32_t incCode, Real limit, std::vector<PatchPoint<3>>& out) {
  Real height = 0;
  Vec<3> base = ref.under(p, height);
  bool beside = false;
  for (const Side3& side : sides) beside = beside || side.m.dot(p) > side.offset;
  if (beside) base = ref.nearestOnRim(base);
  height = ref.outward.dot(p - base);
  if (!(height <= limit)) return;
  if (ref.first) {
    out.push_back({base, p, height, featureNumber(refCode, incCode)});
  } else {
    out.push_back({p, base, height, featureNumber(incCode, refCode)});
  }
}

/// The part of an edge between two vertices of `inc` inside the side planes of the reference face, with tolerances as
/// for a face. When both are one vertex, that is a point, whose number needs no tolerance to be steady.
inline void clipEdge(const Reference3& ref, const Core3& inc, const std::array<int, 2>& vertices,
                     const PlacedPair<3>& pair, ClipScratch3& scratch, std::vector<PatchPoint<3>>& out) {
  const int ends = vertices[0] == vertices[1] ? 1 : 2;
  const Real tolerance = ends == 1 ? Real(0) : pair.tolerance;
  Real t[2] = {0, 1};
  int cutBy[2] = {-1, -1};
  const Vec<3>&a = inc.v[vertices[0]], &b = inc.v[vertices[1]];
  ref.fillSides(scratch.sides);
  for (int j = 0; j < ref.size(); ++j) {
    const auto& [m, offset] = scratch.sides[static_cast<std::size_t>(j)];
    const Real da = m.dot(a) - offset, db = m.dot(b) - offset;
    if (da > tolerance && db > tolerance) return;
    // An end within the tolerance stays where it is, even when the other one is cut off.
    const Real cut1 = db < 0 ? da / (da - db) : Real(1), cut2 = da < 0 ? da / (da - db) : Real(0);
    if (da > tolerance && cut1 > t[0]) t[0] = cut1, cutBy[0] = j;
    if (db > tolerance && cut2 < t[1]) t[1] = cut2, cutBy[1] = j;
  }
  if (t[0] > t[1]) return;
  for (int end = 0; end < ends; ++end) {
    const int cut = cutBy[end];
    const int vertex = vertices[static_cast<std::size_t>(end)];
    const Vec<3> p = cut < 0 ? inc.v[vertex] : Vec<3>(a + t[end] * (b - a));
    addClipped(ref, scratch.sides, p, cut < 0 ? kNoFeature : ref.edgeCode(cut), featureCode(vertex), pair.limit, out);
  }
}

/// For a core without faces: a segment, or a point.
inline void clipSegment(const Reference3& ref, const Core3& inc, const PlacedPair<3>& pair, ClipScratch3& scratch,
                        std::vector<PatchPoint<3>>& out) {
  clipEdge(ref, inc, {0, inc.vertexCount - 1}, pair, scratch, out);
}

/// Sutherland-Hodgman: the part of face `incFace` of `inc` inside the side planes of the reference face. A corner that
/// lies outside by less than the pair's tolerance stays as it is: faces of equal size that lie on each other would
/// otherwise get new corners, and lose their impulses, with every rounding.
inline void clipFace(const Reference3& ref, const Core3& inc, int incFace, const PlacedPair<3>& pair,
                     ClipScratch3& scratch, std::vector<PatchPoint<3>>& out) {
  const int begin = inc.face(incFace).begin, size = inc.faceSize(incFace);
  if (size == 2) {  // a side of a triangle
    return clipEdge(ref, inc, {inc.loop(begin), inc.loop(begin + 1)}, pair, scratch, out);
  }
  auto& from = scratch.from;
  auto& to = scratch.to;
  from.clear();
  ref.fillSides(scratch.sides);
  for (int k = 0; k < size; ++k) from.push_back({inc.v[inc.loop(begin + k)], k == 0 ? size - 1 : k - 1, k});
  const Real tolerance = pair.tolerance;
  for (int j = 0; j < ref.size() && !from.empty(); ++j) {
    const auto& [m, offset] = scratch.sides[static_cast<std::size_t>(j)];
    to.clear();
    const ClipVertex3* p = &from.back();
    Real dp = m.dot(p->p) - offset;
    for (const ClipVertex3& q : from) {
      const Real dq = m.dot(q.p) - offset;
      const bool leaves = dp < 0 && dq > tolerance, enters = dp > tolerance && dq < 0;
      if (leaves || enters) {
        const Vec<3> x = p->p + dp / (dp - dq) * (q.p - p->p);
        to.push_back(leaves ? ClipVertex3{x, p->out, ~j} : ClipVertex3{x, ~j, p->out});
      }
      if (dq <= tolerance) to.push_back(q);
      p = &q, dp = dq;
    }
    std::swap(from, to);
  }
  const auto incVertex = [&](int k) { return inc.loop(begin + (k < size ? k : 0)); };
  for (const ClipVertex3& c : from) {
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
    addClipped(ref, scratch.sides, c.p, refCode, incCode, pair.limit, out);
  }
}

/// For an empty clip of overlapping cores, which only rounding at a face's rim makes: the foremost vertex of `inc`, of
/// equals the one least far outside the reference face.
inline void addForemost(const Reference3& ref, const Core3& inc, Real separation, const PlacedPair<3>& pair,
                        ClipScratch3& scratch, std::vector<PatchPoint<3>>& out) {
  int best = -1;
  Real least = std::numeric_limits<Real>::infinity();
  ref.fillSides(scratch.sides);
  for (int v = 0; v < inc.vertexCount; ++v) {
    Real height = 0, outside = 0;
    ref.under(inc.v[v], height);
    if (height > separation + pair.tolerance) continue;
    for (const Side3& side : scratch.sides) outside = std::max(outside, side.m.dot(inc.v[v]) - side.offset);
    if (outside < least) best = v, least = outside;
  }
  if (best >= 0) addClipped(ref, scratch.sides, inc.v[best], kNoFeature, featureCode(best), pair.limit, out);
}

}  // namespace lpc::inline LPC_PRECISION::contacts
