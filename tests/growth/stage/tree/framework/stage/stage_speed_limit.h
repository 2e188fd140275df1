// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/problem/body.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Limits velocities so that no body passes through a static body between two steps. Called once a step, before the
/// solver.
template <int D>
class SpeedLimit : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::speedLimit;
  static constexpr int kDimension = D;

  /// Reduces velocities (m/s) of active bodies and increases none.
  virtual void limit(Real dt, Bodies<D>& bodies) = 0;
};

}}  // namespace lpc::LPC_PRECISION
