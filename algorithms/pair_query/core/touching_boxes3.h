// SPDX-License-Identifier: Zlib
// Where two 3D cores that are boxes, flat ones included, meet along n in the common case: at a corner of one of them,
// or where two edges cross. touching.h handles faces on faces and parallel edges, like any two features.
#pragma once

#include "algorithms/pair_query/gjk/triple.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

inline Triple sizes(const Triple& v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }

/// Two boxes in A's frame, number by number; the same products as CorePair's, bit for bit.
struct BoxPair3 {
  Triple hA, hB, p;  // half extents, p_AB
  Triple r[3];       // columns of R_AB

  explicit BoxPair3(const CorePair<3>& pair) : hA(pair.a.half), hB(pair.b.half), p(pair.p) {
    for (int j = 0; j < 3; ++j) r[j] = {pair.r(0, j), pair.r(1, j), pair.r(2, j)};
  }
  Triple row(int i) const { return {r[0][i], r[1][i], r[2][i]}; }
  Triple back(const Triple& v) const { return {dot(r[0], v), dot(r[1], v), dot(r[2], v)}; }
  /// Eigen takes two rows at a time, and the last one alone.
  Triple turned(const Triple& v) const {
    return {dot(row(0), v), dot(row(1), v), r[0].z * v.x + (r[1].z * v.y + r[2].z * v.z)};
  }
  /// The support corner along n, as in coreSupport; a branch on a sign would be mispredicted half of the time.
  static Triple foremost(const Triple& half, const Triple& n) {
    return {std::copysign(half.x, n.x + 0), std::copysign(half.y, n.y + 0), std::copysign(half.z, n.z + 0)};
  }
};

class TouchingBoxes3 {
 public:
  /// `band` (m): vertices within this distance of the support vertex belong to the feature.
  TouchingBoxes3(const CorePair<3>& pair, const Vec<3>& n, Real band) : m_in(pair), m_n(n), m_band(band) {}

  /// The common point, without its component along n; false if the features are not of this kind, or miss each other by
  /// more than the band.
  bool find(Vec<3>& common) const {
    Triple found;
    if (!meet(found)) return false;
    (found - dot(found, m_n) * m_n).store(common);
    return true;
  }

 private:
  // The axes along which the feature along n extends.
  struct Feature {
    bool free[3];

    Feature(const Triple& half, const Triple& n, Real band) {
      for (int k = 0; k < 3; ++k) free[k] = half[k] > 0 && 2 * std::abs(n[k]) * half[k] <= band;
    }
    int count() const { return free[0] + free[1] + free[2]; }
    int axis() const { return free[2] ? 2 : free[1] ? 1 : 0; }
  };

  bool meet(Triple& common) const {
    const Triple back = -m_in.back(m_n);
    const Feature a(m_in.hA, m_n, m_band), b(m_in.hB, back, m_band);
    const Triple onA = m_in.foremost(m_in.hA, m_n), onB = m_in.foremost(m_in.hB, back);
    if (a.count() == 0) {
      common = onA;
      return meets(m_in.hB, b, onB, m_in.back(onA - m_in.p), back);
    }
    const Triple from = m_in.p + m_in.turned(onB);
    if (b.count() == 0) {
      common = from;
      return meets(m_in.hA, a, onA, common, m_n);
    }
    return a.count() == 1 && b.count() == 1 && crossing(onA, a.axis(), onB, b.axis(), from, common);
  }
  // Whether the feature with this corner lies above or below q along n, all in its box's frame.
  bool meets(const Triple& half, const Feature& f, const Triple& corner, const Triple& q, const Triple& n) const {
    const auto at = [&](int k) { return f.free[k] ? std::clamp(q[k], -half[k], half[k]) : corner[k]; };
    const Triple gap = Triple(at(0), at(1), at(2)) - q, miss = gap - dot(gap, n) * n;
    return dot(miss, miss) <= m_band * m_band;
  }
  // Two edges: the nearest point of their lines, if both edges reach it.
  bool crossing(const Triple& onA, int i, const Triple& onB, int j, const Triple& from, Triple& common) const {
    const Triple& u = m_in.r[j];
    const Triple w = from - onA;  // w + t u - s e_i is orthogonal to both lines
    const Real us[3] = {u.x, u.y, u.z}, ws[3] = {w.x, w.y, w.z}, as[3] = {onA.x, onA.y, onA.z},
               bs[3] = {onB.x, onB.y, onB.z}, halfA[3] = {m_in.hA.x, m_in.hA.y, m_in.hA.z},
               halfB[3] = {m_in.hB.x, m_in.hB.y, m_in.hB.z};
    const Real cosine = us[i], sine2 = dot(u, u) - cosine * cosine;
    if (!(sine2 > kCrossingSine * kCrossingSine)) return false;
    const Real alongA = ws[i], alongB = dot(w, u);
    const Real t = (alongA * cosine - alongB) / sine2, s = alongA + t * cosine;
    const Real placeA = as[i] + s, placeB = bs[j] + t;
    if (!(std::abs(placeA) <= halfA[i] && std::abs(placeB) <= halfB[j])) return false;
    common = {i == 0 ? placeA : onA.x, i == 1 ? placeA : onA.y, i == 2 ? placeA : onA.z};
    const Triple gap = from + t * u - common, miss = gap - dot(gap, m_n) * m_n;
    common = common + Triple(miss.x / 2, miss.y / 2, miss.z / 2);
    return dot(miss, miss) <= m_band * m_band;
  }

  const BoxPair3 m_in;
  const Triple m_n;
  Real m_band;
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
