// SPDX-License-Identifier: Zlib
// Forces: what a user adds, what a world keeps, and what a kind of force is. A kind is one file in algorithms/force/;
// nobody else knows its name.
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

/// What forces may depend on. An integrator may ask about states that no body is in.
template <int D>
struct ForceState {
  const Bodies<D>& bodies;          // masses, types, flags: not its poses and motions
  IndexedSpan<const Pose<D>> pose;  // X_WC by slot
  IndexedSpan<const Motion<D>> motion;
  Real dt = 0;  // s, of the step that is made: a force that brakes stops within it and does not turn round; 0: any
  /// The contacts of the step before, with the impulses of its solver, and how long it took (s): for kinds that say
  /// readsContacts(). They stay the same however often a step asks. None in the first step.
  IndexedSpan<const Manifold<D>> contacts = {};
  Real contactDt = 0;
};

/// Forces of one's own, by code: a save does not hold them. `apply` must be pure: it may be called any number of times
/// per step, at any state.
template <int D>
class ForceGenerator {
 public:
  virtual ~ForceGenerator() = default;
  /// Adds to `out` (by body slot) what acts at time t (s).
  virtual void apply(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const = 0;
};

/// A force as a user adds it, on B: `lpc list --stage force` names kinds and parameters.
template <int D>
struct ForceDef {
  std::string kind = "spring{stiffness=10}";
  Handle bodyA = {};  // whom it comes from, where the kind has such an end; nobody: the world
  Handle bodyB = {};  // nobody: every body that forces move, where the kind can
  /// Where it acts, in the body's own frame, else at its centre of mass; of A in the world where A is nobody, else its
  /// origin.
  std::optional<Vec<D>> anchorA = {}, anchorB = {};
};

template <int D>
class ForceKind;

template <int D>
struct ForceRecord {
  std::shared_ptr<const ForceKind<D>> kind;  // null: a free slot
  std::string spec;                          // the kind with every parameter
  std::int32_t bodyA = -1, bodyB = -1;       // -1: nobody
  std::uint32_t generation = 0;
  Vec<D> localA = Vec<D>::Zero();  // in the centre-of-mass frame; world where A is nobody
  Vec<D> localB = Vec<D>::Zero();
};

/// The ends that a kind of force has.
struct ForceEnds {
  bool from = false;     // comes from A, a body or the world
  bool all = true;       // B may be nobody, which is all
  bool anchors = false;  // acts at points of A and B
};

/// How a kind of force acts. Stateless, but for scratch.
template <int D>
class ForceKind : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::force;
  static constexpr int kDimension = D;

  virtual ForceEnds ends() const = 0;
  /// Whether it asks for ForceState::contacts: an engine that tells of none refuses it then.
  virtual bool readsContacts() const { return false; }
  /// Of a new force, at these poses. Throws UserError when its ends make no such force.
  virtual void begin(const ForceRecord<D>&, const Pose<D>& /*X_WA*/, const Pose<D>& /*X_WB*/) const {}
  /// Adds to `out` (by body slot) what acts at time t (s). Pure, and at any state, as a ForceGenerator's. Whom forces
  /// do not move gets nothing.
  virtual void apply(const ForceRecord<D>& force, const ForceState<D>& state, Real t,
                     std::span<Wrench<D>> out) const = 0;
};

/// The force of a definition between bodies as they are. Throws UserError for an unknown kind or parameter, ends that
/// the kind has not, a body with itself, bodies that forces do not move, and anchors that are not finite. Precondition:
/// handles are of `bodies`, or of nobody.
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
/// f(slot) for each body that the force acts on: B, or all.
template <int D, class F>
void forEachActedOn(const ForceRecord<D>& force, const Bodies<D>& bodies, const F& f) {
  const std::size_t first = force.bodyB < 0 ? 0 : static_cast<std::size_t>(force.bodyB);
  const std::size_t end = force.bodyB < 0 ? bodies.used.size() : first + 1;
  for (std::size_t i = first; i < end; ++i) {
    if (movedByForces(bodies, i)) f(i);
  }
}

/// One end of a force: a point of a body, or of the world for -1.
template <int D>
struct ForceEnd {
  Vec<D> p, arm = Vec<D>::Zero(), v = Vec<D>::Zero();  // world; the arm from the centre of mass
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

/// All forces of a world as a solver or integrator sees them: a pure function of state and time.
template <int D>
class Forces {
 public:
  virtual ~Forces() = default;
  /// Overwrites `out`, one wrench per body slot; zero for bodies that forces do not move.
  virtual void eval(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const = 0;
};

}}  // namespace lpc::LPC_PRECISION
