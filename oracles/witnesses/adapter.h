// SPDX-License-Identifier: Zlib
// Shared by the adapters of the witnesses: converts answers to our conventions.
#pragma once

#include <limits>

#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION {

/// For capsules and cylinders along z: ours are along x.
inline Eigen::Matrix3d turnFromZ() {
  Eigen::Matrix3d turn;
  turn << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  return turn;
}

/// The answer of a library that reports separation without a distance. When only the cores were queried and they have a
/// rounding, this is no answer: refused.
template <int D>
PairAnswer<D> apartAnswer(double rounding) {
  PairAnswer<D> answer;
  if (rounding > 0) return answer;
  answer.status = QueryStatus::degenerate;  // only the side is known
  answer.distance = std::numeric_limits<Real>::min();
  return answer;
}

/// Answer from the depth of the cores along the unit normal n_AB, and the midpoint of their deepest points.
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
