// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/problem/body.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Holds velocities to what discrete steps can bear, so that nobody passes through a wall between two of them. Called
/// once a step, before the solver.
template <int D>
class SpeedLimit : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::speedLimit;
  static constexpr int kDimension = D;

  /// Shortens velocities (m/s) of active bodies, and lengthens none.
  virtual void limit(Real dt, Bodies<D>& bodies) = 0;
};

}}  // namespace lpc::LPC_PRECISION
