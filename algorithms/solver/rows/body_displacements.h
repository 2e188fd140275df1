// SPDX-License-Identifier: Zlib
#pragma once

#include <array>
#include <span>

#include "framework/math/indexed.h"
#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// Positions of bodies as those at the start of the step and the displacements since, m. Far from the origin a
/// displacement keeps digits that a position has lost. Empty: poses alone.
template <int D>
struct BodyDisplacements {
  IndexedSpan<const Vec<D>> start;
  IndexedSpan<Vec<D>> displacement;

  bool empty() const { return start.empty(); }
  /// Poses of two bodies in a frame with A's start as origin.
  std::array<Pose<D>, 2> pair(const Bodies<D>& bodies, std::int32_t a, std::int32_t b) const {
    return {Pose<D>{displacement[a], bodies.pose[a].q},
            Pose<D>{(start[b] - start[a]) + displacement[b], bodies.pose[b].q}};
  }
};

}}}  // namespace lpc::LPC_PRECISION::solver
