// SPDX-License-Identifier: Zlib
// Separating axes of two 3D cores of any kind: face normals, common normals of edges with Gauss arcs that cross
// (Gregorius 2013), and for cores that are apart the directions between vertices and edges.
#pragma once

#include <array>
#include <bit>

#include "algorithms/pair_query/sat/sat_features3.h"
#include "algorithms/pair_query/sat/sat_polytope2.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

template <class Watch>
class SatPolytope<3, Watch> {
 public:
  explicit SatPolytope(const Watch& watch = {}) : m_watch(watch) {}

  /// `memory`, which may be null, holds the features of the best axis.
  void run(const CorePair<3>& pair, QueryNeed need, PairMemory* memory, BestAxis<3>& best, WorkDone& work) {
    m_pair = &pair, m_best = &best, m_work = &work;
    m_sideAlone = need == QueryNeed::boolean;
    m_slack = kBoundRounding * pair.scale;
    m_features = {};
    m_a.start(pair.a), m_b.start(pair.b, pair.p, pair.r);
    const bool somewhere = pair.p.allFinite() && pair.r.allFinite();  // otherwise no bound would end the search
    if (somewhere && !(memory && recall(*memory))) search();
    if (!std::isfinite(best.bound)) best.tryDirection(pair, Vec<3>::Unit(0), work, m_watch);
    if (memory) remember(*memory);
  }

 private:
  using Kind = SatFeatures::Kind;
  using Plane = SatCore::Plane;

  // Axes that prove no more than this are useless. If only the side is wanted, either some face or pair of edges proves
  // separation, or none does.
  Real least() const { return m_sideAlone ? std::max(m_best->bound, -m_slack) : m_best->bound; }
  bool isEnough() const { return m_sideAlone && m_best->bound > m_pair->radii(); }

  // `all`: no vertex is lower.
  void take(const Vec<3>& n, Real bound, const SatFeatures& features, bool all = true) {
    if (bound > m_best->bound) m_features = features;
    m_best->take(n, bound);
    m_watch([&](auto& t) { t.axis(*m_pair, n, bound, *m_best, words(features), all); });
  }

  // --- memory --------------------------------------------------------------------------------------------------------

  struct Stored {
    SatFeatures features;
    std::array<std::int32_t, 5> none{};
  };

  // Starts from the best features of the last query; whether they are best is proved anew, so that wrong ones do no
  // harm. Returns true if they, or features near by, answer the query; else the search starts from what they prove.
  bool recall(const PairMemory& memory) {
    const SatFeatures f = std::bit_cast<Stored>(memory.bytes).features;
    if (!exist(f, m_a, m_b)) return false;
    const Vec<3> way = wayBetween(f, m_a, m_b);
    Vec<3> n;
    if (!commonNormal(f, m_a, m_b, way, n)) return false;
    project(n, f);
    if (f.kind == Kind::edges) project(-n, f);
    return isEnough() || (m_best->bound > -m_slack && closeGap(f));
  }
  void remember(PairMemory& memory) const {
    Stored stored;
    stored.features = m_features;
    memory.bytes = std::bit_cast<decltype(memory.bytes)>(stored);
  }

  // --- axes ----------------------------------------------------------------------------------------------------------

  void search() {
    Vec<3> n = m_pair->p;
    if (m_features.kind == Kind::none && makeUnit<3>(n)) project(n, {});  // most axes prove less and are done
    if (isEnough()) return;
    m_a.fill(), m_b.fill();
    testFaces();
    if (isEnough()) return;
    m_ridgesA.clear(), m_ridgesB.clear();
    if (!m_b.edges().empty()) pickRidges(m_a, m_b, m_ridgesA);
    if (!m_ridgesA.empty()) pickRidges(m_b, m_a, m_ridgesB);
    for (const SatRidge& a : m_ridgesA) {
      for (const SatRidge& b : m_ridgesB) {
        if (arcsMayCross(a, b)) testEdges(a, b);
      }
    }
    if (isEnough() || !(m_best->bound > -m_slack || !std::isfinite(m_best->bound))) return;
    if (!closeGap(m_features)) tryVertices();
  }

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  // Both cores' support vertices along the unit vector n.
  std::pair<int, int> project(const Vec<3>& n, const SatFeatures& features) {
    ++(*m_work)[WorkCount::axisTests];
    const int a = m_a.foremost(n), b = m_b.foremost(-n);
    take(n, n.dot(m_b.vertex(b) - m_a.vertex(a)), features);
    return {a, b};
  }

