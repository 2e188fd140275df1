// SPDX-License-Identifier: Zlib
// Separating axes of two 2D cores of any kind: edge normals, and if these do not suffice, the nearest two vertices.
#pragma once

#include <vector>

#include "algorithms/pair_query/core/core_pair.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

template <int D, class Watch = NoWatch>
class SatPolytope;

template <class Watch>
class SatPolytope<2, Watch> {
 public:
  explicit SatPolytope(const Watch& watch = {}) : m_watch(watch) {}

  void run(const CorePair<2>& pair, QueryNeed, PairMemory*, BestAxis<2>& best, WorkDone& work) {
    fill(pair.a, Pose<2>{}.p, Mat<2>::Identity(), m_a);
    fill(pair.b, pair.p, pair.r, m_b);
    testNormals(pair, m_a, m_b, 1, best, work);
    testNormals(pair, m_b, m_a, -1, best, work);
    // For cores that are apart, the nearest features are two vertices, or a vertex and an edge; normals of edges have
    // been tested.
    if (best.bound <= -kBoundRounding * pair.scale) return;
    Real least = std::numeric_limits<Real>::infinity();
    for (const Vec<2>& a : m_a.vertices) {
      for (const Vec<2>& b : m_b.vertices) least = std::min(least, (b - a).squaredNorm());
    }
    const Real tie = std::sqrt(least) * (1 + kTiePart) + kTieRounding * pair.scale;
    for (const Vec<2>& a : m_a.vertices) {
      for (const Vec<2>& b : m_b.vertices) {
        if ((b - a).squaredNorm() <= tie * tie) best.tryDirection(pair, b - a, work, m_watch);
      }
    }
    if (!std::isfinite(best.bound)) best.tryDirection(pair, Vec<2>::Unit(0), work, m_watch);  // two equal points
  }

 private:
  struct Core {
    std::vector<Vec<2>> vertices, normals;  // normals[i]: of the edge from vertex i on; a segment has two, a point none
  };

  static void fill(const ShapeView<2>& shape, const Vec<2>& p, const Mat<2>& r, Core& core) {
    core.vertices.clear(), core.normals.clear();
    const Real x = shape.half[0], y = shape.half[1];
    const auto add = [&](const Vec<2>& v, const Vec<2>& n) {
      core.vertices.push_back(p + r * v);
      core.normals.push_back(r * n);
    };
    switch (shape.core()) {
      case CoreClass::point:
        core.vertices.push_back(p);
        break;
      case CoreClass::segment:
        add({x, 0}, {0, 1}), add({-x, 0}, {0, -1});
        break;
      case CoreClass::box:
        add({x, -y}, {1, 0}), add({x, y}, {0, 1}), add({-x, y}, {-1, 0}), add({-x, -y}, {0, -1});
        break;
      case CoreClass::hull:
        for (std::size_t i = 0; i < shape.hull->vertices.size(); ++i) {
          add(shape.hull->vertices[i], shape.hull->normals[i]);
        }
        break;
      case CoreClass::curved:
      case CoreClass::plane:
        LPC_ASSERT(false);  // has no list of edges
        break;
    }
  }

  // The outward normals of `of`; sign 1 if that is A, so that n points from A to B.
  void testNormals(const CorePair<2>& pair, const Core& of, const Core& other, Real sign, BestAxis<2>& best,
                   WorkDone& work) const {
    work[WorkCount::axisTests] += of.normals.size();
    for (std::size_t i = 0; i < of.normals.size(); ++i) {
      const Vec<2>& n = of.normals[i];
      // A rounded normal may lean out over the next vertex: the larger end of the edge is its offset.
      const Real offset = std::max(n.dot(of.vertices[i]), n.dot(of.vertices[(i + 1) % of.vertices.size()]));
      Real bound = std::numeric_limits<Real>::infinity();
      for (const Vec<2>& v : other.vertices) {
        bound = std::min(bound, n.dot(v) - offset);
        if (bound <= best.bound) break;
      }
      const bool all = bound > best.bound;
      best.take(sign * n, bound);
      m_watch([&](auto& t) { t.axis(pair, Vec<2>(sign * n), bound, best, t.part("edge", i, sign > 0), all); });
    }
  }

  [[no_unique_address]] Watch m_watch;
  Core m_a, m_b;
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
