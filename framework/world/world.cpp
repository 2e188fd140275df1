// SPDX-License-Identifier: Zlib
// A world's bodies as their user sees them between steps. Each other room has a file: world_build.cpp, world_query.cpp,
// world_contacts.cpp, world_step.cpp, world_save.cpp.
#include "framework/world/world.h"

#include <algorithm>

#include "framework/math/user_numbers.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
World<D>::World(const Pipeline& pipeline, const WorldSettings<D>& settings)
    : m_pipeline(pipeline), m_settings(settings), m_stages(pipeline), m_boxes(stage<Broadphase>(), settings.margin) {
  if (!settings.gravity.allFinite()) throw UserError("world: gravity is not finite");
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
std::uint64_t World<D>::userData(Handle body) const {
  return m_bodies.userData[slotOf(body)];
}
template <int D>
void World<D>::setUserData(Handle body, std::uint64_t data) {
  m_bodies.userData[slotOf(body)] = data;
}

template <int D>
void World<D>::touched(std::size_t body) {
  ++m_visits;
  m_bodies.awake[body] = 1;
  m_events.push_back({SleepEvent::userChange, static_cast<std::int32_t>(body), -1});
  m_boxes.touch(body);
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
  if (!force.allFinite() || !point.allFinite()) throw UserError("applyForce: force or point is not finite");
  m_userForces[i].force += force;
  m_userForces[i].torque += cross(point - m_bodies.pose[i].p, force);
  touched(i);
}
template <int D>
void World<D>::applyTorque(Handle body, const Ang<D>& torque) {
  const std::size_t i = slotOf(body);
  if (!torque.allFinite()) throw UserError("applyTorque: the torque is not finite");
  m_userForces[i].torque += torque;
  touched(i);
}
template <int D>
void World<D>::wake(Handle body) {
  touched(slotOf(body));
}
template <int D>
void World<D>::follow(std::span<const Pose<D>> X_WC, std::span<const Motion<D>> motion) {
  LPC_ASSERT(X_WC.size() == m_bodies.pose.size() && motion.size() == m_bodies.pose.size());
  for (std::size_t i = 0; i < X_WC.size(); ++i) {
    if (m_bodies.used[i] && m_bodies.type[i] != BodyType::fixed)
      m_bodies.pose[i] = X_WC[i], m_bodies.motion[i] = motion[i];
  }
  for (JointRecord<D>& j : m_joints) {  // whole turns are counted here, too
    if (j.active()) j.kind->finish(j, poseOf(m_bodies, j.bodyA), poseOf(m_bodies, j.bodyB));
  }
  m_events.clear();  // nobody decides about sleep
  m_boxes.outdate();
}

template <int D>
void World<D>::add(std::shared_ptr<const ForceGenerator<D>> generator) {
  if (!generator) throw UserError("world: the force generator is null");
  m_generators.push_back(std::move(generator));
}
template <int D>
void World<D>::remove(const ForceGenerator<D>* generator) {
  std::erase_if(m_generators, [&](const auto& f) { return f.get() == generator; });
}
template <int D>
void World<D>::addListener(ContactListener<D>* listener) {
  if (!listener) throw UserError("world: the listener is null");
  if (std::find(m_listeners.begin(), m_listeners.end(), listener) == m_listeners.end()) m_listeners.push_back(listener);
}
template <int D>
void World<D>::addListener(Handle body, ContactListener<D>* listener) {
  const std::size_t i = slotOf(body);
  if (!listener) throw UserError("world: the listener is null");
  if (i >= m_bodyListeners.size()) m_bodyListeners.resize(i + 1);
  auto& of = m_bodyListeners[i];
  if (std::find(of.begin(), of.end(), listener) == of.end()) of.push_back(listener);
}
template <int D>
bool World<D>::isListenerOf(std::int32_t slot, const ContactListener<D>* listener) const {
  const auto i = static_cast<std::size_t>(slot);
  if (slot < 0 || i >= m_bodyListeners.size()) return false;
  return std::find(m_bodyListeners[i].begin(), m_bodyListeners[i].end(), listener) != m_bodyListeners[i].end();
}
template <int D>
void World<D>::removeListener(ContactListener<D>* listener) {
  std::erase(m_listeners, listener);
  for (auto& of : m_bodyListeners) std::erase(of, listener);
}

template class World<2>;
template class World<3>;

}}  // namespace lpc::LPC_PRECISION
