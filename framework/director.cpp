// SPDX-License-Identifier: Zlib
#include "framework/director.h"

#include <algorithm>

namespace lpc::inline LPC_PRECISION {
namespace {

// A point of the body's own frame, seen from its centre of mass.
template <int D>
Vec<D> fromCenter(const Simulation<D>& world, Handle body, const Vec<D>& p) {
  return p - world.bodies().center[static_cast<std::size_t>(body.slot)];
}

}  // namespace

template <int D>
Director<D>::Director(SceneSpec<D> scene) : m_scene(std::move(scene)) {
  const auto comes = [&](int spawn) { return spawn < 0 ? 0 : m_scene.spawns.at(static_cast<std::size_t>(spawn)).step; };
  for (std::size_t i = 0; i < m_scene.joints.size(); ++i) {
    const auto& j = m_scene.joints[i];
    m_joints.emplace_back(std::max({j.step, comes(j.bodyA), comes(j.bodyB)}), i);
  }
  std::sort(m_joints.begin(), m_joints.end());  // those of one step in the order of the file
}

template <int D>
void Director<D>::advance(Simulation<D>& world) {
  const long step = world.stepCount();
  const std::size_t first = m_next;
  for (; m_next < m_scene.spawns.size() && m_scene.spawns[m_next].step <= step; ++m_next) {
    m_handles.push_back(world.add(m_scene.spawns[m_next].body));
  }
  const auto came = [&](int a, int b) {  // the later of the two came in this call
    const auto last = static_cast<std::size_t>(std::max(a, b));
    return last >= first && last < m_next;
  };
  for (; m_nextJoint < m_joints.size() && m_joints[m_nextJoint].first <= step; ++m_nextJoint) {
    const auto& j = m_scene.joints[m_joints[m_nextJoint].second];
    JointDef<D> def = j.def;
    def.bodyA = body(j.bodyA), def.bodyB = body(j.bodyB);
    world.add(def);
  }
  if (m_next > first) {
    for (const auto& s : m_scene.springs) {
      if (!came(s.bodyA, s.bodyB)) continue;
      auto spring = std::make_shared<Spring<D>>();
      spring->bodyA = body(s.bodyA), spring->bodyB = body(s.bodyB);
      spring->localA = s.bodyA < 0 ? s.localA : fromCenter(world, spring->bodyA, s.localA);
      spring->localB = fromCenter(world, spring->bodyB, s.localB);
      spring->restLength = s.restLength, spring->stiffness = s.stiffness, spring->damping = s.damping;
      world.add(std::move(spring));
    }
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
