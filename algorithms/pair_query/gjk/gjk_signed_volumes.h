// SPDX-License-Identifier: Zlib
// The point of a simplex nearest to the origin by signed volumes (Montanari, Petrinic and Barbieri 2017): the
// projection of the origin is compared with the corners in the coordinate plane or axis in which the simplex is
// largest, by signs of lengths, areas and volumes. Products of differences are divided only by the largest of their
// kind.
#pragma once

#include "algorithms/pair_query/gjk/gjk_simplex3.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// The segment a b.
template <int D>
void offerByLengths(const Vec<D>& a, const Vec<D>& b, NearestFeature<D>& best) {
  const Vec<D> e = b - a;
  const Real square = e.squaredNorm();
  const Vec<D> foot = square > 0 ? Vec<D>(b - b.dot(e) / square * e) : a;
  int axis = 0;
  e.cwiseAbs().maxCoeff(&axis);
  const Real length = e[axis], toB = b[axis] - foot[axis], fromA = foot[axis] - a[axis];  // signed parts of it
  if ((length > 0 && toB > 0 && fromA > 0) || (length < 0 && toB < 0 && fromA < 0)) {
    return best.offer(footOnLine<D>(a, b), {&a, &b});
  }
  best.offer(a, {&a});
  best.offer(b, {&b});
}

/// The triangle a b c.
inline void offerByAreas(const Vec<3>& a, const Vec<3>& b, const Vec<3>& c, NearestFeature<3>& best) {
  const Vec<3> n = (b - a).cross(c - a);
  const Real square = n.squaredNorm();
  if (square > 0) {
    const Vec<3> foot = a.dot(n) / square * n;
    int axis = 0;
    n.cwiseAbs().maxCoeff(&axis);
    const int k = (axis + 1) % 3, l = (axis + 2) % 3;
    const auto area = [&](const Vec<3>& u, const Vec<3>& v, const Vec<3>& w) {
      return (v[k] - u[k]) * (w[l] - u[l]) - (v[l] - u[l]) * (w[k] - u[k]);
    };
    const Real whole = n[axis], ofA = area(foot, b, c), ofB = area(a, foot, c), ofC = area(a, b, foot);
    if ((whole > 0 && ofA > 0 && ofB > 0 && ofC > 0) || (whole < 0 && ofA < 0 && ofB < 0 && ofC < 0)) {
      return best.offer(footOnPlane(a, b, c, Vec<3>(n / std::sqrt(square))), {&a, &b, &c});
    }
  }
  offerByLengths<3>(a, b, best);
  offerByLengths<3>(b, c, best);
  offerByLengths<3>(c, a, best);
}

/// Returns true if the triangle contains the origin; `best` is then untouched.
inline bool nearestByVolumes(const Simplex<2>& s, NearestFeature<2>& best) {
  if (s.count == 1) {
    best.offer(s[0], {&s[0]});
    return false;
  }
  if (s.count == 3) {
    const auto area = [](const Vec<2>& u, const Vec<2>& v) { return u[0] * v[1] - u[1] * v[0]; };
    const Real ofA = area(s[1], s[2]), ofB = area(s[2], s[0]), ofC = area(s[0], s[1]);
    if ((ofA > 0 && ofB > 0 && ofC > 0) || (ofA < 0 && ofB < 0 && ofC < 0)) return true;
  }
  for (int i = 0; i < s.count; ++i) {
    for (int j = 0; j < i; ++j) offerByLengths<2>(s[i], s[j], best);
  }
  return false;
}

/// Returns true if the tetrahedron contains the origin; `best` is then untouched. A flat one contains nothing.
inline bool nearestByVolumes(const Simplex<3>& s, NearestFeature<3>& best) {
  if (s.count == 1) {
    best.offer(s[0], {&s[0]});
    return false;
  }
  if (s.count == 2) {
    offerByLengths<3>(s[0], s[1], best);
    return false;
  }
  if (s.count == 3) {
    offerByAreas(s[0], s[1], s[2], best);
    return false;
  }
  const auto volume = [](const Vec<3>& u, const Vec<3>& v, const Vec<3>& w) { return u.dot(v.cross(w)); };
  // Volumes of the tetrahedra of the origin and each face; they sum to the whole.
  const Real ofA = volume(s[1], s[2], s[3]), ofB = volume(s[0], s[3], s[2]), ofC = volume(s[0], s[1], s[3]),
             ofD = volume(s[0], s[2], s[1]);
  const Real whole = volume(s[1] - s[0], s[2] - s[0], s[3] - s[0]);
  const auto alike = [&](Real part) { return (whole > 0 && part > 0) || (whole < 0 && part < 0); };
  if (alike(ofA) && alike(ofB) && alike(ofC) && alike(ofD)) return true;
  if (!alike(ofA)) offerByAreas(s[1], s[2], s[3], best);
  if (!alike(ofB)) offerByAreas(s[0], s[2], s[3], best);
  if (!alike(ofC)) offerByAreas(s[0], s[1], s[3], best);
  if (!alike(ofD)) offerByAreas(s[0], s[1], s[2], best);
  return false;
}

}}}  // namespace lpc::LPC_PRECISION::pair_query
