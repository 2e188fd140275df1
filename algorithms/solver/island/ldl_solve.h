// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// Returns a^-1 x for a symmetric positive definite a, by L d L^T: without square roots, and without pivoting, which a
/// matrix with mass on its diagonal does not need.
template <int N>
RealMatrix<N, 1> ldlSolve(const RealMatrix<N, N>& a, RealMatrix<N, 1> x) {
  RealMatrix<N, N> l;  // d on its diagonal
  for (int i = 0; i < N; ++i) {
    Real d = a(i, i);
    for (int j = 0; j < i; ++j) {
      Real sum = a(i, j);
      for (int k = 0; k < j; ++k) sum -= l(i, k) * l(j, k) * l(k, k);
      l(i, j) = sum / l(j, j);
      d -= l(i, j) * sum;
    }
    l(i, i) = d;
  }
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < i; ++j) x[i] -= l(i, j) * x[j];
  }
  for (int i = N; i-- > 0;) {
    x[i] /= l(i, i);
    for (int j = i + 1; j < N; ++j) x[i] -= l(j, i) * x[j];
  }
  return x;
}

}}}  // namespace lpc::LPC_PRECISION::solver
