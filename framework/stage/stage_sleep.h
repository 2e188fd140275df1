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

/// Events that may wake a body. Gravity and the scene's own forces wake no body.
struct SleepEvent {
  enum Kind : std::uint8_t {
    bodyRemoved,   // a body in contact with `body` was removed
    userChange,    // the user has set a force, velocity or pose
    contactBegun,  // speed: approach speed
    contactLost,
    separationGrown,  // speed: growth of the separation since contacts were last made, over that time; of awake bodies
                      // only if they were deeper than the slop
    jointRemoved,     // a joint of `body` and `other` was removed
    bodyAdded         // a new kind goes to the end, because saved worlds contain the number
  };
  Kind kind;
  std::int32_t body;   // the body that may wake
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
  Vec<D> gravity;             // m/s^2: distinguishes a body at rest from one at the top of its flight
  WorkDone& work;
  const ContactGraph<D>& graph;  // of `manifolds` and `joints`
};

/// Decides which bodies are awake, once a step before the solver. Writes `awake`, and `memory`, which holds two scalars
/// per body. The world zeroes the velocities of bodies that fall asleep.
template <int D>
class SleepPolicy : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::sleep;
  static constexpr int kDimension = D;
  virtual void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake,
                      std::span<std::array<Real, 2>> memory) = 0;
};

}}  // namespace lpc::LPC_PRECISION
