// SPDX-License-Identifier: Zlib
// The point of a simplex nearest to the origin, in space.
#pragma once

#include "algorithms/pair_query/gjk/gjk_simplex2.h"
#include "algorithms/pair_query/gjk/triple.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// The projection of the origin on the plane of a, b and c with the unit normal n. The height is that of the nearest
/// corner, where an inaccurate normal costs least.
inline Triple footOnPlane(const Triple& a, const Triple& b, const Triple& c, const Triple& n) {
  Triple near = a;
  if (dot(b, b) < dot(near, near)) near = b;
  if (dot(c, c) < dot(near, near)) near = c;
  return dot(n, near) * n;
}
inline Vec<3> footOnPlane(const Vec<3>& a, const Vec<3>& b, const Vec<3>& c, const Vec<3>& n) {
  return footOnPlane(Triple(a), Triple(b), Triple(c), Triple(n)).vector();
}

/// The nearest point of a simplex in 3D: features are stored as indices of points, since points are expensive to copy.
class NearestOf3 {
 public:
  NearestOf3(const Simplex<3>& simplex, Real length2)
      : m_simplex(simplex),
        m_w{Triple(simplex[0]), Triple(simplex[1]), Triple(simplex[2]), Triple(simplex[3])},
        m_length2(length2) {}

  const Triple& point(int i) const { return m_w[i]; }
  void offer(const Triple& foot, int count, int i, int j, int k) {
    const Real squared = dot(foot, foot);
    if (!(squared < m_length2)) return;
    m_length2 = squared, m_foot = foot, m_count = count, m_on[0] = i, m_on[1] = j, m_on[2] = k;
  }
  void offerPoint(int i) { offer(m_w[i], 1, i, 0, 0); }
  /// Like offerSegment in 2D.
  void offerSegment(int i, int j) {
    const Triple a = m_w[i], b = m_w[j];
    Triple e = b - a;
    if (!(dot(a, e) < 0)) return offerPoint(i);
    if (!(dot(b, e) > 0)) return offerPoint(j);
    Triple foot = dot(a, a) < dot(b, b) ? a : b;
    if (makeUnit(e)) removeAlong(foot, e);
    offer(foot, 2, i, j, 0);
  }
  /// Planes through the edges along the normal decide the sides: they stay valid on slivers where barycentric
  /// coordinates from dot products do not. If they fail, too, the three edges remain.
  void offerTriangle(int i, int j, int k) {
    const Triple a = m_w[i], b = m_w[j], c = m_w[k], n = cross(b - a, c - a);
    const Real ab = dot(n, cross(a, b - a)), bc = dot(n, cross(b, c - b)), ca = dot(n, cross(c, a - c));
    Triple unit = n;
    if (ab > 0 && bc > 0 && ca > 0 && makeUnit(unit)) return offer(footOnPlane(a, b, c, unit), 3, i, j, k);
    if (!(ab > 0)) offerSegment(i, j);
    if (!(bc > 0)) offerSegment(j, k);
    if (!(ca > 0)) offerSegment(k, i);
  }
  /// Writes nothing if nothing nearer was offered.
  void tell(NearestFeature<3>& best) const {
    if (m_count == 0) return;
    best.length2 = m_length2, best.v = m_foot.vector(), best.feature.count = 0;
    for (const int i : m_on) best.feature.push(m_simplex[i]);
    best.feature.count = m_count;
  }

 private:
  const Simplex<3>& m_simplex;
  Triple m_w[4];
  Triple m_foot;
  Real m_length2;
  int m_on[3] = {}, m_count = 0;
};

/// Returns true if the tetrahedron contains the origin; `best` is then untouched. A flat one contains nothing.
inline bool nearestOfSimplex(const Simplex<3>& s, NearestFeature<3>& best) {
  NearestOf3 nearest(s, best.length2);
  bool inside = false;
  switch (s.count) {
    case 1:
      nearest.offerPoint(0);
      break;
    case 2:
      nearest.offerSegment(0, 1);
      break;
    case 3:
      nearest.offerTriangle(0, 1, 2);
      break;
    default: {
      // Skips a face if the origin lies on its inner side, the side of the fourth corner.
      const auto inner = [&](int i, int j, int k, int l) {
        const Triple a = nearest.point(i), n = cross(nearest.point(j) - a, nearest.point(k) - a);
        const Real corner = dot(n, nearest.point(l) - a), origin = -dot(n, a);
        return (corner > 0 && origin > 0) || (corner < 0 && origin < 0);
      };
      constexpr int kFaces[4][4] = {
          {3, 0, 1, 2}, {3, 1, 2, 0}, {3, 2, 0, 1}, {0, 1, 2, 3}};  // the newest point's first
      inside = true;
      for (const auto& f : kFaces) {
        if (inner(f[0], f[1], f[2], f[3])) continue;
        inside = false;
        nearest.offerTriangle(f[0], f[1], f[2]);
      }
    }
  }
  nearest.tell(best);
  return inside;
}

inline bool featureDirection(const NearestFeature<3>& nearest, Vec<3>& n) {
  const Simplex<3>& s = nearest.feature;
  Triple d(nearest.v);
  if (s.count == 3) {
    const Triple a(s[0]);
    d = cross(Triple(s[1]) - a, Triple(s[2]) - a);
    if (dot(d, a) < 0) d = -d;
  }
  if (!makeUnit(d)) return false;
  n = d.vector();
  return true;
}

}}}  // namespace lpc::LPC_PRECISION::pair_query
