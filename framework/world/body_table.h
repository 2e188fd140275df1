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

/// Stores the bodies and shapes of a world: their slots, the data made from their definitions, and their boxes.
template <int D>
class BodyTable {
 public:
  /// Does not own the broadphase.
  BodyTable(Broadphase<D>& broadphase, Real margin) : boxes(broadphase, margin) {}

  // --- state, which a save holds -------------------------------------------------------------------------------------
  Bodies<D> bodies;
  std::vector<ShapeRecord<D>> shapes;
  std::vector<Wrench<D>> userForces;  // for the coming step, by body slot
  std::vector<SleepEvent> events;     // since the last sleep decision

  // --- derived from the state ----------------------------------------------------------------------------------------
  mutable BoxIndex<D> boxes;  // updated by sync(), when a step or a query needs the boxes
  std::uint64_t visits = 0;   // WorkCount::eventVisits since the last step

  // --- handles and slots ---------------------------------------------------------------------------------------------
  bool valid(BodyHandle body) const {
    const auto i = static_cast<std::size_t>(body.slot);
    return body.slot >= 0 && i < bodies.used.size() && bodies.used[i] && bodies.generation[i] == body.generation;
  }
  std::size_t slotOf(BodyHandle body) const;  // throws UserError for an invalid handle
  BodyHandle handle(std::int32_t slot) const { return {slot, bodies.generation[static_cast<std::size_t>(slot)]}; }
  int count() const { return m_bodySlots.inUse(); }
  std::span<const std::int32_t> shapesOf(std::size_t body) const { return m_shapesOf.of(body); }
  Pose<D> frame(std::size_t body) const {  // X_WB, of the body frame
    const Pose<D>& x = bodies.pose[body];
    return {x.p - x.q * bodies.center[body], x.q};
  }
  /// 64-bit hash of all poses and velocities.
  std::uint64_t hash() const;

  // --- adding, changing and removing bodies --------------------------------------------------------------------------
  std::size_t add(const BodyDef<D>& def, const CheckedBody<D>& checked);
  void remove(std::size_t body);
  void clear();  // bodies added later get the same slots as in a new table
  /// Returns a definition of the body. Adding it to an empty table gives the same body.
  BodyDef<D> definition(std::size_t body) const;

  /// The result of matching a body's present shapes with a new list of shapes.
  struct ShapeMatch {
    std::vector<std::size_t> removed;  // slots of shapes to remove, ascending
    std::vector<std::size_t> kept;     // by index among the new shapes: the matching slot, or kNew
  };
  static constexpr auto kNew = static_cast<std::size_t>(-1);
  ShapeMatch match(std::size_t body, std::span<const ShapeDef<D>> shapes);
  /// Rewrites the body from the definition. Returns the displacement of its centre of mass in the body frame. When
  /// `def` leaves pose or velocity as definition() gave it, the body keeps its rigid motion: bit for bit, unless its
  /// centre of mass moves.
  Vec<D> rewrite(std::size_t body, const BodyDef<D>& def, const CheckedBody<D>& checked, const ShapeMatch& match);

  /// Shape kinds of all convex parts in the table.
  std::array<bool, kShapeKinds> kinds() const;
  /// Shape kinds as in kinds(), with the parts of `checked` in place of those of body `inPlaceOf`; -1: in addition to
  /// all parts.
  std::array<bool, kShapeKinds> kindsWith(const CheckedBody<D>& checked, std::int32_t inPlaceOf) const;

  // --- changes by the user and by a step -----------------------------------------------------------------------------
  /// Marks the body as changed by the user: its boxes are stale, and it wakes.
  void touch(std::size_t body);
  void wake(std::size_t body) {
    if (!bodies.awake[body]) touch(body);
  }
  void wakeAll();
  /// Updates the inverse masses and inertias that a solver uses. With `rotation` false, inertias are not rotated to the
  /// world.
  void refreshMasses(bool rotation);
  /// Zeroes the velocities of bodies that have fallen asleep.
  void stopSleepers(std::span<const std::uint8_t> awakeBefore);

  // --- boxes ---------------------------------------------------------------------------------------------------------
  /// Updates the boxes. With `sleepers`, boxes of sleeping bodies are active too.
  void sync(bool sleepers) const { boxes.sync(shapes, bodies, events, sleepers); }
  /// True when neither of the two shapes of a manifold or record is active.
  template <class Pair>
  bool resting(const Pair& p) const {
    return !boxes.active(p.shapeA) && !boxes.active(p.shapeB);
  }
  /// Rebuilds the boxes for a fresh broadphase.
  void index(Broadphase<D>& broadphase, Real margin);
  /// Recomputes the derived data after the state was replaced. Call index() afterwards.
  void recount();

 private:
  std::size_t takeSlot();
  void freeBody(std::size_t body);  // frees only the slot, not the shapes
  void write(std::size_t body, const BodyDef<D>& def, const CheckedBody<D>& checked);
  void putShape(const ShapeDef<D>& def, std::int32_t body, std::int32_t index);
  void fillShape(std::size_t slot, const ShapeDef<D>& def, std::int32_t body, std::int32_t index);
  void freeShape(std::size_t slot);
  bool sameShape(const ShapeRecord<D>& record, const ShapeDef<D>& def) const;  // same shape at the same place on its
                                                                               // body
  void countKinds(const Shape<D>& shape, int change);

  SlotTable m_bodySlots, m_shapeSlots;
  SlotLists m_shapesOf;                        // by body slot
  std::array<int, kShapeKinds> m_kindCount{};  // of convex parts
};

}}  // namespace lpc::LPC_PRECISION
