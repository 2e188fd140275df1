// SPDX-License-Identifier: Zlib
#pragma once

#include <memory>
#include <string>

#include "framework/stage/registry.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A complete external engine, which replaces a pipeline of stages: "engine=bullet{iterations=10}". Masses, sizes,
/// friction and its mixing, restitution and its threshold, gravity and dt are set as in a World. Sleep and continuous
/// collision are off.
template <int D>
class Engine : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::engine;
  static constexpr int kDimension = D;

  /// Starts an empty simulation. Throws UserError, with the reason, when this build or precision lacks the engine.
  virtual std::unique_ptr<Simulation<D>> start(const WorldSettings<D>& settings) const = 0;
  /// Settings in which the engine differs from a World: one line, shown with the engine's rank.
  virtual std::string differences() const = 0;
};

/// Optional interface of an engine's simulation: it can change gravity during a run.
template <int D>
class ChangesGravity {
 public:
  virtual ~ChangesGravity() = default;
  /// Sets the gravity of all bodies from now on (m/s^2). Throws UserError when it is not finite.
  virtual void setGravity(const Vec<D>& gravity) = 0;
};

/// Sets the gravity of a World, or of an engine with ChangesGravity. Otherwise throws UserError with the reason.
template <int D>
void changeGravity(Simulation<D>& simulation, const Vec<D>& gravity);

}}  // namespace lpc::LPC_PRECISION
