// SPDX-License-Identifier: Zlib
#include "framework/world/joint_table.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "framework/world/slot_record.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
JointHandle JointTable<D>::add(const JointDef<D>& def, BodyTable<D>& table) {
  const Bodies<D>& bodies = table.bodies;
  const bool toWorld = def.bodyA == BodyHandle{};
  const std::size_t b = table.slotOf(def.bodyB), a = toWorld ? b : table.slotOf(def.bodyA);
  const auto moves = [&](std::size_t i) { return bodies.type[i] == BodyType::dynamic; };
  if (def.bodyA == def.bodyB)
    throw UserError("world: a joint between a body and itself; valid: two bodies, or the world and a body");
  if (!moves(b) && (toWorld || !moves(a)))
    throw UserError("world: a joint between two bodies that cannot move; valid: at least one dynamic body");
  JointRecord<D> j = makeJoint(def, poseOf(bodies, def.bodyA.slot), bodies.pose[b]);
  j.kind->weigh(j, massBetween(bodies, j.bodyA, j.bodyB));
  const std::size_t i = m_slots.take(table.visits);
  if (i == records.size()) records.emplace_back();
  j.generation = records[i].generation;
  records[i] = std::move(j);
  link(i, table.visits);
  for (const std::int32_t body : {records[i].bodyA, records[i].bodyB}) {  // the joint may pull at a sleeping body
    if (body >= 0) table.wake(static_cast<std::size_t>(body));
  }
  return {static_cast<std::int32_t>(i), records[i].generation};
}

template <int D>
void JointTable<D>::remove(JointHandle joint, BodyTable<D>& table) {
  if (!holdsRecord(records, joint)) {
    throw UserError("world: no joint has the handle " + std::to_string(joint.slot) + " (removed?)");
  }
  const auto i = static_cast<std::size_t>(joint.slot);
  release(records[i], table.events);
  unlink(i, table.visits);
  freeRecord(records[i]);
  m_slots.give(i, table.visits);
}

template <int D>
void JointTable<D>::removeAllOf(std::size_t body, BodyTable<D>& table) {
  while (!of(body).empty()) {  // from the end of the list: removing the first would move all others
    const std::int32_t j = of(body).back();
    remove(JointHandle{j, records[static_cast<std::size_t>(j)].generation}, table);
  }
}

template <int D>
void JointTable<D>::release(const JointRecord<D>& joint, std::vector<SleepEvent>& events) {
  if (joint.broken) return;  // its bodies were informed when it broke
  if (joint.bodyA >= 0) events.push_back({SleepEvent::jointRemoved, joint.bodyA, joint.bodyB});
  events.push_back({SleepEvent::jointRemoved, joint.bodyB, joint.bodyA});
}

template <int D>
void JointTable<D>::breakJoint(std::size_t slot, std::vector<SleepEvent>& events) {
  JointRecord<D>& j = records[slot];
  LPC_ASSERT(j.active());
  release(j, events);
  j.broken = 1, j.impulse.fill(0);
}

template <int D>
void JointTable<D>::clear(std::uint64_t& visits) {
  visits += records.size();
  for (JointRecord<D>& j : records) {
    if (j.kind) freeRecord(j);
  }
  m_of.clear();
  m_slots.read(records, [](const auto&) { return true; });
}

template <int D>
void JointTable<D>::link(std::size_t slot, std::uint64_t& visits) {
  for (const std::int32_t body : {records[slot].bodyA, records[slot].bodyB}) {
    if (body >= 0) m_of.add(static_cast<std::size_t>(body), slot, visits);
  }
}
template <int D>
void JointTable<D>::unlink(std::size_t slot, std::uint64_t& visits) {
  for (const std::int32_t body : {records[slot].bodyA, records[slot].bodyB}) {
    if (body >= 0) m_of.remove(static_cast<std::size_t>(body), slot, visits);
  }
}

