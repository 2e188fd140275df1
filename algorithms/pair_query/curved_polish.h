// SPDX-License-Identifier: Zlib
// The last steps to the best direction of a curved pair. The support point is the gradient of the support function, so
// L(n) = n . m(n) (core_pair.h) has the gradient m(n) across n; its change over a small turn is the curvature, and with
// both Newton's step is known. Where M has an edge or a corner there is no curvature, the step is wrong, and not taken.
#pragma once

#include <Eigen/LU>

#include "algorithms/pair_query/core_pair.h"

namespace lpc::inline LPC_PRECISION::pair_query {

/// Newton's step from n, not of unit length.
template <int D>
Vec<D> newtonDirection(const CorePair<D>& pair, const Vec<D>& n, Work& work) {
  // A turn whose square is a rounding of the result, and far above the rounding of a difference of gradients.
  static const Real kTurn = std::sqrt(std::sqrt(kEpsilon)) / 16;
  const auto t = tangents(n);
  const auto gradient = [&](const Vec<D>& direction) {
    work[Count::supportCalls] += 2;
    return Matrix<D - 1, 1>(t.transpose() * pair.support(direction));
  };
  const Matrix<D - 1, 1> g = gradient(n);
  Matrix<D - 1, D - 1> curvature;
  for (int k = 0; k < D - 1; ++k) {
    Vec<D> turned = n + kTurn * t.col(k);
    makeUnit<D>(turned);
    curvature.col(k) = (gradient(turned) - g) / kTurn;
  }
  // At the maximum the curvature is negative; on a ring of maxima it has a zero, which the shift keeps harmless.
  curvature.diagonal().array() -= 64 * kEpsilon / kTurn * curvature.cwiseAbs().maxCoeff();
  return n - t * Matrix<D - 1, 1>(curvature.inverse() * g);
}

/// For a search that ended before its tolerance: steps as long as the bound gets better.
template <int D>
void polishCurved(const CorePair<D>& pair, BestAxis<D>& best, Work& work) {
  constexpr int kMostSteps = 16;
  for (int step = 0; step < kMostSteps; ++step) {
    const Real before = best.bound;
    best.tryDirection(pair, newtonDirection<D>(pair, best.n, work), work);
    if (!(best.bound > before)) return;
  }
}

/// For witnesses: a direction that is off by the root of a rounding gives the right bound, and a support point that is
/// off by that root. Two steps that cost the bound no more than roundings.
template <int D>
void settleCurved(const CorePair<D>& pair, BestAxis<D>& best, Work& work) {
  for (int step = 0; step < 2; ++step) {
    Vec<D> n = newtonDirection<D>(pair, best.n, work);
    if (!makeUnit<D>(n)) return;
    const Real bound = pair.bound(n);
    if (!(bound >= best.bound - 8 * kEpsilon * pair.scale)) return;
    best.n = n, best.bound = std::max(bound, best.bound);
  }
}

}  // namespace lpc::inline LPC_PRECISION::pair_query
