// SPDX-License-Identifier: Zlib
// Where two cores that are boxes, flat ones included, meet along n, in the common case: a corner of one of them, or two
// edges that cross. What lies face to face or along each other is left to touching.h, where any two features are.
#pragma once

#include "algorithms/pair_query/core_pair.h"

namespace lpc::inline LPC_PRECISION::pair_query {

template <int D>
class TouchingBoxes {
 public:
  /// `band` (m): vertices that lie no farther behind the foremost one belong to the feature.
  TouchingBoxes(const CorePair<D>& pair, const Vec<D>& n, Real band) : m_pair(pair), m_n(n), m_band(band) {}

  /// The common point, without its part along n; false when the features are no such two, or miss each other by more
  /// than the band.
  bool find(Vec<D>& common) const {
    const Vec<D> back = -(m_pair.r.transpose() * m_n);
    int alongA = 0, alongB = 0;  // the last axis along which the feature extends
    const int freeA = extent(m_pair.a.half, m_n, alongA), freeB = extent(m_pair.b.half, back, alongB);
    const Vec<D> onA = foremost(m_pair.a.half, m_n), onB = foremost(m_pair.b.half, back);
    if (freeA == 0) {
      common = onA;
      return meets(m_pair.b.half, back, onB, m_pair.r.transpose() * (onA - m_pair.p), back) && across(common);
    }
    if (freeB == 0) {
      common = m_pair.p + m_pair.r * onB;
      return meets(m_pair.a.half, m_n, onA, common, m_n) && across(common);
    }
    if constexpr (D == 3) {
      if (freeA == 1 && freeB == 1) return crossing(onA, alongA, onB, alongB, common) && across(common);
    }
    return false;
  }

 private:
  static Vec<D> foremost(const Vec<D>& half, const Vec<D>& n) {
    Vec<D> v;
    for (int k = 0; k < D; ++k) v[k] = n[k] >= 0 ? half[k] : -half[k];
    return v;
  }
  // How many axes the feature along n extends along.
  int extent(const Vec<D>& half, const Vec<D>& n, int& along) const {
    int free = 0;
    for (int k = 0; k < D; ++k) {
      if (half[k] > 0 && 2 * std::abs(n[k]) * half[k] <= m_band) along = k, ++free;
    }
    return free;
  }
  // Does the feature with this corner lie above or below q, along n? All in its box's frame.
  bool meets(const Vec<D>& half, const Vec<D>& n, Vec<D> corner, const Vec<D>& q, const Vec<D>& direction) const {
    for (int k = 0; k < D; ++k) {
      if (half[k] > 0 && 2 * std::abs(n[k]) * half[k] <= m_band) corner[k] = std::clamp(q[k], -half[k], half[k]);
    }
    corner -= q;
    corner -= corner.dot(direction) * direction;
    return corner.squaredNorm() <= m_band * m_band;
  }
  // Two edges: where their lines are nearest to each other, if both reach as far.
  bool crossing(const Vec<D>& onA, int i, const Vec<D>& onB, int j, Vec<D>& common) const {
    const Vec<D> u = m_pair.r.col(j), from = m_pair.p + m_pair.r * onB;
    const Real cosine = u[i], sine2 = u.squaredNorm() - cosine * cosine;
    if (!(sine2 > kCrossingSine * kCrossingSine)) return false;
    // w = from + t u - (onA + s e_i) is across both lines.
    const Vec<D> w = from - onA;
    const Real alongA = w[i], alongB = w.dot(u);
    const Real t = (alongA * cosine - alongB) / sine2, s = alongA + t * cosine;
    const Real placeA = onA[i] + s, placeB = onB[j] + t;
    if (!(std::abs(placeA) <= m_pair.a.half[i] && std::abs(placeB) <= m_pair.b.half[j])) return false;
    common = onA;
    common[i] = placeA;
    const Vec<D> gap = from + t * u - common;
    const Vec<D> miss = gap - gap.dot(m_n) * m_n;
    common += miss / 2;
    return miss.squaredNorm() <= m_band * m_band;
  }
  bool across(Vec<D>& common) const {
    common -= common.dot(m_n) * m_n;
    return true;
  }

  const CorePair<D>& m_pair;
  const Vec<D>& m_n;
  Real m_band;
};

}  // namespace lpc::inline LPC_PRECISION::pair_query
