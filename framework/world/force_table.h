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

/// The forces of a world, by slot, and those by code.
template <int D>
class ForceTable {
 public:
  std::vector<ForceRecord<D>> records;                                 // state: what a save holds
  std::vector<std::shared_ptr<const ForceGenerator<D>>> generators{};  // not saved

  /// Throws UserError for a handle of no body and for what makeForce() refuses. The bodies that it acts on wake.
  ForceHandle add(const ForceDef<D>& def, BodyTable<D>& table);
  /// Throws UserError for a handle of no force. The bodies that it acts on wake.
  void remove(ForceHandle force, BodyTable<D>& table);
  void removeAllOf(std::size_t body, BodyTable<D>& table);
  void clear(std::uint64_t& visits);

  /// Keeps the contacts of the step before where a force reads them: a solver changes impulses while it asks for
  /// forces.
  void keepContacts(const std::vector<Manifold<D>>& manifolds);
  std::span<const Manifold<D>> lastContacts() const { return m_lastContacts; }

  // --- bodies that change --------------------------------------------------------------------------------------------
  /// The centre of mass of the body has moved within it.
  void moveCenter(std::size_t body, const Vec<D>& by, std::uint64_t& visits);
  /// Forces of `from` become those of `into`, but for those between the two.
  void handOver(std::size_t from, std::size_t into, const Bodies<D>& bodies);
  /// What is derived, from records that were put here.
  void recount();

 private:
  void wakeActedOn(const ForceRecord<D>& force, BodyTable<D>& table);

  SlotTable m_slots;
  std::vector<Manifold<D>> m_lastContacts;
};

/// What acts in one step: the user's forces of this step, gravity, the table's records and its generators.
template <int D>
class StepForces final : public Forces<D> {
 public:
  struct Step {
    Vec<D> gravity;      // m/s^2
    Real dt = 0;         // s
    Real contactDt = 0;  // s, of the step before
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
