// SPDX-License-Identifier: Zlib
// The last steps to the best direction of a curved pair. The support point is the gradient of the support function, so
// L(n) = n . m(n) (core_pair.h) has the gradient m(n) across n; its change over a small turn is the curvature, and with
// both Newton's step is known. Where M has an edge or a corner there is no curvature, the step is wrong, and not taken.
#pragma once

#include <Eigen/LU>

#include "algorithms/pair_query/core_pair.h"

namespace lpc::inline LPC_PRECISION::pair_query {

template <int D>
void polishCurved(const CorePair<D>& pair, BestAxis<D>& best, Work& work) {
  constexpr int kMostSteps = 16;
  // A turn whose square is a rounding of the result, and far above the rounding of a difference of gradients.
  static const Real kTurn = std::sqrt(std::sqrt(kEpsilon)) / 16;
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec<D> n = best.n;
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
    const Real shift = 64 * kEpsilon / kTurn * curvature.cwiseAbs().maxCoeff();
    curvature.diagonal().array() -= shift;
    const Real before = best.bound;
    best.tryDirection(pair, Vec<D>(n - t * Matrix<D - 1, 1>(curvature.inverse() * g)), work);
    if (!(best.bound > before)) return;
  }
}

}  // namespace lpc::inline LPC_PRECISION::pair_query
