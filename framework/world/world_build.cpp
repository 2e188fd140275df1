// SPDX-License-Identifier: Zlib
// What a world is built of: bodies with their shapes, joints, and forces. A definition is checked as a whole before
// anything changes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "framework/math/inverse_inertia.h"
#include "framework/math/user_numbers.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
bool isFinite(const MassProperties<D>& m) {
  return std::isfinite(m.mass) && m.center.allFinite() && m.inertia.allFinite();
}

template <int D>
void checkShape(const ShapeDef<D>& s, const std::string& who) {
  checkPose(s.X_BS, who + ", shape");
  checkAmount(s.density, who, "density");
  checkAmount(s.friction, who, "friction");
  checkAmount(s.restitution, who, "restitution");
}

template <int D>
void checkGivenMass(const MassProperties<D>& m, const std::string& who) {
  checkAmount(m.mass, who, "the mass (kg)");
  if (!m.center.allFinite() || !m.inertia.allFinite()) throw UserError(who + ": its centre or inertia is not finite");
  if (isInertia(m.inertia)) return;
  throw UserError(who + ": no body has such an inertia; valid: " +
                  (D == 2 ? "a number >= 0"
                          : "a symmetric matrix whose principal values are >= 0, none above the sum of the others"));
}

}  // namespace

template <int D>
std::size_t World<D>::freeBodySlot() {
  auto& b = m_bodies;
  const std::size_t i = m_bodySlots.take(m_visits);
  if (i < b.used.size()) return i;
  b.pose.emplace_back(), b.motion.emplace_back(), b.center.emplace_back(Vec<D>::Zero());
  b.invMass.push_back(0), b.mass.push_back(0);
  b.invInertia.push_back(Inertia<D>::Zero()), b.invInertiaBody.push_back(Inertia<D>::Zero());
  b.type.push_back(BodyType::fixed);
  b.used.push_back(0), b.awake.push_back(0), b.canSleep.push_back(0), b.pinned.push_back(0), b.rotatable.push_back(0);
  b.gravityScale.push_back(0), b.givenMass.emplace_back();
  b.sleep.push_back({}), b.solver.push_back({}), b.generation.push_back(0), b.userData.push_back(0);
  m_userForces.emplace_back();
  return i;
}

template <int D>
typename World<D>::Weighed World<D>::weigh(const BodyDef<D>& def, std::int32_t inPlaceOf) const {
  const std::string who = def.name.empty() ? "body" : "body '" + def.name + "'";
  checkPose(def.X_WB, who);
  checkMotion(Motion<D>{def.velocity, def.angularVelocity}, who);
  if (!std::isfinite(def.gravityScale)) throw UserError(who + ": the gravity scale is not finite");
  Weighed w;
  w.shapes = def.shapes;
  std::array<bool, kShapeKinds> kinds{};
  for (ShapeDef<D>& s : w.shapes) {
    checkShape(s, who);
    const ShapePart<D> near = centredPart<D>({s.shape, s.X_BS});
    s.shape = near.shape, s.X_BS = near.X_SP;
    const MassProperties<D> part = transformed(massProperties(s.shape, s.density), s.X_BS);
    w.mass = combined(w.mass, part);
    if (!isFinite(part) || !isFinite(w.mass)) {
      throw UserError(who + ": its mass, " + std::to_string(part.mass) +
                      " kg, or its inertia is beyond what numbers hold; valid: smaller ones");
    }
    if (s.shape.isPlane() && def.type != BodyType::fixed) {
      throw UserError(who + ": a plane has no end and cannot move; make the body fixed, or give it a box");
    }
    if (s.shape.surface() && def.type != BodyType::fixed) {
      throw UserError(who + ": a " + (D == 2 ? "chain" : "mesh") +
                      " moves nothing; valid for bodies that move: convex shapes or a compound of them");
    }
    markKinds(s.shape, kinds);
  }
  if (def.mass) {
    checkGivenMass(*def.mass, who);
    w.mass = *def.mass;
  }
  if (def.type == BodyType::dynamic && !(w.mass.mass > 0)) {
    throw UserError(who + ": a dynamic body needs mass; give it one, or a shape with density > 0, or make it fixed");
  }
  if (def.type == BodyType::dynamic) {
    std::optional<Inertia<D>> inverse = Inertia<D>(Inertia<D>::Zero());
    if (def.rotatable && w.mass.inertia.trace() > 0) inverse = inverseInertia<D>(w.mass.inertia);
    if (!std::isfinite(1 / w.mass.mass) || !inverse) {
      char kilograms[32];
      std::snprintf(kilograms, sizeof kilograms, "%g", double(w.mass.mass));
      throw UserError(who + ": its mass, " + kilograms +
                      " kg, or its inertia has no inverse that numbers hold; valid: larger ones");
    }
    w.invInertia = *inverse;
  }
  std::array<int, kShapeKinds> others = m_kindCount;
  if (inPlaceOf >= 0) {
    for (const std::int32_t s : m_shapesOf.of(static_cast<std::size_t>(inPlaceOf))) {
      forParts(m_shapes[static_cast<std::size_t>(s)].shape, Pose<D>{},
               [&](const ShapeView<D>& v, const auto&) { --others[static_cast<std::size_t>(v.kind)]; });
    }
  }
  for (std::size_t k = 0; k < kShapeKinds; ++k) kinds[k] = kinds[k] || others[k] > 0;
  requireStages(m_stages, m_pipeline, kinds, who + ": ");
  return w;
}

