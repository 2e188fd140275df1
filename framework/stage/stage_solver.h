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

/// What a scene needs. What it does not need is skipped by one branch per stage. All on is always right; an experiment
/// measures what each unneeded one costs.
struct Features {
  bool friction = true;
  bool rotation = true;  // off: no body turns
  bool restitution = true;
  bool cache = true;  // off: contacts are forgotten from step to step
  bool joints = true;
  bool sleeping = true;
  bool continuous = true;  // off: nobody looks at what lies between the poses of two steps
  bool operator==(const Features&) const = default;
};

/// Lets a solver ask for fresh contacts inside its step. Afterwards `manifolds` and `active` of StepInput are new.
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
  Real lastDt;                            // of the step before, 0 in the first: impulses scale by dt / lastDt
  Real time;                              // at the start of the step, s
  Bodies<D>& bodies;                      // invInertia is fresh
  IndexedVector<Manifold<D>>& manifolds;  // sorted; solve only the active ones
  IndexedVector<int>& active;             // indices of manifolds that have an active body and were not vetoed
  IndexedSpan<JointRecord<D>> joints;     // by slot; jointRows() gives the rows of those that are active
  const Forces<D>& forces;
  DetectAgain& detect;
  const Features& features;
  Real restitutionThreshold;  // m/s
  WorkDone& work;
  Profiler& profiler;  // for sub-phases: prepare, warm_start, iterate, integrate, correct, ...
  /// Of `manifolds` and `joints`, new after detect.again().
  const ContactGraph<D>& graph;
  VelocityWatcher<D>* watcher = nullptr;  // who is shown each velocity problem before it is solved
};

/// Takes the bodies from the start of a step to its end: velocities, positions, impulses. Sleeping and static bodies
/// are left as they are; kinematic ones are moved by their velocity.
template <int D>
class Solver : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::solver;
  static constexpr int kDimension = D;
  virtual void step(const StepInput<D>& in) = 0;
};

/// Position errors as a velocity resolver sees them, and their repair after it.
template <int D>
class PositionResolver;

struct GivenProblem;

template <int D>
struct VelocityInput {
  Real dt, lastDt;
  Bodies<D>& bodies;
  IndexedSpan<Manifold<D>> manifolds;
  IndexedSpan<const int> order;  // indices of the manifolds to solve, in the order in which to solve them
  IndexedSpan<JointRecord<D>> joints;
  const PositionResolver<D>& position;  // bias() is asked once per contact and step
  const Features& features;
  Real restitutionThreshold;
  WorkDone& work;
  Profiler& profiler;
  /// Velocities before this step's forces, by slot: what a bounce is measured by, or gravity would raise an elastic
  /// ball step by step. Empty: the bodies' own.
  IndexedSpan<const Motion<D>> arrival = {};
  /// Offsets into `order`: contacts from order[colours[c]] to order[colours[c + 1]] share no dynamic body. Empty:
  /// `order` has no colours.
  IndexedSpan<const int> colours = {};
  /// A matrix in the place of bodies, contacts and joints: for those whose info says that they solve it, see
  /// AlgorithmInfo::matrixAlone.
  GivenProblem* given = nullptr;
};

/// Takes velocity problems out of a step. A solver whose method has none shows none.
template <int D>
class VelocityWatcher {
 public:
  virtual ~VelocityWatcher() = default;
  virtual void see(const VelocityInput<D>& problem) = 0;
};

/// Changes velocities only, so that contacts stop approaching and joints stop drifting. Starts from the impulses in the
/// manifolds and joints and writes the accumulated ones back (a method without accumulation writes what it applied).
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
  const Features& features;
  WorkDone& work;
  Profiler& profiler;
  IndexedSpan<const int> colours = {};  // as in VelocityInput
};

template <int D>
class PositionResolver : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::position;
  static constexpr int kDimension = D;

  /// The normal velocity (m/s, separating is positive) that a velocity resolver shall reach at a penetrating contact,
  /// >= 0. `separation` <= 0. What holds for separation > 0 is not a matter of taste: see `contactTarget` in
  /// algorithms/solver/rows/contact_rows.h.
  virtual Real bias(Real /*separation*/, Real /*dt*/) const { return 0; }
  /// The velocity with which a joint's error (m or rad) shall shrink is jointBias() times the error (1/s).
  virtual Real jointBias(Real /*dt*/) const { return 0; }
  virtual void correct(const PositionInput<D>&) {}
};

template <int D>
struct IntegrateInput {
  Real dt, time;
  Bodies<D>& bodies;  // motion is changed, pose is not
  const Forces<D>& forces;
  const Features& features;
  WorkDone& work;
};

/// Free motion under forces for one step. Writes the new velocities into bodies.motion, and into `drift`, by slot, the
/// constant velocity with which each body would travel from its old to its new pose if nothing touched it. The solver
/// then adds to `drift` what the constraints changed and moves the bodies by drift * dt. So semi-implicit Euler returns
/// the new velocity, explicit Euler the old one, RK4 its weighted mean, and all of them serve under contacts.
template <int D>
class Integrator : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::integrator;
  static constexpr int kDimension = D;
  virtual void integrate(const IntegrateInput<D>& in, std::span<Motion<D>> drift) = 0;
};

}}  // namespace lpc::LPC_PRECISION
