// SPDX-License-Identifier: Zlib
// One step of a world: boxes, pairs, cache.select, contacts, cache.carry, listeners, sleep, solver.
#define XXH_INLINE_ALL  // one hash needs no library at link time
#include <xxhash.h>

#include <algorithm>
#include <cmath>

#include "framework/world.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using Clock = std::chrono::steady_clock;

template <int D>
Real smallestSeparation(const Manifold<D>& m) {
  Real s = m.points[0].separation;
  for (int i = 1; i < m.count; ++i) s = std::min(s, m.points[static_cast<std::size_t>(i)].separation);
  return s;
}

// Largest speed of approach over the points, m/s, at least 0.
template <int D>
Real approachSpeed(const Manifold<D>& m, const Bodies<D>& bodies) {
  const auto a = static_cast<std::size_t>(m.bodyA), b = static_cast<std::size_t>(m.bodyB);
  Real speed = 0;
  for (int i = 0; i < m.count; ++i) {
    const ContactPoint<D>& c = m.points[static_cast<std::size_t>(i)];
    const Vec<D> vA = bodies.motion[a].v + cross(bodies.motion[a].w, bodies.pose[a].q * c.localA);
    const Vec<D> vB = bodies.motion[b].v + cross(bodies.motion[b].w, bodies.pose[b].q * c.localB);
    speed = std::max(speed, -(vB - vA).dot(m.normal));
  }
  return speed;
}

}  // namespace

template <int D>
bool World<D>::proxyActive(std::size_t body) const {
  return m_bodies.awake[body] && m_bodies.type[body] != BodyType::fixed;
}

template <int D>
void World<D>::refreshBox(std::size_t shape) const {
  const ShapeRecord<D>& s = m_shapes[shape];
  const auto body = static_cast<std::size_t>(s.body);
  // Both boxes of a pair grow by half the margin, so that they overlap when the shapes are within the whole of it.
  Aabb<D> box = boundingBox(s.shape.view(), m_bodies.pose[body] * s.X_CS).grown(m_settings.margin / 2);
  // A body that has become NaN takes no part in collision; it is for the caller to see and stop.
  if (!box.lo.allFinite() || !box.hi.allFinite()) box = Aabb<D>{};
  m_proxies.setBox(static_cast<ProxyId>(shape), box);
  m_proxies.active[shape] = proxyActive(body);
}

template <int D>
void World<D>::sync() const {
  if (!m_stale) return;
  m_stale = false;
  for (std::size_t s = 0; s < m_shapes.size(); ++s) {
    const std::int32_t body = m_shapes[s].body;
    if (body < 0) continue;
    const bool active = proxyActive(static_cast<std::size_t>(body));
    if (active) {
      refreshBox(s);
      m_moved.push_back(static_cast<ProxyId>(s));
    } else if (m_proxies.active[s]) {
      m_proxies.active[s] = 0;
      m_moved.push_back(static_cast<ProxyId>(s));
    }
  }
  std::sort(m_moved.begin(), m_moved.end());
  m_moved.erase(std::unique(m_moved.begin(), m_moved.end()), m_moved.end());
  stage<Broadphase>().update(m_proxies, {m_added, m_removed, m_moved});
  m_added.clear(), m_removed.clear(), m_moved.clear();
}

template <int D>
void World<D>::findPairs() {
  m_proxyPairs.clear();
  stage<Broadphase>().findPairs(m_proxies, m_proxyPairs, m_profiler.frame().work);
  m_unpaired.clear();
  if (m_settings.features.joints) {
    for (const PivotJoint<D>& j : m_joints) {
      if (j.bodyA >= 0 && !j.collide) m_unpaired.emplace_back(std::minmax(j.bodyA, j.bodyB));
    }
    std::sort(m_unpaired.begin(), m_unpaired.end());
  }
  m_pairs.clear();
  for (const ProxyPair& p : m_proxyPairs) {
    ShapePair pair{p.a, p.b};
    std::int32_t a = m_shapes[static_cast<std::size_t>(p.a)].body, b = m_shapes[static_cast<std::size_t>(p.b)].body;
    if (a > b) std::swap(a, b), std::swap(pair.a, pair.b);
    const bool moves = m_bodies.type[static_cast<std::size_t>(a)] == BodyType::dynamic ||
                       m_bodies.type[static_cast<std::size_t>(b)] == BodyType::dynamic;
    if (!moves || std::binary_search(m_unpaired.begin(), m_unpaired.end(), std::pair(a, b))) continue;
    m_pairs.push_back(pair);
  }
}

