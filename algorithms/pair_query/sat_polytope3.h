// SPDX-License-Identifier: Zlib
// Separating axes of two spatial cores of any kind: face normals, common normals of edges whose Gauss arcs cross
// (Gregorius 2013), and for cores that are apart the directions between vertices and edges.
#pragma once

#include <vector>

#include "algorithms/pair_query/core_pair.h"

namespace lpc::inline LPC_PRECISION::pair_query {

template <int D>
class SatPolytope;

template <>
class SatPolytope<3> {
 public:
  void run(const CorePair<3>& pair, BestAxis<3>& best, WorkDone& work) {
    m_pair = &pair, m_best = &best, m_work = &work;
    fill(pair.a, Vec<3>::Zero(), Mat<3>::Identity(), m_a);
    fill(pair.b, pair.p, pair.r, m_b);
    testFaces(m_a, m_b, 1);
    testFaces(m_b, m_a, -1);
    for (const Edge& a : m_a.edges) {
      for (const Edge& b : m_b.edges) {
        if (arcsMayCross(a, b)) testEdges(a, b);
      }
    }
    if (best.bound > -kBoundRounding * pair.scale) tryVertices();
  }

 private:
  struct Edge {
    int v0, v1;
    Vec<3> direction;                                 // unit, v0 to v1
    Vec<3> n0 = Vec<3>::Zero(), n1 = Vec<3>::Zero();  // of its faces; a segment's edge has none
    bool bare = false;
  };
  struct Plane {
    Vec<3> n;
    Real offset;
  };
  struct Core {
    std::vector<Vec<3>> vertices;
    std::vector<Plane> faces;
    std::vector<Edge> edges;
  };

  static void fill(const ShapeView<3>& shape, const Vec<3>& p, const Mat<3>& r, Core& core) {
    core.vertices.clear(), core.faces.clear(), core.edges.clear();
    const Vec<3>& h = shape.half;
    switch (shape.core()) {
      case CoreClass::hull:
        return fillPolytope(*shape.hull, p, r, core);
      case CoreClass::box:
        return fillBox(h, p, r, core);
      case CoreClass::point:
        core.vertices.push_back(p);
        return;
      case CoreClass::segment: {
        core.vertices.push_back(p - h[0] * r.col(0));
        core.vertices.push_back(p + h[0] * r.col(0));
        Edge edge{0, 1, r.col(0)};
        edge.bare = true;
        core.edges.push_back(edge);
        return;
      }
      case CoreClass::curved:
      case CoreClass::plane:
        LPC_ASSERT(false);  // has no list of edges
        return;
    }
  }

  static void fillPolytope(const Polytope<3>& hull, const Vec<3>& p, const Mat<3>& r, Core& core) {
    for (const Vec<3>& v : hull.vertices) core.vertices.push_back(p + r * v);
    for (const auto& f : hull.faces) {
      const Vec<3> n = r * f.normal;
      core.faces.push_back({n, f.offset + n.dot(p)});
    }
    for (const auto& e : hull.edges) {
      Vec<3> direction = hull.vertices[at(e.v1)] - hull.vertices[at(e.v0)];
      makeUnit<3>(direction);
      core.edges.push_back({e.v0, e.v1, r * direction, core.faces[at(e.faceA)].n, core.faces[at(e.faceB)].n});
    }
  }

  static void fillBox(const Vec<3>& h, const Vec<3>& p, const Mat<3>& r, Core& core) {
    for (int bits = 0; bits < 8; ++bits) {
      const Vec<3> v((bits & 1) ? h[0] : -h[0], (bits & 2) ? h[1] : -h[1], (bits & 4) ? h[2] : -h[2]);
      core.vertices.push_back(p + r * v);
    }
    for (int k = 0; k < 3; ++k) {
      const Vec<3> n = r.col(k);
      core.faces.push_back({n, n.dot(p) + h[k]});
      core.faces.push_back({-n, h[k] - n.dot(p)});
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      for (const int si : {-1, 1}) {
        for (const int sj : {-1, 1}) {
          const int v0 = (si > 0 ? 1 << i : 0) | (sj > 0 ? 1 << j : 0);
          // Right-handed: n0 x n1 is the edge's direction, as in a polytope's loops.
          const Vec<3> ni = Real(si) * r.col(i), nj = Real(sj) * r.col(j);
          const bool turn = si * sj > 0;
          core.edges.push_back({v0, v0 | (1 << k), n, turn ? ni : nj, turn ? nj : ni});
        }
      }
    }
  }

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  void testFaces(const Core& of, const Core& other, Real sign) {
    (*m_work)[WorkCount::axisTests] += of.faces.size();
    for (const Plane& face : of.faces) {
      Real bound = std::numeric_limits<Real>::infinity();
      for (const Vec<3>& v : other.vertices) {
        bound = std::min(bound, face.n.dot(v) - face.offset);
        if (bound <= m_best->bound) break;
      }
      m_best->take(sign * face.n, bound);
    }
  }

  // Do the arcs of normals of a and of -b meet on the sphere? Inclusive: an arc missed by rounding ends on a face
  // normal, which has been tested, and an arc taken wrongly costs one more test.
  static bool arcsMayCross(const Edge& a, const Edge& b) {
    if (a.bare && b.bare) return true;
    if (a.bare) return !sameSide(b.n0.dot(a.direction), b.n1.dot(a.direction), kArcSine);
    const Real a0 = a.n0.dot(b.direction), a1 = a.n1.dot(b.direction);
    if (sameSide(a0, a1, kArcSine)) return false;
    if (b.bare) return true;
    const Real b0 = b.n0.dot(a.direction), b1 = b.n1.dot(a.direction);
    return !sameSide(b0, b1, kArcSine) && !sameSide(b0, a1, kArcSine);
  }
  static bool sameSide(Real x, Real y, Real near) { return (x > near && y > near) || (x < -near && y < -near); }