  // The ball in the other core rejects most faces: a face proves no more than its plane leaves beside the ball. Faces
  // that look most towards the ball's centre come first, since a better bound rejects more faces.
  void testFaces() {
    const int first[2] = {m_a.measure(m_b.centre), m_b.measure(m_a.centre)};
    for (const bool ofA : {true, false}) {
      m_low[ofA] = {}, m_known[ofA] = 1;
      if (!(ofA ? m_a : m_b).heights.empty()) testFace(ofA, first[ofA ? 0 : 1]);
      if (isEnough()) return;
    }
    for (const bool ofA : {true, false}) {
      const SatCore &of = ofA ? m_a : m_b, &other = ofA ? m_b : m_a;
      Real low = lowFor(other);
      for (std::size_t k = 0; k < of.heights.size(); ++k) {
        if (of.heights[k] <= low || of.below[k] >= 0) continue;
        testFace(ofA, static_cast<int>(k));
        if (isEnough()) return;
        low = lowFor(other);
      }
    }
  }
  // A face with the ball's centre no higher than this above its plane proves no more than the best.
  Real lowFor(const SatCore& other) const { return least() + other.inner - kFaceRounding * m_pair->scale; }

  // Tests first those vertices of the other core that rejected earlier faces, the latest one first.
  void testFace(bool ofA, int face) {
    SatCore &of = ofA ? m_a : m_b, &other = ofA ? m_b : m_a;
    const Plane plane = of.plane(of.faces()[at(face)]);
    ++(*m_work)[WorkCount::axisTests];
    std::array<int, kLowVertices>& low = m_low[ofA];
    std::size_t &known = m_known[ofA], i = 0;
    const auto height = [&](int v) { return plane.n.dot(other.vertices[at(v)]) - plane.offset; };
    const Real enough = least();
    Real bound = height(low[0]);
    while (bound > enough && ++i < known) bound = height(low[i]);
    const bool all = i == known;
    if (all) {
      if (known < low.size()) {
        ++known;
      } else {
        --i;
      }
      bound = std::numeric_limits<Real>::infinity();
      for (int v = 0; v < other.vertexCount(); ++v) {
        const Real h = height(v);
        if (h < bound) bound = h, low[i] = v;
      }
    }
    std::rotate(low.data(), low.data() + i, low.data() + i + 1);
    of.below[at(face)] = low[0];
    const Real sign = ofA ? Real(1) : Real(-1);
    take(sign * plane.n, bound,
         ofA ? SatFeatures{Kind::faceOfA, face, low[0]} : SatFeatures{Kind::faceOfB, low[0], face}, all);
  }

  // Selects the edges with normals that may still prove more than the best. All normals of an edge are normalised sums
  // of those of its two faces. If some point of the other core is so low that both of these prove no more than c, so
  // does every normal between: for negative c a longer sum proves less, for positive c at most 1 / cos(half the angle)
  // times as much. Such a point is a vertex that rejected a face, or the centre of the ball, which reaches lower by its
  // radius.
  void pickRidges(const SatCore& of, const SatCore& other, std::vector<SatRidge>& out) const {
    const Real low = lowFor(other), surely = std::min(low, Real(0));
    const Real* heights = of.heights.data();
    for (std::size_t i = 0; i < of.edges().size(); ++i) {
      const SatCore::Edge& e = of.edges()[i];
      if (e.faceA >= 0) {
        const Real higher = std::max(heights[e.faceA], heights[e.faceB]);
        if (higher <= surely || isHopeless(of, other, e, higher, low)) continue;
      }
      out.emplace_back(of, static_cast<int>(i));
      if (e.faceA >= 0) out.back().n0 = of.normal(e.faceA), out.back().n1 = of.normal(e.faceB);
    }
  }
  bool isHopeless(const SatCore& of, const SatCore& other, const SatCore::Edge& e, Real higher, Real low) const {
    const Real most = least(), cosine = of.faces()[at(e.faceA)].normal.dot(of.faces()[at(e.faceB)].normal);
    if (higher > 0 && low > 0 && 2 * higher * higher <= low * low * (1 + cosine)) return true;
    const Real c = most > 0 ? most * std::sqrt(std::max(Real(0), (1 + cosine) / 2)) : most;
    const Vec<3>& foot = of.vertices[at(e.v0)];
    const Vec<3> n0 = of.normal(e.faceA), n1 = of.normal(e.faceB);
    for (const int below : {of.below[at(e.faceA)], of.below[at(e.faceB)]}) {
      if (below < 0) continue;
      const Vec<3> v = other.vertices[at(below)] - foot;
      if (n0.dot(v) <= c && n1.dot(v) <= c) return true;
    }
    return false;
  }

