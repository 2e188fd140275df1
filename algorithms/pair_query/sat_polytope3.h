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
    best.tryDirection(pair, pair.p, work);  // most axes prove less, and are done with at once
    testFaces(m_a, m_b, 1);
    testFaces(m_b, m_a, -1);
    m_ridgesA.clear(), m_ridgesB.clear();
    if (!m_b.edges.empty()) pickRidges(m_a, m_b, m_ridgesA);
    if (!m_ridgesA.empty()) pickRidges(m_b, m_a, m_ridgesB);
    for (const Ridge& a : m_ridgesA) {
      for (const Ridge& b : m_ridgesB) {
        if (arcsMayCross(a, b)) testEdges(a, b);
      }
    }
    if (best.bound > -kBoundRounding * pair.scale) tryVertices();
  }

 private:
  struct Edge {
    int v0, v1;
    int f0 = -1, f1 = -1;  // its faces; a segment's edge has none
  };
  struct Plane {
    Vec<3> n;
    Real offset;
    int below = 0;  // the vertex of the other core that bounds what n proves
  };
  struct Core {
    std::vector<Vec<3>> vertices;
    std::vector<Plane> faces;
    std::vector<Edge> edges;
  };
  /// An edge that is looked at.
  struct Ridge {
    Vec<3> v0, v1;
    Vec<3> direction;  // unit, v0 to v1
    Vec<3> n0 = Vec<3>::Zero(), n1 = Vec<3>::Zero();
    bool bare = false;
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
      case CoreClass::segment:
        core.vertices.push_back(p - h[0] * r.col(0));
        core.vertices.push_back(p + h[0] * r.col(0));
        core.edges.push_back({0, 1});
        return;
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
    for (const auto& e : hull.edges) core.edges.push_back({e.v0, e.v1, e.faceA, e.faceB});
  }

  static void fillBox(const Vec<3>& h, const Vec<3>& p, const Mat<3>& r, Core& core) {
    for (int bits = 0; bits < 8; ++bits) {
      const Vec<3> v((bits & 1) ? h[0] : -h[0], (bits & 2) ? h[1] : -h[1], (bits & 4) ? h[2] : -h[2]);
      core.vertices.push_back(p + r * v);
    }
    for (int k = 0; k < 3; ++k) {  // face 2 k looks along axis k, 2 k + 1 back
      const Vec<3> n = r.col(k);
      core.faces.push_back({n, n.dot(p) + h[k]});
      core.faces.push_back({-n, h[k] - n.dot(p)});
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      for (const int si : {-1, 1}) {
        for (const int sj : {-1, 1}) {
          const int v0 = (si > 0 ? 1 << i : 0) | (sj > 0 ? 1 << j : 0);
          const int fi = 2 * i + (si < 0), fj = 2 * j + (sj < 0);
          // Right-handed: n0 x n1 is the edge's direction, as in a polytope's loops.
          const bool turn = si * sj > 0;
          core.edges.push_back({v0, v0 | (1 << k), turn ? fi : fj, turn ? fj : fi});
        }
      }
    }
  }

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  // The vertex that bounded the last face is asked first: most faces prove less than the best for the same reason.
  void testFaces(Core& of, const Core& other, Real sign) {
    (*m_work)[WorkCount::axisTests] += of.faces.size();
    int below = 0;
    for (Plane& face : of.faces) {
      Real bound = face.n.dot(other.vertices[at(below)]) - face.offset;
      for (std::size_t i = 0; i < other.vertices.size() && bound > m_best->bound; ++i) {
        const Real height = face.n.dot(other.vertices[i]) - face.offset;
        if (height < bound) bound = height, below = static_cast<int>(i);
      }
      face.below = below;
      m_best->take(sign * face.n, bound);
    }
  }

  Ridge ridge(const Core& core, const Edge& e) const {
    Ridge out{core.vertices[at(e.v0)], core.vertices[at(e.v1)], {}};
    out.direction = out.v1 - out.v0;
    makeUnit<3>(out.direction);
    out.bare = e.f0 < 0;
    if (!out.bare) out.n0 = core.faces[at(e.f0)].n, out.n1 = core.faces[at(e.f1)].n;
    return out;
  }

  // The edges whose normals may still prove more than the best. All normals of an edge are sums of those of its faces,
  // made unit. If some vertex of the other core lies so low that both of these prove no more than c, then so does every
  // one between: of a negative c a longer sum makes less, of a positive one at most 1 / cos(half the angle) times as
  // much.
  void pickRidges(const Core& of, const Core& other, std::vector<Ridge>& out) const {
    for (const Edge& e : of.edges) {
      bool hopeless = false;
      if (e.f0 >= 0) {
        const Plane &f0 = of.faces[at(e.f0)], &f1 = of.faces[at(e.f1)];
        Real c = m_best->bound;
        if (c > 0) c *= std::sqrt(std::max(Real(0), (1 + f0.n.dot(f1.n)) / 2));
        const Vec<3>& foot = of.vertices[at(e.v0)];
        for (const int below : {f0.below, f1.below}) {
          const Vec<3> v = other.vertices[at(below)] - foot;
          hopeless = hopeless || (f0.n.dot(v) <= c && f1.n.dot(v) <= c);
        }
      }
      if (!hopeless) out.push_back(ridge(of, e));
    }
  }

  // Do the arcs of normals of a and of -b meet on the sphere? Inclusive: an arc missed by rounding ends on a face
  // normal, which has been tested, and an arc taken wrongly costs one more test.
  static bool arcsMayCross(const Ridge& a, const Ridge& b) {
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
  void testEdges(const Ridge& a, const Ridge& b) {
    Vec<3> n = a.direction.cross(b.direction);
    if (n.squaredNorm() <= kParallelSine * kParallelSine || !makeUnit<3>(n)) return;
    removeAlong<3>(n, a.direction);
    n.normalize();
    const Real along = n.dot(b.v0 - a.v0);
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
      pick(m_a, n, nearest - m_best->bound, m_verticesA, m_ridgesA);
      pick(m_b, -n, nearest - m_best->bound, m_verticesB, m_ridgesB);
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

  void pick(const Core& core, const Vec<3>& n, Real slab, std::vector<Vec<3>>& vertices,
            std::vector<Ridge>& ridges) const {
    vertices.clear(), ridges.clear();
    Real farthest = -std::numeric_limits<Real>::infinity();
    for (const Vec<3>& v : core.vertices) farthest = std::max(farthest, n.dot(v));
    const auto near = [&](const Vec<3>& v) { return n.dot(v) >= farthest - slab; };
    for (const Vec<3>& v : core.vertices) {
      if (near(v)) vertices.push_back(v);
    }
    for (const Edge& e : core.edges) {
      if (near(core.vertices[at(e.v0)]) || near(core.vertices[at(e.v1)])) ridges.push_back(ridge(core, e));
    }
  }

  // f(pB - pA) for each picked vertex with each picked edge or vertex of the other core.
  template <class F>
  void forDifferences(F&& f) {
    for (const Vec<3>& a : m_verticesA) {
      for (const Ridge& e : m_ridgesB) f(toEdge(e, a));
    }
    for (const Vec<3>& b : m_verticesB) {
      for (const Ridge& e : m_ridgesA) f(-toEdge(e, b));
      if (!m_a.edges.empty() && !m_b.edges.empty()) continue;
      for (const Vec<3>& a : m_verticesA) f(b - a);
    }
  }
  // From q to the edge's nearest point; across the edge to the last bit where that is inside.
  static Vec<3> toEdge(const Ridge& e, const Vec<3>& q) {
    const Vec<3> from0 = e.v0 - q, from1 = e.v1 - q;
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
  std::vector<Ridge> m_ridgesA, m_ridgesB;  // those that may matter
};

}  // namespace lpc::inline LPC_PRECISION::pair_query
