// SPDX-License-Identifier: Zlib
// Fallback for an iteration that rounding has stopped early: its direction is good enough to select the few vertices
// near contact, and all candidate directions among these are tried.
#pragma once

#include <span>
#include <vector>

#include "algorithms/pair_query/core/touching.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

template <int D>
class LocalFeatures {
 public:
  /// Around the unit direction n, whose bound may be `gap` from the truth (m).
  void improve(const CorePair<D>& pair, Vec<D> n, Real gap, BestAxis<D>& best, WorkDone& work) {
    const Real band = kGapBand * gap + kFeatureBand * pair.scale;
    supportingVertices<D>(pair.a, n, band, m_a, work);
    supportingVertices<D>(pair.b, Vec<D>(-(pair.r.transpose() * n)), band, m_b, work);
    if (m_a.size() > kMostLocalVertices || m_b.size() > kMostLocalVertices) return;
    for (Vec<D>& v : m_b) v = pair.p + pair.r * v;
    const auto test = [&](const Vec<D>& v) { best.tryDirection(pair, v, work); };
    const auto testBoth = [&](const Vec<D>& v) { test(v), test(-v); };
    for (const Vec<D>& a : m_a) {
      for (const Vec<D>& b : m_b) test(b - a);
    }
    forEdges(m_b, [&](const Vec<D>& b0, const Vec<D>& eB) {
      for (const Vec<D>& a : m_a) test(across(b0 - a, eB));
      testNormals(eB, testBoth);
    });
    forEdges(m_a, [&](const Vec<D>& a0, const Vec<D>& eA) {
      for (const Vec<D>& b : m_b) test(across(b - a0, eA));
      testNormals(eA, testBoth);
      if constexpr (D == 3) {
        forEdges(m_b, [&](const Vec<D>&, const Vec<D>& eB) { testBoth(across(eA.cross(eB), eA)); });
        forEdges(m_a, [&](const Vec<D>&, const Vec<D>& other) { testBoth(across(eA.cross(other), eA)); });
      }
    });
    if constexpr (D == 3) {
      forEdges(m_b, [&](const Vec<D>&, const Vec<D>& e0) {
        forEdges(m_b, [&](const Vec<D>&, const Vec<D>& e1) { testBoth(across(e0.cross(e1), e0)); });
      });
    }
  }

  /// For cores that barely overlap: a facet of the difference may be a needle that rounded sums have lost. The edges at
  /// the contact are not sums, and give the normals of all facets there.
  void improveAcrossEdges(const CorePair<3>& pair, BestAxis<3>& best, WorkDone& work) {
    const Real band = -kGapBand * best.bound + kFeatureBand * pair.scale;
    for (int round = 0; round < kMostEdgeRounds; ++round) {
      const Real before = best.bound;
      edgesAt(pair.a, best.n, band, m_a, work);
      edgesAt(pair.b, Vec<3>(-(pair.r.transpose() * best.n)), band, m_b, work);
      for (Vec<3>& e : m_b) e = pair.r * e;
      m_a.insert(m_a.end(), m_b.begin(), m_b.end());
      for (std::size_t i = 0; i < m_a.size(); ++i) {
        for (std::size_t j = i + 1; j < m_a.size(); ++j) {
          const Vec<3> n = across(m_a[i].cross(m_a[j]), m_a[i]);
          best.tryDirection(pair, n, work), best.tryDirection(pair, -n, work);
        }
      }
      if (!(best.bound > before)) return;
    }
  }

 private:
  // Unit edges with an end within `band` of the core's support vertex along n.
  static void edgesAt(const ShapeView<3>& shape, const Vec<3>& n, Real band, std::vector<Vec<3>>& out, WorkDone& work) {
    out.clear();
    switch (shape.core()) {
      case CoreClass::point:
      case CoreClass::segment:
      case CoreClass::box:
        for (int k = 0; k < 3; ++k) {
          if (shape.half[k] > 0) out.push_back(Vec<3>::Unit(k));
        }
        return;
      case CoreClass::curved:  // has no facets to lose
      case CoreClass::plane:
        return;
      case CoreClass::hull:
        break;
    }
    const IndexedVector<Vec<3>>& vertices = shape.hull->vertices;
    ++work[WorkCount::supportCalls];
    const Real height = coreSupport(shape, n).dot(n) - band;
    for (const auto& edge : shape.hull->edges) {
      const Vec<3>&u = vertices[edge.v0], &v = vertices[edge.v1];
      Vec<3> e = v - u;
      if ((u.dot(n) >= height || v.dot(n) >= height) && makeUnit<3>(e)) out.push_back(e);
    }
  }

  template <class F>
  static void forEdges(std::span<const Vec<D>> vertices, F&& f) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      for (std::size_t j = i + 1; j < vertices.size(); ++j) {
        Vec<D> e = vertices[j] - vertices[i];
        if (makeUnit<D>(e)) f(vertices[i], e);
      }
    }
  }
  static Vec<D> across(Vec<D> v, const Vec<D>& e) {
    removeAlong<D>(v, e);
    return v;
  }
  template <class F>
  static void testNormals(const Vec<D>& e, F&& testBoth) {
    if constexpr (D == 2) testBoth(Vec<D>(-e[1], e[0]));
  }

  std::vector<Vec<D>> m_a, m_b;
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
