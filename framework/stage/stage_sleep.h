// SPDX-License-Identifier: Zlib
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "framework/math/work.h"
#include "framework/problem/contact.h"
#include "framework/problem/contact_graph.h"
#include "framework/problem/joint.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What may wake a body. Gravity and the scene's own forces wake nobody.
struct SleepEvent {
  enum Kind : std::uint8_t {
    bodyRemoved,   // a body that touched `body` is gone
    userChange,    // a force, velocity or pose was set by the user
    contactBegun,  // speed: of approach
    contactLost,
    separationGrown,  // speed: growth of the separation since the last step, over dt
    jointRemoved      // a joint of `body` and `other` is gone; the number is in saved worlds, so it stays the last
  };
  Kind kind;
  std::int32_t body;   // whom it concerns
  std::int32_t other;  // the other body of the pair, -1 for none
  double speed = 0;    // m/s
};

template <int D>
struct SleepInput {
  Real dt;
  const Bodies<D>& bodies;  // `awake` is the last step's state
  std::span<const Manifold<D>> manifolds;
  std::span<const JointRecord<D>> joints;
  std::span<const SleepEvent> events;
  Real restitutionThreshold;  // m/s
  Vec<D> gravity;             // m/s^2: tells a body that rests from one that is at the top of its flight
  WorkDone& work;
  const ContactGraph<D>& graph;  // of `manifolds` and `joints`
};

/// Decides who is awake, once a step before the solver. Changes `awake` and the two scalars per body; the world zeroes
/// the velocities of those who fall asleep.
template <int D>
class SleepPolicy : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::sleep;
  static constexpr int kDimension = D;
  virtual void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake,
                      std::span<std::array<Real, 2>> memory) = 0;
};

}}  // namespace lpc::LPC_PRECISION