template <int D>
void JointTable<D>::finish(const Bodies<D>& bodies, Real dt, std::vector<SleepEvent>& events) {
  JointRows<D> rows;
  for (std::size_t i = 0; i < records.size(); ++i) {
    JointRecord<D>& j = records[i];
    if (!j.active()) continue;
    j.kind->finish(j, poseOf(bodies, j.bodyA), poseOf(bodies, j.bodyB));
    if (!std::isfinite(j.breakForce) && !std::isfinite(j.breakTorque)) continue;
    // Skip joints of sleeping bodies: their impulses are from an earlier step, which may have been longer.
    if (!bodies.active(j.bodyB) && (j.bodyA < 0 || !bodies.active(j.bodyA))) continue;
    jointRows(j, bodies, rows);
    const JointLoad load = jointLoad(rows.all(), std::span<const Real>(j.impulse), dt);
    if (load.force <= j.breakForce && load.torque <= j.breakTorque) continue;
    breakJoint(i, events);
  }
}

template <int D>
void JointTable<D>::countTurns(const Bodies<D>& bodies) {
  for (JointRecord<D>& j : records) {
    if (j.active()) j.kind->finish(j, poseOf(bodies, j.bodyA), poseOf(bodies, j.bodyB));
  }
}

template <int D>
void JointTable<D>::requireMoving(std::size_t body, BodyTable<D>& table) const {
  for (const std::int32_t joint : m_of.of(body, table.visits)) {
    const JointRecord<D>& j = records[static_cast<std::size_t>(joint)];
    const std::int32_t other = j.bodyA == static_cast<std::int32_t>(body) ? j.bodyB : j.bodyA;
    if (other >= 0 && table.bodies.type[static_cast<std::size_t>(other)] == BodyType::dynamic) continue;
    throw UserError("change: a joint would remain between two bodies that cannot move; valid: remove the joint first");
  }
}

template <int D>
void JointTable<D>::moveCenter(std::size_t body, const Vec<D>& by, std::uint64_t& visits) {
  for (const std::int32_t joint : m_of.of(body, visits)) {
    JointRecord<D>& j = records[static_cast<std::size_t>(joint)];
    (j.bodyA == static_cast<std::int32_t>(body) ? j.X_CaJ : j.X_CbJ).p -= by;
  }
}

template <int D>
void JointTable<D>::updateMass(std::size_t body, BodyTable<D>& table) {
  for (const std::int32_t joint : m_of.of(body, table.visits)) {
    JointRecord<D>& j = records[static_cast<std::size_t>(joint)];
    j.kind->weigh(j, massBetween(table.bodies, j.bodyA, j.bodyB));
  }
}

template <int D>
void JointTable<D>::reassign(std::size_t from, std::size_t into, BodyTable<D>& table) {
  const auto a = static_cast<std::int32_t>(into), b = static_cast<std::int32_t>(from);
  const Pose<D> X_AcBc = poseBetween(table.bodies.pose[into], table.bodies.pose[from]);
  const std::span<const std::int32_t> joints = m_of.of(from, table.visits);
  for (const std::int32_t joint : std::vector<std::int32_t>(joints.begin(), joints.end())) {
    const auto slot = static_cast<std::size_t>(joint);
    JointRecord<D>& j = records[slot];
    if (std::minmax(j.bodyA, j.bodyB) == std::minmax(a, b)) continue;
    unlink(slot, table.visits);
    (j.bodyA == b ? j.bodyA : j.bodyB) = a;
    Pose<D>& X_CJ = j.bodyA == a ? j.X_CaJ : j.X_CbJ;
    X_CJ = X_AcBc * X_CJ;
    link(slot, table.visits);
  }
}

template <int D>
void JointTable<D>::recount(std::uint64_t& visits) {
  m_slots.read(records, [](const JointRecord<D>& j) { return !j.kind; });
  m_of.clear();
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (records[i].kind) link(i, visits);
  }
}

template class JointTable<2>;
template class JointTable<3>;

}}  // namespace lpc::LPC_PRECISION
