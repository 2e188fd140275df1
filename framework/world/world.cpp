// SPDX-License-Identifier: Zlib
// The user's calls between steps; the world's parts do the work. The step is in world_step.cpp.
#include "framework/world/world.h"

#include <algorithm>
#include <utility>

#include "framework/math/user_numbers.h"
#include "framework/world/saved_state.h"
#include "framework/world/stage_engine.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
World<D>::World(const Pipeline& pipeline, const WorldSettings<D>& settings) : World(StageSet<D>(pipeline), settings) {}

template <int D>
World<D>::World(StageSet<D> stages, const WorldSettings<D>& settings)
    : m_settings(settings), m_stages(std::move(stages)), m_table(stage<Broadphase>(), settings.margin) {
  if (!settings.gravity.allFinite()) throw UserError("world: gravity is not finite");
  checkAmount(settings.margin, "world", "the contact margin");
  checkAmount(settings.restitutionThreshold, "world", "the restitution threshold");
}

template <int D>
World<D>::~World() = default;

template <int D>
Pose<D> World<D>::pose(BodyHandle body) const {
  return m_table.frame(slotOf(body));
}
template <int D>
Motion<D> World<D>::motion(BodyHandle body) const {
  return m_table.bodies.motion[slotOf(body)];
}
template <int D>
Vec<D> World<D>::centerOfMass(BodyHandle body) const {
  return m_table.bodies.pose[slotOf(body)].p;
}
template <int D>
Real World<D>::mass(BodyHandle body) const {
  return m_table.bodies.mass[slotOf(body)];
}
template <int D>
bool World<D>::awake(BodyHandle body) const {
  return m_table.bodies.awake[slotOf(body)] != 0;
}

template <int D>
std::uint64_t World<D>::userData(BodyHandle body) const {
  return m_table.bodies.userData[slotOf(body)];
}
template <int D>
void World<D>::setUserData(BodyHandle body, std::uint64_t data) {
  m_table.bodies.userData[slotOf(body)] = data;
}

template <int D>
void World<D>::setPose(BodyHandle body, const Pose<D>& X_WB) {
  const std::size_t i = slotOf(body);
  checkPose(X_WB, "setPose");
  m_table.bodies.pose[i] = {X_WB * m_table.bodies.center[i], X_WB.q};
  m_table.touch(i);
}
template <int D>
void World<D>::setMotion(BodyHandle body, const Motion<D>& motion) {
  const std::size_t i = slotOf(body);
  checkMotion(motion, "setMotion");
  if (m_table.bodies.type[i] == BodyType::fixed) throw UserError("setMotion: a fixed body has no velocity");
  m_table.bodies.motion[i] = motion;
  m_table.touch(i);
}
template <int D>
void World<D>::applyForce(BodyHandle body, const Vec<D>& force, const Vec<D>& point) {
  const std::size_t i = slotOf(body);
  if (!force.allFinite() || !point.allFinite()) throw UserError("applyForce: force or point is not finite");
  m_table.userForces[i].force += force;
  m_table.userForces[i].torque += cross(point - m_table.bodies.pose[i].p, force);
  m_table.touch(i);
}
template <int D>
void World<D>::applyTorque(BodyHandle body, const Ang<D>& torque) {
  const std::size_t i = slotOf(body);
  if (!torque.allFinite()) throw UserError("applyTorque: the torque is not finite");
  m_table.userForces[i].torque += torque;
  m_table.touch(i);
}
template <int D>
void World<D>::wake(BodyHandle body) {
  m_table.touch(slotOf(body));
}
template <int D>
void World<D>::applyImpulse(BodyHandle body, const Wrench<D>& impulse) {
  const std::size_t i = slotOf(body);
  if (!impulse.force.allFinite() || !impulse.torque.allFinite()) {
    throw UserError("applyImpulse: an impulse is not finite");
  }
  if (m_table.bodies.type[i] != BodyType::dynamic) return;
  if (!m_table.bodies.pinned[i]) m_table.bodies.motion[i].v += impulse.force / m_table.bodies.mass[i];
  if (m_settings.model.rotation) {
    m_table.bodies.motion[i].w +=
        rotateInertia(m_table.bodies.pose[i].q, m_table.bodies.invInertiaBody[i]) * impulse.torque;
  }
  m_table.touch(i);
}

