// SPDX-License-Identifier: Zlib
// What a pair answer can be checked for without the referee: it is finite, and its distance is the separation along its
// normal.
#pragma once

#include <cmath>

#include "framework/stage/stage_narrowphase.h"
#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Null if nothing is wrong. `X_AB` maps B's frame to A's, in which the answer is given. Errors up to 1e-12 of
/// `errorScale` are allowed, as in all accuracy claims in f64.
template <int D>
const char* faultOf(const ShapeView<D>& a, const ShapeView<D>& b, const Pose<D>& X_AB, const PairAnswer<D>& answer) {
  constexpr double kBound = 1e-12;
  if (!std::isfinite(answer.distance) || !answer.normal.allFinite()) return "an answer that is not finite";
  if (answer.status != QueryStatus::converged) return nullptr;
  const double distance = static_cast<double>(answer.distance);
  const double s = errorScale<D>(a, {}, b, X_AB, distance);
  const Vecd<D> n = answer.normal.template cast<double>();
  if (n.isZero()) return nullptr;
  if (!(std::abs(n.norm() - 1) < kBound)) return "a normal that has not unit length";
  const bool along = separationAlong<D>(a, {}, b, X_AB, n).distanceTo(distance) <= kBound * s;
  return along ? nullptr : "a distance that is not the one along its normal";
}

}}  // namespace lpc::LPC_PRECISION
