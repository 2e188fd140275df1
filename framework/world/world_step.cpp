// SPDX-License-Identifier: Zlib
// One step of a world: boxes, pairs, cache.select, contacts, cache.carry, listeners, sleep, solver, continuous.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using Clock = std::chrono::steady_clock;

template <class F>
class CallAgain final : public DetectAgain {
 public:
  explicit CallAgain(const F& f) : m_f(f) {}
  void again() override { m_f(); }

 private:
  const F& m_f;
};

}  // namespace

template <int D>
void World<D>::step(Real dt) {
  if (!(dt >= 0) || !std::isfinite(dt)) {
    throw UserError("step: dt is " + std::to_string(dt) + "; valid: a finite number of seconds >= 0");
  }
  if (dt == 0) return;
  const Clock::time_point start = Clock::now();
  m_profiler.beginFrame(m_steps);
  Profiler::Frame& f = m_profiler.frame();
  f.work[WorkCount::eventVisits] += std::exchange(m_table.visits, 0);
  m_forces.keepContacts(m_contacts.manifolds);
  {
    Profiler::Scope scope(m_profiler, "boxes");
    sync();
  }
  {
    Profiler::Scope scope(m_profiler, "broadphase");
    m_nonColliding.read(jointsInUse());
    m_contacts.findPairs(m_table, m_nonColliding, f.work);
  }
  const ContinuousInput<D> continuous{dt,        stage<ContinuousCollision>(), m_table, m_settings, m_nonColliding,
                                      m_profiler};
  m_continuous.findSpeculativePairs(continuous);
  {
    Profiler::Scope scope(m_profiler, "cache");
    m_contacts.sortPairs(m_table.shapes, m_continuous.speculativePairs());
  }
  const auto detect = [&](bool again) {
    m_contacts.make({stage<ContactCache>(), stage<ContactGenerator>(), m_table, m_settings,
                     m_continuous.speculativePairs(), m_profiler});
    Profiler::Scope scope(m_profiler, "listeners");
    m_listeners.notify(*this, m_table,
                       {m_contacts.manifolds, m_contacts.before(), m_contacts.past(), m_sinceContacts, again});
  };
  const auto outdateGraph = [&] { m_graph.reset(m_table.bodies, m_contacts.manifolds, jointsInUse(), f.work); };
  detect(false);
  outdateGraph();
  if (m_settings.model.sleeping) {
    Profiler::Scope scope(m_profiler, "sleep");
    m_awakeBefore = m_table.bodies.awake;
    stage<SleepPolicy>().decide({dt, m_table.bodies, m_contacts.manifolds, jointsInUse(), m_table.events,
                                 m_settings.restitutionThreshold, m_settings.gravity, f.work, m_graph},
                                m_table.bodies.awake, m_table.bodies.sleep);
    m_table.stopSleepers(m_awakeBefore);
  }
  m_table.events.clear();
  {
    Profiler::Scope scope(m_profiler, "solver");
    m_table.refreshMasses(m_settings.model.rotation);
    m_continuous.begin(continuous);
    const StepForces<D> forces(m_table, m_forces, {m_settings.gravity, dt, m_lastDt});
    int detections = 1;  // evenly spaced
    const auto again = [&] {
      ++detections, ++f.work[WorkCount::detections];
      detect(true);
      m_contacts.collectActive(m_table.bodies);
      outdateGraph();
    };
    CallAgain callAgain(again);
    stage<Solver>().step({dt, m_lastDt, m_time, m_table.bodies, m_contacts.manifolds,
                          m_contacts.collectActive(m_table.bodies), m_joints.records, forces, callAgain,
                          m_settings.model, m_settings.restitutionThreshold, f.work, m_profiler, m_graph, m_watcher});
    m_sinceContacts = dt / static_cast<Real>(detections);
  }
  m_continuous.stopAtImpacts(continuous, m_contacts.manifolds, m_joints.records, m_graph);
  if (m_settings.model.joints) m_joints.finish(m_table.bodies, dt, m_table.events);
  m_table.boxes.markAllStale();
  std::fill(m_table.userForces.begin(), m_table.userForces.end(), Wrench<D>{});
  m_time += dt, m_lastDt = dt;
  ++m_steps;

  f.bodies = bodyCount(), f.pairs = static_cast<int>(m_contacts.pairs().size());
  f.manifolds = static_cast<int>(m_contacts.manifolds.size());
  f.awake = f.points = 0;
  for (int i = 0; i < m_table.bodies.size(); ++i) f.awake += m_table.bodies.active(i);
  for (const Manifold<D>& m : m_contacts.manifolds) f.points += m.count;
  m_profiler.endFrame(std::chrono::duration<double>(Clock::now() - start).count());
}

template void World<2>::step(Real);
template void World<3>::step(Real);

}}  // namespace lpc::LPC_PRECISION
