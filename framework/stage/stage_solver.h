// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/math/work.h"
#include "framework/problem/contact.h"
#include "framework/problem/contact_graph.h"
#include "framework/problem/force.h"
#include "framework/problem/joint.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

class Profiler;

/// Parts of the model that a scene needs. A stage skips an unneeded part by one branch. All parts on is always correct;
/// an experiment measures the cost of unneeded parts.
struct PhysicsModel {
  bool friction = true;
  bool rotation = true;  // off: no body rotates
  bool restitution = true;
  bool cache = true;  // off: contacts are not kept from step to step
  bool joints = true;
  bool sleeping = true;
  bool continuous = true;  // off: no continuous collision between the poses of two steps
  bool operator==(const PhysicsModel&) const = default;
};

/// Lets a solver request new contacts inside its step. Afterwards `manifolds` and `active` of StepInput are new. The n
/// detections of a step, the one before the solver included, must be dt / n apart: speeds in sleep events rely on this.
class DetectAgain {
 public:
  virtual ~DetectAgain() = default;
  virtual void again() = 0;
};

template <int D>
class VelocityWatcher;

template <int D>
struct StepInput {
  Real dt;                                // s, > 0
  Real lastDt;                            // of the last step, 0 in the first: impulses scale by dt / lastDt
  Real time;                              // at the start of the step, s
  Bodies<D>& bodies;                      // invMass and invInertia are those of this step
  IndexedVector<Manifold<D>>& manifolds;  // sorted; solve only the active manifolds
  IndexedVector<int>& active;             // indices of manifolds that have an active body and were not vetoed
  IndexedSpan<JointRecord<D>> joints;     // by slot; jointRows() gives the rows of active joints
  const Forces<D>& forces;
  DetectAgain& detect;
  const PhysicsModel& model;
  Real restitutionThreshold;  // m/s
  WorkDone& work;
  Profiler& profiler;  // for sub-phases: prepare, warm_start, iterate, integrate, correct, ...
  /// Graph of `manifolds` and `joints`; rebuilt by detect.again().
  const ContactGraph<D>& graph;
  VelocityWatcher<D>* watcher = nullptr;  // gets each velocity problem before it is solved
};

/// Advances the bodies through a step: velocities, positions, impulses. Leaves sleeping and static bodies unchanged,
/// and moves kinematic bodies by their velocity.
template <int D>
class Solver : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::solver;
  static constexpr int kDimension = D;
  virtual void step(const StepInput<D>& in) = 0;
};

/// Converts position errors into target velocities for a velocity resolver, or corrects them after it.
template <int D>
class PositionResolver;

struct GivenProblem;

template <int D>
struct VelocityInput {
  Real dt, lastDt;
  Bodies<D>& bodies;
  IndexedSpan<Manifold<D>> manifolds;
  IndexedSpan<const int> order;  // indices of the manifolds to solve, in solving order
  IndexedSpan<JointRecord<D>> joints;
  const PositionResolver<D>& position;  // bias() is called once per contact and step
  const PhysicsModel& model;
  Real restitutionThreshold;
  WorkDone& work;
  Profiler& profiler;
  /// Velocities before this step's forces, by slot, which determine restitution; otherwise gravity would raise an
  /// elastic ball step by step. Empty: the bodies' current velocities.
  IndexedSpan<const Motion<D>> arrival = {};
  /// Offsets into `order`. Contacts from order[colours[c]] up to, but not including, order[colours[c + 1]] share no
  /// dynamic body. Empty: `order` has no colours.
  IndexedSpan<const int> colours = {};
  /// A matrix that replaces bodies, contacts and joints, for resolvers with AlgorithmInfo::matrixAlone.
  GivenProblem* given = nullptr;
};

/// Receives the velocity problems of a step. A solver without velocity problems never calls it.
template <int D>
class VelocityWatcher {
 public:
  virtual ~VelocityWatcher() = default;
  virtual void see(const VelocityInput<D>& problem) = 0;
};

/// Changes velocities only, so that contacts stop approaching and joints stop drifting. Starts from the impulses in the
/// manifolds and joints, and writes the accumulated impulses back. A method that does not accumulate writes the applied
/// impulses.
template <int D>
class VelocityResolver : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::velocity;
  static constexpr int kDimension = D;
  virtual void solve(const VelocityInput<D>& in) = 0;
};

template <int D>
struct PositionInput {
  Real dt;
  Bodies<D>& bodies;  // poses may be changed, velocities not
  IndexedSpan<Manifold<D>> manifolds;
  IndexedSpan<const int> order;
  IndexedSpan<JointRecord<D>> joints;
  const PhysicsModel& model;
  WorkDone& work;
  Profiler& profiler;
  IndexedSpan<const int> colours = {};  // as in VelocityInput
};

template <int D>
class PositionResolver : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::position;
  static constexpr int kDimension = D;

  /// The normal velocity (m/s, >= 0, separating is positive) that a velocity resolver must reach at a penetrating
  /// contact. Called only with `separation` <= 0. For separation > 0 every resolver uses the same target: see
  /// `contactTarget` in algorithms/solver/rows/contact_rows.h.
  virtual Real bias(Real /*separation*/, Real /*dt*/) const { return 0; }
  /// The rate (1/s) at which a joint's error must shrink: the target velocity is jointBias() times the error (m or
  /// rad).
  virtual Real jointBias(Real /*dt*/) const { return 0; }
  virtual void correct(const PositionInput<D>&) {}
};

template <int D>
struct IntegrateInput {
  Real dt, time;
  Bodies<D>& bodies;  // motion is changed, poses are not
  const Forces<D>& forces;
  const PhysicsModel& model;
  WorkDone& work;
};

/// Integrates the free motion under forces for one step. Writes the new velocities into bodies.motion. Writes into
/// `drift`, by slot, the constant velocity that would move each body from its old to its new pose without contacts. The
/// solver adds the constraints' velocity changes to `drift` and moves the bodies by drift * dt. So `drift` is the new
/// velocity for semi-implicit Euler, the old one for explicit Euler, and a weighted mean for RK4. All integrators work
/// with contacts.
template <int D>
class Integrator : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::integrator;
  static constexpr int kDimension = D;
  virtual void integrate(const IntegrateInput<D>& in, std::span<Motion<D>> drift) = 0;
};

}}  // namespace lpc::LPC_PRECISION
