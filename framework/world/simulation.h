// SPDX-License-Identifier: Zlib
// The interface of a world for trials, directors and recorders. Implemented by `World` and by external engines
// (framework/world/stage_engine.h). Slots, frames and units are those of `Bodies`.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "framework/math/tolerances.h"
#include "framework/problem/contact.h"
#include "framework/problem/force.h"
#include "framework/problem/joint.h"
#include "framework/stage/profiler.h"
#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
Vec<D> defaultGravity() {
  Vec<D> g = Vec<D>::Zero();
  g[1] = Real(-9.81);  // y is up, in 3D too
  return g;
}

template <int D>
struct WorldSettings {
  Vec<D> gravity = defaultGravity<D>();  // m/s^2
  Real restitutionThreshold = kRestitutionThreshold;
  Real margin = kContactMargin;
  PhysicsModel model{};
  MixRules mixing{};
  /// On: contacts of sleeping bodies are made again in each step, as if the bodies were awake. Off: a sleeping pair
  /// keeps the contacts of the step in which it fell asleep. The 2009 engine called this switch `findSleepingContacts`.
  bool sleepingContacts = false;
};

template <int D>
class Simulation {
 public:
  virtual ~Simulation() = default;

  // --- building, at any time between steps ---------------------------------------------------------------------------
  /// Adds a body. All add() throw UserError, with the reason, when the definition is invalid or the simulation does not
  /// support it.
  virtual BodyHandle add(const BodyDef<D>& def) = 0;
  /// Adds a joint. Also throws for a joint from a body to itself, between two bodies that do not move, or with invalid
  /// frames or limits.
  virtual JointHandle add(const JointDef<D>& def) = 0;
  /// Adds a force. Also throws for bodies or anchors that the kind of force does not have or does not allow.
  virtual ForceHandle add(const ForceDef<D>& def) = 0;
  virtual void add(std::shared_ptr<const ForceGenerator<D>> generator) = 0;
  virtual void remove(BodyHandle body) = 0;  // and its joints and forces
  virtual void remove(JointHandle joint) = 0;
  virtual void remove(ForceHandle force) = 0;

  // --- changing bodies by a script, between steps --------------------------------------------------------------------
  // All five throw UserError for an invalid handle and for numbers that are not finite.
  virtual void setPose(BodyHandle body, const Pose<D>& X_WB) = 0;  // of the body frame
  /// Sets the velocity of the centre of mass and the angular velocity. Throws UserError for a static body.
  virtual void setMotion(BodyHandle body, const Motion<D>& motion) = 0;
  /// Applies a force (N) at a world point, or a torque (N m), in the next step only.
  virtual void applyForce(BodyHandle body, const Vec<D>& force, const Vec<D>& point) = 0;
  virtual void applyTorque(BodyHandle body, const Ang<D>& torque) = 0;
  /// Changes velocities immediately, by an impulse (N s) at the centre of mass and an angular impulse (N m s) about it.
  /// Has no effect on bodies that are not dynamic; a pinned body takes only the angular impulse.
  virtual void applyImpulse(BodyHandle body, const Wrench<D>& impulse) = 0;

  // --- running -------------------------------------------------------------------------------------------------------
  /// Advances by dt seconds. Only this call is timed. dt = 0 changes nothing. Throws UserError when dt is negative or
  /// not finite.
  virtual void step(Real dt) = 0;
  virtual long stepCount() const = 0;
  virtual Real time() const = 0;    // s
  virtual Real lastDt() const = 0;  // s, 0 before the first step

  // --- state -------------------------------------------------------------------------------------------------------
  /// Masses and inertias are those of the scene, even when an engine has rounded them internally.
  virtual const Bodies<D>& bodies() const = 0;
  virtual std::span<const ShapeRecord<D>> shapes() const = 0;
  virtual std::span<const JointRecord<D>> joints() const = 0;
  virtual std::span<const ForceRecord<D>> forces() const = 0;
  /// Empty when the engine does not report contacts.
  virtual std::optional<std::span<const Manifold<D>>> contacts() const = 0;
  virtual const WorldSettings<D>& settings() const = 0;
  virtual int bodyCount() const = 0;
  virtual bool valid(BodyHandle body) const = 0;
  virtual Pose<D> pose(BodyHandle body) const = 0;  // X_WB, of the body frame
  virtual Profiler& profiler() = 0;                 // counts and times of the last step
  /// 64-bit hash of all poses and velocities, bit by bit: equal for equal histories.
  virtual std::uint64_t hash() const = 0;
};

}}  // namespace lpc::LPC_PRECISION
