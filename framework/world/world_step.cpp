// SPDX-License-Identifier: Zlib
// One step of a world: boxes, pairs, cache.select, contacts, cache.carry, listeners, sleep, solver, continuous.
#define XXH_INLINE_ALL  // one hash needs no library at link time
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

template <int D>
void World<D>::decideSleep(Real dt) {
  m_awakeBefore = m_bodies.awake;
  stage<SleepPolicy>().decide({dt, m_bodies, m_manifolds, jointsInUse(), m_events, m_settings.restitutionThreshold,
                               m_settings.gravity, m_profiler.frame().work, m_graph},
                              m_bodies.awake, m_bodies.sleep);
  for (std::size_t i = 0; i < m_bodies.awake.size(); ++i) {
    if (m_awakeBefore[i] && !m_bodies.awake[i]) m_bodies.motion[i] = {};
  }
}

template <int D>
void World<D>::refreshMasses() {
  auto& b = m_bodies;
  for (std::size_t i = 0; i < b.pose.size(); ++i) {
    if (!b.active(static_cast<int>(i))) {
      b.invMass[i] = 0, b.invInertia[i] = Inertia<D>::Zero();
      continue;
    }
    b.invMass[i] = b.pinned[i] ? Real(0) : 1 / b.mass[i];
    if (m_settings.features.rotation) b.invInertia[i] = rotateInertia(b.pose[i].q, b.invInertiaBody[i]);
  }
}

template <int D>
void World<D>::eval(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Real mass = m_bodies.mass[i];
    out[i] = m_userForces[i];
    out[i].force += mass * m_bodies.gravityScale[i] * m_settings.gravity;
  }
  const ForceState<D> known{state.bodies, state.pose, state.motion, m_dt, m_lastContacts, m_lastDt};
  applyForces(forces(), known, t, out);
  for (const auto& f : m_generators) f->apply(known, t, out);
}

template <int D>
void World<D>::step(Real dt) {
  if (!(dt >= 0) || !std::isfinite(dt)) {
    throw UserError("step: dt is " + std::to_string(dt) + "; valid: a finite number of seconds >= 0");
  }
  if (dt == 0) return;
  const Clock::time_point start = Clock::now();
  m_profiler.beginFrame(m_steps);
  m_dt = dt;
  m_lastContacts.clear();  // a solver changes impulses while it asks for forces
  if (std::any_of(m_forces.begin(), m_forces.end(), [](const auto& f) { return f.kind && f.kind->readsContacts(); })) {
    m_lastContacts.reserve(m_manifolds.capacity());  // a copy has room for itself alone
    m_lastContacts.insert(m_lastContacts.end(), m_manifolds.begin(), m_manifolds.end());
  }
  m_profiler.frame().work[WorkCount::eventVisits] += std::exchange(m_visits, 0);
  {
    Profiler::Scope scope(m_profiler, "boxes");
    sync();
  }
  findPairs(dt);
  makeContacts();
  {
    Profiler::Scope scope(m_profiler, "listeners");
    tellListeners(false);
  }
  outdateGraph();
  if (m_settings.features.sleeping) {
    Profiler::Scope scope(m_profiler, "sleep");
    decideSleep(dt);
  }
  m_events.clear();
  {
    Profiler::Scope scope(m_profiler, "solver");
    refreshMasses();
    if (looks(Lookout::after)) m_start = m_bodies.pose;
    collectActive();
    stage<Solver>().step({dt, m_lastDt, m_time, m_bodies, m_manifolds, m_active, m_joints, *this, *this,
                          m_settings.features, m_settings.restitutionThreshold, m_profiler.frame().work, m_profiler,
                          m_graph, m_watcher});
  }
  stopAtMeetings(dt);
  if (m_settings.features.joints) finishJoints(dt);
  m_boxes.outdate();
  std::fill(m_userForces.begin(), m_userForces.end(), Wrench<D>{});
  m_time += dt, m_lastDt = dt;
  ++m_steps;

  Profiler::Frame& f = m_profiler.frame();
  f.bodies = bodyCount(), f.pairs = static_cast<int>(m_pairs.size()),
  f.manifolds = static_cast<int>(m_manifolds.size());
  f.awake = f.points = 0;
  for (std::size_t i = 0; i < m_bodies.pose.size(); ++i) f.awake += m_bodies.active(static_cast<int>(i));
  for (const Manifold<D>& m : m_manifolds) f.points += m.count;
  m_profiler.endFrame(std::chrono::duration<double>(Clock::now() - start).count());
}

template <int D>
std::uint64_t World<D>::hash() const {
  XXH64_state_t* state = XXH64_createState();
  XXH64_reset(state, 0);
  const auto put = [&](const auto& x) { XXH64_update(state, &x, sizeof x); };
  for (std::size_t i = 0; i < m_bodies.pose.size(); ++i) {
    put(m_bodies.used[i]);
    if (!m_bodies.used[i]) continue;
    const Pose<D>& x = m_bodies.pose[i];
    XXH64_update(state, x.p.data(), sizeof(Real) * D);
    put(x.q);
    XXH64_update(state, m_bodies.motion[i].v.data(), sizeof(Real) * D);
    XXH64_update(state, m_bodies.motion[i].w.data(), sizeof(Real) * kAngDim<D>);
  }
  const std::uint64_t h = XXH64_digest(state);
  XXH64_freeState(state);
  return h;
}

// The members of this file; the class as a whole is instantiated in world.cpp.
#define LPC_INSTANTIATE(D)                                                              \
  template void World<D>::eval(const ForceState<D>&, Real, std::span<Wrench<D>>) const; \
  template void World<D>::step(Real);                                                   \
  template std::uint64_t World<D>::hash() const
LPC_INSTANTIATE(2);
LPC_INSTANTIATE(3);
#undef LPC_INSTANTIATE

}}  // namespace lpc::LPC_PRECISION
