// SPDX-License-Identifier: Zlib
// From pairs of boxes to the manifolds that a solver sees, and who is told: pairs, cache.select, contacts, cache.carry,
// listeners.
#include <algorithm>
#include <utility>

#include "framework/math/user_numbers.h"
#include "framework/world/internal_edges.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// The manifolds of the first pair of shapes, one for each pair of their children: they stand together.
template <class M>
std::span<M> firstPair(std::span<M> manifolds) {
  std::size_t n = 0;
  while (n < manifolds.size() && manifolds[n].shapeKey() == manifolds[0].shapeKey()) ++n;
  return manifolds.first(n);
}

template <int D>
Real smallestSeparation(std::span<const Manifold<D>> pair) {
  Real s = pair[0].points[0].separation;
  for (const Manifold<D>& m : pair) {
    for (int i = 0; i < m.count; ++i) s = std::min(s, m.points[static_cast<std::size_t>(i)].separation);
  }
  return s;
}

// Largest speed of approach over the points, m/s, at least 0.
template <int D>
Real approachSpeed(std::span<const Manifold<D>> pair, const Bodies<D>& bodies) {
  const auto a = static_cast<std::size_t>(pair[0].bodyA), b = static_cast<std::size_t>(pair[0].bodyB);
  Real speed = 0;
  for (const Manifold<D>& m : pair) {
    for (int i = 0; i < m.count; ++i) {
      const ContactPoint<D>& c = m.points[static_cast<std::size_t>(i)];
      const Vec<D> vA = bodies.motion[a].v + cross(bodies.motion[a].w, bodies.pose[a].q * c.localA);
      const Vec<D> vB = bodies.motion[b].v + cross(bodies.motion[b].w, bodies.pose[b].q * c.localB);
      speed = std::max(speed, -(vB - vA).dot(m.normal));
    }
  }
  return speed;
}

}  // namespace

