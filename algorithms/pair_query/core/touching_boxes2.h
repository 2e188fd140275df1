// SPDX-License-Identifier: Zlib
// Where two 2D cores that are boxes, flat ones included, meet along n in the common case: at a corner of one of them.
// touching.h handles parallel edges, like any two features.
#pragma once

#include "algorithms/pair_query/core/core_pair.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

class TouchingBoxes2 {
 public:
  /// `band` (m): vertices within this distance of the support vertex belong to the feature.
  TouchingBoxes2(const CorePair<2>& pair, const Vec<2>& n, Real band) : m_pair(pair), m_n(n), m_band(band) {}

  /// The common point, without its component along n; false if the features are not of this kind, or miss each other by
  /// more than the band.
  bool find(Vec<2>& common) const {
    const Vec<2> back = -(m_pair.r.transpose() * m_n);
    const int freeA = extent(m_pair.a.half, m_n), freeB = extent(m_pair.b.half, back);
    const Vec<2> onA = foremost(m_pair.a.half, m_n), onB = foremost(m_pair.b.half, back);
    if (freeA == 0) {
      common = onA;
      return meets(m_pair.b.half, back, onB, m_pair.r.transpose() * (onA - m_pair.p), back) && across(common);
    }
    if (freeB == 0) {
      common = m_pair.p + m_pair.r * onB;
      return meets(m_pair.a.half, m_n, onA, common, m_n) && across(common);
    }
    return false;
  }

 private:
  static Vec<2> foremost(const Vec<2>& half, const Vec<2>& n) {
    Vec<2> v;
    for (int k = 0; k < 2; ++k) v[k] = n[k] >= 0 ? half[k] : -half[k];
    return v;
  }
  // Number of axes along which the feature along n extends.
  int extent(const Vec<2>& half, const Vec<2>& n) const {
    int free = 0;
    for (int k = 0; k < 2; ++k) {
      if (half[k] > 0 && 2 * std::abs(n[k]) * half[k] <= m_band) ++free;
    }
    return free;
  }
  // Whether the feature with this corner lies above or below q along n, all in its box's frame.
  bool meets(const Vec<2>& half, const Vec<2>& n, Vec<2> corner, const Vec<2>& q, const Vec<2>& direction) const {
    for (int k = 0; k < 2; ++k) {
      if (half[k] > 0 && 2 * std::abs(n[k]) * half[k] <= m_band) corner[k] = std::clamp(q[k], -half[k], half[k]);
    }
    corner -= q;
    corner -= corner.dot(direction) * direction;
    return corner.squaredNorm() <= m_band * m_band;
  }
  bool across(Vec<2>& common) const {
    common -= common.dot(m_n) * m_n;
    return true;
  }

  const CorePair<2>& m_pair;
  const Vec<2>& m_n;
  Real m_band;
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
