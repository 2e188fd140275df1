// SPDX-License-Identifier: Zlib
// Expanding polytope (van den Bergen 2001): the face of the Minkowski difference that is nearest to the origin from
// inside. It also works for an origin that lies just outside, where GJK's directions are rounding: then it finds the
// widest separating axis.
#pragma once

#include <vector>

#include "algorithms/pair_query/epa2.h"
#include "algorithms/pair_query/face_planes.h"
#include "algorithms/pair_query/triple.h"

namespace lpc::inline LPC_PRECISION::pair_query {

template <>
class Epa<3> {
 public:
  QueryStatus run(const CorePair<3>& pair, const Simplex<3>& start, const EpaLimits& limits, BestAxis<3>& best,
                  WorkDone& work) {
    m_pair = &pair, m_best = &best, m_work = &work;
    m_visible = kVisible * pair.scale;
    m_points.clear(), m_faces.clear(), m_queue.clear();
    m_doubt = 0;
    m_inside = limits.inside, m_tolerance = limits.tolerance;
    if (!seed(start)) return QueryStatus::converged;  // flat: both normals of its plane are tested
    // Only bounds of true faces end the search: from outside, the polytope's own faces bound nothing from above.
    Real settled = -std::numeric_limits<Real>::infinity();
    for (int expansions = 0;;) {
      const int lowest = takeLowest();
      if (lowest < 0) return QueryStatus::converged;
      const Face& face = m_faces[at(lowest)];
      const Real allowed = limits.allowed(face.offset);
      if (-face.offset <= settled + allowed) return QueryStatus::converged;
      const Triple w(support(face.outward.vector()));
      const Real height = dot(face.outward, w);
      if (height - face.offset <= allowed || isKnown(w)) {
        settled = std::max(settled, -height);  // a face of the difference itself: its own bound has been taken
        m_doubt = std::max(m_doubt, tiltError(face));
        continue;
      }
      if (static_cast<int>(m_faces.size()) >= limits.faces || expansions >= limits.expansions) {
        return QueryStatus::iterationLimit;
      }
      ++expansions;
      if (!expand(lowest, w)) return QueryStatus::degenerate;
    }
  }

  /// How far below the truth the best bound may be because the corners of a settled face, rounded sums, lie so near to
  /// one line that its normal leans (m).
  Real doubt() const { return m_doubt; }

 private:
  struct Face {
    Triple outward;
    Real offset;
    int v[3];                       // counter-clockwise seen from outside
    int neighbor[3];                // across the edge from v[i] to v[i + 1],
    unsigned char neighborEdge[3];  // which is this edge of the neighbor
    bool alive;
  };
  struct Queued {
    Real offset;
    int face;
    bool operator<(const Queued& other) const {  // std's heaps have the last one on top
      return offset > other.offset || (offset == other.offset && face > other.face);
    }
  };
  struct FaceEdge {
    int face, edge;
  };

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  // The farthest point of the difference along unit d; every support is a bound as well.
  Vec<3> support(const Vec<3>& d) {
    (*m_work)[WorkCount::supportCalls] += 2;
    const Vec<3> w = m_pair->support(-d);
    m_best->take(-d, -d.dot(w));
    return w;
  }

  bool isKnown(const Triple& w) const {
    for (const Triple& p : m_points) {
      if (p.x == w.x && p.y == w.y && p.z == w.z) return true;
    }
    return false;
  }

  void addFace(int i, int j, int k) {
    Face& f = m_faces.emplace_back();
    f.v[0] = i, f.v[1] = j, f.v[2] = k, f.alive = true;
  }

  // The planes of all faces from `first` on, which are then waiting.
  void openFaces(int first) {
    const int last = static_cast<int>(m_faces.size());
    (*m_work)[WorkCount::polytopeFaces] += static_cast<std::uint64_t>(last - first);
    // Who holds the origin is no deeper than the best bound says, and faces that are farther need not be looked at.
    // From outside, one that is farther now may have nearer ones behind it.
    const Real farthest =
        m_inside && m_best->bound < 0 ? m_tolerance - m_best->bound : std::numeric_limits<Real>::infinity();
    for (; first < last; first += FacePlanes::kFan) {
      const int count = std::min(last - first, FacePlanes::kFan);
      for (int i = 0; i < count; ++i) {
        const Face& f = m_faces[at(first + i)];
        put(f.v[0], i, m_planes.a), put(f.v[1], i, m_planes.b), put(f.v[2], i, m_planes.c);
      }
      m_planes.find(count);
      for (int i = 0; i < count; ++i) openFace(first + i, i, farthest);
    }
  }
  void put(int point, int to, std::array<FacePlanes::Row, 3>& rows) const {
    const Triple& p = m_points[at(point)];
    rows[0][at(to)] = p.x, rows[1][at(to)] = p.y, rows[2][at(to)] = p.z;
  }
  // The offset is the height of all three corners: a sliver's normal may lean.
  void openFace(int face, int i, Real farthest) {
    Face& f = m_faces[at(face)];
    f.outward = {m_planes.outward[0][at(i)], m_planes.outward[1][at(i)], m_planes.outward[2][at(i)]};
    f.offset = m_planes.offset[at(i)];
    const Real square = m_planes.square[at(i)];
    if (!(square > kSafeSquare && square < 1 / kSafeSquare)) [[unlikely]] {
      const Triple a = m_points[at(f.v[0])], b = m_points[at(f.v[1])], c = m_points[at(f.v[2])];
      f.outward = cross(b - a, c - a);
      f.offset = 0;
      if (!makeUnit(f.outward)) return;  // there is no way to go from it
      f.offset = std::max({dot(f.outward, a), dot(f.outward, b), dot(f.outward, c)});
    }
    if (!(f.offset <= farthest)) return;
    m_queue.push_back({f.offset, face});
    std::push_heap(m_queue.begin(), m_queue.end());
  }

