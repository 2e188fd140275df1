// SPDX-License-Identifier: Zlib
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "framework/body.h"

namespace lpc::inline LPC_PRECISION {

template <int D>
struct Wrench {
  Vec<D> force = Vec<D>::Zero();   // N, world
  Ang<D> torque = Ang<D>::Zero();  // N m, about the centre of mass, world
};

/// What forces may depend on. An integrator may ask about states that no body is in.
template <int D>
struct ForceState {
  const Bodies<D>& bodies;        // masses, types, flags: not its poses and motions
  std::span<const Pose<D>> pose;  // X_WC by slot
  std::span<const Motion<D>> motion;
};

/// Forces of one's own. `apply` must be pure: it may be called any number of times per step, at any state.
template <int D>
class ForceGenerator {
 public:
  virtual ~ForceGenerator() = default;
  /// Adds to `out` (by body slot) what acts at time t (s).
  virtual void apply(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const = 0;
};

/// Linear spring with damper between two bodies, or between a body and a point of the world (bodyA.slot = -1).
template <int D>
class Spring final : public ForceGenerator<D> {
 public:
  Handle bodyA, bodyB;
  Vec<D> localA = Vec<D>::Zero();  // in A's centre-of-mass frame; world when there is no A
  Vec<D> localB = Vec<D>::Zero();
  Real restLength = 0;  // m
  Real stiffness = 0;   // N/m
  Real damping = 0;     // N s/m, along the spring

  void apply(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const override;
};

/// Drag of the 2009 report (9.4.4): force -(linear + quadratic |v|) v on each dynamic body, and the same on its
/// rotation, which is what makes circles stop rolling.
template <int D>
class Drag final : public ForceGenerator<D> {
 public:
  Real linear = Real(0.01);     // N s/m (and N m s)
  Real quadratic = Real(0.01);  // N s^2/m^2 (and N m s^2)

  void apply(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const override;
};

/// All forces of a world as a solver or integrator sees them: a pure function of state and time.
template <int D>
class Forces {
 public:
  virtual ~Forces() = default;
  /// Overwrites `out`, one wrench per body slot; zero for bodies that forces do not move.
  virtual void eval(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const = 0;
};

}  // namespace lpc::inline LPC_PRECISION
