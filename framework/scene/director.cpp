// SPDX-License-Identifier: Zlib
#include "framework/scene/director.h"

#include <algorithm>
#include <string>

namespace lpc { inline namespace LPC_PRECISION {
template <int D>
Director<D>::Director(SceneSpec<D> scene)
    : m_scene(std::move(scene)),
      m_bodyHandles(m_scene.spawns.size()),
      m_jointHandles(m_scene.joints.size()),
      m_forceHandles(m_scene.forces.size()) {
  for (std::size_t i = 0; i < m_scene.spawns.size(); ++i) {
    const auto& spawn = m_scene.spawns[i];
    if (spawn.addedBy < 0) m_coming.list.push_back({spawn.step, false, static_cast<int>(i)});
    if (spawn.removeAt >= 0 && spawn.removedBy < 0)
      m_leaving.list.push_back({spawn.removeAt, true, static_cast<int>(i)});
  }
  // Due with the later of its bodies; after the events when an event adds that body.
  const auto between = [&](const auto& list, Schedule& turns) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (list[i].byEvent) continue;
      std::pair when(list[i].step, false);
      for (const int end : {list[i].bodyA, list[i].bodyB}) {
        if (end < 0) continue;
        const auto& spawn = m_scene.spawns.at(static_cast<std::size_t>(end));
        when = std::max(when, std::pair(spawn.step, spawn.addedBy >= 0));
      }
      turns.list.push_back({when.first, when.second, static_cast<int>(i)});
    }
  };
  between(m_scene.joints, m_joints), between(m_scene.forces, m_forces);
  for (Schedule* turns : {&m_coming, &m_joints, &m_forces, &m_leaving}) {
    std::sort(turns->list.begin(), turns->list.end());
  }
}

template <int D>
void Director<D>::addBody(Simulation<D>& world, int spawn) {
  const auto& s = m_scene.spawns.at(static_cast<std::size_t>(spawn));
  setBody(spawn, s.existing == BodyHandle{} ? world.add(s.body) : s.existing);
}

template <int D>
void Director<D>::addJoint(Simulation<D>& world, int joint) {
  const auto& j = m_scene.joints.at(static_cast<std::size_t>(joint));
  JointDef<D> def = j.def;
  def.bodyA = body(j.bodyA), def.bodyB = body(j.bodyB);
  m_jointHandles[joint] = world.add(def);
}

template <int D>
void Director<D>::addForce(Simulation<D>& world, int force) {
  const auto& f = m_scene.forces.at(static_cast<std::size_t>(force));
  ForceDef<D> def = f.def;
  def.bodyA = body(f.bodyA), def.bodyB = body(f.bodyB);
  const ForceHandle handle = world.add(def);
  m_forceHandles[force] = handle;
  if (f.removeAt >= 0) m_ending.push_back({f.removeAt, handle});
}

template <int D>
void Director<D>::begin(Simulation<D>& world) {
  if (!m_begin) m_begin = world.stepCount();
  const long step = world.stepCount() - *m_begin;
  m_coming.play(step, false, [&](int i) { addBody(world, i); });
  m_joints.play(step, false, [&](int i) { addJoint(world, i); });
  std::erase_if(m_ending, [&](const Ending& e) {
    if (e.step > step) return false;
    const ForceRecord<D>& f = world.forces()[static_cast<std::size_t>(e.force.slot)];
    if (f.kind && f.generation == e.force.generation)
      world.remove(e.force);  // otherwise it was removed with a body or by an event
    return true;
  });
  m_forces.play(step, false, [&](int i) { addForce(world, i); });
  for (; m_nextEvent < m_scene.events.size() && m_scene.events[m_nextEvent].step <= step; ++m_nextEvent) {
    const auto& event = m_scene.events[m_nextEvent];
    try {
      event.act(*this, world, event.body);
    } catch (const UserError& e) {
      if (!event.place) throw;
      throw UserError(*event.place + ": at step " + std::to_string(step) + ": " + e.what());
    }
    m_begin = world.stepCount() - step;  // a cleared world restarts at step 0, the script continues
  }
}

template <int D>
void Director<D>::finish(Simulation<D>& world) {
  const long step = world.stepCount() - *m_begin;
  m_joints.play(step, true, [&](int i) { addJoint(world, i); });
  m_forces.play(step, true, [&](int i) { addForce(world, i); });
  m_leaving.play(step, true, [&](int i) {
    if (world.valid(body(i))) world.remove(body(i));  // otherwise an event has cleared the world
  });
}

template class Director<2>;
template class Director<3>;

}}  // namespace lpc::LPC_PRECISION
