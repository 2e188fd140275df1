// SPDX-License-Identifier: Zlib
// Closest points of cores that are apart and have nearest features without a separating axis of SAT: two corners, a
// corner and an edge, parallel edges.
#pragma once

#include "algorithms/contacts/clip/clip3.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

struct SegmentPair3 {
  Vec<3> a1, b1, a2, b2;  // segments 1 and 2; a point has a = b
};

/// Closest points at a1 + s (b1 - a1) and a2 + t (b2 - a2); returns their squared distance (Ericson 2005, 5.1.9).
inline Real closestOfSegments(const SegmentPair3& x, Real& s, Real& t) {
  const Vec<3> d1 = x.b1 - x.a1, d2 = x.b2 - x.a2, r = x.a1 - x.a2;
  const Real a = d1.squaredNorm(), e = d2.squaredNorm(), c = d1.dot(r), f = d2.dot(r), b = d1.dot(d2);
  const auto unit = [](Real v) { return std::clamp(v, Real(0), Real(1)); };
  s = t = 0;
  if (a > 0) {
    if (e > 0) {
      const Real det = a * e - b * b;
      // Parallel: every s is equally good; the clamps below find the right end.
      if (det > kParallelDeterminant * a * e) s = unit((b * f - c * e) / det);
      t = (b * s + f) / e;
      if (!(t >= 0)) {
        t = 0, s = unit(-c / a);
      } else if (t > 1) {
        t = 1, s = unit((b - c) / a);
      } else {
        s = unit((b * t - c) / a);  // again, for the digits that the determinant lost
      }
    } else {
      s = unit(-c / a);
    }
  } else if (e > 0) {
    t = unit(f / e);
  }
  return ((x.a2 + t * d2) - (x.a1 + s * d1)).squaredNorm();
}

/// The edge of each core and the position on it. A core without edges has edge -1: its one vertex.
struct ClosestEdges3 {
  int edge1 = -1, edge2 = -1;
  Real s = 0, t = 0, squared = std::numeric_limits<Real>::infinity();
};

inline void edgeEnds(const Core3& c, int e, int& v0, int& v1) {
  v0 = e < 0 ? 0 : c.edge(e).v0;
  v1 = e < 0 ? 0 : c.edge(e).v1;
}
inline SegmentPair3 segmentPair(const Core3& c1, int edge1, const Core3& c2, int edge2) {
  int v[4];
  edgeEnds(c1, edge1, v[0], v[1]), edgeEnds(c2, edge2, v[2], v[3]);
  return {c1.v[v[0]], c1.v[v[1]], c2.v[v[2]], c2.v[v[3]]};
}

/// Separation of segment 2 from segment 1 along n (m).
inline Real separationOfSegments(const SegmentPair3& x, const Vec<3>& n) {
  return std::min(n.dot(x.a2), n.dot(x.b2)) - std::max(n.dot(x.a1), n.dot(x.b1));
}

/// n_12 of two segments from their closest points. The vector between them loses digits when the segments nearly cross,
/// and its component along a segment reduces the separation by that part of the segment's length. So the best of three
/// is used: the vector, the vector orthogonalised against either segment, and the cross product of both.
inline Vec<3> normalOfSegments(const SegmentPair3& x, const ClosestEdges3& e, const PlacedPair<3>& pair) {
  const Vec<3> d1 = x.b1 - x.a1, d2 = x.b2 - x.a2, apart = (x.a2 + e.t * d2) - (x.a1 + e.s * d1);
  const Real distance = apart.norm();
  Vec<3> best = Vec<3>::Zero();
  Real most = -std::numeric_limits<Real>::infinity();
  if (distance > pair.rounding) {
    best = apart / distance, most = separationOfSegments(x, best);
    if (most >= distance - pair.rounding) return best;
  }
  const Real length1 = d1.norm(), length2 = d2.norm();
  const auto across = [](const Vec<3>& v, const Vec<3>& d, Real length) -> Vec<3> {
    return length > 0 ? Vec<3>(v - v.dot(d) / length / length * d) : v;
  };
  const auto offer = [&](const Vec<3>& v) {
    const Real length = v.norm();
    if (!(length > 0)) return;
    const Vec<3> n = v / length;
    const Real separation = separationOfSegments(x, n);
    if (separation > most) best = n, most = separation;
  };
  // Orthogonalised once more against one of them, which makes it orthogonal to both to the last digit at any angle.
  Vec<3> both = d1.cross(d2);
  if (both.norm() > kParallelCross * length1 * length2) {
    both = across(both, d1, length1);
  } else {
    const Vec<3>& longer = length1 >= length2 ? d1 : d2;
    both = longer.isZero(0) ? Vec<3>(Vec<3>::Unit(0)) : Vec<3>(tangents(Vec<3>(longer.normalized())).col(0));
  }
  const bool forward = both.dot(distance > pair.rounding ? apart : pair.X_12.p) >= 0;
  offer(forward ? both : Vec<3>(-both));
  if (distance > pair.rounding) offer(across(apart, d1, length1)), offer(across(apart, d2, length2));
  return best;
}

