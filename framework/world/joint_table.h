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

  /// Adds a joint and wakes both bodies. Throws UserError for a joint from a body to itself or between two bodies that
  /// do not move, and when makeJoint() throws.
  JointHandle add(const JointDef<D>& def, BodyTable<D>& table);
  /// Removes a joint. Its bodies get a sleep event, unless the joint was broken before. Throws UserError for an invalid
  /// handle.
  void remove(JointHandle joint, BodyTable<D>& table);
  void removeAllOf(std::size_t body, BodyTable<D>& table);
  /// Breaks a joint, which keeps its slot but has no rows. Precondition: the joint is active.
  void breakJoint(std::size_t slot, std::vector<SleepEvent>& events);
  void clear(std::uint64_t& visits);

  /// Slots of a body's joints, ascending.
  std::span<const std::int32_t> of(std::size_t body) const { return m_of.of(body); }

  /// Call after a step of dt seconds: unwraps angles and breaks overloaded joints.
  void finish(const Bodies<D>& bodies, Real dt, std::vector<SleepEvent>& events);
  /// Unwraps angles without breaking joints, after something other than a step has moved bodies.
  void countTurns(const Bodies<D>& bodies);

  // --- changes of bodies ---------------------------------------------------------------------------------------------
  /// Throws UserError when a joint would connect two bodies that do not move, if this body were made immovable.
  void requireMoving(std::size_t body, BodyTable<D>& table) const;
  /// Updates frames after the centre of mass of the body has moved by `by` within the body.
  void moveCenter(std::size_t body, const Vec<D>& by, std::uint64_t& visits);
  /// Call after the mass of the body has changed.
  void updateMass(std::size_t body, BodyTable<D>& table);
  /// Moves the joints of `from` to `into`, except joints between these two bodies.
  void reassign(std::size_t from, std::size_t into, BodyTable<D>& table);
  /// Recomputes the derived data after the records were replaced.
  void recount(std::uint64_t& visits);

 private:
  void link(std::size_t slot, std::uint64_t& visits);  // adds the joint to the lists of its bodies
  void unlink(std::size_t slot, std::uint64_t& visits);
  static void release(const JointRecord<D>& joint,
                      std::vector<SleepEvent>& events);  // adds a sleep event

  SlotTable m_slots;
  SlotLists m_of;  // by body slot
};

}}  // namespace lpc::LPC_PRECISION