  // The nearest face that is left, of several the oldest; -1: none.
  int takeLowest() {
    while (!m_queue.empty()) {
      std::pop_heap(m_queue.begin(), m_queue.end());
      const int face = m_queue.back().face;
      m_queue.pop_back();
      if (m_faces[at(face)].alive) return face;
    }
    return -1;
  }

  void farther(const Vec<3>& w, const auto& height, Vec<3>& farthest) const {
    if (height(w) > height(farthest)) farthest = w;
  }

  Real tiltError(const Face& f) const {
    const Triple a = m_points[at(f.v[0])], b = m_points[at(f.v[1])], c = m_points[at(f.v[2])];
    const auto square = [](const Triple& e) { return dot(e, e); };
    const Real longest = std::sqrt(std::max({square(b - a), square(c - b), square(a - c)}));
    const Real height = norm(cross(b - a, c - a)) / longest;
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
    m_points.assign({Triple(a), Triple(b), Triple(c), Triple(d)});
    if (volume > 0) std::swap(m_points[1], m_points[2]);
    // With d below the plane a b c: faces a b c, and d with each edge turned round.
    addFace(0, 1, 2), addFace(0, 3, 1), addFace(1, 3, 2), addFace(2, 3, 0);
    openFaces(0);
    join(0, 0, 1, 2), join(0, 1, 2, 2), join(0, 2, 3, 2), join(1, 0, 3, 1), join(1, 1, 2, 0), join(2, 1, 3, 0);
    return true;
  }

  // Across these edges the two faces are neighbors.
  void join(int face, int edge, int other, int otherEdge) {
    Face &f = m_faces[at(face)], &g = m_faces[at(other)];
    f.neighbor[edge] = other, f.neighborEdge[edge] = static_cast<unsigned char>(otherEdge);
    g.neighbor[otherEdge] = face, g.neighborEdge[otherEdge] = static_cast<unsigned char>(edge);
  }

  // A face that w lies beyond, or in whose plane w lies in line with the edge by which we came: the new triangle there
  // would have no normal.
  bool isVisible(const Face& f, int edge, const Triple& w) const {
    const Real beyond = dot(f.outward, w) - f.offset;
    if (beyond > m_visible) return true;
    if (beyond < -m_visible) return false;
    const Triple a = m_points[at(f.v[edge])], b = m_points[at(f.v[(edge + 1) % 3])], e = b - a;
    return norm(cross(e, w - a)) <= m_visible * norm(e);
  }

  // Walks over the visible faces from `face`, entered by its edge `edge`, and leaves the horizon in order.
  void walk(int face, int edge, const Triple& w) {
    Face& f = m_faces[at(face)];
    if (!f.alive) return;
    if (!isVisible(f, edge, w)) {
      m_horizon.push_back({face, edge});
      return;
    }
    f.alive = false;
    constexpr int kNext[3] = {1, 2, 0}, kLast[3] = {2, 0, 1};
    step(f, kNext[edge], w), step(f, kLast[edge], w);
  }
  void step(const Face& f, int edge, const Triple& w) { walk(f.neighbor[edge], f.neighborEdge[edge], w); }

  bool expand(int face, const Triple& w) {
    m_horizon.clear();
    Face& f = m_faces[at(face)];
    f.alive = false;
    for (int k = 0; k < 3; ++k) step(f, k, w);
    const int count = static_cast<int>(m_horizon.size()), first = static_cast<int>(m_faces.size());
    if (count < 3) return false;
    for (int i = 0; i < count; ++i) {
      // Rounding has torn the visible faces apart: no honest expansion is left.
      if (from(m_horizon[at(i)]) != to(m_horizon[at((i + 1) % count)])) return false;
      if (!m_faces[at(m_horizon[at(i)].face)].alive) return false;
    }
    m_points.push_back(w);
    const int apex = static_cast<int>(m_points.size()) - 1;
    for (int i = 0; i < count; ++i) {
      const FaceEdge outer = m_horizon[at(i)];
      const int made = first + i;
      addFace(to(outer), from(outer), apex);
      join(made, 0, outer.face, outer.edge);
      if (i > 0) join(made, 2, made - 1, 1);
    }
    join(first, 2, first + count - 1, 1);
    openFaces(first);
    return true;
  }
  int from(FaceEdge e) const { return m_faces[at(e.face)].v[e.edge]; }
  int to(FaceEdge e) const { return m_faces[at(e.face)].v[(e.edge + 1) % 3]; }

  const CorePair<3>* m_pair = nullptr;
  BestAxis<3>* m_best = nullptr;
  WorkDone* m_work = nullptr;
  Real m_visible = 0, m_doubt = 0, m_tolerance = 0;
  bool m_inside = false;
  FacePlanes m_planes;
  std::vector<Triple> m_points;
  std::vector<Face> m_faces;
  std::vector<Queued> m_queue;      // a heap; with faces that are gone
  std::vector<FaceEdge> m_horizon;  // of the faces that stay
};

}  // namespace lpc::inline LPC_PRECISION::pair_query
