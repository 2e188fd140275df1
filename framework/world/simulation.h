// SPDX-License-Identifier: Zlib
// What a trial, a director and a recorder need of a world, whoever moves the bodies: our own `World`, or a whole engine
// of other people's (framework/world/stage_engine.h). Slots, frames and units are those of `Bodies`.
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
  Features features{};
  MixRules mixing{};
  /// Contacts of bodies that sleep are made anew in each step, as if these were awake. Off, a sleeping pair keeps those
  /// that it fell asleep with: the switch `findSleepingContacts` of the 2009 engine.
  bool sleepingContacts = false;
};

template <int D>
class Simulation {
 public:
  virtual ~Simulation() = default;

  // --- building, at any time between steps ---------------------------------------------------------------------------
  /// Throw UserError for what makes no sense, and for what this simulation cannot do, with the reason.
  virtual Handle add(const BodyDef<D>& def) = 0;
  /// Also for a body with itself, two that do not move, frames and limits that make no such joint.
  virtual JointHandle add(const JointDef<D>& def) = 0;
  /// Also for ends that the kind has not, or that cannot be its ends.
  virtual ForceHandle add(const ForceDef<D>& def) = 0;
  virtual void add(std::shared_ptr<const ForceGenerator<D>> generator) = 0;
  virtual void remove(Handle body) = 0;  // and its joints and forces
  virtual void remove(JointHandle joint) = 0;
  virtual void remove(ForceHandle force) = 0;

  // --- what a script does to bodies, between steps -------------------------------------------------------------------
  // All five throw UserError for a body that is gone and for numbers that are not finite.
  virtual void setPose(Handle body, const Pose<D>& X_WB) = 0;  // of the body's own frame
  /// Of its centre of mass. Throws UserError for a fixed body.
  virtual void setMotion(Handle body, const Motion<D>& motion) = 0;
  /// A force (N) at a world point, or a torque (N m), for the coming step only.
  virtual void applyForce(Handle body, const Vec<D>& force, const Vec<D>& point) = 0;
  virtual void applyTorque(Handle body, const Ang<D>& torque) = 0;
  /// Changes velocities at once: an impulse (N s) at the centre of mass, and an angular one (N m s) about it. What is
  /// not dynamic takes none, a pinned one no linear part.
  virtual void applyImpulse(Handle body, const Wrench<D>& impulse) = 0;

  // --- running -------------------------------------------------------------------------------------------------------
  /// Advances by dt seconds; this alone is timed. dt = 0 changes nothing. Throws UserError for a dt that is negative or
  /// not finite.
  virtual void step(Real dt) = 0;
  virtual long stepCount() const = 0;
  virtual Real time() const = 0;    // s
  virtual Real lastDt() const = 0;  // s, 0 before the first step

  // --- state -------------------------------------------------------------------------------------------------------
  /// Masses and inertias are the scene's, also where an engine has rounded them for itself.
  virtual const Bodies<D>& bodies() const = 0;
  virtual std::span<const ShapeRecord<D>> shapes() const = 0;
  virtual std::span<const JointRecord<D>> joints() const = 0;
  virtual std::span<const ForceRecord<D>> forces() const = 0;
  /// Nothing where contacts are not told: their impulses and anchors are an engine's own affair.
  virtual std::optional<std::span<const Manifold<D>>> contacts() const = 0;
  virtual const WorldSettings<D>& settings() const = 0;
  virtual int bodyCount() const = 0;
  virtual bool valid(Handle body) const = 0;
  virtual Pose<D> pose(Handle body) const = 0;  // X_WB, of the body's own frame
  virtual Profiler& profiler() = 0;             // counts and times of the last step
  /// 64-bit hash of all poses and velocities, bit by bit: equal for equal histories.
  virtual std::uint64_t hash() const = 0;
};

}}  // namespace lpc::LPC_PRECISION
