// SPDX-License-Identifier: Zlib
// Expanding polytope (van den Bergen 2001): the face of the Minkowski difference nearest to the origin from inside. It
// also works for an origin just outside, where GJK's directions are rounding: then it finds the widest separating axis.
#pragma once

#include <vector>

#include "algorithms/pair_query/gjk/epa2.h"
#include "algorithms/pair_query/gjk/face_planes.h"
#include "algorithms/pair_query/gjk/triple.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

template <class Watch>
class Epa<3, Watch> {
 public:
  explicit Epa(const Watch& watch = {}) : m_watch(watch) {}

  /// `finish(n)` raises the bound by steps from the direction n, and returns where they end; unused below
  /// `limits.local` faces.
  template <class Finish = NoFinish>
  QueryStatus run(const CorePair<3>& pair, const Simplex<3>& start, const EpaLimits& limits, BestAxis<3>& best,
                  WorkDone& work, const Finish& finish = {}) {
    m_pair = &pair, m_best = &best, m_work = &work;
    m_visible = kVisible * pair.scale;
    m_points.clear(), m_reached.clear();
    m_count = m_waitingCount = 0, m_doubt = 0;
    m_inside = limits.inside, m_tolerance = limits.tolerance;
    if (!seed(start)) return QueryStatus::converged;  // flat: both normals of its plane are tested
    // Only bounds of true faces end the search: from outside, the polytope's own faces give no upper bound.
    Real settled = -std::numeric_limits<Real>::infinity();
    for (int expansions = 0, idle = 0;;) {
      const int lowest = takeLowest();
      if (lowest < 0) return QueryStatus::converged;
      const Face& face = m_faces[at(lowest)];
      const Real allowed = limits.allowed(face.offset);
      if (-face.offset <= settled + allowed) return QueryStatus::converged;
      const Triple w(support(face.outward.vector(), lowest));
      const Real height = dot(face.outward, w);
      if (height - face.offset <= allowed || isKnown(w)) {
        settled = std::max(settled, -height);  // a face of the difference itself: its own bound has been taken
        m_doubt = std::max(m_doubt, tiltError(face));
        continue;
      }
      if (m_count >= limits.local) {
        if (m_reached.empty()) m_reached.push_back(finish(best.n));
        if (m_inside && -face.offset <= best.bound + allowed) return QueryStatus::converged;
        const Real more = Real(m_count) / Real(limits.local), more2 = more * more;
        if (height - face.offset <= kNearFace * more2 * more2 * std::abs(face.offset)) {
          const Vec<3> n = -face.outward.vector();
          if (isReached(n)) continue;
          const Real before = best.bound;
          const Vec<3> end = finish(n);
          idle = best.bound > before + allowed ? 0 : idle + isReached(end);
          m_reached.push_back(end);
          if (idle == kMostIdleStarts || m_reached.size() == kMostStarts) return QueryStatus::converged;
          continue;
        }
      }
      if (m_count >= limits.faces || expansions >= limits.expansions) {
        return QueryStatus::iterationLimit;
      }
      ++expansions;
      if (!expand(lowest, w)) return QueryStatus::degenerate;
    }
  }

  /// Whether `finish` was used.
  bool finished() const { return !m_reached.empty(); }
  /// How far (m) the best bound may be below the truth because the corners of a settled face, which are rounded sums,
  /// are nearly collinear, so that its normal is inaccurate.
  Real doubt() const { return m_doubt; }

 private:
  struct Face {
    Triple outward;
    Real offset;
    int v[3];     // counter-clockwise seen from outside
    int edge[3];  // across the edge from v[i] to v[i + 1]: 4 x the neighbor, and the index of the shared edge in it
    bool gone;
  };
  static constexpr Real kNever = std::numeric_limits<Real>::infinity();

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  // The support point of the difference along unit d, a face's normal; every support gives a bound, too.
  Vec<3> support(const Vec<3>& d, int face = -1) {
    (*m_work)[WorkCount::supportCalls] += 2;
    const Vec<3> w = m_pair->support(-d);
    m_best->take(-d, -d.dot(w));
    m_watch([&](auto& t) {
      auto& step = t.expansion(*m_pair, Vec<3>(-d), w, *m_best, face >= 0);
      for (const Triple& p : m_points) step.corners.push_back(p.vector());
      for (int i = 0; i < m_count; ++i) {
        const Face& f = m_faces[at(i)];
        if (i == face) step.face = static_cast<int>(step.faces.size());
        if (!f.gone) step.faces.push_back({f.v[0], f.v[1], f.v[2]});
      }
    });
    return w;
  }