template <int D>
void World<D>::applyImpulse(BodyHandle body, const Vec<D>& impulse, const Vec<D>& point) {
  const std::size_t i = slotOf(body);
  if (!point.allFinite()) throw UserError("applyImpulse: the point is not finite");
  applyImpulse(body, {impulse, cross(Vec<D>(point - m_table.bodies.pose[i].p), impulse)});
}

template <int D>
void World<D>::applyAngularImpulse(BodyHandle body, const Ang<D>& impulse) {
  applyImpulse(body, {Vec<D>::Zero(), impulse});
}

template <int D>
void World<D>::wakeAll() {
  m_table.wakeAll();
}

template <int D>
void World<D>::follow(std::span<const Pose<D>> X_WC, std::span<const Motion<D>> motion) {
  Bodies<D>& b = m_table.bodies;
  LPC_ASSERT(X_WC.size() == b.pose.size() && motion.size() == b.pose.size());
  for (std::size_t i = 0; i < X_WC.size(); ++i) {
    if (b.used[i] && b.type[i] != BodyType::fixed) b.pose[i] = X_WC[i], b.motion[i] = motion[i];
  }
  m_joints.countTurns(b);
  m_table.events.clear();  // no step will decide about sleep
  m_table.boxes.markAllStale();
}

template <int D>
CheckedBody<D> World<D>::checkBody(const BodyDef<D>& def, std::int32_t inPlaceOf) const {
  const CheckedBody<D> checked = lpc::checkBody(def);
  requireStages(m_stages, m_table.kindsWith(checked, inPlaceOf), bodyLabel(def) + ": ");
  return checked;
}

template <int D>
void World<D>::requireStages(const StageSet<D>& stages, const std::array<bool, kShapeKinds>& kinds,
                             const std::string& prefix) const {
  requireContacts(stages.template get<ContactGenerator<D>>(), kinds,
                  prefix + "contacts=" + stages.pipeline()[StageKind::contacts].name);
  if (!m_settings.model.continuous) return;
  requireCasts(stages.template get<ContinuousCollision<D>>(), kinds,
               prefix + "continuous=" + stages.pipeline()[StageKind::continuous].name);
}

// Ends the contacts of a removed body, or of removed shapes. Wakes the other body and informs listeners, which may
// still ask for both bodies' user data. `endedBy` is called for manifolds and records.
template <int D>
template <class EndedBy>
void World<D>::endContacts(const EndedBy& endedBy) {
  m_contacts.end(endedBy, [&](const Manifold<D>& m, std::int32_t body) {
    m_table.events.push_back({SleepEvent::bodyRemoved, m.bodyA == body ? m.bodyB : m.bodyA, body});
    m_listeners.forEach(m, [&](ContactListener<D>& l) { l.end(*this, m); });
  });
}

template <int D>
BodyHandle World<D>::add(const BodyDef<D>& def) {
  const std::size_t i = m_table.add(def, checkBody(def, -1));
  for (const std::int32_t shape : shapesOf(i)) m_continuous.forget(static_cast<std::size_t>(shape));
  return handle(static_cast<std::int32_t>(i));
}

template <int D>
void World<D>::remove(BodyHandle body) {
  const std::size_t i = slotOf(body);
  const std::int32_t slot = body.slot;
  m_table.visits += m_contacts.manifolds.size() + m_contacts.records.size();
  endContacts([&](const auto& pair) { return pair.bodyA == slot || pair.bodyB == slot ? slot : -1; });
  m_joints.removeAllOf(i, m_table);
  m_forces.removeAllOf(i, m_table);
  m_listeners.forget(i);
  m_table.remove(i);
}

