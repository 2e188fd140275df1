// SPDX-License-Identifier: Zlib
// Forces: how a user defines one, the data that a world stores, and the interface of a kind of force. A kind is one
// file in algorithms/force/; no other code uses its name.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/problem/contact.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct Wrench {
  Vec<D> force = Vec<D>::Zero();   // N, world
  Ang<D> torque = Ang<D>::Zero();  // N m, about the centre of mass, world
};

/// The state on which forces may depend. An integrator may evaluate forces at trial states.
template <int D>
struct ForceState {
  const Bodies<D>& bodies;          // masses, types and flags; for poses and motions read the members below
  IndexedSpan<const Pose<D>> pose;  // X_WC by slot
  IndexedSpan<const Motion<D>> motion;
  Real dt = 0;  // s, length of the step, in which a braking force must not reverse the motion; 0: any length
  /// The contacts of the last step with their impulses, and the length of that step (s), for kinds with
  /// readsContacts(). They do not change during a step. Empty in the first step.
  IndexedSpan<const Manifold<D>> contacts = {};
  Real contactDt = 0;
};

/// A user's own force in code; not saved. `apply` must be pure: it may be called any number of times per step, at any
/// state.
template <int D>
class ForceGenerator {
 public:
  virtual ~ForceGenerator() = default;
  /// Adds the forces at time t (s) to `out`, by body slot.
  virtual void apply(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const = 0;
};

/// A force as a user adds it, acting on B. `lpc list --stage force` lists kinds and parameters.
template <int D>
struct ForceDef {
  std::string kind = "spring{stiffness=10}";
  BodyHandle bodyA = {};  // the source, for kinds that have one; none: the world
  BodyHandle bodyB = {};  // none: every body moved by forces, for kinds that allow it
  /// Points in the body frames at which the force acts; default: the centre of mass. When A is the world, anchorA is a
  /// point in the world; default: its origin.
  std::optional<Vec<D>> anchorA = {}, anchorB = {};
};

template <int D>
class ForceKind;

template <int D>
struct ForceRecord {
  std::shared_ptr<const ForceKind<D>> kind;  // null: a free slot
  std::string spec;                          // the kind with every parameter
  std::int32_t bodyA = -1, bodyB = -1;       // -1: none
  std::uint32_t generation = 0;
  Vec<D> localA = Vec<D>::Zero();  // in the centre-of-mass frame; in the world when A is the world
  Vec<D> localB = Vec<D>::Zero();
};

/// The ends that a kind of force has.
struct ForceEnds {
  bool from = false;     // has a source A, a body or the world
  bool all = true;       // B may be none, which means all bodies
  bool anchors = false;  // acts at points of A and B
};

/// A kind of force. Stateless except for scratch memory.
template <int D>
class ForceKind : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::force;
  static constexpr int kDimension = D;

  virtual ForceEnds ends() const = 0;
  /// True when the kind reads ForceState::contacts. An engine that does not report contacts then rejects the force.
  virtual bool readsContacts() const { return false; }
  /// Called for a new force, with the current poses. Throws UserError when its ends are invalid for this kind.
  virtual void begin(const ForceRecord<D>&, const Pose<D>& /*X_WA*/, const Pose<D>& /*X_WB*/) const {}
  /// Adds the force at time t (s) to `out`, by body slot. Must be pure, and valid at any state, like
  /// ForceGenerator::apply. Adds nothing for bodies that forces do not move.
  virtual void apply(const ForceRecord<D>& force, const ForceState<D>& state, Real t,
                     std::span<Wrench<D>> out) const = 0;
};

/// Makes the record of a force from its definition. Throws UserError for an unknown kind or parameter, missing or
/// invalid ends, a force from a body to itself, bodies that forces do not move, and anchors that are not finite.
/// Precondition: handles are of `bodies`, or empty.
template <int D>
ForceRecord<D> makeForce(const ForceDef<D>& def, const Bodies<D>& bodies);

template <int D>
void applyForces(std::span<const ForceRecord<D>> forces, const ForceState<D>& state, Real t, std::span<Wrench<D>> out) {
  for (const ForceRecord<D>& f : forces) {
    if (f.kind) f.kind->apply(f, state, t, out);
  }
}
template <int D>
bool movedByForces(const Bodies<D>& bodies, AnyIndex auto body) {
  return bodies.used[body] && bodies.type[body] == BodyType::dynamic;
}
/// Calls f(slot) for each body on which the force acts: B, or all bodies.
template <int D, class F>
void forEachActedOn(const ForceRecord<D>& force, const Bodies<D>& bodies, const F& f) {
  const std::size_t first = force.bodyB < 0 ? 0 : static_cast<std::size_t>(force.bodyB);
  const std::size_t end = force.bodyB < 0 ? bodies.used.size() : first + 1;
  for (std::size_t i = first; i < end; ++i) {
    if (movedByForces(bodies, i)) f(i);
  }
}

/// One end of a force: a point of a body, or of the world when `body` is -1.
template <int D>
struct ForceEnd {
  Vec<D> p, arm = Vec<D>::Zero(), v = Vec<D>::Zero();  // world; arm is from the centre of mass
  std::int32_t body;

  ForceEnd(const ForceState<D>& state, std::int32_t of, const Vec<D>& local) : p(local), body(of) {
    if (of < 0) return;
    arm = state.pose[of].q * local;
    p = state.pose[of].p + arm;
    v = state.motion[of].v + cross(state.motion[of].w, arm);
  }
  void push(const Vec<D>& force, const Bodies<D>& bodies, IndexedSpan<Wrench<D>> out) const {
    if (body < 0 || !movedByForces(bodies, body)) return;
    Wrench<D>& w = out[body];
    w.force += force, w.torque += cross(arm, force);
  }
};

/// All forces of a world, for a solver or integrator: a pure function of state and time.
template <int D>
class Forces {
 public:
  virtual ~Forces() = default;
  /// Overwrites `out`, one wrench per body slot; zero for bodies that forces do not move.
  virtual void eval(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const = 0;
};

}}  // namespace lpc::LPC_PRECISION
