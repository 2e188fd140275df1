// SPDX-License-Identifier: Zlib
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "framework/math/slots.h"
#include "framework/problem/force.h"
#include "framework/world/body_table.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Stores the forces of a world, by slot, and its force generators.
template <int D>
class ForceTable {
 public:
  std::vector<ForceRecord<D>> records;                                 // state, which a save holds
  std::vector<std::shared_ptr<const ForceGenerator<D>>> generators{};  // not saved

  /// Adds a force and wakes the bodies on which it acts. Throws UserError for an invalid body handle, and when
  /// makeForce() throws.
  ForceHandle add(const ForceDef<D>& def, BodyTable<D>& table);
  /// Removes a force and wakes the bodies on which it acts. Throws UserError for an invalid handle.
  void remove(ForceHandle force, BodyTable<D>& table);
  void removeAllOf(std::size_t body, BodyTable<D>& table);
  void clear(std::uint64_t& visits);

  /// Copies the contacts of the last step when a force reads contacts: the solver changes impulses while it evaluates
  /// forces.
  void keepContacts(const std::vector<Manifold<D>>& manifolds);
  std::span<const Manifold<D>> lastContacts() const { return m_lastContacts; }

  // --- changes of bodies ---------------------------------------------------------------------------------------------
  /// Updates anchors after the centre of mass of the body has moved by `by` within the body.
  void moveCenter(std::size_t body, const Vec<D>& by, std::uint64_t& visits);
  /// Moves the forces of `from` to `into`, except forces between these two bodies.
  void reassign(std::size_t from, std::size_t into, const Bodies<D>& bodies);
  /// Recomputes the derived data after the records were replaced.
  void recount();

 private:
  void wakeActedOn(const ForceRecord<D>& force, BodyTable<D>& table);

  SlotTable m_slots;
  std::vector<Manifold<D>> m_lastContacts;
};

/// Evaluates all forces of one step: the user's forces for this step, gravity, the records of the table, and its
/// generators.
template <int D>
class StepForces final : public Forces<D> {
 public:
  struct Step {
    Vec<D> gravity;      // m/s^2
    Real dt = 0;         // s
    Real contactDt = 0;  // s, of the last step
  };
  StepForces(const BodyTable<D>& bodies, const ForceTable<D>& forces, const Step& step)
      : m_bodies(bodies), m_forces(forces), m_step(step) {}
  void eval(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const override;

 private:
  const BodyTable<D>& m_bodies;
  const ForceTable<D>& m_forces;
  Step m_step;
};

}}  // namespace lpc::LPC_PRECISION
