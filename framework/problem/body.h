// SPDX-License-Identifier: Zlib
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/shape/mass.h"
#include "framework/shape/shape_def.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A public handle: a slot, and the generation of the record in it. Bodies, joints and forces have separate handle
/// types, so that they cannot be confused.
template <class Of>
struct SlotHandle {
  std::int32_t slot = -1;
  std::uint32_t generation = 0;
  bool operator==(const SlotHandle&) const = default;
};
using BodyHandle = SlotHandle<struct OfBody>;
using JointHandle = SlotHandle<struct OfJoint>;
using ForceHandle = SlotHandle<struct OfForce>;

enum class BodyType : std::uint8_t {
  fixed,      // static: never moves, infinite mass (`static` is a C++ keyword)
  kinematic,  // moves with the velocity it was given, infinite mass
  dynamic
};

/// A body as a user adds it. Mass, centre of mass and inertia follow from the shapes and their densities, unless `mass`
/// gives them. A body without shapes has no contacts. With a given mass such a body is a point moved by forces and
/// joints; without a mass it must be static.
template <int D>
struct BodyDef {
  BodyType type = BodyType::dynamic;
  Pose<D> X_WB{};
  Vec<D> velocity = Vec<D>::Zero();         // of the centre of mass, m/s
  Ang<D> angularVelocity = Ang<D>::Zero();  // rad/s, world frame
  bool pinned = false;                      // its centre of mass does not move; the body may rotate
  bool rotatable = true;
  bool canSleep = true;
  bool awake = true;
  std::vector<ShapeDef<D>> shapes = {};
  std::string name = {};       // for messages and displays; may be empty
  std::uint64_t userData = 0;  // the user's own number, as in ShapeDef
  Real gravityScale = 1;       // factor of the world's gravity: 0 floats, negative rises
  /// Replaces the values computed from the shapes; in the body frame. Zero inertia: the body does not rotate. For a
  /// body that is not dynamic only the centre is used.
  std::optional<MassProperties<D>> mass = {};

  /// A static body of one shape: the 2009 engine's createStatic.
  static BodyDef fixed(const ShapeDef<D>& shape, const Pose<D>& X_WB = {}) {
    BodyDef def;
    def.type = BodyType::fixed, def.X_WB = X_WB, def.shapes = {shape};
    return def;
  }
};

/// All bodies, by slot. A free slot has `used` = 0 and zeros elsewhere.
///
/// invMass and invInertia are the values that a solver uses; the world refreshes them before each solve. Both are zero
/// for static, kinematic and sleeping bodies. invInertia is also zero for bodies that may not rotate, invMass for
/// pinned bodies. So a solver needs no branch for these cases.
template <int D>
struct Bodies {
  IndexedVector<Pose<D>> pose;  // X_WC of the centre-of-mass frame C: body axes, origin at the centre of mass
  IndexedVector<Motion<D>> motion;
  IndexedVector<Real> invMass;               // 1/kg
  IndexedVector<Inertia<D>> invInertia;      // world frame, 1/(kg m^2)
  IndexedVector<Real> mass;                  // kg; 0 for static and kinematic bodies
  IndexedVector<Inertia<D>> invInertiaBody;  // body frame; zero for bodies that may not rotate
  IndexedVector<Vec<D>> center;              // p_BC, the centre of mass in the body frame
  IndexedVector<BodyType> type;
  IndexedVector<std::uint8_t> used, awake, canSleep, pinned, rotatable;
  IndexedVector<Real> gravityScale;
  IndexedVector<std::optional<MassProperties<D>>> givenMass;  // given by the user, in the body frame
  IndexedVector<std::array<Real, 2>> sleep;                   // the sleep policy's two scalars
  IndexedVector<std::array<Real, 6>> solver;                  // scratch of the solver; zeros for a new body
  IndexedVector<std::uint32_t> generation;
  IndexedVector<std::uint64_t> userData;

  int size() const { return static_cast<int>(pose.size()); }
  /// True when forces and contacts move the body in this step.
  bool active(int slot) const { return used[slot] && awake[slot] && type[slot] == BodyType::dynamic; }
};

/// All shapes, by slot (= ProxyId).
template <int D>
struct ShapeRecord {
  Shape<D> shape = Shape<D>::sphere(0);
  Pose<D> X_CS{};          // in its body's centre-of-mass frame
  std::int32_t body = -1;  // -1: free slot
  std::int32_t index = 0;  // its index among the body's shapes
  Real friction = 0, restitution = 0;
  std::uint32_t category = 1, mask = ~0u;
  std::uint64_t userData = 0;
  Real density = 0;  // kg/m^D, to recompute the body's mass
};

}}  // namespace lpc::LPC_PRECISION
