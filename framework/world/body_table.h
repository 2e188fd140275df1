// SPDX-License-Identifier: Zlib
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "framework/math/slots.h"
#include "framework/problem/force.h"
#include "framework/stage/stage_sleep.h"
#include "framework/world/box_index.h"
#include "framework/world/definitions.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The bodies and shapes of a world: which slots they have, what their definitions made of them, and their boxes.
template <int D>
class BodyTable {
 public:
  /// The broadphase is not owned.
  BodyTable(Broadphase<D>& broadphase, Real margin) : boxes(broadphase, margin) {}

  // --- state: what a save holds --------------------------------------------------------------------------------------
  Bodies<D> bodies;
  std::vector<ShapeRecord<D>> shapes;
  std::vector<Wrench<D>> userForces;  // for the coming step, by body slot
  std::vector<SleepEvent> events;     // since the last decision

  // --- derived from it -----------------------------------------------------------------------------------------------
  mutable BoxIndex<D> boxes;  // brought up to date by sync(), when a step or a query needs them
  std::uint64_t visits = 0;   // WorkCount::eventVisits since the last step

  // --- which body ----------------------------------------------------------------------------------------------------
  bool valid(Handle body) const {
    const auto i = static_cast<std::size_t>(body.slot);
    return body.slot >= 0 && i < bodies.used.size() && bodies.used[i] && bodies.generation[i] == body.generation;
  }
  std::size_t slotOf(Handle body) const;  // throws UserError for a handle of no body
  Handle handle(std::int32_t slot) const { return {slot, bodies.generation[static_cast<std::size_t>(slot)]}; }
  int count() const { return m_bodySlots.inUse(); }
  std::span<const std::int32_t> shapesOf(std::size_t body) const { return m_shapesOf.of(body); }
  Pose<D> frame(std::size_t body) const {  // X_WB, of the body's own frame
    const Pose<D>& x = bodies.pose[body];
    return {x.p - x.q * bodies.center[body], x.q};
  }
  /// 64 bits of all poses and velocities.
  std::uint64_t hash() const;

  // --- bodies come, change and go ------------------------------------------------------------------------------------
  std::size_t add(const BodyDef<D>& def, const Weighed<D>& weighed);
  void remove(std::size_t body);
  void clear();  // a body that is added then gets the slot that it has in a new table
  /// Added to an empty table, the same body.
  BodyDef<D> definition(std::size_t body) const;

  /// What becomes of the shapes of a body that gets these.
  struct ShapeMatch {
    std::vector<std::size_t> gone;  // slots, rising
    std::vector<std::size_t> kept;  // slot by number among the new shapes; kNew: a shape that was not there
  };
  static constexpr auto kNew = static_cast<std::size_t>(-1);
  ShapeMatch match(std::size_t body, std::span<const ShapeDef<D>> shapes);
  /// Makes the body what the definition says, and returns how far its centre of mass has moved within it. It keeps its
  /// motion, to the last bit, where `definition` says it was.
  Vec<D> rewrite(std::size_t body, const BodyDef<D>& def, const Weighed<D>& weighed, const ShapeMatch& match);

  /// Kinds of the convex parts of all shapes.
  std::array<bool, kShapeKinds> kinds() const;
  /// The same with a definition's in place of those of a body; -1: beside all that are there.
  std::array<bool, kShapeKinds> kindsWith(const Weighed<D>& weighed, std::int32_t inPlaceOf) const;

  // --- what a user and a step do to them -----------------------------------------------------------------------------
  /// The user has changed the body: its boxes are stale, and it wakes.
  void touch(std::size_t body);
  void wake(std::size_t body) {
    if (!bodies.awake[body]) touch(body);
  }
  void wakeAll();
  /// Masses as a solver uses them. Without rotation no inertia is turned.
  void refreshMasses(bool rotation);
  /// Zeroes the velocities of bodies that have fallen asleep.
  void stopSleepers(std::span<const std::uint8_t> awakeBefore);

  // --- boxes ---------------------------------------------------------------------------------------------------------
  /// With `sleepers` those of sleeping bodies are active, too.
  void sync(bool sleepers) const { boxes.sync(shapes, bodies, sleepers); }
  /// Neither of the shapes of a manifold or a record is active.
  template <class Pair>
  bool resting(const Pair& p) const {
    return !boxes.active(p.shapeA) && !boxes.active(p.shapeB);
  }
  /// Boxes anew, for a broadphase that is fresh: no history is in them.
  void index(Broadphase<D>& broadphase, Real margin);
  /// What is derived, from a state that was put here; index() is to follow.
  void recount();

 private:
  std::size_t takeSlot();
  void freeBody(std::size_t body);  // its row alone
  void write(std::size_t body, const BodyDef<D>& def, const Weighed<D>& weighed);
  void putShape(const ShapeDef<D>& def, std::int32_t body, std::int32_t index);
  void fillShape(std::size_t slot, const ShapeDef<D>& def, std::int32_t body, std::int32_t index);
  void freeShape(std::size_t slot);
  bool sameShape(const ShapeRecord<D>& record, const ShapeDef<D>& def) const;  // in the same place on its body
  void countKinds(const Shape<D>& shape, int change);

  SlotTable m_bodySlots, m_shapeSlots;
  SlotLists m_shapesOf;                        // by body slot
  std::array<int, kShapeKinds> m_kindCount{};  // of convex parts
};

}}  // namespace lpc::LPC_PRECISION