template <int D>
void World<D>::requireStages(const StageSet<D>& stages, const Pipeline& pipeline,
                             const std::array<bool, kShapeKinds>& kinds, const std::string& who) const {
  requireContacts(stages.template get<ContactGenerator<D>>(), kinds,
                  who + "contacts=" + pipeline[StageKind::contacts].name);
  if (!m_settings.features.continuous) return;
  requireCasts(stages.template get<ContinuousCollision<D>>(), kinds,
               who + "continuous=" + pipeline[StageKind::continuous].name);
}

// All of a body but its shapes, where it is and how it moves.
template <int D>
void World<D>::write(std::size_t i, const BodyDef<D>& def, const Weighed& weighed) {
  auto& b = m_bodies;
  const bool dynamic = def.type == BodyType::dynamic;
  b.used[i] = 1, b.type[i] = def.type;
  b.awake[i] = def.awake || !dynamic, b.canSleep[i] = def.canSleep && dynamic, b.pinned[i] = def.pinned;
  b.rotatable[i] = def.rotatable, b.gravityScale[i] = def.gravityScale, b.givenMass[i] = def.mass;
  b.center[i] = weighed.mass.center;
  b.mass[i] = dynamic ? weighed.mass.mass : Real(0);
  b.invInertiaBody[i] = weighed.invInertia;
  b.sleep[i] = {}, b.solver[i] = {}, b.userData[i] = def.userData;
}

template <int D>
Handle World<D>::add(const BodyDef<D>& def) {
  const Weighed weighed = weigh(def, -1);
  const std::size_t i = freeBodySlot();
  write(i, def, weighed);
  auto& b = m_bodies;
  b.pose[i] = {def.X_WB * b.center[i], def.X_WB.q};
  b.motion[i] = def.type == BodyType::fixed ? Motion<D>{} : Motion<D>{def.velocity, def.angularVelocity};
  m_userForces[i] = {};
  for (std::size_t s = 0; s < weighed.shapes.size(); ++s) {
    putShape(weighed.shapes[s], static_cast<std::int32_t>(i), static_cast<std::int32_t>(s));
  }
  return handle(static_cast<std::int32_t>(i));
}

template <int D>
void World<D>::countKinds(const Shape<D>& shape, int change) {
  forParts(shape, Pose<D>{},
           [&](const ShapeView<D>& v, const auto&) { m_kindCount[static_cast<std::size_t>(v.kind)] += change; });
}

template <int D>
void World<D>::fillShape(std::size_t slot, const ShapeDef<D>& def, std::int32_t body, std::int32_t index) {
  const Vec<D>& center = m_bodies.center[static_cast<std::size_t>(body)];
  m_shapes[slot] = {def.shape,    {def.X_BS.p - center, def.X_BS.q},
                    body,         index,
                    def.friction, def.restitution,
                    def.category, def.mask,
                    def.userData, def.density};
}

