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
    const Mat<D> flat = m_pair.r.cwiseAbs();
    for (int k = 0; k < D; ++k) {
      offer(std::abs(m_pair.p[k]) - (m_hA[k] + flat.row(k).dot(m_hB)), k);
      offer(std::abs(m_pair.r.col(k).dot(m_pair.p)) - (m_hB[k] + flat.col(k).dot(m_hA)), D + k);
    }
    m_work[WorkCount::axisTests] += 2 * D;
    if constexpr (D == 3) offerEdges(flat);
    takeWidest();
    // Apart, an axis proves the distance only where the nearest features are vertex and face or edge and edge: what is
    // left are pairs with a vertex in them. Flat cores in one plane are apart at a bound of zero, but for rounding.
    if (m_best.bound > -kBoundRounding * m_pair.scale) tryCorners();
  }

 private:
  static constexpr int kCorners = 1 << D;

  // Axes by number: A's, B's, then the common normals of edge i of A and j of B.
  void offer(Real gap, int axis) {
    if (gap > m_widest) m_widest = gap, m_axis = axis;
  }

  // Edges parallel to within rounding have no common normal but noise. Their axes are left out only to save time: by
  // core_pair.h no direction can claim more than is true, and the true optimum is then a face normal's. The common
  // normal e_i x r_j has no part along e_i: with (i, k, l) in turn it is -r(l, j) along k and r(k, j) along l.
  void offerEdges(const Mat<3>& flat) {
    const Mat<3>& r = m_pair.r;
    for (int i = 0; i < 3; ++i) {
      if (!(m_hA[i] > 0)) continue;
      const int k = (i + 1) % 3, l = (i + 2) % 3;
      for (int j = 0; j < 3; ++j) {
        if (!(m_hB[j] > 0)) continue;
        const Real length2 = r(k, j) * r(k, j) + r(l, j) * r(l, j);
        if (!(length2 > kParallelSine * kParallelSine)) continue;
        ++m_work[WorkCount::axisTests];
        if (length2 < kShortNormal * kShortNormal) {  // products of rounded numbers, divided by little
          Vec<3> axis = Vec<3>::Unit(i).cross(r.col(j));
          take(axis / axis.norm());
          continue;
        }
        const int m = (j + 1) % 3, n = (j + 2) % 3;
        const Real along = std::abs(r(k, j) * m_pair.p[l] - r(l, j) * m_pair.p[k]);
        const Real reach = m_hA[k] * flat(l, j) + m_hA[l] * flat(k, j) + m_hB[m] * flat(i, n) + m_hB[n] * flat(i, m);
        const Real gap = along - reach;
        if (gap < 0 && (m_widest >= 0 || gap * gap > m_widest * m_widest * length2)) continue;  // without a root
        offer(gap / std::sqrt(length2), 6 + 3 * i + j);
      }
    }
  }

  // Both signs at once: boxes are their own mirror images. What is reported is the bound of the very vector that is.
  void take(const Vec<D>& n) {
    const Real along = n.dot(m_pair.p);
    const Real reach = m_hA.dot(n.cwiseAbs()) + m_hB.dot((m_pair.r.transpose() * n).cwiseAbs());
    m_best.take(along < 0 ? Vec<D>(-n) : n, std::abs(along) - reach);
  }
  void takeWidest() {
    Vec<D> n = Vec<D>::Zero();
    if (m_axis < D) {
      n[m_axis] = 1;
    } else if (m_axis < 2 * D) {
      n = m_pair.r.col(m_axis - D);
    } else if constexpr (D == 3) {
      n = Vec<D>::Unit((m_axis - 6) / 3).cross(m_pair.r.col((m_axis - 6) % 3));
      n /= n.norm();
    }
    take(n);
  }

  // f(v) for each corner of one box that may be within `most` of the other: v leads from it to the nearest point of the
  // other, in the other's frame, `ofA` says whose corner it is. One that lies `lag` behind the foremost corner along
  // the best axis is farther than the bound by as much, at least. f returns the new `most`.
  template <class F>
  void forCorners(Real most, F&& f) {
    const Mat<D>& r = m_pair.r;
    const Real proved = m_best.bound;  // along n: another direction may prove more meanwhile
    const Vec<D> n = m_best.n, back = -(r.transpose() * n);
    for (const bool ofA : {true, false}) {
      const Vec<D>&half = ofA ? m_hA : m_hB, &other = ofA ? m_hB : m_hA, &along = ofA ? n : back;
      Vec<D> corner;
      for (int k = 0; k < D; ++k) corner[k] = along[k] >= 0 ? half[k] : -half[k];
      const Vec<D> foremost = ofA ? Vec<D>(r.transpose() * (corner - m_pair.p)) : Vec<D>(m_pair.p + r * corner);
      int extended = 0;
      for (int k = 0; k < D; ++k) extended |= half[k] > 0 ? 1 << k : 0;
      for (int bits = 0; bits < kCorners; ++bits) {
        if (bits & ~extended) continue;  // the same corner again
        Real lag = 0;
        for (int k = 0; k < D; ++k) lag += (bits >> k) & 1 ? 2 * half[k] * std::abs(along[k]) : Real(0);
        if (proved + lag > most) continue;
        Vec<D> q = foremost;
        for (int k = 0; k < D; ++k) {
          if ((bits >> k) & 1) q -= 2 * corner[k] * (ofA ? Vec<D>(r.row(k).transpose()) : Vec<D>(r.col(k)));
        }
        most = f(Vec<D>(q.cwiseMax(-other).cwiseMin(other) - q), ofA);
      }
    }
  }
  // pB - pA in A's frame.
  Vec<D> toB(const Vec<D>& v, bool ofA) const { return ofA ? Vec<D>(m_pair.r * v) : Vec<D>(-v); }

  void tryCorners() {
    constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
    const Real slack = kBoundRounding * m_pair.scale;
    Real least2 = kInfinity, most = kInfinity;
    Vec<D> nearest = Vec<D>::Zero();
    bool nearestOfA = true;
    forCorners(most, [&](const Vec<D>& v, bool ofA) {
      const Real length2 = v.squaredNorm();
      if (length2 < least2) least2 = length2, nearest = v, nearestOfA = ofA, most = std::sqrt(length2) + slack;
      return most;
    });
    m_best.tryDirection(m_pair, toB(nearest, nearestOfA), m_work);
    const Real least = std::sqrt(least2);
    if (m_best.bound >= least - slack) return;
    // Among features that tie, rounding decides which is nearest, but not which direction proves most.
    const Real tie = least + kTiePart * least + kTieRounding * m_pair.scale;
    forCorners(tie, [&](const Vec<D>& v, bool ofA) {
      if (v.norm() <= tie) m_best.tryDirection(m_pair, toB(v, ofA), m_work);
      return tie;
    });
  }

  const CorePair<D>& m_pair;
  BestAxis<D>& m_best;
  WorkDone& m_work;
  const Vec<D>&m_hA, &m_hB;
  Real m_widest = -std::numeric_limits<Real>::infinity();
  int m_axis = 0;
};

}  // namespace lpc::inline LPC_PRECISION::pair_query