  bool isReached(const Vec<3>& n) const {
    return std::any_of(m_reached.begin(), m_reached.end(),
                       [&](const Vec<3>& end) { return (n - end).squaredNorm() < kSameDirection * kSameDirection; });
  }
  bool isKnown(const Triple& w) const {
    bool known = false;
    for (const Triple& p : m_points) known |= (p.x == w.x) & (p.y == w.y) & (p.z == w.z);
    return known;
  }

  int addFace(int i, int j, int k) {
    Face& f = m_faces[at(m_count)];
    f.v[0] = i, f.v[1] = j, f.v[2] = k, f.gone = false;
    m_turn[at(m_count)] = kNever;
    return m_count++;
  }

  // Makes the planes of the fan of faces from `first` on, around their last corner, each one's second corner the next
  // one's first, and joins them. Returns false if rounding has torn the visible faces apart and no valid expansion
  // remains.
  bool openFan(int first) {
    (*m_work)[WorkCount::polytopeFaces] += static_cast<std::uint64_t>(m_count - first);
    const Triple apex = m_points.back();
    const Real farthest = farthestToLook();
    m_planes.apex = {apex.x, apex.y, apex.z};
    bool torn = false;
    for (int before = m_count - 1; first < m_count; first += FacePlanes::kFan) {
      const int count = std::min(m_count - first, FacePlanes::kFan);
      for (int i = 0; i < count; before = first + i++) {
        const Face& f = m_faces[at(first + i)];
        torn |= m_faces[at(before)].v[1] != f.v[0];
        torn |= m_faces[at(f.edge[0] >> 2)].gone;
        join(first + i, 2, before, 1);
        put(f.v[0], i);
      }
      put(m_faces[at(before)].v[1], count);
      m_planes.find(count);
      for (int i = 0; i < count; ++i) {
        const auto k = at(i);
        Face& f = m_faces[at(first + i)];
        f.outward = {m_planes.outward[0][k], m_planes.outward[1][k], m_planes.outward[2][k]};
        f.offset = m_planes.offset[k];
        const Real square = m_planes.square[k];
        const bool safe = (square > kSafeSquare) & (square < 1 / kSafeSquare);
        if (safe || makePlane(f)) wait(first + i, farthest);
      }
    }
    return !torn;
  }
  void put(int point, int to) {
    const Triple& p = m_points[at(point)];
    m_planes.ring[0][at(to)] = p.x, m_planes.ring[1][at(to)] = p.y, m_planes.ring[2][at(to)] = p.z;
  }
  // The offset is the largest of all three corners: a sliver's normal may be inaccurate. Returns false if the face
  // cannot be expanded.
  bool makePlane(Face& f) const {
    const Triple a = m_points[at(f.v[0])], b = m_points[at(f.v[1])], c = m_points[at(f.v[2])];
    f.outward = cross(b - a, c - a);
    f.offset = 0;
    if (!makeUnit(f.outward)) return false;
    f.offset = std::max({dot(f.outward, a), dot(f.outward, b), dot(f.outward, c)});
    return true;
  }
  // If the origin is inside, the depth is no more than the best bound says, and farther faces are skipped. From
  // outside, a farther face may have nearer ones behind it.
  Real farthestToLook() const { return m_inside && m_best->bound < 0 ? m_tolerance - m_best->bound : kNever; }
  // No branch depends on the position of a face, here as in the waiting list: half of such branches would be
  // mispredicted, which costs more than the rest.
  void wait(int face, Real farthest) {
    const Real offset = m_faces[at(face)].offset;
    m_turn[at(face)] = offset;
    m_waiting[at(m_waitingCount)] = face;
    m_waitingCount += offset <= farthest;
  }

  // The nearest remaining face, the oldest of several; -1 if there is none. Linear search: removed faces leave the
  // list, and the bound keeps it short, except from outside and for round cores with a common centre, where nearly all
  // faces wait.
  int takeLowest() {
    Real least = kNever;
    int lowest = -1, kept = 0;
    for (int i = 0; i < m_waitingCount; ++i) {
      const int face = m_waiting[at(i)];
      const Real turn = m_turn[at(face)];
      m_waiting[at(kept)] = face;
      kept += turn < kNever;
      lowest = turn < least ? face : lowest;
      least = turn < least ? turn : least;
    }
    m_waitingCount = kept;
    if (lowest >= 0) m_turn[at(lowest)] = kNever;
    return lowest;
  }

  void farther(const Vec<3>& w, const auto& height, Vec<3>& farthest) const {
    if (height(w) > height(farthest)) farthest = w;
  }

