// SPDX-License-Identifier: Zlib
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "framework/math/slots.h"
#include "framework/problem/joint.h"
#include "framework/world/body_table.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The joints of a world, by slot and by body: how they come, go, break and follow bodies that change.
template <int D>
class JointTable {
 public:
  IndexedVector<JointRecord<D>> records;  // state: what a save holds

  /// Throws UserError for a body with itself, two that do not move, and what makeJoint() refuses. Both bodies wake.
  JointHandle add(const JointDef<D>& def, BodyTable<D>& table);
  /// Throws UserError for a handle of no joint. The bodies get an event, unless the joint was broken.
  void remove(JointHandle joint, BodyTable<D>& table);
  void removeAllOf(std::size_t body, BodyTable<D>& table);
  /// It stays, without rows. Precondition: it is active.
  void breakJoint(std::size_t slot, std::vector<SleepEvent>& events);
  void clear(std::uint64_t& visits);

  /// Slots of a body's joints, rising.
  std::span<const std::int32_t> of(std::size_t body) const { return m_of.of(body); }

  /// After a step of dt seconds: whole turns are counted, and a joint that bore too much breaks.
  void finish(const Bodies<D>& bodies, Real dt, std::vector<SleepEvent>& events);
  /// Whole turns alone, for bodies that something else has moved.
  void countTurns(const Bodies<D>& bodies);

  // --- bodies that change --------------------------------------------------------------------------------------------
  /// Throws UserError where a body that does not move would leave a joint between two such.
  void requireMoving(std::size_t body, BodyTable<D>& table) const;
  /// The centre of mass of the body has moved within it.
  void moveCenter(std::size_t body, const Vec<D>& by, std::uint64_t& visits);
  /// The mass of the body is another.
  void weigh(std::size_t body, BodyTable<D>& table);
  /// Joints of `from` become those of `into`, but for those between the two.
  void handOver(std::size_t from, std::size_t into, BodyTable<D>& table);
  /// What is derived, from records that were put here.
  void recount(std::uint64_t& visits);

 private:
  void list(std::size_t slot, std::uint64_t& visits);  // by its bodies
  void unlist(std::size_t slot, std::uint64_t& visits);
  static void release(const JointRecord<D>& joint, std::vector<SleepEvent>& events);  // tells its bodies

  SlotTable m_slots;
  SlotLists m_of;  // by body slot
};

}}  // namespace lpc::LPC_PRECISION