template <int D>
void World<D>::makeContacts() {
  std::swap(m_manifolds, m_oldManifolds);
  m_fresh.clear();
  Work& work = m_profiler.frame().work;
  {
    Profiler::Scope scope(m_profiler, "cache");
    stage<ContactCache>().select(m_pairs, m_oldManifolds, m_bodies.pose, m_regenerate);
  }
  {
    Profiler::Scope scope(m_profiler, "contacts");
    stage<ContactGenerator>().generate(
        {m_regenerate, m_shapes, m_bodies.pose, m_settings.margin, m_settings.features.friction}, m_fresh, work);
  }
  Profiler::Scope scope(m_profiler, "cache");
  // A pair without an active proxy is not reported by the broadphase: it stays as it was.
  for (const Manifold<D>& m : m_oldManifolds) {
    const bool resting =
        !m_proxies.active[static_cast<std::size_t>(m.shapeA)] && !m_proxies.active[static_cast<std::size_t>(m.shapeB)];
    if (resting) m_fresh.push_back(m);
  }
  // Sort an index first: manifolds are large.
  m_order.resize(m_fresh.size());
  for (std::size_t i = 0; i < m_order.size(); ++i) m_order[i] = static_cast<std::uint32_t>(i);
  const auto before = [&](std::uint32_t a, std::uint32_t b) { return m_fresh[a].key() < m_fresh[b].key(); };
  if (!std::is_sorted(m_order.begin(), m_order.end(), before)) std::sort(m_order.begin(), m_order.end(), before);
  m_manifolds.clear();
  for (std::uint32_t i : m_order) m_manifolds.push_back(m_fresh[i]);
  if (m_settings.features.cache) stage<ContactCache>().carry(m_oldManifolds, m_manifolds);
}

template <int D>
void World<D>::tellListeners() {
  const auto asleep = [&](std::int32_t body) { return !m_bodies.awake[static_cast<std::size_t>(body)]; };
  // Only sleeping bodies need events, and seldom are there any.
  const auto wakeEvent = [&](SleepEvent::Kind kind, const Manifold<D>& m, Real speed) {
    if (asleep(m.bodyA)) m_events.push_back({kind, m.bodyA, m.bodyB, double(speed)});
    if (asleep(m.bodyB)) m_events.push_back({kind, m.bodyB, m.bodyA, double(speed)});
  };
  const auto resting = [&](const Manifold<D>& m) {
    return !m_proxies.active[static_cast<std::size_t>(m.shapeA)] &&
           !m_proxies.active[static_cast<std::size_t>(m.shapeB)];
  };
  const auto ended = [&](const Manifold<D>& m) {
    wakeEvent(SleepEvent::contactLost, m, 0);
    for (ContactListener<D>* l : m_listeners) l->end(*this, m);
  };
  std::size_t o = 0;
  for (Manifold<D>& m : m_manifolds) {
    while (o < m_oldManifolds.size() && m_oldManifolds[o].key() < m.key()) ended(m_oldManifolds[o++]);
    const bool known = o < m_oldManifolds.size() && m_oldManifolds[o].key() == m.key();
    const Manifold<D>* old = known ? &m_oldManifolds[o++] : nullptr;
    if (resting(m)) continue;
    m.begun = !known, m.ignored = 0;
    if (!known) {
      wakeEvent(SleepEvent::contactBegun, m, approachSpeed(m, m_bodies));
    } else if (asleep(m.bodyA) || asleep(m.bodyB)) {
      const Real growth = smallestSeparation(m) - smallestSeparation(*old);
      if (growth > 0 && m_lastDt > 0) wakeEvent(SleepEvent::separationGrown, m, growth / m_lastDt);
    }
    for (ContactListener<D>* l : m_listeners) {
      if (!(known ? l->persist(*this, m) : l->begin(*this, m))) m.ignored = 1;
    }
  }
  while (o < m_oldManifolds.size()) ended(m_oldManifolds[o++]);
}

