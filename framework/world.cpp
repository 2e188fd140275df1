// SPDX-License-Identifier: Zlib
// Building, reading and asking a world. The step itself is in world_step.cpp, saving in world_save.cpp.
#include "framework/world.h"

#include <algorithm>
#include <cmath>

namespace lpc::inline LPC_PRECISION {
namespace {

template <class M>
bool finite(const M& m) {
  for (int i = 0; i < m.size(); ++i) {
    if (!std::isfinite(m[i])) return false;
  }
  return true;
}

bool unit(const Rot<2>& q) { return std::abs(q.c * q.c + q.s * q.s - 1) < 4 * kUnitTolerance; }
bool unit(const Rot<3>& q) { return std::abs(q.w * q.w + q.imag().squaredNorm() - 1) < 4 * kUnitTolerance; }

template <int D>
bool finite(const MassProperties<D>& m) {
  return std::isfinite(m.mass) && finite(m.center) && m.inertia.allFinite();
}

template <int D>
void checkPose(const Pose<D>& x, const std::string& who) {
  if (!finite(x.p)) throw UserError(who + ": the position is not finite");
  if (!unit(x.q)) throw UserError(who + ": the rotation is not a unit complex number or quaternion");
}

template <int D>
void checkMotion(const Motion<D>& m, const std::string& who) {
  if (!finite(m.v) || !finite(m.w)) throw UserError(who + ": the velocity is not finite");
}

void checkAmount(Real value, const std::string& who, const char* what) {
  if (value >= 0 && std::isfinite(value)) return;
  throw UserError(who + ": " + what + " is " + std::to_string(value) + "; valid: a finite number >= 0");
}

template <int D>
void checkShape(const ShapeDef<D>& s, const std::string& who) {
  checkPose(s.X_BS, who + ", shape");
  checkAmount(s.density, who, "density");
  checkAmount(s.friction, who, "friction");
  checkAmount(s.restitution, who, "restitution");
}

// Slot for one more item: the lowest free one, or a new one at the end. `count` is how many are in use.
template <class T>
std::size_t lowestFree(const std::vector<T>& items, int count, auto isFree) {
  std::size_t i = 0;
  if (static_cast<std::size_t>(count) == items.size()) return items.size();
  while (!isFree(items[i])) ++i;
  return i;
}

}  // namespace

template <int D>
World<D>::World(const Pipeline& pipeline, const WorldSettings<D>& settings)
    : m_pipeline(pipeline), m_settings(settings), m_stages(pipeline) {
  if (!finite(settings.gravity)) throw UserError("world: gravity is not finite");
  checkAmount(settings.margin, "world", "the contact margin");
  checkAmount(settings.restitutionThreshold, "world", "the restitution threshold");
}

template <int D>
World<D>::~World() = default;

template <int D>
std::size_t World<D>::slotOf(Handle body) const {
  if (!valid(body)) throw UserError("world: there is no body with handle " + std::to_string(body.slot) + " (removed?)");
  return static_cast<std::size_t>(body.slot);
}

template <int D>
std::size_t World<D>::freeBodySlot() {
  auto& b = m_bodies;
  const std::size_t i = lowestFree(b.used, m_bodyCount, [](std::uint8_t used) { return !used; });
  if (i < b.used.size()) return i;
  b.pose.emplace_back(), b.motion.emplace_back(), b.center.emplace_back(Vec<D>::Zero());
  b.invMass.push_back(0), b.mass.push_back(0);
  b.invInertia.push_back(Inertia<D>::Zero()), b.invInertiaBody.push_back(Inertia<D>::Zero());
  b.type.push_back(BodyType::fixed);
  b.used.push_back(0), b.awake.push_back(0), b.canSleep.push_back(0), b.pinned.push_back(0);
  b.sleep.push_back({}), b.generation.push_back(0);
  m_userForces.emplace_back();
  return i;
}

template <int D>
Handle World<D>::add(const BodyDef<D>& def) {
  const std::string who = def.name.empty() ? "body" : "body '" + def.name + "'";
  checkPose(def.X_WB, who);
  checkMotion(Motion<D>{def.velocity, def.angularVelocity}, who);
  MassProperties<D> mass;
  bool kinds[kShapeKinds] = {};
  for (const ShapeDef<D>& s : def.shapes) {
    checkShape(s, who);
    const MassProperties<D> part = transformed(massProperties(s.shape.view(), s.density), s.X_BS);
    mass = combined(mass, part);
    if (!finite(part) || !finite(mass)) {
      throw UserError(who + ": its mass, " + std::to_string(part.mass) +
                      " kg, or its inertia is beyond what numbers hold");
    }
    kinds[static_cast<int>(s.shape.kind())] = true;
  }
  if (def.type == BodyType::dynamic && !(mass.mass > 0)) {
    throw UserError(who + ": a dynamic body needs mass; give it a shape with density > 0, or make it fixed");
  }
  for (int k = 0; k < kShapeKinds; ++k) kinds[k] = kinds[k] || m_kindCount[static_cast<std::size_t>(k)] > 0;
  for (const ShapeDef<D>& s : def.shapes) {
    for (int k = 0; k < kShapeKinds; ++k) {
      const auto a = std::min(s.shape.kind(), static_cast<ShapeKind>(k));
      const auto b = std::max(s.shape.kind(), static_cast<ShapeKind>(k));
      if (kinds[k] && !stage<ContactGenerator>().supports(a, b)) {
        throw UserError(who + ": contacts=" + m_pipeline[StageKind::contacts].name + " does not support " +
                        std::string(shapeKindName(a)) + " against " + std::string(shapeKindName(b)));
      }
    }
  }

  const std::size_t i = freeBodySlot();
  auto& b = m_bodies;
  const bool dynamic = def.type == BodyType::dynamic;
  b.used[i] = 1, b.type[i] = def.type;
  b.awake[i] = def.awake || !dynamic, b.canSleep[i] = def.canSleep && dynamic, b.pinned[i] = def.pinned;
  b.center[i] = mass.center;
  b.pose[i] = {def.X_WB * mass.center, def.X_WB.q};
  b.motion[i] = def.type == BodyType::fixed ? Motion<D>{} : Motion<D>{def.velocity, def.angularVelocity};
  b.mass[i] = dynamic ? mass.mass : Real(0);
  b.invInertiaBody[i] = Inertia<D>::Zero();
  if (dynamic && def.rotatable && mass.inertia.trace() > 0) b.invInertiaBody[i] = mass.inertia.inverse();
  b.sleep[i] = {}, m_userForces[i] = {};
  ++m_bodyCount;
  for (std::size_t s = 0; s < def.shapes.size(); ++s) {
    putShape(def.shapes[s], static_cast<std::int32_t>(i), static_cast<std::int32_t>(s));
  }
  m_stale = true;
  return handle(static_cast<std::int32_t>(i));
}

template <int D>
void World<D>::putShape(const ShapeDef<D>& def, std::int32_t body, std::int32_t index) {
  const std::size_t i = lowestFree(m_shapes, m_shapeCount, [](const ShapeRecord<D>& r) { return r.body < 0; });
  if (i == m_shapes.size()) m_shapes.emplace_back();
  ++m_shapeCount, ++m_kindCount[static_cast<std::size_t>(def.shape.kind())];
  const Vec<D>& center = m_bodies.center[static_cast<std::size_t>(body)];
  m_shapes[i] = {def.shape, {def.X_BS.p - center, def.X_BS.q}, body, index, def.friction, def.restitution, def.category,
                 def.mask};
  m_proxies.resize(static_cast<int>(m_shapes.size()));
  m_proxies.category[i] = def.category, m_proxies.mask[i] = def.mask, m_proxies.body[i] = body;
  refreshBox(i);
  m_added.push_back(static_cast<ProxyId>(i));
}

template <int D>
void World<D>::remove(Handle body) {
  const std::size_t i = slotOf(body);
  const std::int32_t slot = body.slot;
  for (std::size_t s = 0; s < m_shapes.size(); ++s) {
    if (m_shapes[s].body != slot) continue;
    --m_shapeCount, --m_kindCount[static_cast<std::size_t>(m_shapes[s].shape.kind())];
    m_shapes[s] = ShapeRecord<D>{};
    m_proxies.setBox(static_cast<ProxyId>(s), Aabb<D>{});
    m_proxies.body[s] = -1, m_proxies.active[s] = 0;
    std::erase(m_moved, static_cast<ProxyId>(s));
    // A slot that the broadphase has not heard of yet needs no farewell.
    if (std::erase(m_added, static_cast<ProxyId>(s)) == 0) m_removed.push_back(static_cast<ProxyId>(s));
  }
  std::erase_if(m_manifolds, [&](const Manifold<D>& m) {
    if (m.bodyA != slot && m.bodyB != slot) return false;
    m_events.push_back({SleepEvent::bodyRemoved, m.bodyA == slot ? m.bodyB : m.bodyA, slot});
    for (ContactListener<D>* l : m_listeners) l->end(*this, m);
    return true;
  });
  for (std::size_t j = 0; j < m_joints.size(); ++j) {
    PivotJoint<D>& joint = m_joints[j];
    if (joint.bodyA < 0 || (joint.bodyA != slot && joint.bodyB != slot)) continue;
    m_events.push_back({SleepEvent::bodyRemoved, joint.bodyA == slot ? joint.bodyB : joint.bodyA, slot});
    removeJoint({static_cast<std::int32_t>(j), joint.generation});
  }
  std::erase_if(m_events, [&](const SleepEvent& e) { return e.body == slot; });
  auto& b = m_bodies;
  b.pose[i] = {}, b.motion[i] = {}, b.invMass[i] = b.mass[i] = 0, b.center[i] = Vec<D>::Zero();
  b.invInertia[i] = b.invInertiaBody[i] = Inertia<D>::Zero();
  b.type[i] = BodyType::fixed, b.used[i] = b.awake[i] = b.canSleep[i] = b.pinned[i] = 0;
  b.sleep[i] = {}, m_userForces[i] = {};
  ++b.generation[i];
  --m_bodyCount;
  m_stale = true;
}

template <int D>
Handle World<D>::add(const PivotDef<D>& def) {
  const std::size_t a = slotOf(def.bodyA), b = slotOf(def.bodyB);
  if (a == b) throw UserError("world: a pivot needs two bodies");
  if (!finite(def.anchor)) throw UserError("world: the pivot's anchor is not finite");
  const std::size_t i = lowestFree(m_joints, m_jointCount, [](const PivotJoint<D>& j) { return j.bodyA < 0; });
  if (i == m_joints.size()) m_joints.emplace_back();
  ++m_jointCount;
  PivotJoint<D>& j = m_joints[i];
  j.bodyA = def.bodyA.slot, j.bodyB = def.bodyB.slot;
  j.localA = m_bodies.pose[a].inverse() * def.anchor, j.localB = m_bodies.pose[b].inverse() * def.anchor;
  j.impulse = Vec<D>::Zero(), j.collide = def.collide;
  m_stale = true;
  return {static_cast<std::int32_t>(i), j.generation};
}

template <int D>
void World<D>::removeJoint(Handle joint) {
  const auto i = static_cast<std::size_t>(joint.slot);
  if (joint.slot < 0 || i >= m_joints.size() || m_joints[i].bodyA < 0 || m_joints[i].generation != joint.generation) {
    throw UserError("world: there is no joint with handle " + std::to_string(joint.slot) + " (removed?)");
  }
  const std::uint32_t generation = m_joints[i].generation + 1;
  m_joints[i] = PivotJoint<D>{};
  m_joints[i].generation = generation;
  --m_jointCount;
}

template <int D>
void World<D>::add(std::shared_ptr<const ForceGenerator<D>> generator) {
  if (!generator) throw UserError("world: the force generator is null");
  m_forces.push_back(std::move(generator));
}
template <int D>
void World<D>::remove(const ForceGenerator<D>* generator) {
  std::erase_if(m_forces, [&](const auto& f) { return f.get() == generator; });
}
template <int D>
void World<D>::addListener(ContactListener<D>* listener) {
  if (!listener) throw UserError("world: the listener is null");
  m_listeners.push_back(listener);
}
template <int D>
void World<D>::removeListener(ContactListener<D>* listener) {
  std::erase(m_listeners, listener);
}

template <int D>
bool World<D>::valid(Handle body) const {
  const auto i = static_cast<std::size_t>(body.slot);
  return body.slot >= 0 && i < m_bodies.used.size() && m_bodies.used[i] && m_bodies.generation[i] == body.generation;
}
template <int D>
Handle World<D>::handle(std::int32_t slot) const {
  return {slot, m_bodies.generation[static_cast<std::size_t>(slot)]};
}
template <int D>
Pose<D> World<D>::pose(Handle body) const {
  const std::size_t i = slotOf(body);
  const Pose<D>& x = m_bodies.pose[i];
  return {x.p - x.q * m_bodies.center[i], x.q};
}
template <int D>
Motion<D> World<D>::motion(Handle body) const {
  return m_bodies.motion[slotOf(body)];
}
template <int D>
Real World<D>::mass(Handle body) const {
  return m_bodies.mass[slotOf(body)];
}
template <int D>
bool World<D>::awake(Handle body) const {
  return m_bodies.awake[slotOf(body)] != 0;
}

template <int D>
void World<D>::touched(std::size_t body) {
  m_stale = true;
  m_bodies.awake[body] = 1;
  const auto slot = static_cast<std::int32_t>(body);
  m_events.push_back({SleepEvent::userChange, slot, -1});
  for (std::size_t s = 0; s < m_shapes.size(); ++s) {
    if (m_shapes[s].body == slot) refreshBox(s), m_moved.push_back(static_cast<ProxyId>(s));
  }
}
template <int D>
void World<D>::setPose(Handle body, const Pose<D>& X_WB) {
  const std::size_t i = slotOf(body);
  checkPose(X_WB, "setPose");
  m_bodies.pose[i] = {X_WB * m_bodies.center[i], X_WB.q};
  touched(i);
}
template <int D>
void World<D>::setMotion(Handle body, const Motion<D>& motion) {
  const std::size_t i = slotOf(body);
  checkMotion(motion, "setMotion");
  if (m_bodies.type[i] == BodyType::fixed) throw UserError("setMotion: a fixed body has no velocity");
  m_bodies.motion[i] = motion;
  touched(i);
}
template <int D>
void World<D>::applyForce(Handle body, const Vec<D>& force, const Vec<D>& point) {
  const std::size_t i = slotOf(body);
  if (!finite(force) || !finite(point)) throw UserError("applyForce: force or point is not finite");
  m_userForces[i].force += force;
  m_userForces[i].torque += cross(point - m_bodies.pose[i].p, force);
  touched(i);
}
template <int D>
void World<D>::applyTorque(Handle body, const Ang<D>& torque) {
  const std::size_t i = slotOf(body);
  if (!finite(torque)) throw UserError("applyTorque: the torque is not finite");
  m_userForces[i].torque += torque;
  touched(i);
}
template <int D>
void World<D>::wake(Handle body) {
  touched(slotOf(body));
}

// The bodies, each once, of those proxies whose shape holds; `holds` is asked with the shape and its pose.
template <int D>
template <class Holds>
std::vector<Handle> World<D>::bodiesOf(std::vector<ProxyId>& found, const Holds& holds) const {
  std::sort(found.begin(), found.end());
  std::vector<Handle> out;
  for (ProxyId id : found) {
    const ShapeRecord<D>& s = m_shapes[static_cast<std::size_t>(id)];
    const Pose<D> X_WS = m_bodies.pose[static_cast<std::size_t>(s.body)] * s.X_CS;
    const Handle h = handle(s.body);
    if (holds(s.shape.view(), X_WS) && std::find(out.begin(), out.end(), h) == out.end()) out.push_back(h);
  }
  return out;
}

template <int D>
std::vector<Handle> World<D>::at(const Vec<D>& point) const {
  sync();
  std::vector<ProxyId> found;
  stage<Broadphase>().at(m_proxies, point, found);
  return bodiesOf(found, [&](const auto& shape, const Pose<D>& X_WS) { return containsPoint(shape, X_WS, point); });
}

template <int D>
std::vector<Handle> World<D>::overlap(const Aabb<D>& box) const {
  sync();
  std::vector<ProxyId> found;
  stage<Broadphase>().overlap(m_proxies, box, found);
  return bodiesOf(found, [&](const auto& shape, const Pose<D>& X_WS) { return overlapsBox(shape, X_WS, box); });
}

template <int D>
std::vector<BodyRayHit<D>> World<D>::ray(const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly) const {
  sync();
  std::vector<RayHit<D>> found;
  stage<Broadphase>().ray(m_proxies, p, direction, maxT, false, found);  // the first box need not hold the first shape
  std::vector<BodyRayHit<D>> out;
  for (const RayHit<D>& hit : found) {
    const ShapeRecord<D>& s = m_shapes[static_cast<std::size_t>(hit.proxy)];
    const Pose<D> X_WS = m_bodies.pose[static_cast<std::size_t>(s.body)] * s.X_CS;
    const Real t = castRay(s.shape.view(), X_WS, p, direction, maxT);
    if (t >= 0) out.push_back({handle(s.body), s.index, t});
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.t, a.body.slot, a.shape) < std::tuple(b.t, b.body.slot, b.shape);
  });
  if (firstOnly && out.size() > 1) out.resize(1);
  return out;
}

template class World<2>;
template class World<3>;

}  // namespace lpc::inline LPC_PRECISION