template <int D>
void World<D>::clear() {
  m_table.visits += m_contacts.manifolds.size() + m_contacts.records.size();
  endContacts([](const auto& pair) { return pair.bodyA; });  // all; it wakes no body, since all are removed
  m_table.clear();
  m_joints.clear(m_table.visits);
  m_forces.clear(m_table.visits);
  m_listeners.forgetBodies();
  m_contacts.forgetPairs();
  m_time = m_lastDt = m_sinceContacts = 0, m_steps = 0;
}

template <int D>
JointHandle World<D>::add(const JointDef<D>& def) {
  return m_joints.add(def, m_table);
}
template <int D>
void World<D>::remove(JointHandle joint) {
  m_joints.remove(joint, m_table);
}
template <int D>
void World<D>::breakJoint(std::size_t slot) {
  m_joints.breakJoint(slot, m_table.events);
}
template <int D>
ForceHandle World<D>::add(const ForceDef<D>& def) {
  return m_forces.add(def, m_table);
}
template <int D>
void World<D>::remove(ForceHandle force) {
  m_forces.remove(force, m_table);
}
template <int D>
void World<D>::add(std::shared_ptr<const ForceGenerator<D>> generator) {
  if (!generator) throw UserError("world: the force generator is null");
  m_forces.generators.push_back(std::move(generator));
}
template <int D>
void World<D>::remove(const ForceGenerator<D>* generator) {
  std::erase_if(m_forces.generators, [&](const auto& f) { return f.get() == generator; });
}

template <int D>
void World<D>::addListener(ContactListener<D>* listener) {
  m_listeners.add(listener);
}
template <int D>
void World<D>::addListener(BodyHandle body, ContactListener<D>* listener) {
  m_listeners.add(slotOf(body), listener);
}
template <int D>
bool World<D>::isListenerOf(std::int32_t slot, const ContactListener<D>* listener) const {
  return m_listeners.isOf(slot, listener);
}
template <int D>
void World<D>::removeListener(ContactListener<D>* listener) {
  m_listeners.remove(listener);
}

template <int D>
BodyDef<D> World<D>::definition(BodyHandle body) const {
  return m_table.definition(slotOf(body));
}

template <int D>
void World<D>::change(BodyHandle body, const BodyDef<D>& def) {
  const std::size_t i = slotOf(body);
  const std::int32_t slot = body.slot;
  const CheckedBody<D> checked = checkBody(def, slot);
  if (def.type != BodyType::dynamic) m_joints.requireMoving(i, m_table);
  const auto match = m_table.match(i, checked.shapes);
  const auto isGone = [&](std::int32_t shape) {
    return std::find(match.removed.begin(), match.removed.end(), static_cast<std::size_t>(shape)) !=
           match.removed.end();
  };
  // Two bodies that do not move have no contact, and no step would end an existing one.
  const auto& type = m_table.bodies.type;
  const bool stops = def.type != BodyType::dynamic && type[i] == BodyType::dynamic;
  const auto bothStay = [&](const auto& pair) {
    if (!stops || (pair.bodyA != slot && pair.bodyB != slot)) return false;
    return type[static_cast<std::size_t>(pair.bodyA == slot ? pair.bodyB : pair.bodyA)] != BodyType::dynamic;
  };
  if (stops || !match.removed.empty()) {  // otherwise all contacts stay and are not visited
    m_table.visits += m_contacts.manifolds.size() + m_contacts.records.size();
    endContacts(
        [&](const auto& pair) { return isGone(pair.shapeA) || isGone(pair.shapeB) || bothStay(pair) ? slot : -1; });
  }
  const Vec<D> by = m_table.rewrite(i, def, checked, match);
  if (!by.isZero(0)) {  // update everything measured from the centre of mass
    m_contacts.moveCenter(i, by, m_table.visits);
    m_joints.moveCenter(i, by, m_table.visits);
    m_forces.moveCenter(i, by, m_table.visits);
  }
  m_joints.updateMass(i, m_table);
  for (const std::int32_t shape : shapesOf(i)) m_continuous.forget(static_cast<std::size_t>(shape));
  m_table.touch(i);
}