template <int D>
void World<D>::putShape(const ShapeDef<D>& def, std::int32_t body, std::int32_t index) {
  const std::size_t i = m_shapeSlots.take(m_visits);
  if (i == m_shapes.size()) m_shapes.emplace_back();
  countKinds(def.shape, 1);
  m_fast.forget(i);
  fillShape(i, def, body, index);
  m_shapesOf.add(static_cast<std::size_t>(body), i, m_visits);
  m_boxes.add(i, m_shapes[i]);
}

template <int D>
void World<D>::freeShape(std::size_t slot) {
  countKinds(m_shapes[slot].shape, -1);
  m_shapesOf.remove(static_cast<std::size_t>(m_shapes[slot].body), slot, m_visits);
  m_shapes[slot] = ShapeRecord<D>{};
  m_shapeSlots.give(slot, m_visits);
  m_boxes.remove(slot);
}

template <int D>
void World<D>::remove(Handle body) {
  const std::size_t i = slotOf(body);
  const std::int32_t slot = body.slot;
  m_visits += m_manifolds.size() + m_records.size() + m_forces.size();
  endContacts([&](const auto& pair) { return pair.bodyA == slot || pair.bodyB == slot ? slot : -1; });
  while (!m_shapesOf.of(i).empty()) freeShape(static_cast<std::size_t>(m_shapesOf.of(i).back()));
  while (!m_jointsOf.of(i).empty()) {  // from the end of the list: else each would move all behind it
    const std::int32_t j = m_jointsOf.of(i).back();
    remove(JointHandle{j, m_joints[static_cast<std::size_t>(j)].generation});
  }
  for (std::size_t f = 0; f < m_forces.size(); ++f) {
    const ForceRecord<D>& force = m_forces[f];
    if (!force.kind || (force.bodyA != slot && force.bodyB != slot)) continue;
    remove(ForceHandle{static_cast<std::int32_t>(f), force.generation});
  }
  std::erase_if(m_events, [&](const SleepEvent& e) { return e.body == slot; });
  if (i < m_bodyListeners.size()) m_bodyListeners[i].clear();
  freeBody(i);
  m_bodySlots.give(i, m_visits);
}

template <int D>
void World<D>::freeBody(std::size_t i) {
  auto& b = m_bodies;
  b.pose[i] = {}, b.motion[i] = {}, b.invMass[i] = b.mass[i] = 0, b.center[i] = Vec<D>::Zero();
  b.invInertia[i] = b.invInertiaBody[i] = Inertia<D>::Zero();
  b.type[i] = BodyType::fixed, b.used[i] = b.awake[i] = b.canSleep[i] = b.pinned[i] = b.rotatable[i] = 0;
  b.gravityScale[i] = 0, b.givenMass[i].reset();
  b.sleep[i] = {}, b.solver[i] = {}, b.userData[i] = 0, m_userForces[i] = {};
  ++b.generation[i];
}

namespace {

// The slot of a joint or a force: whoever had it, its handle is of nobody now.
template <class Record>
void freeRecord(Record& record) {
  const std::uint32_t next = record.generation + 1;
  record = Record{};
  record.generation = next;
}

}  // namespace

template <int D>
void World<D>::clear() {
  m_visits += m_bodies.used.size() + m_shapes.size() + m_joints.size() + m_forces.size() + m_manifolds.size() +
              m_records.size();
  endContacts([](const auto& pair) { return pair.bodyA; });  // all; whom it would wake goes, too
  m_events.clear();
  for (std::size_t s = 0; s < m_shapes.size(); ++s) {
    if (m_shapes[s].body < 0) continue;
    m_shapes[s] = ShapeRecord<D>{};
    m_boxes.remove(s);
  }
  for (std::size_t i = 0; i < m_bodies.used.size(); ++i) {
    if (m_bodies.used[i]) freeBody(i);
  }
  for (JointRecord<D>& j : m_joints) {
    if (j.kind) freeRecord(j);
  }
  for (ForceRecord<D>& f : m_forces) {
    if (f.kind) freeRecord(f);
  }
  m_kindCount = {};
  m_shapesOf.clear(), m_jointsOf.clear();
  const auto isFree = [](const auto&) { return true; };
  m_bodySlots.read(m_bodies.used, isFree), m_shapeSlots.read(m_shapes, isFree);
  m_jointSlots.read(m_joints, isFree), m_forceSlots.read(m_forces, isFree);
  m_bodyListeners.clear(), m_generators.clear();
  m_pairs.clear();
  m_time = m_lastDt = 0, m_steps = 0;
}

