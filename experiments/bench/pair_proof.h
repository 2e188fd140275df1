// SPDX-License-Identifier: Zlib
#pragma once

#include <benchmark/benchmark.h>

#include <cmath>
#include <limits>
#include <span>

#include "framework/shape/support_map.h"
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {

inline constexpr Real kProved = sizeof(Real) == 8 ? Real(1e-6) : Real(1e-3);  // m

/// Extent of the shape along a unit direction of its own frame, m. A plane is bounded only along its own normal.
template <int D>
Real reachAlong(const ShapeView<D>& shape, const Vec<D>& n) {
  if (shape.core() != CoreClass::plane) return supportValue(shape, n);
  return 1 - n[1] < kProved ? Real(0) : std::numeric_limits<Real>::infinity();
}

// Separation of the shapes along a unit direction of A's frame: if it equals the answer, it proves the distance.
template <int D>
Real separationAlong(const PairView<D>& pair, const Vec<D>& n) {
  return n.dot(pair.X_AB.p) - reachAlong(pair.a, n) - reachAlong(pair.b, Vec<D>(pair.X_AB.q.inverse() * Vec<D>(-n)));
}

/// An answer is right if the method reports convergence and its own normal proves its distance.
template <int D>
struct PairProof {
  int unfinished = 0, unproved = 0, overlaps = 0;

  void count(std::span<const PairView<D>> pairs, std::span<const PairAnswer<D>> answers) {
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const PairAnswer<D>& answer = answers[k];
      unfinished += answer.status != QueryStatus::converged;
      overlaps += answer.distance < 0;
      const Real error = std::abs(separationAlong(pairs[k], answer.normal) - answer.distance);
      unproved += !(error <= kProved);
    }
  }
  void tell(benchmark::State& state) const {
    state.counters["unfinished"] = unfinished, state.counters["unproved"] = unproved,
    state.counters["overlaps"] = overlaps;
  }
};

}}}  // namespace lpc::LPC_PRECISION::bench
