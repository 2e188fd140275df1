// SPDX-License-Identifier: Zlib
// Shared by integrators and by solvers that integrate themselves: the change of velocity by forces, and the motion at
// constant velocity.
#pragma once

#include <span>
#include <vector>

#include "algorithms/solver/lanes/rotation_lanes.h"
#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// velocity += dt x (present forces) / mass, without the gyroscopic term. Bodies of zero inverse mass keep their
/// velocity.
template <int D>
void kick(const IntegrateInput<D>& in, std::vector<Wrench<D>>& wrenches) {
  Bodies<D>& bodies = in.bodies;
  auto& motion = bodies.motion;
  wrenches.resize(bodies.pose.size());
  in.forces.eval({bodies, bodies.pose, motion}, in.time, wrenches);
  ++in.work[WorkCount::forceEvals];
  for (std::size_t i = 0; i < motion.size(); ++i) {
    motion[i].v += (in.dt * bodies.invMass[i]) * wrenches[i].force;
    if (in.model.rotation) motion[i].w += bodies.invInertia[i] * (in.dt * wrenches[i].torque);
  }
}

/// Zeroes velocities that a step must not use: of bodies outside the step, of pinned ones, of ones that may not turn.
template <int D>
void haltUnmoving(Bodies<D>& bodies, bool rotation) {
  for (std::size_t i = 0; i < bodies.pose.size(); ++i) {
    const bool dynamic = bodies.type[i] == BodyType::dynamic;
    if (dynamic && bodies.pinned[i]) bodies.motion[i].v.setZero();
    if (!rotation || (dynamic && bodies.invInertiaBody[i].trace() == 0)) bodies.motion[i].w.setZero();
  }
}

/// Whether the step moves this body. Kinematic bodies move at their given velocity.
template <int D>
bool travels(const Bodies<D>& bodies, std::size_t i) {
  return bodies.used[i] && bodies.type[i] != BodyType::fixed && bodies.awake[i];
}

/// Moves all bodies that travel, at constant velocities for dt. `motion` is by slot.
template <int D>
class FreeMotion {
 public:
  void move(Bodies<D>& bodies, IndexedSpan<const Motion<D>> motion, Real dt, bool rotation) {
    m_bodies.clear();
    for (std::size_t i = 0; i < bodies.pose.size(); ++i) {
      if (travels(bodies, i)) m_bodies.push_back(static_cast<std::int32_t>(i));
    }
    for (const std::int32_t i : m_bodies) bodies.pose[i].p += dt * motion[i].v;
    if (rotation) turnBodies(bodies.pose, motion, m_bodies, dt);
  }

 private:
  std::vector<std::int32_t> m_bodies;  // that travel
};

}}}  // namespace lpc::LPC_PRECISION::solver