template <int D>
JointHandle World<D>::add(const JointDef<D>& def) {
  const bool toWorld = def.bodyA == Handle{};
  const std::size_t b = slotOf(def.bodyB), a = toWorld ? b : slotOf(def.bodyA);
  const auto moves = [&](std::size_t i) { return m_bodies.type[i] == BodyType::dynamic; };
  if (def.bodyA == def.bodyB) throw UserError("world: a joint needs two bodies, or the world and a body");
  if (!moves(b) && (toWorld || !moves(a))) throw UserError("world: a joint of two bodies that do not move");
  JointRecord<D> j = makeJoint(def, poseOf(m_bodies, def.bodyA.slot), m_bodies.pose[b]);
  j.kind->weigh(j, massBetween(m_bodies, j.bodyA, j.bodyB));
  const std::size_t i = m_jointSlots.take(m_visits);
  if (i == m_joints.size()) m_joints.emplace_back();
  j.generation = m_joints[i].generation;
  m_joints[i] = std::move(j);
  listJoint(i);
  for (const std::int32_t body : {m_joints[i].bodyA, m_joints[i].bodyB}) {  // it may pull at who sleeps
    if (body >= 0 && !m_bodies.awake[static_cast<std::size_t>(body)]) touched(static_cast<std::size_t>(body));
  }
  return {static_cast<std::int32_t>(i), m_joints[i].generation};
}

template <int D>
void World<D>::remove(JointHandle joint) {
  const auto i = static_cast<std::size_t>(joint.slot);
  if (joint.slot < 0 || i >= m_joints.size() || !m_joints[i].kind || m_joints[i].generation != joint.generation) {
    throw UserError("world: there is no joint with handle " + std::to_string(joint.slot) + " (removed?)");
  }
  releaseJoint(m_joints[i]);
  unlistJoint(i);
  freeRecord(m_joints[i]);
  m_jointSlots.give(i, m_visits);
}

template <int D>
void World<D>::listJoint(std::size_t slot) {
  if (!m_joints[slot].kind) return;
  for (const std::int32_t body : {m_joints[slot].bodyA, m_joints[slot].bodyB}) {
    if (body >= 0) m_jointsOf.add(static_cast<std::size_t>(body), slot, m_visits);
  }
}
template <int D>
void World<D>::unlistJoint(std::size_t slot) {
  for (const std::int32_t body : {m_joints[slot].bodyA, m_joints[slot].bodyB}) {
    if (body >= 0) m_jointsOf.remove(static_cast<std::size_t>(body), slot, m_visits);
  }
}

template <int D>
void World<D>::releaseJoint(const JointRecord<D>& joint) {
  if (joint.broken) return;  // it was told then
  if (joint.bodyA >= 0) m_events.push_back({SleepEvent::jointRemoved, joint.bodyA, joint.bodyB});
  m_events.push_back({SleepEvent::jointRemoved, joint.bodyB, joint.bodyA});
}

template <int D>
void World<D>::breakJoint(std::size_t slot) {
  JointRecord<D>& j = m_joints[slot];
  LPC_ASSERT(j.active());
  releaseJoint(j);
  j.broken = 1, j.impulse.fill(0);
}

template <int D>
ForceHandle World<D>::add(const ForceDef<D>& def) {
  for (const Handle& body : {def.bodyA, def.bodyB}) {
    if (body != Handle{}) slotOf(body);
  }
  ForceRecord<D> force = makeForce(def, m_bodies);
  const std::size_t i = m_forceSlots.take(m_visits);
  if (i == m_forces.size()) m_forces.emplace_back();
  force.generation = m_forces[i].generation;
  m_forces[i] = std::move(force);
  wakeActedOn(m_forces[i]);
  return {static_cast<std::int32_t>(i), m_forces[i].generation};
}

