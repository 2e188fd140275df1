// SPDX-License-Identifier: Zlib
// Expanding polytope (van den Bergen 2001): the face of the Minkowski difference that is nearest to the origin from
// inside. It also works for an origin that lies just outside, where GJK's directions are rounding: then it finds the
// widest separating axis.
#pragma once

#include <vector>

#include "algorithms/pair_query/epa2.h"

namespace lpc::inline LPC_PRECISION::pair_query {

template <>
class Epa<3> {
 public:
  QueryStatus run(const CorePair<3>& pair, const Simplex<3>& start, const EpaLimits& limits, BestAxis<3>& best,
                  WorkDone& work) {
    m_pair = &pair, m_best = &best, m_work = &work;
    m_visible = kVisible * pair.scale;
    m_points.clear(), m_faces.clear();
    m_doubt = 0;
    if (!seed(start)) return QueryStatus::converged;  // flat: both normals of its plane are tested
    // Only bounds of true faces end the search: from outside, the polytope's own faces bound nothing from above.
    Real settled = -std::numeric_limits<Real>::infinity();
    while (true) {
      int lowest = -1;
      for (int i = 0; i < static_cast<int>(m_faces.size()); ++i) {
        const Face& f = m_faces[at(i)];
        if (f.alive && f.open && (lowest < 0 || f.offset < m_faces[at(lowest)].offset)) lowest = i;
      }
      if (lowest < 0 || -m_faces[at(lowest)].offset <= settled + limits.tolerance) return QueryStatus::converged;
      Face& face = m_faces[at(lowest)];
      const Vec<3> w = support(face.outward);
      if (face.outward.dot(w) - face.offset <= limits.tolerance || isKnown(w)) {
        settled = std::max(settled, -face.outward.dot(w));
        face.open = false;  // a face of the difference itself: its own bound has been taken
        m_doubt = std::max(m_doubt, tiltError(face));
        continue;
      }
      if (static_cast<int>(m_faces.size()) >= limits.faces) return QueryStatus::iterationLimit;
      if (!expand(lowest, w)) return QueryStatus::degenerate;
    }
  }

  /// How far below the truth the best bound may be because the corners of a settled face, rounded sums, lie so near to
  /// one line that its normal leans (m).
  Real doubt() const { return m_doubt; }

 private:
  struct Face {
    int v[3];         // counter-clockwise seen from outside
    int neighbor[3];  // across the edge from v[i] to v[i + 1]
    Vec<3> outward;
    Real offset;
    bool alive, open;
  };
  struct HorizonEdge {
    int outer;     // the face that stays
    int from, to;  // as in the face that goes
  };

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  // The farthest point of the difference along unit d; every support is a bound as well.
  Vec<3> support(const Vec<3>& d) {
    (*m_work)[WorkCount::supportCalls] += 2;
    const Vec<3> w = m_pair->support(-d);
    m_best->take(-d, -d.dot(w));
    return w;
  }

  bool isKnown(const Vec<3>& w) const { return std::find(m_points.begin(), m_points.end(), w) != m_points.end(); }

  int addFace(int i, int j, int k) {
    ++(*m_work)[WorkCount::polytopeFaces];
    const Vec<3>&a = m_points[at(i)], &b = m_points[at(j)], &c = m_points[at(k)];
    Face f{{i, j, k}, {-1, -1, -1}, (b - a).cross(c - a), 0, true, true};
    f.open = makeUnit<3>(f.outward);
    // The height of all three corners: a sliver's normal may lean.
    f.offset = std::max({f.outward.dot(a), f.outward.dot(b), f.outward.dot(c)});
    m_faces.push_back(f);
    return static_cast<int>(m_faces.size()) - 1;
  }

  void farther(const Vec<3>& w, const auto& height, Vec<3>& farthest) const {
    if (height(w) > height(farthest)) farthest = w;
  }

  Real tiltError(const Face& f) const {
    const Vec<3>&a = m_points[at(f.v[0])], &b = m_points[at(f.v[1])], &c = m_points[at(f.v[2])];
    const Real longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const Real height = (b - a).cross(c - a).norm() / longest;
    return kEpsilon * m_pair->scale / height * m_pair->scale;
  }

  // A tetrahedron that is not flat: from GJK's simplex, or by supports across what there is of it.
  bool seed(const Simplex<3>& start) {
    const Real flat = kFlat * m_pair->scale;
    if (start.count == 4 && seedFrom(start[0], start[1], start[2], start[3], kThinSeed)) return true;
    const Vec<3> u = start.count > 0 ? start[0] : support(Vec<3>::Unit(0));
    Vec<3> v = u, w = u, x = u;
    const auto length = [&](const Vec<3>& q) { return (q - u).norm(); };
    for (int k = 0; k < 3; ++k) {
      farther(support(Vec<3>::Unit(k)), length, v);
      farther(support(-Vec<3>::Unit(k)), length, v);
    }
    Vec<3> e = v - u;
    if (e.norm() <= flat || !makeUnit<3>(e)) e = Vec<3>::Unit(0);  // one point: any direction will do
    const auto width = [&](const Vec<3>& q) { return (q - u).cross(e).norm(); };
    const RealMatrix<3, 2> across = tangents(e);
    for (int k = 0; k < 2; ++k) {
      farther(support(across.col(k)), width, w);
      farther(support(-across.col(k)), width, w);
    }
    if (width(w) <= flat) return false;
    Vec<3> n = e.cross(w - u);
    makeUnit<3>(n);
    const auto height = [&](const Vec<3>& q) { return std::abs(n.dot(q - u)); };
    farther(support(n), height, x);
    farther(support(-n), height, x);
    return height(x) > flat && seedFrom(u, v, w, x, 0);
  }