template <int D>
void World<D>::decideSleep(Real dt) {
  m_awakeBefore = m_bodies.awake;
  stage<SleepPolicy>().decide(
      {dt, m_bodies, m_manifolds, m_joints, m_events, m_settings.restitutionThreshold, m_settings.gravity},
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
void World<D>::collectActive() {
  m_active.clear();
  for (std::size_t i = 0; i < m_manifolds.size(); ++i) {
    const Manifold<D>& m = m_manifolds[i];
    if (!m.ignored && (m_bodies.active(m.bodyA) || m_bodies.active(m.bodyB))) m_active.push_back(static_cast<int>(i));
  }
}

template <int D>
void World<D>::again() {
  ++m_profiler.frame().work[Count::detections];
  makeContacts();
  // What was begun or vetoed in this step stays so.
  std::size_t o = 0;
  for (Manifold<D>& m : m_manifolds) {
    while (o < m_oldManifolds.size() && m_oldManifolds[o].key() < m.key()) ++o;
    if (o < m_oldManifolds.size() && m_oldManifolds[o].key() == m.key()) {
      m.begun = m_oldManifolds[o].begun, m.ignored = m_oldManifolds[o].ignored;
    } else {
      m.begun = 1;
    }
  }
  collectActive();
}

template <int D>
void World<D>::eval(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Real mass = m_bodies.mass[i];
    out[i] = m_userForces[i];
    out[i].force += mass * m_settings.gravity;
  }
  for (const auto& f : m_forces) f->apply(state, t, out);
}

template <int D>
void World<D>::step(Real dt) {
  if (!(dt >= 0) || !std::isfinite(dt)) {
    throw UserError("step: dt is " + std::to_string(dt) + "; valid: a finite number of seconds >= 0");
  }
  if (dt == 0) return;
  const Clock::time_point start = Clock::now();
  m_profiler.beginFrame(m_steps);
  {
    Profiler::Scope scope(m_profiler, "boxes");
    sync();
  }
  {
    Profiler::Scope scope(m_profiler, "broadphase");
    findPairs();
  }
  makeContacts();
  {
    Profiler::Scope scope(m_profiler, "listeners");
    tellListeners();
  }
  if (m_settings.features.sleeping) {
    Profiler::Scope scope(m_profiler, "sleep");
    decideSleep(dt);
  }
  m_events.clear();
  {
    Profiler::Scope scope(m_profiler, "solver");
    refreshMasses();
    collectActive();
    stage<Solver>().step({dt, m_lastDt, m_time, m_bodies, m_manifolds, m_active, m_joints, *this, *this,
                          m_settings.features, m_settings.restitutionThreshold, m_profiler.frame().work, m_profiler});
  }
  m_stale = true;
  std::fill(m_userForces.begin(), m_userForces.end(), Wrench<D>{});
  m_time += dt, m_lastDt = dt;
  ++m_steps;

  Profiler::Frame& f = m_profiler.frame();
  f.bodies = m_bodyCount, f.pairs = static_cast<int>(m_pairs.size()),
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
  template bool World<D>::proxyActive(std::size_t) const;                               \
  template void World<D>::refreshBox(std::size_t) const;                                \
  template void World<D>::sync() const;                                                 \
  template void World<D>::again();                                                      \
  template void World<D>::eval(const ForceState<D>&, Real, std::span<Wrench<D>>) const; \
  template void World<D>::step(Real);                                                   \
  template std::uint64_t World<D>::hash() const
LPC_INSTANTIATE(2);
LPC_INSTANTIATE(3);
#undef LPC_INSTANTIATE

}  // namespace lpc::inline LPC_PRECISION