template <int D>
void World<D>::findPairs(Real dt) {
  {
    Profiler::Scope scope(m_profiler, "broadphase");
    m_proxyPairs.clear();
    m_boxes.findPairs(m_proxyPairs, m_profiler.frame().work);
    m_unpaired.clear();
    if (m_settings.features.joints) {
      for (const JointRecord<D>& j : m_joints) {
        if (j.active() && j.bodyA >= 0 && !j.collide) m_unpaired.emplace_back(std::minmax(j.bodyA, j.bodyB));
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
      if (!moves || unpaired(a, b)) continue;
      m_pairs.push_back(pair);
    }
  }
  lookAhead(dt);
  for (const Ahead& p : m_ahead) m_pairs.push_back(p.shapes);  // the broadphase has found those that are near
  // Not for the outcome, which the order of manifolds decides: generators make most of those in the order of the pairs,
  // and moving pairs is cheap.
  Profiler::Scope scope(m_profiler, "cache");
  for (const ShapePair& p : m_pairs) {
    m_order.add(
        {m_shapes[static_cast<std::size_t>(p.a)].body, p.a, m_shapes[static_cast<std::size_t>(p.b)].body, p.b, 0, 0});
  }
  m_order.apply(std::span(m_pairs));
  if (!m_ahead.empty()) m_pairs.erase(std::unique(m_pairs.begin(), m_pairs.end()), m_pairs.end());
}

namespace {

template <int D>
PairRecord recordOf(const ConvexPair<D>& pair, std::span<const ShapeRecord<D>> shapes) {
  const auto body = [&](std::int32_t shape) { return shapes[static_cast<std::size_t>(shape)].body; };
  const ShapePair& s = pair.shapes;
  return {.bodyA = body(s.a),
          .shapeA = s.a,
          .bodyB = body(s.b),
          .shapeB = s.b,
          .childA = pair.childA,
          .childB = pair.childB};
}

}  // namespace

template <int D>
Real World<D>::marginOf(const ShapePair& pair) const {
  const auto at = std::partition_point(m_ahead.begin(), m_ahead.end(), [&](const Ahead& p) { return p.shapes < pair; });
  return at != m_ahead.end() && at->shapes == pair ? at->margin : m_settings.margin;
}

// What was remembered of each pair, nothing of a new one. Both lists are in the order of their keys.
template <int D>
std::span<PairMemory> World<D>::recall(std::span<const ConvexPair<D>> children) {
  m_memory.clear();
  if (!m_settings.features.cache || !stage<ContactGenerator>().remembers()) return {};
  if (children.empty()) return {};
  const auto first = recordOf<D>(children[0], m_shapes).key();
  auto o = static_cast<std::size_t>(
      std::partition_point(m_records.begin(), m_records.end(), [&](const PairRecord& r) { return r.key() < first; }) -
      m_records.begin());
  for (const ConvexPair<D>& pair : children) {
    const auto key = recordOf<D>(pair, m_shapes).key();
    while (o < m_records.size() && m_records[o].key() < key) ++o;
    const bool known = o < m_records.size() && m_records[o].key() == key;
    m_memory.push_back(known ? m_records[o].memory : PairMemory{});
  }
  return m_memory;
}

// After the generator has written its memory. A pair that nobody was asked about keeps its record: it rests, or the
// cache keeps its contacts. All others are forgotten.
template <int D>
void World<D>::remember() {
  std::swap(m_records, m_oldRecords);
  m_records.clear();
  if (!m_settings.features.cache || !stage<ContactGenerator>().remembers()) return;
  const auto among = [&](const std::vector<ShapePair>& pairs, const PairRecord& r) {
    const auto keyOf = [&](const ShapePair& p) {
      return std::tuple(m_shapes[static_cast<std::size_t>(p.a)].body, p.a, m_shapes[static_cast<std::size_t>(p.b)].body,
                        p.b);
    };
    const std::tuple key(r.bodyA, r.shapeA, r.bodyB, r.shapeB);
    const auto at =
        std::partition_point(pairs.begin(), pairs.end(), [&](const ShapePair& p) { return keyOf(p) < key; });
    return at != pairs.end() && keyOf(*at) == key;
  };
  std::size_t o = 0;
  const auto keepUpTo = [&](const auto& isPast) {
    for (; o < m_oldRecords.size() && !isPast(m_oldRecords[o]); ++o) {
      const PairRecord& r = m_oldRecords[o];
      if (resting(r) || (among(m_pairs, r) && !among(m_regenerate, r))) m_records.push_back(r);
    }
  };
  for (const PairRecord& r : m_asked) {
    keepUpTo([&](const PairRecord& old) { return old.key() >= r.key(); });
    if (o < m_oldRecords.size() && m_oldRecords[o].key() == r.key()) ++o;
    m_records.push_back(r);
  }
  keepUpTo([](const PairRecord&) { return false; });
}

template <int D>
void World<D>::generate(std::span<const ShapePair> pairs, Real margin) {
  WorkDone& work = m_profiler.frame().work;
  const auto children = m_children.of(pairs, m_shapes, m_bodies.pose, margin, work);
  const std::span<PairMemory> memory = recall(children);
  const std::span<const Manifold<D>> old = m_oldManifolds;
  const std::size_t before = m_manifolds.size();
  stage<ContactGenerator>().generate(
      {children, m_shapes, m_bodies.pose, margin, m_settings.features.friction, m_settings.mixing, memory,
       m_settings.features.cache ? old : std::span<const Manifold<D>>()},
      m_manifolds, work);
  correctSurfaceContacts<D>(m_shapes, m_bodies.pose, margin, before, m_manifolds);
  for (std::size_t i = 0; i < memory.size(); ++i) {
    m_asked.push_back(recordOf<D>(children[i], m_shapes));
    m_asked.back().memory = memory[i];
  }
}

template <int D>
void World<D>::makeContacts() {
  // Where everybody rests contacts stay in their places: copying them was most of such a step.
  const auto rests = [&](const Manifold<D>& m) { return resting(m); };
  if (m_pairs.empty() && std::all_of(m_manifolds.begin(), m_manifolds.end(), rests)) {
    Profiler::Scope scope(m_profiler, "contacts");
    m_oldManifolds.clear(), m_asked.clear();
    remember();
    return;
  }
  std::swap(m_manifolds, m_oldManifolds);
  m_manifolds.clear();
  const CacheInput<D> cacheInput{m_pairs, m_oldManifolds, m_shapes, m_bodies.pose, m_settings.margin};
  {
    Profiler::Scope scope(m_profiler, "cache");
    if (m_settings.features.cache) {
      stage<ContactCache>().select(cacheInput, m_regenerate);
    } else {
      m_regenerate = m_pairs;
    }
  }
  {
    Profiler::Scope scope(m_profiler, "contacts");
    m_asked.clear();
    for (std::span<const ShapePair> rest = m_regenerate; !rest.empty();) {  // most have the same margin
      const Real margin = marginOf(rest[0]);
      std::size_t n = 1;
      while (n < rest.size() && (m_ahead.empty() || marginOf(rest[n]) == margin)) ++n;
      generate(rest.first(n), margin);
      rest = rest.subspan(n);
    }
    remember();
    for (Manifold<D>& m : m_manifolds) {
      const Pose<D>& X_WA = m_bodies.pose[static_cast<std::size_t>(m.bodyA)];
      m.X_AB = poseBetween(X_WA, m_bodies.pose[static_cast<std::size_t>(m.bodyB)]);
      m.normalA = X_WA.q.inverse() * m.normal;
    }
  }
  Profiler::Scope scope(m_profiler, "cache");
  // A pair without an active proxy is not reported by the broadphase: it stays as it was.
  for (const Manifold<D>& m : m_oldManifolds) {
    if (resting(m)) m_manifolds.push_back(m);
  }
  for (const Manifold<D>& m : m_manifolds) m_order.add(m.key());
  m_order.apply(std::span(m_manifolds));
  if (!m_settings.features.cache) return;
  stage<ContactCache>().carry(cacheInput, m_manifolds);
  if (m_regenerate.size() < m_pairs.size()) mixKept();
}

// What a cache has kept has the material that a listener gave it, or that a shape had before it was changed. All other
// contacts were made in this step, with the material of their shapes, or rest.
template <int D>
void World<D>::mixKept() {
  std::span<const ShapePair> fresh = m_regenerate;  // in the order of the manifolds
  for (Manifold<D>& m : m_manifolds) {
    const auto before = [&](const ShapePair& p) {
      return std::tuple(m_shapes[static_cast<std::size_t>(p.a)].body, p.a, m_shapes[static_cast<std::size_t>(p.b)].body,
                        p.b) < m.shapeKey();
    };
    while (!fresh.empty() && before(fresh[0])) fresh = fresh.subspan(1);
    if (resting(m) || (!fresh.empty() && fresh[0] == ShapePair{m.shapeA, m.shapeB})) continue;
    const PairMaterial material = mixed(m);
    m.friction = material.friction, m.restitution = material.restitution;
  }
}

template <int D>
PairMaterial World<D>::mixed(const Manifold<D>& m) const {
  const ShapeRecord<D>&a = m_shapes[static_cast<std::size_t>(m.shapeA)],
        &b = m_shapes[static_cast<std::size_t>(m.shapeB)];
  return {m_settings.features.friction ? lpc::mix(m_settings.mixing.friction, a.friction, b.friction) : Real(0),
          lpc::mix(m_settings.mixing.restitution, a.restitution, b.restitution)};
}

namespace {

// A world may stop in a step with an exception of its user's making, and no other.
void checkMaterial(const PairMaterial& m) {
  checkAmount(m.friction, "a listener's mix", "friction");
  checkAmount(m.restitution, "a listener's mix", "restitution");
}

// What was begun, vetoed or mixed stays so.
template <int D>
void hear(Manifold<D>& m, const Manifold<D>& said) {
  m.begun = said.begun, m.ignored = said.ignored;
  m.friction = said.friction, m.restitution = said.restitution;
}

}  // namespace

template <int D>
void World<D>::tellListeners(bool again) {
  const auto asleep = [&](std::int32_t body) { return !m_bodies.awake[static_cast<std::size_t>(body)]; };
  // Only sleeping bodies need events, and seldom are there any.
  const auto wakeEvent = [&](SleepEvent::Kind kind, const Manifold<D>& m, Real speed) {
    if (asleep(m.bodyA)) m_events.push_back({kind, m.bodyA, m.bodyB, double(speed)});
    if (asleep(m.bodyB)) m_events.push_back({kind, m.bodyB, m.bodyA, double(speed)});
  };
  std::span<const Manifold<D>> old = m_oldManifolds;
  const auto end = [&] {
    wakeEvent(SleepEvent::contactLost, old[0], 0);
    forListeners(old[0], [&](ContactListener<D>& l) { l.end(*this, old[0]); });
    old = old.subspan(firstPair(old).size());
  };
  for (std::span<Manifold<D>> rest = m_manifolds; !rest.empty();) {
    const std::span<Manifold<D>> pair = firstPair(rest);
    const Manifold<D>& m = pair[0];
    rest = rest.subspan(pair.size());
    while (!old.empty() && old[0].shapeKey() < m.shapeKey()) end();
    const bool known = !old.empty() && old[0].shapeKey() == m.shapeKey();
    const std::span<const Manifold<D>> before = known ? firstPair(old) : std::span<const Manifold<D>>();
    old = old.subspan(before.size());
    if (resting(m)) continue;
    if (known && (again || quiet(m))) {  // made anew within the step, or for sleepers: what was said of it stays
      for (Manifold<D>& child : pair) hear(child, before[0]);
      continue;
    }
    for (Manifold<D>& child : pair) child.begun = !known, child.ignored = 0;
    if (!known) {
      wakeEvent(SleepEvent::contactBegun, m, approachSpeed<D>(pair, m_bodies));
    } else if (asleep(m.bodyA) || asleep(m.bodyB)) {
      const Real growth = smallestSeparation<D>(pair) - smallestSeparation<D>(before);
      if (growth > 0 && m_lastDt > 0) wakeEvent(SleepEvent::separationGrown, m, growth / m_lastDt);
    }
    PairMaterial material{m.friction, m.restitution};
    forListeners(m, [&](ContactListener<D>& l) { l.mix(*this, m, material); });
    checkMaterial(material);
    for (Manifold<D>& child : pair) child.friction = material.friction, child.restitution = material.restitution;
    forListeners(m, [&](ContactListener<D>& l) {
      if (known ? l.persist(*this, m) : l.begin(*this, m)) return;
      for (Manifold<D>& child : pair) child.ignored = 1;
    });
    // Who slept on it has lost it, too.
    if (known && m.ignored && !before[0].ignored) wakeEvent(SleepEvent::contactLost, m, 0);
  }
  while (!old.empty()) end();
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
  ++m_profiler.frame().work[WorkCount::detections];
  makeContacts();
  {
    Profiler::Scope scope(m_profiler, "listeners");
    tellListeners(true);
  }
  collectActive();
  outdateGraph();
}

// The members of this file; the class as a whole is instantiated in world.cpp.
#define LPC_INSTANTIATE(D)                                                         \
  template void World<D>::findPairs(Real);                                         \
  template void World<D>::makeContacts();                                          \
  template std::span<PairMemory> World<D>::recall(std::span<const ConvexPair<D>>); \
  template void World<D>::remember();                                              \
  template Real World<D>::marginOf(const ShapePair&) const;                        \
  template PairMaterial World<D>::mixed(const Manifold<D>&) const;                 \
  template void World<D>::mixKept();                                               \
  template void World<D>::generate(std::span<const ShapePair>, Real);              \
  template void World<D>::tellListeners(bool);                                     \
  template void World<D>::collectActive();                                         \
  template void World<D>::again()
LPC_INSTANTIATE(2);
LPC_INSTANTIATE(3);
#undef LPC_INSTANTIATE

}}  // namespace lpc::LPC_PRECISION
