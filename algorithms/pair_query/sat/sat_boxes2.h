// SPDX-License-Identifier: Zlib
// Separating axes of two 2D cores that are boxes, flat ones included: a point is a box of zero size, a segment has one
// extent.
#pragma once

#include "algorithms/pair_query/core/core_pair.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// All candidate directions of the pair and the best bound: the signed distance of the cores.
template <class Watch = NoWatch>
class SatBoxes2 {
  static constexpr int D = 2;

 public:
  SatBoxes2(const CorePair<D>& pair, QueryNeed need, BestAxis<D>& best, WorkDone& work, const Watch& watch = {})
      : m_watch(watch), m_pair(pair), m_need(need), m_best(best), m_work(work), m_hA(pair.a.half), m_hB(pair.b.half) {}

  void run() {
    LPC_ASSERT(m_pair.a.core() <= CoreClass::box && m_pair.b.core() <= CoreClass::box);
    const Mat<D> flat = m_pair.r.cwiseAbs();
    Widest widest;
    for (int k = 0; k < D; ++k) {
      offer(widest, std::abs(m_pair.p[k]) - (m_hA[k] + flat.row(k).dot(m_hB)), k);
      offer(widest, std::abs(m_pair.r.col(k).dot(m_pair.p)) - (m_hB[k] + flat.col(k).dot(m_hA)), D + k);
    }
    m_work[WorkCount::axisTests] += 2 * D;
    takeWidest(widest.axis);
    // For cores that are apart, an axis proves the distance only if the nearest features are vertex and face: pairs of
    // vertices remain. Flat cores in one plane are apart at a bound of zero, except for rounding.
    if (m_need == QueryNeed::boolean && m_best.bound > m_pair.radii()) return;  // any axis decides the side
    if (m_best.bound > -kBoundRounding * m_pair.scale) tryCorners();
  }

 private:
  static constexpr int kCorners = 1 << D;

  // Axes by number: A's, B's.
  struct Widest {
    Real gap = -std::numeric_limits<Real>::infinity();
    int axis = 0;

    void offer(Real offered, int number) {
      if (offered > gap) gap = offered, axis = number;
    }
  };

  void offer(Widest& widest, Real gap, int number) const {
    widest.offer(gap, number);
    m_watch([&](auto& t) {
      t.axis(m_pair, facing(number), gap, {facing(widest.axis), widest.gap}, t.part("side", number % D, number < D));
    });
  }

  // Both signs at once: boxes are their own mirror images. The reported bound is that of the reported vector itself.
  void take(const Vec<D>& n) {
    const Real along = n.dot(m_pair.p);
    const Real reach = m_hA.dot(n.cwiseAbs()) + m_hB.dot((m_pair.r.transpose() * n).cwiseAbs());
    m_best.take(along < 0 ? Vec<D>(-n) : n, std::abs(along) - reach);
  }
  Vec<D> axis(int number) const {
    Vec<D> n = Vec<D>::Zero();
    if (number < D) {
      n[number] = 1;
    } else {
      n = m_pair.r.col(number - D);
    }
    return n;
  }
  // From A to B.
  Vec<D> facing(int number) const {
    const Vec<D> n = axis(number);
    return n.dot(m_pair.p) < 0 ? Vec<D>(-n) : n;
  }
  void takeWidest(int number) {
    take(axis(number));
    m_watch([&](auto& t) { t.refined(m_pair, m_best, "the widest axis's own vector"); });
  }

  // A box's corners in the other's frame, with their distance behind the support corner along the best axis; a corner
  // is farther from the other box than the bound by at least this distance. A core's corners count once: `flat` axes
  // have one end.
  struct Corners {
    std::array<Vec<D>, kCorners> q;
    std::array<Real, kCorners> lag;
    Vec<D> other;  // half extents

    // Vector from the corner to the nearest point of the other box.
    Vec<D> toOther(std::size_t i) const { return q[i].cwiseMax(-other).cwiseMin(other) - q[i]; }
  };
  Corners corners(bool ofA) const {
    const Mat<D>& r = m_pair.r;
    const Vec<D>&half = ofA ? m_hA : m_hB, along = ofA ? m_best.n : Vec<D>(-(r.transpose() * m_best.n));
    Vec<D> corner;
    for (int k = 0; k < D; ++k) corner[k] = along[k] >= 0 ? half[k] : -half[k];
    Corners out;
    out.other = ofA ? m_hB : m_hA;
    out.q[0] = ofA ? Vec<D>(r.transpose() * (corner - m_pair.p)) : Vec<D>(m_pair.p + r * corner);
    out.lag[0] = 0;
    for (int k = 0; k < D; ++k) {
      const Vec<D> edge = 2 * corner[k] * (ofA ? Vec<D>(r.row(k).transpose()) : Vec<D>(r.col(k)));
      const Real behind = half[k] > 0 ? 2 * half[k] * std::abs(along[k]) : std::numeric_limits<Real>::infinity();
      for (std::size_t i = 0; i < std::size_t{1} << k; ++i) {
        const std::size_t far = i + (std::size_t{1} << k);
        out.q[far] = out.q[i] - edge, out.lag[far] = out.lag[i] + behind;
      }
    }
    return out;
  }
  // pB - pA in A's frame.
  Vec<D> toB(const Vec<D>& v, bool ofA) const { return ofA ? Vec<D>(m_pair.r * v) : Vec<D>(-v); }

  void tryCorners() {
    const Real slack = kBoundRounding * m_pair.scale;
    Real least2 = std::numeric_limits<Real>::infinity();
    Vec<D> nearest = Vec<D>::Zero();
    bool nearestOfA = true;
    for (const bool ofA : {true, false}) {
      const Corners all = corners(ofA);
      for (std::size_t i = 0; i < kCorners; ++i) {
        const Real behind = m_best.bound + all.lag[i] - slack;
        if (behind > 0 && behind * behind > least2) continue;
        const Vec<D> v = all.toOther(i);
        const Real length2 = v.squaredNorm();
        if (length2 < least2) least2 = length2, nearest = v, nearestOfA = ofA;
      }
    }
    m_best.tryDirection(m_pair, toB(nearest, nearestOfA), m_work, m_watch);
    const Real least = std::sqrt(least2);
    if (m_best.bound >= least - slack) return;
    // Among equally near features rounding decides which is nearest, but not which direction proves most.
    const Real tie = least + kTiePart * least + kTieRounding * m_pair.scale;
    const Real proved = m_best.bound;  // another direction may have proved more
    const std::array<Corners, 2> both = {corners(true), corners(false)};
    for (const bool ofA : {true, false}) {
      const Corners& all = both[ofA ? 0 : 1];
      for (std::size_t i = 0; i < kCorners; ++i) {
        if (proved + all.lag[i] > tie) continue;
        const Vec<D> v = all.toOther(i);
        if (v.norm() <= tie) m_best.tryDirection(m_pair, toB(v, ofA), m_work, m_watch);
      }
    }
  }

  [[no_unique_address]] Watch m_watch;
  const CorePair<D>& m_pair;
  QueryNeed m_need;
  BestAxis<D>& m_best;
  WorkDone& m_work;
  const Vec<D>&m_hA, &m_hB;
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
