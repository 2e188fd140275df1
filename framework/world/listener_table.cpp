// SPDX-License-Identifier: Zlib
#include "framework/world/listener_table.h"

#include "framework/math/user_numbers.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Largest approach speed over the points, m/s, at least 0.
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

// The only exception that a step may throw: its cause is in the user's code.
void checkMaterial(const PairMaterial& m) {
  checkAmount(m.friction, "a listener's mix", "friction");
  checkAmount(m.restitution, "a listener's mix", "restitution");
}

// Copies begun, veto and material.
template <int D>
void hear(Manifold<D>& m, const PastPair& said) {
  m.begun = said.begun, m.ignored = said.ignored;
  m.friction = said.friction, m.restitution = said.restitution;
}

// True when each body is asleep or static, and the user has changed neither.
template <int D>
bool quiet(const Manifold<D>& m, const BodyTable<D>& table) {
  const auto moves = [&](std::int32_t body) {
    const auto i = static_cast<std::size_t>(body);
    return (table.bodies.awake[i] && table.bodies.type[i] != BodyType::fixed) || table.boxes.changed(body);
  };
  return !moves(m.bodyA) && !moves(m.bodyB);
}

template <class Listener>
void addOnce(std::vector<Listener*>& list, Listener* listener) {
  if (!listener) throw UserError("world: the listener is null");
  if (std::find(list.begin(), list.end(), listener) == list.end()) list.push_back(listener);
}

}  // namespace

template <int D>
void ListenerTable<D>::add(ContactListener<D>* listener) {
  addOnce(m_all, listener);
}
template <int D>
void ListenerTable<D>::add(std::size_t body, ContactListener<D>* listener) {
  if (body >= m_ofBodies.size()) m_ofBodies.resize(body + 1);
  addOnce(m_ofBodies[body], listener);
}
template <int D>
bool ListenerTable<D>::isOf(std::int32_t slot, const ContactListener<D>* listener) const {
  const auto i = static_cast<std::size_t>(slot);
  if (slot < 0 || i >= m_ofBodies.size()) return false;
  return std::find(m_ofBodies[i].begin(), m_ofBodies[i].end(), listener) != m_ofBodies[i].end();
}
template <int D>
void ListenerTable<D>::remove(ContactListener<D>* listener) {
  std::erase(m_all, listener);
  for (auto& of : m_ofBodies) std::erase(of, listener);
}
template <int D>
bool ListenerTable<D>::anyFor(const Manifold<D>& m) const {
  const auto has = [&](std::int32_t body) {
    const auto i = static_cast<std::size_t>(body);
    return i < m_ofBodies.size() && !m_ofBodies[i].empty();
  };
  return !m_all.empty() || has(m.bodyA) || has(m.bodyB);
}
template <int D>
void ListenerTable<D>::forget(std::size_t body) {
  if (body < m_ofBodies.size()) m_ofBodies[body].clear();
}

template <int D>
void ListenerTable<D>::notify(const World<D>& world, BodyTable<D>& table, const StepContacts<D>& news) const {
  const auto asleep = [&](std::int32_t body) { return !table.bodies.awake[static_cast<std::size_t>(body)]; };
  // Mostly sleeping bodies need events, and few bodies sleep near contacts that change.
  const auto wakeEvent = [&](SleepEvent::Kind kind, const Manifold<D>& m, Real speed) {
    if (asleep(m.bodyA)) table.events.push_back({kind, m.bodyA, m.bodyB, double(speed)});
    if (asleep(m.bodyB)) table.events.push_back({kind, m.bodyB, m.bodyA, double(speed)});
  };
  // Position correction moves awake bodies without a velocity, so that only an event keeps them awake.
  const auto repairEvent = [&](const Manifold<D>& m, Real speed) {
    for (const auto& [body, other] : {std::pair(m.bodyA, m.bodyB), std::pair(m.bodyB, m.bodyA)}) {
      if (asleep(body) || table.bodies.type[static_cast<std::size_t>(body)] != BodyType::dynamic) continue;
      table.events.push_back({SleepEvent::separationGrown, body, other, double(speed)});
    }
  };
  std::span<const PastPair> old = news.before;
  std::span<const Manifold<D>> past = news.past;
  const auto end = [&] {
    while (past[0].shapeKey() < old[0].shapeKey()) past = past.subspan(1);
    wakeEvent(SleepEvent::contactLost, past[0], 0);
    forEach(past[0], [&](ContactListener<D>& l) { l.end(world, past[0]); });
    old = old.subspan(1);
  };
  for (std::span<Manifold<D>> rest = news.now; !rest.empty();) {
    const std::span<Manifold<D>> pair = firstPair(rest);
    const Manifold<D>& m = pair[0];
    rest = rest.subspan(pair.size());
    while (!old.empty() && old[0].shapeKey() < m.shapeKey()) end();
    const bool known = !old.empty() && old[0].shapeKey() == m.shapeKey();
    const PastPair before = known ? old[0] : PastPair();
    if (known) old = old.subspan(1);
    if (table.resting(m)) continue;
    if (known && (news.again || quiet(m, table))) {  // made again in the step, or at rest: keep the answer
      for (Manifold<D>& manifold : pair) hear(manifold, before);
      continue;
    }
    for (Manifold<D>& manifold : pair) manifold.begun = !known, manifold.ignored = 0;
    if (!known) {
      wakeEvent(SleepEvent::contactBegun, m, approachSpeed<D>(pair, table.bodies));
    } else if (news.sinceBefore > 0) {
      const bool deep = before.separation < -kLinearSlop;
      if (deep || asleep(m.bodyA) || asleep(m.bodyB)) {
        const Real growth = smallestSeparation<D>(pair) - before.separation;
        if (growth > 0) wakeEvent(SleepEvent::separationGrown, m, growth / news.sinceBefore);
        if (growth > 0 && deep) repairEvent(m, growth / news.sinceBefore);
      }
    }
    if (anyFor(m)) {
      PairMaterial material{m.friction, m.restitution};
      forEach(m, [&](ContactListener<D>& l) { l.mix(world, m, material); });
      checkMaterial(material);
      for (Manifold<D>& manifold : pair)
        manifold.friction = material.friction, manifold.restitution = material.restitution;
      forEach(m, [&](ContactListener<D>& l) {
        if (known ? l.persist(world, m) : l.begin(world, m)) return;
        for (Manifold<D>& manifold : pair) manifold.ignored = 1;
      });
    }
    // A veto that begins wakes the bodies in contact; one that ends wakes those that overlap by then.
    if (known && m.ignored && !before.ignored) wakeEvent(SleepEvent::contactLost, m, 0);
    if (known && !m.ignored && before.ignored) {
      wakeEvent(SleepEvent::contactBegun, m, approachSpeed<D>(pair, table.bodies));
    }
  }
  while (!old.empty()) end();
}

template class ListenerTable<2>;
template class ListenerTable<3>;

}}  // namespace lpc::LPC_PRECISION
