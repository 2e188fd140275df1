// SPDX-License-Identifier: Zlib
// What the adapters of the witnesses share: which kinds a library answers, and its answers in our conventions.
#pragma once

#include <array>
#include <limits>
#include <string_view>

#include "framework/stage_narrowphase.h"

namespace lpc::inline LPC_PRECISION {

/// Which pairs of kinds a library really answers ('x'), by ShapeKind, a <= b. A library that lacks a pair may pass over
/// it in silence (FCL prints a warning and calls the shapes apart), so nothing is asked that is not in its table.
struct KindTable {
  std::array<std::string_view, kShapeKinds> rows;

  constexpr bool has(ShapeKind a, ShapeKind b) const {
    const std::string_view row = rows[static_cast<std::size_t>(a)];
    return static_cast<std::size_t>(b) < row.size() && row[static_cast<std::size_t>(b)] == 'x';
  }
};

/// Every pair of the kinds that exist in 3D; a segment does not.
//                                        sphere capsule segment box polytope cylinder ellipsoid
inline constexpr KindTable kAllKinds = {{"xx-xxxx",    // sphere
                                         ".x-xxxx",    // capsule
                                         "..-----",    // segment
                                         "...xxxx",    // box
                                         "....xxx",    // polytope
                                         ".....xx",    // cylinder
                                         "......x"}};  // ellipsoid

/// The answer of a library that says "apart" and no more. Where the cores alone were asked and a rounding lies around
/// them, that is no answer: refused.
inline PairAnswer<3> apartAnswer(double rounding) {
  PairAnswer<3> answer;
  if (rounding > 0) return answer;
  answer.status = QueryStatus::degenerate;  // the side is all there is
  answer.distance = std::numeric_limits<Real>::min();
  return answer;
}

/// Depth of the cores along the unit normal n_AB, with the point half-way between their deepest points.
inline PairAnswer<3> depthAnswer(double depth, const Eigen::Vector3d& normal, const Eigen::Vector3d& middle,
                                 double roundingA, double roundingB) {
  PairAnswer<3> answer;
  answer.status = QueryStatus::converged;
  answer.distance = static_cast<Real>(-depth - roundingA - roundingB);
  answer.normal = normal.cast<Real>();
  answer.pA = (middle + (depth / 2 + roundingA) * normal).cast<Real>();
  answer.pB = (middle - (depth / 2 + roundingB) * normal).cast<Real>();
  return answer;
}

}  // namespace lpc::inline LPC_PRECISION
