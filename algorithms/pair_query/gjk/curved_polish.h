// SPDX-License-Identifier: Zlib
// Last steps to the best direction of a curved pair, by Newton's method. The support point is the gradient of the
// support function, so L(n) = n . m(n) (core_pair.h) has the gradient m(n) across n; its change over a small rotation
// is the curvature. Where a straight edge lies across n, L has a ridge and no gradient: there the steps follow the
// ridge, or start from each of its corners. A step that does not raise the bound is rejected.
#pragma once

#include "algorithms/pair_query/core/touching.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// |H|^-1 g, each eigenvalue of the symmetric H made positive and no smaller than `shift`.
inline RealMatrix<1, 1> uphill(const RealMatrix<1, 1>& h, const RealMatrix<1, 1>& g, Real shift) {
  return g / (std::abs(h(0, 0)) + shift);
}
inline RealMatrix<2, 1> uphill(const RealMatrix<2, 2>& h, const RealMatrix<2, 1>& g, Real shift) {
  const Real middle = (h(0, 0) + h(1, 1)) / 2, half = (h(0, 0) - h(1, 1)) / 2;
  const Real radius = std::sqrt(half * half + h(0, 1) * h(0, 1));
  const Real high = 1 / (std::abs(middle + radius) + shift), low = 1 / (std::abs(middle - radius) + shift);
  if (!(radius > 0)) return high * g;
  const RealMatrix<2, 1> along = (h * g - (middle - radius) * g) / (2 * radius);  // component of g along the larger one
  return high * along + low * (g - along);
}

/// Newton's step from n within the plane of n and the columns of t, which are unit and orthogonal to n and each other.
/// The result is not normalised.
template <int D, int K>
Vec<D> newtonDirection(const CorePair<D>& pair, const Vec<D>& n, const RealMatrix<D, K>& t, WorkDone& work) {
  const auto support = [&](const Vec<D>& direction) {
    work[WorkCount::supportCalls] += 2;
    return pair.support(direction);
  };
  const Vec<D> m = support(n);
  const RealMatrix<K, 1> g = t.transpose() * m;
  // Central differences: across a rim, where the core turns without moving, the relevant curvature is n . m, near
  // contact far smaller than the error of one-sided differences.
  RealMatrix<K, K> curvature;
  for (int k = 0; k < K; ++k) {
    const Vec<D> ahead = support(n + kTurn * t.col(k)), behind = support(n - kTurn * t.col(k));
    curvature.col(k) = t.transpose() * (ahead - behind) / (2 * kTurn);
  }
  curvature.diagonal().array() -= n.dot(m);  // curvature of the sphere of directions
  // At the maximum the curvature is negative. On a ring of maxima it has a zero, which the shift makes harmless. Beside
  // a ridge it is positive, and only the direction of ascent matters.
  const RealMatrix<K, K> symmetric = (curvature + curvature.transpose()) / 2;
  return n + t * uphill(symmetric, g, kLeastCurvature * symmetric.cwiseAbs().maxCoeff());
}

/// The last steps. Where straight edges of the cores lie across n, L has a ridge, and the steps stay on it.
template <int D>
class CurvedPolish {
 public:
  /// Steps while the bound improves: a search may have ended before its tolerance.
  void improve(const CorePair<D>& pair, BestAxis<D>& best, WorkDone& work) {
    for (int step = 0; step < kMostPolishSteps; ++step) {
      const Real before = best.bound;
      const Vec<D> n = best.n;
      best.tryDirection(pair, newtonDirection<D, D - 1>(pair, n, tangents(n), work), work);
      const int edges = gatherEdges(pair, n, work);
      if constexpr (D == 3) {
        if (edges == 1) best.tryDirection(pair, acrossEdge(pair, n, work), work);
      }
      if (edges > 0) leaveRidge(pair, n, best, work);
      if (!(best.bound > before)) return;
    }
  }

