// SPDX-License-Identifier: Zlib
// What lies between the poses of two steps: pairs that would meet get contacts before it, or bodies that met are
// stopped after it.
#include <algorithm>
#include <queue>

#include "framework/world.h"

namespace lpc::inline LPC_PRECISION {
namespace {

constexpr Real kNever = std::numeric_limits<Real>::infinity();

}  // namespace

template <int D>
std::span<const typename FastParts<D>::Pair> World<D>::fastPairs(const Ways<D>& ways) {
  const auto found = m_fast.find(ways, stage<ContinuousCollision>().threshold(), m_bodies, m_shapes, m_boxes);
  m_profiler.frame().work[WorkCount::sweptPairs] += found.size();
  return found;
}

template <int D>
void World<D>::lookAhead(Real dt) {
  m_ahead.clear();
  if (!looks(Lookout::before)) return;
  Profiler::Scope scope(m_profiler, "continuous");
  for (const auto& p : fastPairs({m_bodies.pose, m_bodies.motion, dt})) {
    if (unpaired(p.a.body, p.b.body)) continue;
    m_ahead.push_back({{p.a.shape, p.b.shape}, m_settings.margin + p.a.goes + p.b.goes});
  }
  // Of the parts of two shapes the one that comes nearest.
  std::sort(m_ahead.begin(), m_ahead.end(),
            [](const Ahead& p, const Ahead& q) { return std::tie(p.shapes, q.margin) < std::tie(q.shapes, p.margin); });
  m_ahead.erase(
      std::unique(m_ahead.begin(), m_ahead.end(), [](const Ahead& p, const Ahead& q) { return p.shapes == q.shapes; }),
      m_ahead.end());
}

// Meetings in the order of their times. The first one of a body is its last: who stands still is asked about anew, from
// then on, by those who still come.
template <int D>
void World<D>::stopAtMeetings(Real dt) {
  if (!looks(Lookout::after)) return;
  Profiler::Scope scope(m_profiler, "continuous");
  m_ways.resize(m_start.size());
  for (std::size_t i = 0; i < m_start.size(); ++i) {
    const Pose<D>&from = m_start[i], &to = m_bodies.pose[i];
    if (!m_bodies.used[i] || !m_bodies.awake[i] || m_bodies.type[i] == BodyType::fixed) {
      m_ways[i] = {};
    } else {
      m_ways[i] = {(to.p - from.p) / dt, turnOf(to.q * from.q.inverse()) / dt};
    }
  }
  const Ways<D> ways{m_start, m_ways, dt};
  const auto pairs = fastPairs(ways);
  if (pairs.empty()) return;

  const auto vetoed = [&](const auto& p) {
    const std::tuple key(p.a.body, p.a.shape, p.b.body, p.b.shape);
    const auto m = std::partition_point(m_manifolds.begin(), m_manifolds.end(),
                                        [&](const Manifold<D>& x) { return x.shapeKey() < key; });
    return m != m_manifolds.end() && m->shapeKey() == key && m->ignored;
  };
  m_stop.assign(m_bodies.pose.size(), kNever);
  // Who has been stopped at that time stands still from then on.
  const auto asked = [&](const typename FastParts<D>::Part& part, Real from) {
    ShapeMotion<D> motion = ways.of(part.body, part.X_CP);
    const Real stop = m_stop[static_cast<std::size_t>(part.body)];
    motion.X_WC = motion.bodyAt(std::min(from, stop));
    if (stop <= from) motion.motion = {};
    return motion;
  };
  const auto question = [&](const typename FastParts<D>::Pair& p, Real from) {
    const bool swap = p.a.view.kind > p.b.view.kind;
    const auto &a = swap ? p.b : p.a, &b = swap ? p.a : p.b;
    const auto goesOn = [&](const auto& part) {
      return part.fast && m_stop[static_cast<std::size_t>(part.body)] == kNever;
    };
    return FastPair<D>{{a.view, b.view, asked(a, from), asked(b, from)}, a.girth, b.girth, goesOn(a), goesOn(b)};
  };
  const auto stopOf = [&](const typename FastParts<D>::Pair& p) {  // of the first of the two that was stopped
    return std::min(m_stop[static_cast<std::size_t>(p.a.body)], m_stop[static_cast<std::size_t>(p.b.body)]);
  };

  std::vector<FastPair<D>> questions;
  std::vector<std::size_t> of;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (unpaired(pairs[i].a.body, pairs[i].b.body) || vetoed(pairs[i])) continue;
    questions.push_back(question(pairs[i], 0)), of.push_back(i);
  }
  std::vector<Real> t(questions.size(), kNever);
  WorkDone& work = m_profiler.frame().work;
  stage<ContinuousCollision>().meetings(questions, dt, t, work);
  struct Meeting {
    Real t;
    std::size_t pair;
    Real asked;  // what stopOf said then
    bool operator<(const Meeting& o) const { return std::tie(o.t, o.pair) < std::tie(t, pair); }  // the first on top
  };
  std::priority_queue<Meeting> queue;
  for (std::size_t k = 0; k < t.size(); ++k) {
    if (t[k] < dt) queue.push({t[k], of[k], kNever});
  }
  while (!queue.empty()) {
    const Meeting now = queue.top();
    queue.pop();
    const auto& p = pairs[now.pair];
    const Real stop = stopOf(p);
    if (stop != now.asked) {
      const FastPair<D> again = question(p, stop);
      if (!again.fastA && !again.fastB) continue;
      Real later = kNever;
      stage<ContinuousCollision>().meetings({&again, 1}, dt - stop, {&later, 1}, work);
      if (stop + later < dt) queue.push({stop + later, now.pair, stop});
      continue;
    }
    for (const auto* part : {&p.a, &p.b}) {
      const auto body = static_cast<std::size_t>(part->body);
      if (!part->fast || m_stop[body] != kNever) continue;
      m_stop[body] = now.t;
      m_bodies.pose[body] = ways.of(part->body, {}).bodyAt(now.t);
      ++work[WorkCount::stops], m_profiler.frame().lostTime += dt - now.t;
    }
  }
}

// The members of this file; the class as a whole is instantiated in world.cpp.
#define LPC_INSTANTIATE(D)                                                          \
  template std::span<const FastParts<D>::Pair> World<D>::fastPairs(const Ways<D>&); \
  template void World<D>::lookAhead(Real);                                          \
  template void World<D>::stopAtMeetings(Real)
LPC_INSTANTIATE(2);
LPC_INSTANTIATE(3);
#undef LPC_INSTANTIATE

}  // namespace lpc::inline LPC_PRECISION
