// SPDX-License-Identifier: Zlib
// What lies between the poses of two steps: pairs that would meet get contacts before it, or bodies that met are
// stopped after it.
#include <algorithm>
#include <cmath>

#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr Real kNever = std::numeric_limits<Real>::infinity();

}  // namespace

template <int D>
std::span<const typename FastParts<D>::Pair> World<D>::fastPairs(const Ways<D>& ways) {
  const auto found =
      m_fast.find(ways, stage<ContinuousCollision>().threshold(), m_bodies, m_shapes, m_boxes, m_profiler.frame().work);
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

// How a body went through the step that was just solved. The turn is the one of those with this end that is nearest to
// what its speed says: a pose alone does not tell whole turns.
template <int D>
Motion<D> World<D>::wayOf(std::size_t body, Real dt) const {
  const Pose<D>&from = m_start[body], &to = m_bodies.pose[body];
  constexpr Real kWhole = Real(6.28318530717958647693);
  Ang<D> turn = turnOf(to.q * from.q.inverse());
  const Ang<D> meant = m_bodies.motion[body].w * dt;
  const Real angle = turn.norm();
  const Ang<D> axis = angle > 0 ? Ang<D>(turn / angle) : Ang<D>(meant.normalized());
  const Real more = std::round((meant.dot(axis) - angle) / kWhole);
  if (more != 0 && std::isfinite(more)) turn += more * kWhole * axis;
  return {(to.p - from.p) / dt, turn / dt};
}

// A pair as it goes on from a time on: who has been stopped stands still.
template <int D>
FastPair<D> World<D>::pairFrom(const typename FastParts<D>::Pair& p, const Ways<D>& ways, Real from) const {
  const auto motionOf = [&](const typename FastParts<D>::Part& part) {
    ShapeMotion<D> motion = ways.of(part.body, part.X_CP);
    const Real stop = m_stop[static_cast<std::size_t>(part.body)];
    motion.X_WC = motion.bodyAt(std::min(from, stop));
    if (stop <= from) motion.motion = {};
    return motion;
  };
  const auto goesOn = [&](const typename FastParts<D>::Part& part) {
    return part.fast && m_bodies.active(part.body) && m_stop[static_cast<std::size_t>(part.body)] == kNever;
  };
  const bool swap = p.a.view.kind > p.b.view.kind;
  const auto &a = swap ? p.b : p.a, &b = swap ? p.a : p.b;
  return {{a.view, b.view, motionOf(a), motionOf(b)}, a.girth, b.girth, goesOn(a), goesOn(b)};
}

template <int D>
bool World<D>::vetoed(const typename FastParts<D>::Pair& p) const {
  const std::tuple key(p.a.body, p.a.shape, p.b.body, p.b.shape);
  const auto m = std::partition_point(m_manifolds.begin(), m_manifolds.end(),
                                      [&](const Manifold<D>& x) { return x.shapeKey() < key; });
  return m != m_manifolds.end() && m->shapeKey() == key && m->ignored;
}

// Meetings in the order of their times. The first one of a body ends its step, and that of all who are jointed to it,
// or the joints would be torn. Those who still come are asked at once about who stands there now.
template <int D>
void World<D>::stopAtMeetings(Real dt) {
  if (!looks(Lookout::after)) return;
  Profiler::Scope scope(m_profiler, "continuous");
  m_ways.assign(m_start.size(), {});
  for (std::size_t i = 0; i < m_start.size(); ++i) {
    if (m_bodies.used[i] && m_bodies.awake[i] && m_bodies.type[i] != BodyType::fixed) m_ways[i] = wayOf(i, dt);
  }
  const Ways<D> ways{m_start, m_ways, dt};
  const auto pairs = fastPairs(ways);
  if (pairs.empty()) return;

  m_stop.assign(m_bodies.pose.size(), kNever);
  m_questions.clear(), m_meetings.clear(), m_pairsOf.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (unpaired(pairs[i].a.body, pairs[i].b.body) || vetoed(pairs[i])) continue;
    const FastPair<D> question = pairFrom(pairs[i], ways, 0);
    if (!question.fastA && !question.fastB) continue;
    m_questions.push_back(question), m_meetings.push_back({kNever, i, kNever});
    for (const std::int32_t body : {pairs[i].a.body, pairs[i].b.body}) m_pairsOf.emplace_back(body, i);
  }
  std::sort(m_pairsOf.begin(), m_pairsOf.end());
  m_times.assign(m_questions.size(), kNever);
  WorkDone& work = m_profiler.frame().work;
  stage<ContinuousCollision>().meetings(m_questions, dt, m_times, work);
  for (std::size_t k = 0; k < m_times.size(); ++k) m_meetings[k].t = m_times[k];
  std::erase_if(m_meetings, [&](const Meeting& m) { return !(m.t < dt); });
  std::make_heap(m_meetings.begin(), m_meetings.end());

  const auto firstStop = [&](const typename FastParts<D>::Pair& p) {
    return std::min(m_stop[static_cast<std::size_t>(p.a.body)], m_stop[static_cast<std::size_t>(p.b.body)]);
  };
  const auto stop = [&](std::int32_t slot, Real t) {
    const auto body = static_cast<std::size_t>(slot);
    if (!m_bodies.active(slot) || m_stop[body] != kNever) return;
    m_stop[body] = t, m_bodies.pose[body] = ways.of(slot, {}).bodyAt(t);
    ++work[WorkCount::stops], m_profiler.frame().lostTime += dt - t;
    m_stopped.push_back(slot);
  };
  while (!m_meetings.empty()) {
    std::pop_heap(m_meetings.begin(), m_meetings.end());
    const Meeting now = m_meetings.back();
    m_meetings.pop_back();
    const auto& p = pairs[now.pair];
    if (firstStop(p) != now.asked) continue;  // it was asked anew
    m_stopped.clear();
    for (const auto* part : {&p.a, &p.b}) {
      if (part->fast) stop(part->body, now.t);
    }
    for (std::size_t i = 0; i < m_stopped.size(); ++i) {  // grows
      for (const std::int32_t joint : m_graph.jointsOf(m_stopped[i])) {
        const JointRecord<D>& j = m_joints[static_cast<std::size_t>(joint)];
        if (j.bodyA >= 0) stop(j.bodyA, now.t);
        stop(j.bodyB, now.t);
      }
    }
    for (const std::int32_t body : m_stopped) {
      for (auto of = std::lower_bound(m_pairsOf.begin(), m_pairsOf.end(), std::pair(body, std::size_t(0)));
           of != m_pairsOf.end() && of->first == body; ++of) {
        const FastPair<D> again = pairFrom(pairs[of->second], ways, now.t);
        if (!again.fastA && !again.fastB) continue;
        Real later = kNever;
        stage<ContinuousCollision>().meetings({&again, 1}, dt - now.t, {&later, 1}, work);
        if (!(now.t + later < dt)) continue;
        m_meetings.push_back({now.t + later, of->second, now.t});
        std::push_heap(m_meetings.begin(), m_meetings.end());
      }
    }
  }
}

// The members of this file; the class as a whole is instantiated in world.cpp.
#define LPC_INSTANTIATE(D)                                                                        \
  template std::span<const FastParts<D>::Pair> World<D>::fastPairs(const Ways<D>&);               \
  template void World<D>::lookAhead(Real);                                                        \
  template Motion<D> World<D>::wayOf(std::size_t, Real) const;                                    \
  template FastPair<D> World<D>::pairFrom(const FastParts<D>::Pair&, const Ways<D>&, Real) const; \
  template bool World<D>::vetoed(const FastParts<D>::Pair&) const;                                \
  template void World<D>::stopAtMeetings(Real)
LPC_INSTANTIATE(2);
LPC_INSTANTIATE(3);
#undef LPC_INSTANTIATE

}}  // namespace lpc::LPC_PRECISION