struct ClosestScratch3 {
  std::vector<int> edges1, edges2;
};

/// The nearest pair of edges. `n` (unit, n_12) separates the cores by at least `separation` >= 0. A feature whose
/// distance behind the support plane exceeds the best distance found less `separation` cannot be nearest, so near
/// contact only a few edges remain.
inline ClosestEdges3 closestEdges(const Core3& c1, const Core3& c2, const Vec<3>& n, Real separation,
                                  ClosestScratch3& scratch) {
  ClosestEdges3 best;
  const int foremost1 = vertexAlong(c1, n), foremost2 = vertexAlong(c2, -n);
  const Real front1 = n.dot(c1.v[foremost1]), front2 = n.dot(c2.v[foremost2]);
  const auto collect = [](const Core3& c, std::vector<int>& out, const auto& wanted) {
    out.clear();
    for (int e = 0; e < c.edgeCount(); ++e) {
      if (wanted(c.edge(e))) out.push_back(e);
    }
    if (c.edgeCount() == 0) out.push_back(-1);
  };
  const auto search = [&] {
    for (int e1 : scratch.edges1) {
      for (int e2 : scratch.edges2) {
        Real s = 0, t = 0;
        const Real squared = closestOfSegments(segmentPair(c1, e1, c2, e2), s, t);
        if (squared < best.squared) best = {e1, e2, s, t, squared};
      }
    }
  };
  collect(c1, scratch.edges1, [&](const auto& e) { return e.v0 == foremost1 || e.v1 == foremost1; });
  collect(c2, scratch.edges2, [&](const auto& e) { return e.v0 == foremost2 || e.v1 == foremost2; });
  search();
  const Real slack = std::sqrt(best.squared) - separation;
  collect(c1, scratch.edges1,
          [&](const auto& e) { return std::max(n.dot(c1.v[e.v0]), n.dot(c1.v[e.v1])) >= front1 - slack; });
  collect(c2, scratch.edges2,
          [&](const auto& e) { return std::min(n.dot(c2.v[e.v0]), n.dot(c2.v[e.v1])) <= front2 + slack; });
  search();
  return best;
}

/// Feature number of the nearest pair: vertices if it lies at their ends, else edges.
inline std::uint64_t closestFeature(const Core3& c1, const Core3& c2, const ClosestEdges3& e) {
  int v[4];
  edgeEnds(c1, e.edge1, v[0], v[1]), edgeEnds(c2, e.edge2, v[2], v[3]);
  const auto code = [](int v0, int v1, Real s) {
    return s <= 0 ? featureCode(v0) : s >= 1 ? featureCode(v1) : featureCode(v0, v1);
  };
  return featureNumber(code(v[0], v[1], e.s), code(v[2], v[3], e.t));
}

/// Contact points of two edges (or of an edge and a point) along `n`: their closest points, or the two ends of their
/// common interval if they are nearly parallel.
inline void touchEdges(const Core3& c1, const Core3& c2, const ClosestEdges3& e, const PlacedPair<3>& pair,
                       Patch3& out) {
  const SegmentPair3 x = segmentPair(c1, e.edge1, c2, e.edge2);
  const Vec<3> d1 = x.b1 - x.a1, d2 = x.b2 - x.a2;
  int v[4];
  edgeEnds(c1, e.edge1, v[0], v[1]), edgeEnds(c2, e.edge2, v[2], v[3]);
  const auto add = [&](const Vec<3>& p1, const Vec<3>& p2, std::uint32_t code1, std::uint32_t code2) {
    const Real separation = (p2 - p1).dot(out.normal);
    if (separation <= pair.limit) out.points.push_back({p1, p2, separation, featureNumber(code1, code2)});
  };
  const Real length1 = d1.norm(), length2 = d2.norm();
  if (d1.cross(d2).norm() <= kNearlyParallel * length1 * length2 && length1 > pair.tolerance &&
      length2 > pair.tolerance) {
    const Vec<3> u = d1 / length1;
    const Real from = u.dot(x.a2 - x.a1), to = u.dot(x.b2 - x.a1);
    const bool along = to > from;
    const Real lo = std::max(Real(0), std::min(from, to)), hi = std::min(length1, std::max(from, to));
    if (hi - lo > pair.tolerance) {
      for (bool last : {false, true}) {
        const Real at = last ? hi : lo;
        const Vec<3> p1 = x.a1 + at * u, p2 = x.a2 + (at - from) / (to - from) * d2;
        add(p1, p2, featureCode(last ? v[1] : v[0]), featureCode(last == along ? v[3] : v[2]));
      }
      return;
    }
  }
  const Vec<3> p1 = x.a1 + e.s * d1, p2 = x.a2 + e.t * d2;
  const Real separation = (p2 - p1).dot(out.normal);
  if (separation <= pair.limit) out.points.push_back({p1, p2, separation, closestFeature(c1, c2, e)});
}

}}}  // namespace lpc::LPC_PRECISION::contacts