  /// For closest points: a direction that is off by the square root of a rounding gives the right bound, but a support
  /// point that is off by that root. Makes two steps that cost the bound no more than roundings.
  void settle(const CorePair<D>& pair, BestAxis<D>& best, WorkDone& work) {
    for (int step = 0; step < kSettleSteps; ++step) {
      Vec<D> n = best.n;
      const int edges = gatherEdges(pair, n, work);
      if (edges == D - 1) return;  // they fix the normal
      if (edges == 0) n = newtonDirection<D, D - 1>(pair, n, tangents(n), work);
      if constexpr (D == 3) {
        if (edges == 1) n = acrossEdge(pair, n, work);
      }
      if (!makeUnit<D>(n)) return;
      ++work[WorkCount::axisTests];
      const Real bound = pair.bound(n);
      if (!(bound >= best.bound - kBoundRounding * pair.scale)) return;
      best.n = n, best.bound = std::max(bound, best.bound);
    }
  }

 private:
  // Lists in m_vertices those that a small rotation of n may make the support vertex, which comes first.
  void nearVertices(const ShapeView<D>& shape, const Vec<D>& n, WorkDone& work) {
    Real size = 0;  // of a hull that may lie far from its own frame
    if (shape.hull) {
      ++work[WorkCount::supportCalls];
      const Vec<D> foremost = coreSupport(shape, n);
      for (const Vec<D>& v : shape.hull->vertices) size = std::max(size, (v - foremost).norm());
    } else {
      size = 2 * shape.half.norm();
    }
    supportingVertices<D>(shape, n, kTurn * size, m_vertices, work);
    if (m_vertices.empty()) return;  // not finite
    const auto higher = [&](const Vec<D>& u, const Vec<D>& v) { return u.dot(n) < v.dot(n); };
    std::iter_swap(m_vertices.begin(), std::max_element(m_vertices.begin(), m_vertices.end(), higher));
  }

  // Number of dimensions of the straight edges that lie across n within a small rotation: there L has no gradient.
  // m_edge is the first of them.
  int gatherEdges(const CorePair<D>& pair, const Vec<D>& n, WorkDone& work) {
    int dimensions = 0;
    for (const bool second : {false, true}) {
      const ShapeView<D>& shape = second ? pair.b : pair.a;
      const Vec<D> local = second ? Vec<D>(-(pair.r.transpose() * n)) : n;
      nearVertices(shape, local, work);
      for (std::size_t i = 1; i < m_vertices.size() && dimensions < D - 1; ++i) {
        Vec<D> edge = m_vertices[i] - m_vertices[0];
        if (!makeUnit<D>(edge) || std::abs(edge.dot(local)) > kTurn) continue;
        if (second) edge = pair.r * edge;
        if (dimensions == 0) {
          m_edge = edge, dimensions = 1;
        } else if ((edge - edge.dot(m_edge) * m_edge).norm() > kTurn) {
          dimensions = 2;
        }
      }
    }
    return dimensions;
  }

  // A ridge need not be a maximum: on one side of it, among the normals of one corner, L may increase further. There
  // the pair is that corner and the other core.
  void leaveRidge(const CorePair<D>& pair, const Vec<D>& n, BestAxis<D>& best, WorkDone& work) {
    for (const bool second : {false, true}) {
      const ShapeView<D>& shape = second ? pair.b : pair.a;
      if (shape.core() == CoreClass::curved) continue;
      const Vec<D> local = second ? Vec<D>(-(pair.r.transpose() * n)) : n;
      nearVertices(shape, local, work);
      if (m_vertices.size() < 2 || m_vertices.size() > kMostLocalVertices) continue;
      for (const Vec<D>& v : m_vertices) {
        const ShapeView<D> point;
        CorePair<D> corner = second ? pair.withShapes(pair.a, point) : pair.withShapes(point, pair.b);
        corner.p = second ? Vec<D>(pair.p + pair.r * v) : Vec<D>(pair.p - v);
        BestAxis<D> top;
        ++work[WorkCount::axisTests];
        top.take(n, corner.bound(n));
        for (int step = 0; step < kMostPolishSteps; ++step) {
          const Real before = top.bound;
          top.tryDirection(corner, newtonDirection<D, D - 1>(corner, top.n, tangents(top.n), work), work);
          if (!(top.bound > before)) break;
        }
        best.tryDirection(pair, top.n, work);
      }
    }
  }

  Vec<3> acrossEdge(const CorePair<3>& pair, Vec<3> n, WorkDone& work) const {
    removeAlong<3>(n, m_edge);
    if (!makeUnit<3>(n)) return n;
    return newtonDirection<3, 1>(pair, n, cross(m_edge, n), work);
  }

  Vec<D> m_edge = Vec<D>::Zero();
  std::vector<Vec<D>> m_vertices;
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
