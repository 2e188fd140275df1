// SPDX-License-Identifier: Zlib
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "framework/math/indexed.h"
#include "framework/problem/body.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

template <int D>
using InertiaRoot = IndexedArray<double, kAngDim<D> * kAngDim<D>>;

/// L of L L^T = a body's inverse inertia, row by row; zero for an axis about which the body cannot turn.
template <int D>
InertiaRoot<D> rootOfInertia(const Bodies<D>& bodies, std::int32_t body, bool rotation) {
  InertiaRoot<D> l{};
  constexpr int n = kAngDim<D>;
  const auto at = [&](int i, int j) -> double& { return l[i * n + j]; };
  for (int i = 0; i < n && rotation; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = double(bodies.invInertia[body](i, j));
      const double whole = sum;
      for (int k = 0; k < j; ++k) sum -= at(i, k) * at(j, k);
      const bool flat = !(sum > 1e-12 * whole);
      if (i == j) at(i, i) = flat ? 0 : std::sqrt(sum);
      if (i != j) at(i, j) = at(j, j) > 0 ? sum / at(j, j) : 0;
    }
  }
  return l;
}

}}}  // namespace lpc::LPC_PRECISION::solver
