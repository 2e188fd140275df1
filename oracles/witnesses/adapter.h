// SPDX-License-Identifier: Zlib
// What the adapters of the witnesses share: their answers in our conventions.
#pragma once

#include <limits>

#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Of capsules and cylinders that lie along z: ours lie along x.
inline Eigen::Matrix3d turnFromZ() {
  Eigen::Matrix3d turn;
  turn << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  return turn;
}

/// The answer of a library that says "apart" and no more. Where the cores alone were asked and a rounding lies around
/// them, that is no answer: refused.
template <int D>
PairAnswer<D> apartAnswer(double rounding) {
  PairAnswer<D> answer;
  if (rounding > 0) return answer;
  answer.status = QueryStatus::degenerate;  // the side is all there is
  answer.distance = std::numeric_limits<Real>::min();
  return answer;
}

/// Depth of the cores along the unit normal n_AB, with the point half-way between their deepest points.
template <int D>
PairAnswer<D> depthAnswer(double depth, const Eigen::Vector<double, D>& normal, const Eigen::Vector<double, D>& middle,
                          double roundingA, double roundingB) {
  PairAnswer<D> answer;
  answer.status = QueryStatus::converged;
  answer.distance = static_cast<Real>(-depth - roundingA - roundingB);
  answer.normal = normal.template cast<Real>();
  answer.pA = (middle + (depth / 2 + roundingA) * normal).template cast<Real>();
  answer.pB = (middle - (depth / 2 + roundingB) * normal).template cast<Real>();
  return answer;
}

}}  // namespace lpc::LPC_PRECISION
