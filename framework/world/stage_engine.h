// SPDX-License-Identifier: Zlib
#pragma once

#include <memory>
#include <string>

#include "framework/stage/registry.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A whole engine of other people's, where a pipeline of stages stands: "engine=bullet{iterations=10}". What scenes say
/// is set as our worlds have it: masses, sizes, friction and its mixing, restitution with its threshold, gravity, dt,
/// no sleep, no continuous collision.
template <int D>
class Engine : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::engine;
  static constexpr int kDimension = D;

  /// An empty simulation. Throws UserError, with the reason, where this build or this precision has none.
  virtual std::unique_ptr<Simulation<D>> start(const WorldSettings<D>& settings) const = 0;
  /// What cannot be set as our worlds have it: one line, which stands beside the engine's rank.
  virtual std::string differences() const = 0;
};

/// What an engine's simulation may be besides: one whose gravity changes while it goes on.
template <int D>
class ChangesGravity {
 public:
  virtual ~ChangesGravity() = default;
  /// Of all bodies, from now on (m/s^2). Throws UserError for what is not finite.
  virtual void setGravity(const Vec<D>& gravity) = 0;
};

/// Of a world of ours, or of an engine that can. Throws UserError, with the reason.
template <int D>
void changeGravity(Simulation<D>& simulation, const Vec<D>& gravity);

}}  // namespace lpc::LPC_PRECISION