  // Whether the arcs of normals of a and of -b meet on the sphere. Inclusive: an arc missed by rounding ends on a face
  // normal, which has been tested, and an arc accepted wrongly costs one more test.
  static bool arcsMayCross(const SatRidge& a, const SatRidge& b) {
    if (a.bare && b.bare) return true;
    if (a.bare) return !sameSide(b.n0.dot(a.direction), b.n1.dot(a.direction), kArcSine);
    const Real a0 = a.n0.dot(b.direction), a1 = a.n1.dot(b.direction);
    if (sameSide(a0, a1, kArcSine)) return false;
    if (b.bare) return true;
    const Real b0 = b.n0.dot(a.direction), b1 = b.n1.dot(a.direction);
    return !sameSide(b0, b1, kArcSine) && !sameSide(b0, a1, kArcSine);
  }
  static bool sameSide(Real x, Real y, Real near) { return (x > near && y > near) || (x < -near && y < -near); }

  // Nearly parallel edges give an axis of noise, exactly parallel ones none. Neither does harm: the two points on the
  // edges only give an upper bound of the axis, and then the whole cores are projected (core_pair.h).
  void testEdges(const SatRidge& a, const SatRidge& b) {
    Vec<3> n = a.direction.cross(b.direction);
    if (n.squaredNorm() <= kParallelSine * kParallelSine || !makeUnit<3>(n)) return;
    removeAlong<3>(n, a.direction);
    n.normalize();
    const Real along = n.dot(b.v0 - a.v0);
    for (const Real sign : {Real(1), Real(-1)}) {
      if (sign * along > least()) testAxis(sign * n, {Kind::edges, a.number, b.number});
    }
  }

  void testAxis(const Vec<3>& n, const SatFeatures& features) {
    ++(*m_work)[WorkCount::axisTests];
    Real farA = -std::numeric_limits<Real>::infinity();
    for (const Vec<3>& v : m_a.vertices) farA = std::max(farA, n.dot(v));
    Real bound = std::numeric_limits<Real>::infinity();
    for (const Vec<3>& v : m_b.vertices) {
      bound = std::min(bound, n.dot(v) - farA);
      if (bound <= m_best->bound) {
        m_watch([&](auto& t) { t.axis(*m_pair, n, bound, *m_best, words(features), false); });
        return;
      }
    }
    take(n, bound, features);
  }

  // --- cores that are apart ------------------------------------------------------------------------------------------

  // The vector between two features is no shorter than the distance, and its direction proves no more than the
  // distance: if both agree, they are the distance. Else the features around the support vertices may be nearer.
  // Returns false if there are none; m_way is then the shortest known vector.
  bool closeGap(SatFeatures features) {
    const bool known = features.kind != Kind::none;
    if (!known) (*m_work)[WorkCount::supportCalls] += 2;
    m_way = known ? wayBetween(features, m_a, m_b) : m_pair->support(m_best->n);
    for (int i = 0; i < kMostTurns; ++i) {
      const Real length = m_way.norm();
      if (length - m_best->bound <= m_slack) return true;
      Vec<3> n = m_way;
      if (!makeUnit<3>(n)) return false;
      const auto [a, b] = project(n, features);
      if (length - m_best->bound <= m_slack) return true;
      features = shorten(a, b);
      if (features.kind == Kind::none) return false;
    }
    return false;
  }