template <int D>
void World<D>::merge(BodyHandle into, BodyHandle other) {
  const std::size_t a = slotOf(into), b = slotOf(other);
  if (a == b) throw UserError("merge: a body and itself; valid: two different bodies");
  const BodyDef<D> def = merged(definition(into), definition(other));
  checkBody(def, into.slot);  // throws before anything changes
  m_forces.reassign(b, a, m_table.bodies);
  m_joints.reassign(b, a, m_table);
  // Forces for the next step act on the merged body.
  std::vector<Wrench<D>>& push = m_table.userForces;
  const Vec<D> arm = m_table.bodies.pose[b].p - m_table.bodies.pose[a].p, force = push[b].force;
  push[a].torque += push[b].torque + cross(arm, force);
  push[a].force += force;
  remove(other);
  change(into, def);
}

template <int D>
std::vector<BodyHandle> World<D>::splitByShape(BodyHandle body) {
  const std::size_t i = slotOf(body);
  const std::vector<BodyDef<D>> parts = splitDefinition<D>(definition(body), m_table.bodies.center[i]);
  std::vector<BodyHandle> out = {body};
  if (parts.empty()) return out;
  change(body, parts[0]);  // keeps its motion
  for (std::size_t k = 1; k < parts.size(); ++k) out.push_back(add(parts[k]));
  return out;
}

template <int D>
void World<D>::setGravity(const Vec<D>& gravity) {
  if (!gravity.allFinite()) throw UserError("setGravity: gravity is not finite");
  m_settings.gravity = gravity;
  wakeAll();
}

template <int D>
void changeGravity(Simulation<D>& simulation, const Vec<D>& gravity) {
  if (auto* world = dynamic_cast<World<D>*>(&simulation)) return world->setGravity(gravity);
  auto* engine = dynamic_cast<ChangesGravity<D>*>(&simulation);
  if (!engine) throw UserError("this engine cannot change gravity during a run");
  engine->setGravity(gravity);
}
template void changeGravity(Simulation<2>&, const Vec<2>&);
template void changeGravity(Simulation<3>&, const Vec<3>&);

template <int D>
void World<D>::setPipeline(const Pipeline& pipeline) {
  setPipeline(StageSet<D>(pipeline));
}

template <int D>
void World<D>::setPipeline(StageSet<D> stages) {
  requireStages(stages, m_table.kinds(), "exchange: ");
  // Compare with all parameters written out: a text that omits a default value names the same algorithm.
  const auto whole = [](StageKind kind, const Spec& spec) {
    return Registry::instance().find(kind, D, spec.name).canonical(spec).text();
  };
  const auto isAnother = [&](StageKind kind) {
    if (stages.isOwn(kind) || m_stages.isOwn(kind)) return true;
    return whole(kind, stages.pipeline()[kind]) != whole(kind, m_stages.pipeline()[kind]);
  };
  const bool solver = isAnother(StageKind::solver), contacts = isAnother(StageKind::contacts),
             sleep = isAnother(StageKind::sleep);
  for (std::size_t i = 0; i < m_table.bodies.pose.size(); ++i) {
    if (solver) m_table.bodies.solver[i] = {};
    if (sleep) m_table.bodies.sleep[i] = {};
  }
  for (JointRecord<D>& j : m_joints.records) {
    if (solver) j.memory = {};
  }
  for (Manifold<D>& m : m_contacts.manifolds) {
    for (ContactPoint<D>& c : m.points) {
      if (solver) c.memory = {};
      if (contacts) c.feature = ~std::uint64_t{0};  // another generator numbers features differently
    }
  }
  if (contacts) m_contacts.records.clear();
  m_stages = std::move(stages);
  m_table.index(stage<Broadphase>(), m_settings.margin);
  m_continuous.forgetAll();
  wakeAll();
}

