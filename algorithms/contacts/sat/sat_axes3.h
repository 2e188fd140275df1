// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/clip/core3.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

struct FaceAxis3 {
  int face = -1;
  Real separation = -std::numeric_limits<Real>::infinity();
};

struct EdgeAxis3 {
  int edge1 = -1, edge2 = -1;
  Real separation = -std::numeric_limits<Real>::infinity();
  Vec<3> normal = Vec<3>::Zero();  // n_12
};

struct Axes3 {
  FaceAxis3 face1, face2;
  EdgeAxis3 edges;
  Real best() const { return std::max({face1.separation, face2.separation, edges.separation}); }
};

inline FaceAxis3 bestFace(const Core3& p, const Core3& q, Real limit) {
  FaceAxis3 best;
  for (int f = 0; f < p.faceCount(); ++f) {
    const Vec<3> n = p.n[f];
    Real low = n.dot(q.v[0]);
    for (int k = 1; k < q.vertexCount; ++k) low = std::min(low, n.dot(q.v[k]));
    const Real s = low - n.dot(p.faceVertex(f, 0));
    if (s > best.separation) best = {f, s};
    if (s > limit) break;
  }
  return best;
}

/// Whether no part of either core lies beyond the edge axis, except for `rounding`.
inline bool isForemost(const Core3& c1, const Core3& c2, const EdgeAxis3& axis, Real rounding) {
  const Real front1 = axis.normal.dot(c1.v[c1.edge(axis.edge1).v0]) + rounding;
  const Real front2 = axis.normal.dot(c2.v[c2.edge(axis.edge2).v0]) - rounding;
  for (int i = 0; i < c1.vertexCount; ++i) {
    if (axis.normal.dot(c1.v[i]) > front1) return false;
  }
  for (int i = 0; i < c2.vertexCount; ++i) {
    if (axis.normal.dot(c2.v[i]) < front2) return false;
  }
  return true;
}

/// Two edges form a face of the Minkowski difference if their arcs on the Gauss map cross (Gregorius, GDC 2013); only
/// those are projected. A segment's arc is a whole great circle. The arc between two faces of a sliver is half a circle
/// except for the rounding of their normals, which may turn it to the wrong side; hence the test of the cores
/// themselves. Returns no edges (-1) if none separates by more than `least`. Counts the projected axes.
inline EdgeAxis3 bestEdges(const Core3& c1, const Core3& c2, Real least, Real limit, Real rounding,
                           std::vector<Real>& along, WorkDone& work) {
  EdgeAxis3 best{.separation = least};
  const int faces2 = c2.faceCount();
  if (along.size() < static_cast<std::size_t>(faces2)) along.resize(static_cast<std::size_t>(faces2));
  Real* const alongEdge1 = along.data();  // the components of shape 2's face normals along edge 1
  for (int i = 0; i < c1.edgeCount(); ++i) {
    const auto& e1 = c1.edge(i);
    const Vec<3> d1 = c1.v[e1.v1] - c1.v[e1.v0];
    const Real length1 = d1.squaredNorm();
    for (int f = 0; f < faces2; ++f) alongEdge1[f] = c2.n[f].dot(d1);
    for (int k = 0; k < c2.edgeCount(); ++k) {
      const auto& e2 = c2.edge(k);
      const Real x = alongEdge1[e2.faceA], y = alongEdge1[e2.faceB];
      if (!(x * y < 0)) continue;
      const Vec<3> d2 = c2.v[e2.v1] - c2.v[e2.v0];
      if (e1.faceA >= 0) {
        const Real u = c1.n[e1.faceA].dot(d2), w = c1.n[e1.faceB].dot(d2);
        if (!(u * w < 0 && x * w < 0)) continue;
      }
      Vec<3> n = d1.cross(d2);
      const Real norm2 = n.squaredNorm(), lengths2 = length1 * d2.squaredNorm();
      if (norm2 <= kParallelSine * kParallelSine * lengths2) continue;
      n /= std::sqrt(norm2);
      // Nearly parallel edges: orthogonalised once more against one of them, and thereby against the other.
      if (norm2 <= kNearlyParallel * kNearlyParallel * lengths2) n = (n - n.dot(d1) / length1 * d1).normalized();
      if (n.dot(c2.n[e2.faceA] + c2.n[e2.faceB]) > 0) n = -n;
      ++work[WorkCount::axisTests];
      const Real s = n.dot(c2.v[e2.v0] - c1.v[e1.v0]);
      if (!(s > best.separation)) continue;
      const EdgeAxis3 axis{i, k, s, n};
      if (!isForemost(c1, c2, axis, rounding)) continue;
      best = axis;
      if (s > limit) return best;
    }
  }
  return best;
}

