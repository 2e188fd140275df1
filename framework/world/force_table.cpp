// SPDX-License-Identifier: Zlib
#include "framework/world/force_table.h"

#include <algorithm>
#include <string>
#include <utility>

#include "framework/world/slot_record.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
ForceHandle ForceTable<D>::add(const ForceDef<D>& def, BodyTable<D>& table) {
  for (const BodyHandle& body : {def.bodyA, def.bodyB}) {
    if (body != BodyHandle{}) table.slotOf(body);
  }
  ForceRecord<D> force = makeForce(def, table.bodies);
  const std::size_t i = m_slots.take(table.visits);
  if (i == records.size()) records.emplace_back();
  force.generation = records[i].generation;
  records[i] = std::move(force);
  wakeActedOn(records[i], table);
  return {static_cast<std::int32_t>(i), records[i].generation};
}

template <int D>
void ForceTable<D>::remove(ForceHandle force, BodyTable<D>& table) {
  if (!holdsRecord(records, force)) {
    throw UserError("world: no force has the handle " + std::to_string(force.slot) + " (removed?)");
  }
  const auto i = static_cast<std::size_t>(force.slot);
  wakeActedOn(records[i], table);
  freeRecord(records[i]);
  m_slots.give(i, table.visits);
}

template <int D>
void ForceTable<D>::removeAllOf(std::size_t body, BodyTable<D>& table) {
  const auto slot = static_cast<std::int32_t>(body);
  table.visits += records.size();
  for (std::size_t f = 0; f < records.size(); ++f) {
    const ForceRecord<D>& force = records[f];
    if (!force.kind || (force.bodyA != slot && force.bodyB != slot)) continue;
    remove(ForceHandle{static_cast<std::int32_t>(f), force.generation}, table);
  }
}

template <int D>
void ForceTable<D>::wakeActedOn(const ForceRecord<D>& force, BodyTable<D>& table) {
  forEachActedOn(force, table.bodies, [&](std::size_t body) { table.wake(body); });
  if (force.bodyA >= 0 && movedByForces(table.bodies, static_cast<std::size_t>(force.bodyA))) {
    table.wake(static_cast<std::size_t>(force.bodyA));
  }
}

template <int D>
void ForceTable<D>::clear(std::uint64_t& visits) {
  visits += records.size();
  for (ForceRecord<D>& f : records) {
    if (f.kind) freeRecord(f);
  }
  m_slots.read(records, [](const auto&) { return true; });
  generators.clear();
}

template <int D>
void ForceTable<D>::keepContacts(const std::vector<Manifold<D>>& manifolds) {
  m_lastContacts.clear();
  if (std::none_of(records.begin(), records.end(), [](const auto& f) { return f.kind && f.kind->readsContacts(); })) {
    return;
  }
  m_lastContacts.reserve(manifolds.capacity());  // copying alone would allocate for the current size only
  m_lastContacts.insert(m_lastContacts.end(), manifolds.begin(), manifolds.end());
}

template <int D>
void ForceTable<D>::moveCenter(std::size_t body, const Vec<D>& by, std::uint64_t& visits) {
  const auto slot = static_cast<std::int32_t>(body);
  visits += records.size();
  for (ForceRecord<D>& f : records) {
    if (f.kind && f.bodyA == slot) f.localA -= by;
    if (f.kind && f.bodyB == slot) f.localB -= by;
  }
}

template <int D>
void ForceTable<D>::reassign(std::size_t from, std::size_t into, const Bodies<D>& bodies) {
  const auto a = static_cast<std::int32_t>(into), b = static_cast<std::int32_t>(from);
  const Pose<D> X_AcBc = poseBetween(bodies.pose[into], bodies.pose[from]);
  for (ForceRecord<D>& f : records) {
    if (!f.kind || std::minmax(f.bodyA, f.bodyB) == std::minmax(a, b)) continue;
    if (f.bodyA == b) f.bodyA = a, f.localA = X_AcBc * f.localA;
    if (f.bodyB == b) f.bodyB = a, f.localB = X_AcBc * f.localB;
  }
}

template <int D>
void ForceTable<D>::recount() {
  m_slots.read(records, [](const ForceRecord<D>& f) { return !f.kind; });
}

template <int D>
void StepForces<D>::eval(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Real mass = m_bodies.bodies.mass[i];
    out[i] = m_bodies.userForces[i];
    out[i].force += mass * m_bodies.bodies.gravityScale[i] * m_step.gravity;
  }
  const ForceState<D> known{state.bodies,    state.pose, state.motion, m_step.dt, m_forces.lastContacts(),
                            m_step.contactDt};
  applyForces(std::span<const ForceRecord<D>>(m_forces.records), known, t, out);
  for (const auto& f : m_forces.generators) f->apply(known, t, out);
}

template class ForceTable<2>;
template class ForceTable<3>;
template class StepForces<2>;
template class StepForces<3>;

}}  // namespace lpc::LPC_PRECISION