  // The features at vertex a of A and b of B with the shortest vector, if it is shorter than m_way.
  SatFeatures shorten(int a, int b) {
    SatFeatures nearest;
    Real least2 = m_way.squaredNorm();
    const auto offer = [&](const SatFeatures& f) {
      const Vec<3> way = wayBetween(f, m_a, m_b);
      if (way.squaredNorm() < least2) least2 = way.squaredNorm(), m_way = way, nearest = f;
    };
    offer({Kind::vertices, a, b});
    for (const bool ofA : {true, false}) {
      const SatCore& core = ofA ? m_a : m_b;
      for (const Polytope<3>::Spoke& s : core.spokes(ofA ? a : b)) {
        const int number = s.edge;
        const SatCore::Edge& e = core.edges()[at(number)];
        offer(ofA ? SatFeatures{Kind::edgeVertex, number, b} : SatFeatures{Kind::vertexEdge, a, number});
        if (e.faceA < 0) continue;
        // Of the two faces of an edge, the one to its left; seen from the vertex, each face is to the left of one edge.
        const int face = e.v0 == (ofA ? a : b) ? e.faceA : e.faceB;
        offer(ofA ? SatFeatures{Kind::faceOfA, face, b} : SatFeatures{Kind::faceOfB, a, face});
      }
    }
    return nearest;
  }

  // Vertex against vertex or edge. With L the best bound, n its axis and U any attained distance, the nearest points
  // lie no deeper than U - L behind the support planes of n; all other features are skipped.
  void tryVertices() {
    const Vec<3> n = m_best->n;
    const Real slab = m_way.norm() + kAttainedRounding * m_pair->scale - m_best->bound;
    pick(m_a, n, slab, m_verticesA, m_ridgesA);
    pick(m_b, -n, slab, m_verticesB, m_ridgesB);
    Real nearest = std::numeric_limits<Real>::infinity();
    forDifferences([&](const Vec<3>& v, const SatFeatures&) { nearest = std::min(nearest, v.squaredNorm()); });
    const Real tie = std::sqrt(nearest) * (1 + kTiePart) + kTieRounding * m_pair->scale;
    forDifferences([&](Vec<3> v, const SatFeatures& features) {
      if (v.squaredNorm() <= tie * tie && makeUnit<3>(v)) project(v, features);
    });
  }

  void pick(const SatCore& core, const Vec<3>& n, Real slab, std::vector<int>& vertices,
            std::vector<SatRidge>& ridges) const {
    vertices.clear(), ridges.clear();
    Real farthest = -std::numeric_limits<Real>::infinity();
    for (const Vec<3>& v : core.vertices) farthest = std::max(farthest, n.dot(v));
    const auto near = [&](int i) { return !(n.dot(core.vertices[at(i)]) < farthest - slab); };
    for (int i = 0; i < core.vertexCount(); ++i) {
      if (near(i)) vertices.push_back(i);
    }
    for (std::size_t i = 0; i < core.edges().size(); ++i) {
      const SatCore::Edge& e = core.edges()[i];
      if (near(e.v0) || near(e.v1)) ridges.emplace_back(core, static_cast<int>(i));
    }
  }

  // Calls f(pB - pA, features) for each selected vertex with each selected edge or vertex of the other core.
  template <class F>
  void forDifferences(F&& f) {
    for (const int a : m_verticesA) {
      for (const SatRidge& e : m_ridgesB) f(toEdge(e, m_a.vertices[at(a)]), SatFeatures{Kind::vertexEdge, a, e.number});
    }
    for (const int b : m_verticesB) {
      const Vec<3>& v = m_b.vertices[at(b)];
      for (const SatRidge& e : m_ridgesA) f(-toEdge(e, v), SatFeatures{Kind::edgeVertex, e.number, b});
      if (!m_a.edges().empty() && !m_b.edges().empty()) continue;
      for (const int a : m_verticesA) f(v - m_a.vertices[at(a)], SatFeatures{Kind::vertices, a, b});
    }
  }

  [[no_unique_address]] Watch m_watch;
  const CorePair<3>* m_pair = nullptr;
  BestAxis<3>* m_best = nullptr;
  WorkDone* m_work = nullptr;
  bool m_sideAlone = false;
  Real m_slack = 0;        // m
  SatFeatures m_features;  // features of the best axis
  Vec<3> m_way = Vec<3>::Zero();
  SatCore m_a, m_b;
  std::array<std::array<int, kLowVertices>, 2>
      m_low{};  // low vertices of B for faces of A, second; of A for faces of B, first
  std::array<std::size_t, 2> m_known{};
  std::vector<int> m_verticesA, m_verticesB;
  std::vector<SatRidge> m_ridgesA, m_ridgesB;  // edges that may matter
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
