// SPDX-License-Identifier: Zlib
// Expanding polygon: the edge of the planar Minkowski difference nearest to the origin from inside. It also works for
// an origin just outside, where GJK's directions are rounding: then it finds the widest separating axis.
#pragma once

#include <vector>

#include "algorithms/pair_query/gjk/gjk_simplex2.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// For EpaLimits::local: never.
inline constexpr int kNotLocal = std::numeric_limits<int>::max();

struct EpaLimits {
  int faces, expansions;  // give up beyond
  int local;              // faces beyond which the rest is left to steps from them; 3D only
  Real tolerance;         // m
  Real part;              // allowed relative error of the depth, if larger than the tolerance
  bool inside;            // whether the simplex contains the origin, except for rounding

  Real allowed(Real offset) const { return std::max(tolerance, part * std::abs(offset)); }
};

struct NoFinish {
  auto operator()(const auto& n) const { return n; }
};

template <int D, class Watch = NoWatch>
class Epa;

template <class Watch>
class Epa<2, Watch> {
 public:
  explicit Epa(const Watch& watch = {}) : m_watch(watch) {}

  QueryStatus run(const CorePair<2>& pair, const Simplex<2>& start, const EpaLimits& limits, BestAxis<2>& best,
                  WorkDone& work, const auto&... /* finish, as in 3D */) {
    if (!seed(pair, start, best, work)) return QueryStatus::converged;  // flat: both normals of its line are tested
    // Only bounds of true edges end the search: from outside, the polygon's own edges give no upper bound.
    Real settled = -std::numeric_limits<Real>::infinity();
    for (int expansions = 0;;) {
      std::size_t lowest = m_edges.size();
      for (std::size_t i = 0; i < m_edges.size(); ++i) {
        if (m_edges[i].open && (lowest == m_edges.size() || m_edges[i].offset < m_edges[lowest].offset)) lowest = i;
      }
      if (lowest == m_edges.size()) return QueryStatus::converged;
      Edge& edge = m_edges[lowest];
      if (-edge.offset <= settled + limits.allowed(edge.offset)) return QueryStatus::converged;
      const Vec<2> w = support(pair, edge.outward, best, work, static_cast<int>(lowest));
      const bool known = std::any_of(m_edges.begin(), m_edges.end(), [&](const Edge& e) { return e.from == w; });
      if (known || edge.outward.dot(w) - edge.offset <= limits.allowed(edge.offset)) {
        settled = std::max(settled, -edge.outward.dot(w));
        edge.open = false;  // an edge of the difference itself: its own bound has been taken
        continue;
      }
      if (static_cast<int>(m_edges.size()) >= limits.faces || expansions >= limits.expansions) {
        return QueryStatus::iterationLimit;
      }
      ++expansions;
      lowest = dropCornersWithin(lowest, w, kVisible * pair.scale);
      const Vec<2> from = m_edges[lowest].from, to = m_edges[(lowest + 1) % m_edges.size()].from;
      m_edges[lowest] = makeEdge(from, w, work);
      m_edges.insert(m_edges.begin() + static_cast<std::ptrdiff_t>(lowest) + 1, makeEdge(w, to, work));
    }
  }

  /// As in 3D. An edge of two rounded corners leans too little to matter: its ends are the bound's own points.
  Real doubt() const { return 0; }

 private:
  struct Edge {
    Vec<2> from, outward;
    Real offset;
    bool open;
  };

  // The support point of the difference along d, an edge's normal; every support gives a bound, too.
  Vec<2> support(const CorePair<2>& pair, const Vec<2>& d, BestAxis<2>& best, WorkDone& work, int edge = -1) const {
    work[WorkCount::supportCalls] += 2;
    const Vec<2> w = pair.support(-d);
    best.take(-d, -d.dot(w));
    m_watch([&](auto& t) {
      auto& step = t.expansion(pair, Vec<2>(-d), w, best, edge >= 0);
      step.face = edge;
      const int count = edge < 0 ? 0 : static_cast<int>(m_edges.size());
      for (int i = 0; i < count; ++i) {
        step.corners.push_back(m_edges[i].from);
        step.faces.push_back({i, (i + 1) % count});
      }
    });
    return w;
  }

  static Edge makeEdge(const Vec<2>& from, const Vec<2>& to, WorkDone& work) {
    ++work[WorkCount::polytopeFaces];
    Vec<2> outward(to[1] - from[1], from[0] - to[0]);
    const bool open = makeUnit<2>(outward);
    return {from, outward, outward.dot(from), open};
  }

  // Removes corners beside the edge `at` that w leaves inside: a remembered corner may lie within. An edge that ends in
  // such a corner would count as the difference's own when its support point is an existing corner. Returns the edge's
  // new index.
  std::size_t dropCornersWithin(std::size_t at, const Vec<2>& w, Real visible) {
    const auto sees = [&](const Edge& e) { return e.outward.dot(w) - e.offset > visible; };
    const std::size_t n = m_edges.size();
    if (!sees(m_edges[(at + 1) % n]) && !sees(m_edges[(at + n - 1) % n])) return at;
    std::rotate(m_edges.begin(), m_edges.begin() + static_cast<std::ptrdiff_t>(at), m_edges.end());
    while (m_edges.size() > 2 && sees(m_edges[1])) m_edges.erase(m_edges.begin() + 1);
    while (m_edges.size() > 2 && sees(m_edges.back())) {
      m_edges[0].from = m_edges.back().from;
      m_edges.pop_back();
    }
    return 0;
  }

  // A triangle that is not flat: from GJK's, or by supports across the part that exists.
  bool seed(const CorePair<2>& pair, const Simplex<2>& start, BestAxis<2>& best, WorkDone& work) {
    const Real flat = kFlat * pair.scale;
    const Vec<2> u = start.count > 0 ? start[0] : support(pair, Vec<2>::Unit(0), best, work);
    Vec<2> v = u;
    const auto farther = [&](const Vec<2>& w) {
      if ((w - u).squaredNorm() > (v - u).squaredNorm()) v = w;
    };
    for (int i = 1; i < start.count; ++i) farther(start[i]);
    if ((v - u).norm() <= kShortBase * flat) {
      for (int k = 0; k < 2; ++k) {
        farther(support(pair, Vec<2>::Unit(k), best, work));
        farther(support(pair, -Vec<2>::Unit(k), best, work));
      }
    }
    Vec<2> e = v - u;
    if (e.norm() <= flat || !makeUnit<2>(e)) e = Vec<2>::Unit(0);  // one point: any direction is used
    const Vec<2> across(-e[1], e[0]);
    const Vec<2> left = support(pair, across, best, work), right = support(pair, -across, best, work);
    const Real rise = across.dot(left - u), fall = -across.dot(right - u);
    m_edges.clear();
    if (std::max(rise, fall) <= flat) return false;
    const Vec<2> third = rise >= fall ? left : right;
    const Vec<2> second = rise >= fall ? v : u, first = rise >= fall ? u : v;
    for (const auto& [from, to] : {std::pair(first, second), std::pair(second, third), std::pair(third, first)}) {
      m_edges.push_back(makeEdge(from, to, work));
    }
    return true;
  }

  [[no_unique_address]] Watch m_watch;
  IndexedVector<Edge> m_edges;  // counter-clockwise
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