  Real tiltError(const Face& f) const {
    const Triple a = m_points[at(f.v[0])], b = m_points[at(f.v[1])], c = m_points[at(f.v[2])];
    const auto square = [](const Triple& e) { return dot(e, e); };
    const Real longest2 = std::max({square(b - a), square(c - b), square(a - c)});
    const Real height = std::sqrt(square(cross(b - a, c - a)) / longest2);
    return kEpsilon * m_pair->scale / height * m_pair->scale;
  }

  // A tetrahedron that is not flat: from GJK's simplex, or by supports across the part that exists.
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
    if (e.norm() <= flat || !makeUnit<3>(e)) e = Vec<3>::Unit(0);  // one point: any direction is used
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

  // Fails if the tetrahedron is flatter than `thinnest`, relative to the cube of its longest edge from the first
  // corner.
  bool seedFrom(const Vec<3>& a, const Vec<3>& b, const Vec<3>& c, const Vec<3>& d, Real thinnest) {
    const Real volume = (b - a).cross(c - a).dot(d - a);
    const Real longest = std::sqrt(std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (d - a).squaredNorm()}));
    if (!(std::abs(volume) > thinnest * longest * longest * longest)) return false;
    m_points.assign({Triple(a), Triple(b), Triple(c), Triple(d)});
    if (volume > 0) std::swap(m_points[1], m_points[2]);
    // With d below the plane a b c: face a b c, and d with each edge reversed.
    makeRoom();
    addFace(0, 1, 2), addFace(0, 3, 1), addFace(1, 3, 2), addFace(2, 3, 0);
    const Real farthest = farthestToLook();
    for (int i = 0; i < 4; ++i) {
      if (makePlane(m_faces[at(i)])) wait(i, farthest);
    }
    (*m_work)[WorkCount::polytopeFaces] += 4;
    join(0, 0, 1, 2), join(0, 1, 2, 2), join(0, 2, 3, 2), join(1, 0, 3, 1), join(1, 1, 2, 0), join(2, 1, 3, 0);
    return true;
  }

  // Room for the first four, or for a walk: three steps, and two for each visible face.
  void makeRoom() {
    const std::size_t most = 3 * at(m_count) + 4;
    if (m_faces.size() < most) m_faces.resize(2 * most), m_turn.resize(2 * most), m_waiting.resize(2 * most);
  }

  // Makes two faces neighbors across these edges.
  void join(int face, int edge, int other, int otherEdge) {
    m_faces[at(face)].edge[edge] = 4 * other + otherEdge;
    m_faces[at(other)].edge[otherEdge] = 4 * face + edge;
  }

  // Whether w lies beyond the face, or in its plane and in line with the entry edge: the new triangle there would have
  // no normal.
  bool isVisible(const Face& f, int edge, const Triple& w) const {
    const Real beyond = dot(f.outward, w) - f.offset;
    if (beyond > m_visible) return true;
    if (beyond < -m_visible) return false;
    const Triple a = m_points[at(f.v[edge])], b = m_points[at(f.v[(edge + 1) % 3])], e = b - a;
    return norm(cross(e, w - a)) <= m_visible * norm(e);
  }

  // Walks over the visible faces from the one behind this edge, and makes, in order, a face from each horizon edge to
  // the new point.
  void walk(int edge, const Triple& w) {
    constexpr int kNext[3] = {1, 2, 0}, kLast[3] = {2, 0, 1};
    const int face = edge >> 2, k = edge & 3;
    Face& f = m_faces[at(face)];
    if (f.gone) return;
    if (isVisible(f, k, w)) {
      f.gone = true, m_turn[at(face)] = kNever;
      walk(f.edge[kNext[k]], w), walk(f.edge[kLast[k]], w);
    } else {
      join(addFace(f.v[kNext[k]], f.v[k], static_cast<int>(m_points.size()) - 1), 0, face, k);
    }
  }

  bool expand(int face, const Triple& w) {
    const int first = m_count;
    makeRoom();
    m_points.push_back(w);
    Face& f = m_faces[at(face)];
    f.gone = true;
    for (int k = 0; k < 3; ++k) walk(f.edge[k], w);
    if (m_count - first < 3) return false;
    return openFan(first);
  }

  [[no_unique_address]] Watch m_watch;
  const CorePair<3>* m_pair = nullptr;
  BestAxis<3>* m_best = nullptr;
  WorkDone* m_work = nullptr;
  Real m_visible = 0, m_doubt = 0, m_tolerance = 0;
  bool m_inside = false;
  FacePlanes m_planes;
  std::vector<Triple> m_points;
  std::vector<Vec<3>> m_reached;  // results of `finish`
  std::vector<Face> m_faces;      // the first m_count
  int m_count = 0;
  std::vector<Real> m_turn;    // the offset of a waiting face, else kNever
  std::vector<int> m_waiting;  // the first m_waitingCount, with removed faces
  int m_waitingCount = 0;
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