template <int D>
void World<D>::remove(ForceHandle force) {
  const auto i = static_cast<std::size_t>(force.slot);
  if (force.slot < 0 || i >= m_forces.size() || !m_forces[i].kind || m_forces[i].generation != force.generation) {
    throw UserError("world: there is no force with handle " + std::to_string(force.slot) + " (removed?)");
  }
  wakeActedOn(m_forces[i]);
  freeRecord(m_forces[i]);
  m_forceSlots.give(i, m_visits);
}

template <int D>
void World<D>::wakeActedOn(const ForceRecord<D>& force) {
  const auto wakes = [&](std::size_t body) {
    if (!m_bodies.awake[body]) touched(body);
  };
  forEachActedOn(force, m_bodies, wakes);
  if (force.bodyA >= 0 && movedByForces(m_bodies, static_cast<std::size_t>(force.bodyA))) {
    wakes(static_cast<std::size_t>(force.bodyA));
  }
}

// Whole turns are counted, and what was too much breaks.
template <int D>
void World<D>::finishJoints(Real dt) {
  JointRows<D> rows;
  for (std::size_t i = 0; i < m_joints.size(); ++i) {
    JointRecord<D>& j = m_joints[i];
    if (!j.active()) continue;
    j.kind->finish(j, poseOf(m_bodies, j.bodyA), poseOf(m_bodies, j.bodyB));
    if (!std::isfinite(j.breakForce) && !std::isfinite(j.breakTorque)) continue;
    // Who sleeps keeps the impulses of an earlier step, which may have been longer.
    if (!m_bodies.active(j.bodyB) && (j.bodyA < 0 || !m_bodies.active(j.bodyA))) continue;
    jointRows(j, m_bodies, rows);
    const JointLoad load = jointLoad(rows.all(), std::span<const Real>(j.impulse), dt);
    if (load.force <= j.breakForce && load.torque <= j.breakTorque) continue;
    breakJoint(i);
  }
}

// The members of this file; the class as a whole is instantiated in world.cpp.
#define LPC_INSTANTIATE(D)                                                                                         \
  template std::size_t World<D>::freeBodySlot();                                                                   \
  template typename World<D>::Weighed World<D>::weigh(const BodyDef<D>&, std::int32_t) const;                      \
  template void World<D>::write(std::size_t, const BodyDef<D>&, const Weighed&);                                   \
  template void World<D>::requireStages(const StageSet<D>&, const Pipeline&, const std::array<bool, kShapeKinds>&, \
                                        const std::string&) const;                                                 \
  template void World<D>::fillShape(std::size_t, const ShapeDef<D>&, std::int32_t, std::int32_t);                  \
  template void World<D>::freeShape(std::size_t);                                                                  \
  template Handle World<D>::add(const BodyDef<D>&);                                                                \
  template void World<D>::countKinds(const Shape<D>&, int);                                                        \
  template void World<D>::putShape(const ShapeDef<D>&, std::int32_t, std::int32_t);                                \
  template void World<D>::remove(Handle);                                                                          \
  template void World<D>::freeBody(std::size_t);                                                                   \
  template void World<D>::clear();                                                                                 \
  template JointHandle World<D>::add(const JointDef<D>&);                                                          \
  template void World<D>::listJoint(std::size_t);                                                                  \
  template void World<D>::unlistJoint(std::size_t);                                                                \
  template void World<D>::remove(JointHandle);                                                                     \
  template ForceHandle World<D>::add(const ForceDef<D>&);                                                          \
  template void World<D>::remove(ForceHandle);                                                                     \
  template void World<D>::wakeActedOn(const ForceRecord<D>&);                                                      \
  template void World<D>::breakJoint(std::size_t);                                                                 \
  template void World<D>::finishJoints(Real)
LPC_INSTANTIATE(2);
LPC_INSTANTIATE(3);
#undef LPC_INSTANTIATE

}}  // namespace lpc::LPC_PRECISION
