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
/// The result is not normalised. `jump`: how far (m) the support point moved over the smallest rotations.
template <int D, int K>
Vec<D> newtonDirection(const CorePair<D>& pair, const Vec<D>& n, const RealMatrix<D, K>& t, WorkDone& work,
                       Real* jump = nullptr) {
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
    if (jump) *jump = std::max(*jump, (ahead - behind).norm());
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
    m_lastRidge.setZero();
    const Real size = sizeOfSmaller(pair);
    for (int step = 0; step < kMostPolishSteps; ++step) {
      const Real before = best.bound;
      Vec<D> n = best.n;
      Real jump = 0;
      const Vec<D> next = newtonDirection<D, D - 1>(pair, n, tangents(n), work, &jump);
      best.tryDirection(pair, next, work);
      if (!(best.bound > before) && (next - n).norm() > kTurn && climbToRidge(pair, n, next, best, work)) jump = size;
      if constexpr (D == 3) {
        if (jump > kJump * size) followRidge(pair, best, work);
      }
      n = best.n;
      const int edges = gatherEdges(pair, n, work);
      if constexpr (D == 3) {
        if (edges == 1) best.tryDirection(pair, acrossEdge(pair, n, work), work);
        if (edges == 2) best.tryDirection(pair, m_face, work);
      }
      if (edges > 0) leaveRidge(pair, n, best, work);
      if (!(best.bound > before)) return;
    }
  }

  /// The same from another direction. Returns where it ends.
  Vec<D> improveFrom(const CorePair<D>& pair, const Vec<D>& n, BestAxis<D>& best, WorkDone& work) {
    BestAxis<D> top;
    top.tryDirection(pair, n, work);
    improve(pair, top, work);
    best.take(top.n, top.bound);
    return top.n;
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
  // Half the diagonal (m) of the smaller core that has one.
  static Real sizeOfSmaller(const CorePair<D>& pair) {
    const Real a = pair.a.half.norm(), b = pair.b.half.norm();
    return a > 0 && b > 0 ? std::min(a, b) : std::max(a, b);
  }

  // A step that does not rise has crossed a ridge, where two support points are equally high. Seeks the ridge between
  // both directions; each trial replaces the one on its side. Returns whether the bound is better.
  static bool climbToRidge(const CorePair<D>& pair, Vec<D> n, Vec<D> beyond, BestAxis<D>& best, WorkDone& work) {
    if (!makeUnit<D>(n) || !makeUnit<D>(beyond)) return false;
    work[WorkCount::supportCalls] += 4;
    Vec<D> here = pair.support(n), there = pair.support(beyond);
    const Real before = best.bound;
    for (int step = 0; step < kMostRidgeSteps; ++step) {
      const Real rise = n.dot(there - here), fall = beyond.dot(here - there);
      if (!(rise > 0 && fall > 0)) break;
      Vec<D> middle = n + rise / (rise + fall) * (beyond - n);
      if (!makeUnit<D>(middle)) break;
      work[WorkCount::supportCalls] += 2;
      const Vec<D> w = pair.support(middle);
      best.take(middle, middle.dot(w));
      if (middle.dot(here - w) <= kBoundRounding * pair.scale) break;
      Vec<D> onwards = beyond - n;
      removeAlong<D>(onwards, middle);
      if (onwards.dot(w) > 0) {
        n = middle, here = w;
      } else {
        beyond = middle, there = w;
      }
    }
    return best.bound > before;
  }

  // Where L has a ridge at best.n, tries a step along it: L is the lesser of two smooth functions, one of each side,
  // and their sum, weighted so that it has no slope across the ridge, has the ridge's slope and curvature. Where
  // several ridges meet, tries the normal of the face that they belong to.
  void followRidge(const CorePair<3>& pair, BestAxis<3>& best, WorkDone& work) {
    const Vec<3> n = best.n;
    const auto support = [&](const Vec<3>& d) {
      work[WorkCount::supportCalls] += 2;
      return pair.support(d);
    };
    const RealMatrix<3, 2> basis = tangents(n);
    Vec<3> edge = Vec<3>::Zero();
    for (int k = 0; k < 2; ++k) {
      const Vec<3> t = basis.col(k), jump = support(n + kTurn * t) - support(n - kTurn * t);
      const Vec<3> wider = support(n + 4 * kTurn * t) - support(n - 4 * kTurn * t);
      if (!(jump.norm() > wider.norm() / 2)) continue;  // the support point moves in proportion
      if (edge.isZero(0)) {
        edge = jump;
      } else if (Vec<3> face = cross(edge, jump); face.norm() > kFaceSine * edge.norm() * jump.norm()) {
        best.tryDirection(pair, face.dot(n) < 0 ? Vec<3>(-face) : face, work);
        return;
      }
    }
    removeAlong<3>(edge, n);
    if (!makeUnit<3>(edge)) return;
    const Vec<3> t = cross(edge, n);
    IndexedArray<Real, 2> across, along, curvature;  // slopes and curvature on both sides
    for (int i = 0; i < 2; ++i) {
      const Vec<3> side = i == 0 ? edge : Vec<3>(-edge);
      const Vec<3> w = support(n + kBeside * side), middle = n + 4 * kRidgeTurn * kRidgeTurn * side;
      across[i] = edge.dot(w), along[i] = t.dot(w);
      const Vec<3> ahead = support(middle + kRidgeTurn * t), behind = support(middle - kRidgeTurn * t);
      curvature[i] = t.dot(ahead - behind) / (2 * kRidgeTurn) - n.dot(w);
    }
    const Real share = across[1] / (across[1] - across[0]), before = best.bound;
    if (!(share >= 0 && share <= 1)) {  // L rises on one side
      const Vec<3> side = across[0] > 0 ? edge : Vec<3>(-edge);
      Vec<3> start = n + 4 * kTurn * side;
      if (!makeUnit<3>(start)) return;
      const Vec<3> next = newtonDirection<3, 2>(pair, start, tangents(start), work);
      best.tryDirection(pair, next, work);
      if (!(best.bound > before)) climbToRidge(pair, start, next, best, work);
      return;
    }
    const Real slope = share * along[0] + (1 - share) * along[1];
    Real bend = std::abs(share * curvature[0] + (1 - share) * curvature[1]);
    if (!m_lastRidge.isZero(0)) {  // the change of the slope is more accurate
      const Real gone = t.dot(n - m_lastRidge);
      const Real change = (slope - (t.dot(m_lastAlong) < 0 ? -m_lastSlope : m_lastSlope)) / gone;
      bend = change < 0 ? -change : std::abs(slope / gone) / 2;
    }
    m_lastRidge = n, m_lastAlong = t, m_lastSlope = slope;
    Real step = std::clamp(slope / (bend + kEpsilon * pair.scale), Real(-1), Real(1));
    for (int shorter = 0; shorter < kMostShorterSteps && !(best.bound > before); ++shorter, step /= 4) {
      const Vec<3> next = n + step * t;
      const Real aside = std::max(4 * kTurn, step * step);
      climbToRidge(pair, next - aside * edge, next + aside * edge, best, work);
      if (!(best.bound > before)) climbToRidge(pair, n, next, best, work);  // another ridge may cross this one
    }
  }

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
  // m_edge is the first of them; two have the normal m_face.
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
          if constexpr (D == 3) m_face = cross(m_edge, edge), m_face *= m_face.dot(n) < 0 ? Real(-1) : Real(1);
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

  Vec<D> m_edge = Vec<D>::Zero(), m_face = m_edge;
  Vec<D> m_lastRidge = m_edge, m_lastAlong = m_edge;  // where the last step along a ridge began (zero: none), its
  Real m_lastSlope = 0;                               // direction, and L's slope along it
  std::vector<Vec<D>> m_vertices;
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