template <int D>
std::vector<BodyHandle> World<D>::at(const Vec<D>& point) const {
  sync();
  return BodyQueries<D>(m_table).at(point);
}
template <int D>
std::vector<BodyHandle> World<D>::overlap(const Aabb<D>& box) const {
  sync();
  return BodyQueries<D>(m_table).overlap(box);
}
template <int D>
bool World<D>::contains(BodyHandle body, const Vec<D>& point) const {
  return BodyQueries<D>(m_table).contains(slotOf(body), point);
}
template <int D>
bool World<D>::intersects(BodyHandle body, const Aabb<D>& box) const {
  return BodyQueries<D>(m_table).intersects(slotOf(body), box);
}
template <int D>
std::vector<BodyHandle> World<D>::overlap(const Shape<D>& shape, const Pose<D>& X_WS, const Filter& filter) const {
  sync();
  return BodyQueries<D>(m_table).overlap(shape, X_WS, filter);
}
template <int D>
std::optional<BodyCastHit<D>> World<D>::castFirst(const Shape<D>& shape, const Pose<D>& X_WS,
                                                  const Vec<D>& displacement, const Filter& filter) const {
  sync();
  return BodyQueries<D>(m_table).castFirst(shape, X_WS, displacement, filter);
}
template <int D>
std::optional<ClosestBody<D>> World<D>::closest(const Vec<D>& point, Real maxDistance, const Filter& filter) const {
  sync();
  return BodyQueries<D>(m_table).closest(point, maxDistance, filter);
}
template <int D>
std::vector<BodyRayHit<D>> World<D>::rayAll(const Vec<D>& p, const Vec<D>& direction, Real maxT,
                                            const Filter& filter) const {
  sync();
  return BodyQueries<D>(m_table).rayAll(p, direction, maxT, filter);
}
template <int D>
std::optional<BodyRayHit<D>> World<D>::rayFirst(const Vec<D>& p, const Vec<D>& direction, Real maxT,
                                                const Filter& filter) const {
  sync();
  return BodyQueries<D>(m_table).rayFirst(p, direction, maxT, filter);
}

template <int D>
void World<D>::save(std::ostream& out) const {
  writeState<D>(out,
                {m_settings, m_table.bodies, m_table.shapes, m_joints.records, m_contacts.manifolds, m_table.userForces,
                 m_table.events, m_time, m_lastDt, m_sinceContacts, m_steps, m_contacts.records, m_forces.records});
}

template <int D>
void World<D>::load(std::istream& in) {
  SavedState<D> s = readState<D>(in);
  requireValidState<D>(s, stage<ContactGenerator>());
  if (s.settings.model.continuous) {
    std::array<bool, kShapeKinds> kinds{};
    for (const ShapeRecord<D>& shape : s.shapes) markKinds(shape.shape, kinds);
    requireCasts(stage<ContinuousCollision>(), kinds, "load: this world's continuous collision");
  }
  const std::size_t n = s.bodies.pose.size();
  s.bodies.invMass.assign(n, 0);  // refreshed before each solver step
  s.bodies.invInertia.assign(n, Inertia<D>::Zero());

  m_settings = s.settings, m_time = s.time, m_lastDt = s.lastDt, m_sinceContacts = s.sinceContacts;
  m_steps = static_cast<long>(s.steps);
  m_table.bodies = std::move(s.bodies), m_table.shapes = std::move(s.shapes);
  m_table.userForces = std::move(s.userForces), m_table.events = std::move(s.events);
  m_joints.records = std::move(s.joints), m_forces.records = std::move(s.forces);
  m_contacts.manifolds = std::move(s.manifolds), m_contacts.records = std::move(s.records);

  // New stages: the structures of the old ones hold no history.
  if (m_stages.isOwn(StageKind::broadphase)) m_table.boxes.removeAll();
  m_stages.renew();
  m_table.recount(), m_joints.recount(m_table.visits), m_forces.recount();
  m_table.index(stage<Broadphase>(), m_settings.margin);
  m_continuous.forgetAll();
  m_listeners.forgetBodies(), m_contacts.forgetPairs();  // refer to old bodies
}

template class World<2>;
template class World<3>;

}}  // namespace lpc::LPC_PRECISION
