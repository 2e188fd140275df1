// SPDX-License-Identifier: Zlib
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "framework/math/slots.h"
#include "framework/problem/joint.h"
#include "framework/world/body_table.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Stores the joints of a world, by slot and by body. Adds, removes and breaks joints, and updates them when bodies
/// change.
template <int D>
class JointTable {
 public:
  IndexedVector<JointRecord<D>> records;  // state, which a save holds

  /// Adds a joint and wakes both bodies. Throws UserError for a joint from a body to itself, between two bodies that do
  /// not move, and as makeJoint().
  JointHandle add(const JointDef<D>& def, BodyTable<D>& table);
  /// Removes a joint. The bodies get a sleep event, unless the joint was broken. Throws UserError for an invalid
  /// handle.
  void remove(JointHandle joint, BodyTable<D>& table);
  void removeAllOf(std::size_t body, BodyTable<D>& table);
  /// Breaks a joint: it keeps its slot, without rows. Precondition: it is active.
  void breakJoint(std::size_t slot, std::vector<SleepEvent>& events);
  void clear(std::uint64_t& visits);

  /// Slots of a body's joints, ascending.
  std::span<const std::int32_t> of(std::size_t body) const { return m_of.of(body); }

  /// Call after a step of dt seconds: unwraps angles and breaks overloaded joints.
  void finish(const Bodies<D>& bodies, Real dt, std::vector<SleepEvent>& events);
  /// Only unwraps angles, for bodies moved by something other than a step.
  void countTurns(const Bodies<D>& bodies);

  // --- changes of bodies ---------------------------------------------------------------------------------------------
  /// Throws UserError when making this body immovable would leave a joint between two bodies that do not move.
  void requireMoving(std::size_t body, BodyTable<D>& table) const;
  /// Call after the centre of mass of the body has moved by `by` within the body.
  void moveCenter(std::size_t body, const Vec<D>& by, std::uint64_t& visits);
  /// Call after the mass of the body has changed.
  void updateMass(std::size_t body, BodyTable<D>& table);
  /// Moves the joints of `from` to `into`, except joints between the two.
  void reassign(std::size_t from, std::size_t into, BodyTable<D>& table);
  /// Recomputes the derived data after the records were replaced.
  void recount(std::uint64_t& visits);

 private:
  void link(std::size_t slot, std::uint64_t& visits);  // adds it to the lists of its bodies
  void unlink(std::size_t slot, std::uint64_t& visits);
  static void release(const JointRecord<D>& joint, std::vector<SleepEvent>& events);  // adds an event for its bodies

  SlotTable m_slots;
  SlotLists m_of;  // by body slot
};

}}  // namespace lpc::LPC_PRECISION
