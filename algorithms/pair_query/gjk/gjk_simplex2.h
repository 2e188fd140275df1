// SPDX-License-Identifier: Zlib
// The point of a simplex nearest to the origin, in the plane.
#pragma once

#include <array>

#include "algorithms/pair_query/core/core_pair.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// Up to D + 1 points of the Minkowski difference.
template <int D>
struct Simplex {
  IndexedArray<Vec<D>, D + 1> w;
  int count = 0;

  Simplex() {
    for (Vec<D>& v : w) v.setZero();
  }
  Simplex(const Simplex& other) { *this = other; }
  /// Copies number by number (triple.h), because points are copied just after they are made. Copies all of them,
  /// because their count is unpredictable.
  Simplex& operator=(const Simplex& other) {
    for (std::size_t i = 0; i < w.size(); ++i) {
      for (int k = 0; k < D; ++k) w[i][k] = other.w[i][k];
    }
    count = other.count;
    return *this;
  }
  const Vec<D>& operator[](int i) const { return w[i]; }
  void push(const Vec<D>& point) {
    Vec<D>& place = w[count++];
    for (int k = 0; k < D; ++k) place[k] = point[k];
  }
  bool contains(const Vec<D>& point) const {
    bool found = false;
    for (int i = 0; i <= D; ++i) {
      bool same = i < count;
      for (int k = 0; k < D; ++k) same &= (*this)[i][k] == point[k];
      found |= same;
    }
    return found;
  }
};

/// The feature with the nearest point, and the point.
template <int D>
struct NearestFeature {
  Real length2 = std::numeric_limits<Real>::infinity();
  Vec<D> v = Vec<D>::Zero();
  Simplex<D> feature;

  void offer(const Vec<D>& point, std::initializer_list<const Vec<D>*> on) {
    const Real squared = point.squaredNorm();
    if (!(squared < length2)) return;
    length2 = squared, v = point, feature.count = 0;
    for (const Vec<D>* w : on) feature.push(*w);
  }
};

/// The projection of the origin on the line through a and b, which differ: orthogonal to the edge to the last bit,
/// computed from the nearer end. A long edge far from the origin would otherwise leave its rounding in the direction.
template <int D>
Vec<D> footOnLine(const Vec<D>& a, const Vec<D>& b) {
  Vec<D> e = b - a;
  Vec<D> v = a.squaredNorm() < b.squaredNorm() ? a : b;
  if (makeUnit<D>(e)) removeAlong<D>(v, e);
  return v;
}

/// Offers the nearest point of the segment a b.
template <int D>
void offerSegment(const Vec<D>& a, const Vec<D>& b, NearestFeature<D>& best) {
  const Vec<D> e = b - a;
  if (!(a.dot(e) < 0)) return best.offer(a, {&a});
  if (!(b.dot(e) > 0)) return best.offer(b, {&b});
  best.offer(footOnLine<D>(a, b), {&a, &b});
}

/// Returns true if the triangle contains the origin; `best` is then untouched.
inline bool nearestOfSimplex(const Simplex<2>& s, NearestFeature<2>& best) {
  if (s.count == 1) {
    best.offer(s[0], {&s[0]});
    return false;
  }
  if (s.count == 2) {
    offerSegment<2>(s[0], s[1], best);
    return false;
  }
  const auto area = [](const Vec<2>& u, const Vec<2>& v) { return u[0] * v[1] - u[1] * v[0]; };
  const Real ab = area(s[0], s[1] - s[0]), bc = area(s[1], s[2] - s[1]), ca = area(s[2], s[0] - s[2]);
  if ((ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0)) return true;
  offerSegment<2>(s[2], s[0], best);
  offerSegment<2>(s[2], s[1], best);
  offerSegment<2>(s[0], s[1], best);
  return false;
}

/// The direction from the origin to the nearest point, computed from the feature instead of from the point, whose
/// difference is mostly rounding near contact. False if only the point at the origin remains.
inline bool featureDirection(const NearestFeature<2>& nearest, Vec<2>& n) {
  n = nearest.v;
  if (nearest.feature.count == 2) {
    const Vec<2> e = nearest.feature[1] - nearest.feature[0];
    const Vec<2> across(-e[1], e[0]);
    n = across.dot(nearest.feature[0]) < 0 ? Vec<2>(-across) : across;
  }
  return makeUnit<2>(n);
}

}}}  // namespace lpc::LPC_PRECISION::pair_query