/// Two boxes in closed form: 15 axes (Gottschalk 1996). The compiler knows their indices, as in sat_boxes3.h.
inline bool boxAxes(const Vec<3>& half1, const Vec<3>& half2, const Vec<3>& p, const Mat<3>& R, Real limit,
                    Axes3& axes) {
  const Triple h1(half1), h2(half2), t1(p);
  const auto size = [&](int r, int c) __attribute__((always_inline)) { return std::abs(R(r, c)); };
  const auto offer = [&](FaceAxis3 & best, int face, Real s) __attribute__((always_inline)) {
    if (s > best.separation) best = {face, s};
  };
  FaceAxis3 face1, face2;
  const auto offerFaces = [&]<int k>() __attribute__((always_inline)) {
    const Real s1 = std::abs(p[k]) - (half1[k] + size(k, 0) * h2.x + size(k, 1) * h2.y + size(k, 2) * h2.z);
    const Real t = t1.x * R(0, k) + t1.y * R(1, k) + t1.z * R(2, k);
    const Real s2 = std::abs(t) - (half2[k] + size(0, k) * h1.x + size(1, k) * h1.y + size(2, k) * h1.z);
    offer(face1, 2 * k + (p[k] > 0), s1), offer(face2, 2 * k + (t < 0), s2);
  };
  offerFaces.template operator()<0>(), offerFaces.template operator()<1>(), offerFaces.template operator()<2>();
  if (face1.separation > limit || face2.separation > limit) return false;
  axes.face1 = face1, axes.face2 = face2;
  // Separations of edge axes are compared without normalising.
  Real best = std::max(face1.separation, face2.separation);
  int bestI = -1, bestJ = -1;
  Real bestT = 0;
  const auto offerEdges = [&]<int i, int j>() __attribute__((always_inline)) {
    constexpr int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    const Real norm2 = R(i1, j) * R(i1, j) + R(i2, j) * R(i2, j);  // of the axis a_i x b_j
    const Real t = p[i2] * R(i1, j) - p[i1] * R(i2, j);
    const Real reach =
        half1[i1] * size(i2, j) + half1[i2] * size(i1, j) + half2[j1] * size(i, j2) + half2[j2] * size(i, j1);
    const Real s = std::abs(t) - reach, squares = best * best * norm2;
    if (s < 0 ? best >= 0 || s * s >= squares : best > 0 && s * s <= squares) return;
    if (norm2 <= kParallelSine * kParallelSine) return;
    best = s / std::sqrt(norm2);
    bestI = i, bestJ = j, bestT = t;
  };
  const auto offerAll = [&]<int... e>(std::integer_sequence<int, e...>) __attribute__((always_inline)) {
    (offerEdges.template operator()<e / 3, e % 3>(), ...);
  };
  offerAll(std::make_integer_sequence<int, 9>());
  if (best > limit && bestI >= 0) return false;
  if (bestI < 0) return true;
  const int i1 = bestI == 2 ? 0 : bestI + 1, i2 = bestI == 0 ? 2 : bestI - 1;
  Vec<3> n;
  n[bestI] = 0, n[i1] = -R(i2, bestJ), n[i2] = R(i1, bestJ);
  n /= bestT < 0 ? -n.norm() : n.norm();
  // The edges that touch: the vertex bits across each edge's own axis follow from the normal.
  int v1 = 0, v2 = 0;
  for (int k = 0; k < 3; ++k) {
    if (k != bestI && n[k] > 0) v1 |= 1 << k;
    if (k != bestJ && n.dot(R.col(k)) < 0) v2 |= 1 << k;
  }
  // boxTopology lists the four edges along x, then y, then z, each by the number of its lower vertex.
  const auto edgeNumber = [](int axis, int vertex) {
    const int low = vertex & ((1 << axis) - 1), high = vertex >> (axis + 1);
    return 4 * axis + (high << axis) + low;
  };
  axes.edges = {edgeNumber(bestI, v1), edgeNumber(bestJ, v2), best, n};
  return true;
}

}}}  // namespace lpc::LPC_PRECISION::contacts
