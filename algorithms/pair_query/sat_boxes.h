// SPDX-License-Identifier: Zlib
// Separating axes of two cores that are boxes, flat ones included: a point is a box without extent, a segment has one.
#pragma once

#include "algorithms/pair_query/core_pair.h"

namespace lpc::inline LPC_PRECISION::pair_query {

/// All of the pair's candidate directions and the best bound: the signed distance of the cores.
template <int D>
class SatBoxes {
 public:
  SatBoxes(const CorePair<D>& pair, BestAxis<D>& best, WorkDone& work)
      : m_pair(pair), m_best(best), m_work(work), m_hA(pair.a.half), m_hB(pair.b.half) {}

  void run() {
    LPC_ASSERT(m_pair.a.core() <= CoreClass::box && m_pair.b.core() <= CoreClass::box);
    for (int k = 0; k < D; ++k) {
      test(Vec<D>::Unit(k));
      test(m_pair.r.col(k));
    }
    if constexpr (D == 3) testEdges();
    // Apart, an axis proves the distance only where the nearest features are vertex and face or edge and edge: what is
    // left are pairs with a vertex in them. Flat cores in one plane are apart at a bound of zero, but for rounding.
    if (m_best.bound > -kBoundRounding * m_pair.scale) tryCorners();
  }

 private:
  static constexpr int kCorners = 1 << D;

  // Both signs at once: boxes are their own mirror images.
  void test(const Vec<D>& n) {
    ++m_work[WorkCount::axisTests];
    const Real along = n.dot(m_pair.p);
    const Real reach = m_hA.dot(n.cwiseAbs()) + m_hB.dot((m_pair.r.transpose() * n).cwiseAbs());
    const Real bound = std::abs(along) - reach;
    if (bound > m_best.bound) m_best.take(along < 0 ? Vec<D>(-n) : n, bound);
  }

  // Edges parallel to within rounding have no common normal but noise. Their axes are left out only to save time: by
  // core_pair.h no direction can claim more than is true, and the true optimum is then a face normal's.
  void testEdges() {
    for (int i = 0; i < 3; ++i) {
      if (!(m_hA[i] > 0)) continue;
      for (int j = 0; j < 3; ++j) {
        if (!(m_hB[j] > 0)) continue;
        Vec<D> n = Vec<D>::Unit(i).cross(m_pair.r.col(j));
        const Real length2 = n.squaredNorm();
        if (length2 > kParallelSine * kParallelSine) test(n / std::sqrt(length2));
      }
    }
  }

  // f(pB - pA) for each corner of one box and the point of the other nearest to it.
  template <class F>
  void forCorners(F&& f) {
    const Mat<D>& r = m_pair.r;
    for (int bits = 0; bits < kCorners; ++bits) {
      if (repeats(bits, m_hA)) continue;
      const Vec<D> q = r.transpose() * (corner(bits, m_hA) - m_pair.p);
      f(Vec<D>(r * (q.cwiseMax(-m_hB).cwiseMin(m_hB) - q)));
    }
    for (int bits = 0; bits < kCorners; ++bits) {
      if (repeats(bits, m_hB)) continue;
      const Vec<D> q = m_pair.p + r * corner(bits, m_hB);
      f(Vec<D>(q - q.cwiseMax(-m_hA).cwiseMin(m_hA)));
    }
  }
  static Vec<D> corner(int bits, const Vec<D>& half) {
    Vec<D> v;
    for (int k = 0; k < D; ++k) v[k] = (bits >> k) & 1 ? half[k] : -half[k];
    return v;
  }
  static bool repeats(int bits, const Vec<D>& half) {
    for (int k = 0; k < D; ++k) {
      if (((bits >> k) & 1) && !(half[k] > 0)) return true;
    }
    return false;
  }

  void tryCorners() {
    Real least = std::numeric_limits<Real>::infinity();
    Vec<D> nearest = Vec<D>::Zero();
    forCorners([&](const Vec<D>& v) {
      const Real length2 = v.squaredNorm();
      if (length2 < least) least = length2, nearest = v;
    });
    m_best.tryDirection(m_pair, nearest, m_work);
    least = std::sqrt(least);
    if (m_best.bound >= least - kBoundRounding * m_pair.scale) return;
    // Among features that tie, rounding decides which is nearest, but not which direction proves most.
    const Real tie = least + kTiePart * least + kTieRounding * m_pair.scale;
    forCorners([&](const Vec<D>& v) {
      if (v.norm() <= tie) m_best.tryDirection(m_pair, v, m_work);
    });
  }

  const CorePair<D>& m_pair;
  BestAxis<D>& m_best;
  WorkDone& m_work;
  const Vec<D>&m_hA, &m_hB;
};

}  // namespace lpc::inline LPC_PRECISION::pair_query