  // Fails when the tetrahedron is flatter than `thinnest`, against the cube of its longest edge from the first corner.
  bool seedFrom(const Vec<3>& a, const Vec<3>& b, const Vec<3>& c, const Vec<3>& d, Real thinnest) {
    const Real volume = (b - a).cross(c - a).dot(d - a);
    const Real longest = std::sqrt(std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (d - a).squaredNorm()}));
    if (!(std::abs(volume) > thinnest * longest * longest * longest)) return false;
    m_points.assign({a, b, c, d});
    if (volume > 0) std::swap(m_points[1], m_points[2]);
    // With d below the plane a b c: faces a b c, and d with each edge turned round.
    addFace(0, 1, 2), addFace(0, 3, 1), addFace(1, 3, 2), addFace(2, 3, 0);
    constexpr int kNeighbors[4][3] = {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}};
    for (int i = 0; i < 4; ++i) std::copy_n(kNeighbors[i], 3, m_faces[at(i)].neighbor);
    return true;
  }

  // A face that w lies beyond, or in whose plane w lies in line with the edge by which we came: the new triangle there
  // would have no normal.
  bool isVisible(const Face& f, int edge, const Vec<3>& w) const {
    const Real beyond = f.outward.dot(w) - f.offset;
    if (beyond > m_visible) return true;
    if (beyond < -m_visible) return false;
    const Vec<3>&a = m_points[at(f.v[edge])], &b = m_points[at(f.v[(edge + 1) % 3])];
    const Vec<3> e = b - a;
    return e.cross(w - a).norm() <= m_visible * e.norm();
  }

  // Walks over the visible faces from `face`, entered by its edge `edge`, and leaves the horizon in order.
  void walk(int face, int edge, const Vec<3>& w) {
    Face& f = m_faces[at(face)];
    if (!f.alive) return;
    if (!isVisible(f, edge, w)) {
      m_horizon.push_back({face, f.v[(edge + 1) % 3], f.v[edge]});
      return;
    }
    f.alive = false;
    for (int k = 1; k <= 2; ++k) step(face, (edge + k) % 3, w);
  }
  void step(int face, int edge, const Vec<3>& w) {
    const int next = m_faces[at(face)].neighbor[edge];
    walk(next, edgeTo(next, face, m_faces[at(face)].v[(edge + 1) % 3]), w);
  }
  // The edge of `face` that starts at the vertex `from` and has `other` across.
  int edgeTo(int face, int other, int from) const {
    const Face& f = m_faces[at(face)];
    for (int k = 0; k < 3; ++k) {
      if (f.neighbor[k] == other && f.v[k] == from) return k;
    }
    return 0;
  }

  bool expand(int face, const Vec<3>& w) {
    m_horizon.clear();
    m_faces[at(face)].alive = false;
    for (int k = 0; k < 3; ++k) step(face, k, w);
    const int count = static_cast<int>(m_horizon.size()), first = static_cast<int>(m_faces.size());
    if (count < 3) return false;
    for (int i = 0; i < count; ++i) {
      // Rounding has torn the visible faces apart: no honest expansion is left.
      if (m_horizon[at(i)].to != m_horizon[at((i + 1) % count)].from) return false;
      if (!m_faces[at(m_horizon[at(i)].outer)].alive) return false;
    }
    m_points.push_back(w);
    const int apex = static_cast<int>(m_points.size()) - 1;
    for (int i = 0; i < count; ++i) {
      const HorizonEdge& h = m_horizon[at(i)];
      const int made = addFace(h.from, h.to, apex);
      Face& f = m_faces[at(made)];
      f.neighbor[0] = h.outer;
      f.neighbor[1] = first + (i + 1) % count;
      f.neighbor[2] = first + (i + count - 1) % count;
      Face& outer = m_faces[at(h.outer)];
      for (int k = 0; k < 3; ++k) {
        if (outer.v[k] == h.to && outer.v[(k + 1) % 3] == h.from) outer.neighbor[k] = made;
      }
    }
    return true;
  }

  const CorePair<3>* m_pair = nullptr;
  BestAxis<3>* m_best = nullptr;
  WorkDone* m_work = nullptr;
  Real m_visible = 0, m_doubt = 0;
  std::vector<Vec<3>> m_points;
  std::vector<Face> m_faces;
  std::vector<HorizonEdge> m_horizon;
};

}  // namespace lpc::inline LPC_PRECISION::pair_query
