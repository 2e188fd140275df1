// SPDX-License-Identifier: Zlib
#include "framework/director.h"

#include <algorithm>

namespace lpc::inline LPC_PRECISION {
template <int D>
Director<D>::Director(SceneSpec<D> scene) : m_scene(std::move(scene)) {
  const auto comes = [&](int spawn) { return spawn < 0 ? 0 : m_scene.spawns.at(static_cast<std::size_t>(spawn)).step; };
  const auto inTurn = [&](const auto& list) {  // those of one step in the order of the file
    std::vector<std::pair<long, std::size_t>> turns;
    for (std::size_t i = 0; i < list.size(); ++i) {
      turns.emplace_back(std::max({list[i].step, comes(list[i].bodyA), comes(list[i].bodyB)}), i);
    }
    std::sort(turns.begin(), turns.end());
    return turns;
  };
  m_joints = inTurn(m_scene.joints), m_forces = inTurn(m_scene.forces);
}

template <int D>
void Director<D>::advance(Simulation<D>& world) {
  if (m_begin < 0) m_begin = world.stepCount();
  const long step = world.stepCount() - m_begin;
  for (; m_next < m_scene.spawns.size() && m_scene.spawns[m_next].step <= step; ++m_next) {
    const auto& spawn = m_scene.spawns[m_next];
    m_handles.push_back(spawn.there == Handle{} ? world.add(spawn.body) : spawn.there);
  }
  for (; m_nextJoint < m_joints.size() && m_joints[m_nextJoint].first <= step; ++m_nextJoint) {
    const auto& j = m_scene.joints[m_joints[m_nextJoint].second];
    JointDef<D> def = j.def;
    def.bodyA = body(j.bodyA), def.bodyB = body(j.bodyB);
    world.add(def);
  }
  std::erase_if(m_ending, [&](const Ending& e) {
    if (e.step > step) return false;
    const ForceRecord<D>& f = world.forces()[static_cast<std::size_t>(e.force.slot)];
    if (f.kind && f.generation == e.force.generation) world.remove(e.force);  // else it went with a body
    return true;
  });
  for (; m_nextForce < m_forces.size() && m_forces[m_nextForce].first <= step; ++m_nextForce) {
    const auto& f = m_scene.forces[m_forces[m_nextForce].second];
    ForceDef<D> def = f.def;
    def.bodyA = body(f.bodyA), def.bodyB = body(f.bodyB);
    const ForceHandle force = world.add(def);
    if (f.removeAt >= 0) m_ending.push_back({f.removeAt, force});
  }
  for (; m_nextEvent < m_scene.events.size() && m_scene.events[m_nextEvent].step <= step; ++m_nextEvent) {
    const auto& event = m_scene.events[m_nextEvent];
    event.act(world, body(event.body));
  }
  for (std::size_t i = 0; i < m_next; ++i) {
    if (m_scene.spawns[i].removeAt == step) world.remove(m_handles[i]);
  }
}

template <int D>
Handle Director<D>::body(int spawn) const {
  const auto i = static_cast<std::size_t>(spawn);
  return spawn >= 0 && i < m_handles.size() ? m_handles[i] : Handle{};
}

template class Director<2>;
template class Director<3>;

}  // namespace lpc::inline LPC_PRECISION
