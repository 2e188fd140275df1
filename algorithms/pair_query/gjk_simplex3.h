// SPDX-License-Identifier: Zlib
// The point of a simplex nearest to the origin, in space.
#pragma once

#include "algorithms/pair_query/gjk_simplex2.h"
#include "algorithms/pair_query/triple.h"

namespace lpc::inline LPC_PRECISION::pair_query {

/// The foot of the origin on the plane of a, b and c with the unit normal n. The height is that of the nearest corner:
/// a normal of rounding costs least there.
inline Vec<3> footOnPlane(const Vec<3>& a, const Vec<3>& b, const Vec<3>& c, const Vec<3>& n) {
  const Vec<3>* near = &a;
  for (const Vec<3>* w : {&b, &c}) {
    if (w->squaredNorm() < near->squaredNorm()) near = w;
  }
  return n.dot(*near) * n;
}

/// Offers the nearest point of the triangle a b c. Sides are told by planes through the edges along the normal, which
/// keeps its meaning on slivers where barycentric coordinates from dot products do not; where it does not either, the
/// three edges are there.
inline void offerTriangle(const Vec<3>& a, const Vec<3>& b, const Vec<3>& c, NearestFeature<3>& best) {
  const Triple u(a), v(b), w(c), n = cross(v - u, w - u);
  const Real ab = dot(n, cross(u, v - u)), bc = dot(n, cross(v, w - v)), ca = dot(n, cross(w, u - w));
  Triple unit = n;
  if (ab > 0 && bc > 0 && ca > 0 && makeUnit(unit)) {
    return best.offer(footOnPlane(a, b, c, unit.vector()), {&a, &b, &c});
  }
  if (!(ab > 0)) offerSegment<3>(a, b, best);
  if (!(bc > 0)) offerSegment<3>(b, c, best);
  if (!(ca > 0)) offerSegment<3>(c, a, best);
}

/// True when the tetrahedron holds the origin; then `best` is untouched. A flat one holds nothing.
inline bool nearestOfSimplex(const Simplex<3>& s, NearestFeature<3>& best) {
  switch (s.count) {
    case 1:
      best.offer(s[0], {&s[0]});
      return false;
    case 2:
      offerSegment<3>(s[0], s[1], best);
      return false;
    case 3:
      offerTriangle(s[0], s[1], s[2], best);
      return false;
    default:
      break;
  }
  // A face is passed over when the origin lies on its inner side, where the fourth corner is.
  const std::array<Triple, 4> w = {Triple(s[0]), Triple(s[1]), Triple(s[2]), Triple(s[3])};
  const auto inner = [&](int i, int j, int k, int l) {
    const auto at = [&](int m) { return w[static_cast<std::size_t>(m)]; };
    const Triple n = cross(at(j) - at(i), at(k) - at(i));
    const Real corner = dot(n, at(l) - at(i)), origin = -dot(n, at(i));
    return (corner > 0 && origin > 0) || (corner < 0 && origin < 0);
  };
  constexpr int kFaces[4][4] = {{3, 0, 1, 2}, {3, 1, 2, 0}, {3, 2, 0, 1}, {0, 1, 2, 3}};  // the newest point's first
  bool inside = true;
  for (const auto& f : kFaces) {
    if (inner(f[0], f[1], f[2], f[3])) continue;
    inside = false;
    offerTriangle(s[f[0]], s[f[1]], s[f[2]], best);
  }
  return inside;
}

inline bool featureDirection(const NearestFeature<3>& nearest, Vec<3>& n) {
  const Simplex<3>& s = nearest.feature;
  n = nearest.v;
  if (s.count == 3) {
    const Triple a(s[0]);
    Triple normal = cross(Triple(s[1]) - a, Triple(s[2]) - a);
    if (dot(normal, a) < 0) normal = -normal;
    if (!makeUnit(normal)) return false;
    n = normal.vector();
    return true;
  }
  return makeUnit<3>(n);
}

}  // namespace lpc::inline LPC_PRECISION::pair_query