  // Nearly parallel edges give an axis of noise, exactly parallel ones none. Neither can do harm: the two points on the
  // edges only bound from above what the axis could prove, and then the whole cores are projected (core_pair.h).
  void testEdges(const Edge& a, const Edge& b) {
    Vec<3> n = a.direction.cross(b.direction);
    if (n.squaredNorm() <= kParallelSine * kParallelSine || !makeUnit<3>(n)) return;
    removeAlong<3>(n, a.direction);
    n.normalize();
    const Real along = n.dot(m_b.vertices[at(b.v0)] - m_a.vertices[at(a.v0)]);
    for (const Real sign : {Real(1), Real(-1)}) {
      if (sign * along > m_best->bound) testAxis(sign * n);
    }
  }

  void testAxis(const Vec<3>& n) {
    ++(*m_work)[WorkCount::axisTests];
    Real farA = -std::numeric_limits<Real>::infinity();
    for (const Vec<3>& v : m_a.vertices) farA = std::max(farA, n.dot(v));
    Real bound = std::numeric_limits<Real>::infinity();
    for (const Vec<3>& v : m_b.vertices) {
      bound = std::min(bound, n.dot(v) - farA);
      if (bound <= m_best->bound) return;
    }
    m_best->take(n, bound);
  }

  // Vertex against vertex or edge. With L the best bound, n its axis and U any distance that is attained, the nearest
  // points lie no deeper than U - L behind the supporting planes of n; all other features are left out.
  void tryVertices() {
    const Vec<3> n = m_best->n;
    Real nearest = upperBound(n);
    if (m_best->bound < nearest) {
      pick(m_a, n, nearest - m_best->bound, m_verticesA, m_edgesA);
      pick(m_b, -n, nearest - m_best->bound, m_verticesB, m_edgesB);
    } else {
      return;
    }
    nearest = std::numeric_limits<Real>::infinity();
    const auto shorten = [&](const Vec<3>& v) { nearest = std::min(nearest, v.squaredNorm()); };
    forDifferences(shorten);
    const Real tie = std::sqrt(nearest) * (1 + kTiePart) + kTieRounding * m_pair->scale;
    forDifferences([&](const Vec<3>& v) {
      if (v.squaredNorm() <= tie * tie) m_best->tryDirection(*m_pair, v, *m_work);
    });
    if (!std::isfinite(m_best->bound)) m_best->tryDirection(*m_pair, Vec<3>::Unit(0), *m_work);
  }

  Real upperBound(const Vec<3>& n) const {
    if (!std::isfinite(m_best->bound)) return std::numeric_limits<Real>::max();
    return m_pair->support(n).norm() + kAttainedRounding * m_pair->scale;
  }

  static void pick(const Core& core, const Vec<3>& n, Real slab, std::vector<Vec<3>>& vertices,
                   std::vector<const Edge*>& edges) {
    vertices.clear(), edges.clear();
    Real farthest = -std::numeric_limits<Real>::infinity();
    for (const Vec<3>& v : core.vertices) farthest = std::max(farthest, n.dot(v));
    const auto near = [&](const Vec<3>& v) { return n.dot(v) >= farthest - slab; };
    for (const Vec<3>& v : core.vertices) {
      if (near(v)) vertices.push_back(v);
    }
    for (const Edge& e : core.edges) {
      if (near(core.vertices[at(e.v0)]) || near(core.vertices[at(e.v1)])) edges.push_back(&e);
    }
  }

  // f(pB - pA) for each picked vertex with each picked edge or vertex of the other core.
  template <class F>
  void forDifferences(F&& f) {
    for (const Vec<3>& a : m_verticesA) {
      for (const Edge* e : m_edgesB) f(toEdge(m_b, *e, a));
    }
    for (const Vec<3>& b : m_verticesB) {
      for (const Edge* e : m_edgesA) f(-toEdge(m_a, *e, b));
      if (!m_a.edges.empty() && !m_b.edges.empty()) continue;
      for (const Vec<3>& a : m_verticesA) f(b - a);
    }
  }
  // From q to the edge's nearest point; across the edge to the last bit where that is inside.
  static Vec<3> toEdge(const Core& core, const Edge& e, const Vec<3>& q) {
    const Vec<3> from0 = core.vertices[at(e.v0)] - q, from1 = core.vertices[at(e.v1)] - q;
    if (from0.dot(e.direction) >= 0) return from0;
    if (from1.dot(e.direction) <= 0) return from1;
    Vec<3> v = from0.squaredNorm() < from1.squaredNorm() ? from0 : from1;
    removeAlong<3>(v, e.direction);
    return v;
  }

  const CorePair<3>* m_pair = nullptr;
  BestAxis<3>* m_best = nullptr;
  WorkDone* m_work = nullptr;
  Core m_a, m_b;
  std::vector<Vec<3>> m_verticesA, m_verticesB;
  std::vector<const Edge*> m_edgesA, m_edgesB;
};

}  // namespace lpc::inline LPC_PRECISION::pair_query
