// SPDX-License-Identifier: Zlib
#include "framework/world/continuous_pass.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr Real kNever = std::numeric_limits<Real>::infinity();

template <int D>
bool vetoed(std::span<const Manifold<D>> manifolds, const typename FastParts<D>::Pair& p) {
  const std::tuple key(p.a.body, p.a.shape, p.b.body, p.b.shape);
  const auto m = std::partition_point(manifolds.begin(), manifolds.end(),
                                      [&](const Manifold<D>& x) { return x.shapeKey() < key; });
  return m != manifolds.end() && m->shapeKey() == key && m->ignored;
}

}  // namespace

template <int D>
std::span<const typename FastParts<D>::Pair> ContinuousPass<D>::fastPairs(const ContinuousInput<D>& in,
                                                                          const BodySweeps<D>& sweeps) {
  const auto found = m_fast.find(sweeps, in.method.threshold(), in.table.bodies, in.table.shapes, in.table.boxes,
                                 in.profiler.frame().work);
  in.profiler.frame().work[WorkCount::sweptPairs] += found.size();
  return found;
}

template <int D>
void ContinuousPass<D>::findSpeculativePairs(const ContinuousInput<D>& in) {
  m_speculative.clear();
  if (!in.runsIn(CcdPhase::before)) return;
  Profiler::Scope scope(in.profiler, "continuous");
  for (const auto& p : fastPairs(in, {in.table.bodies.pose, in.table.bodies.motion, in.dt})) {
    if (in.nonColliding.contains(p.a.body, p.b.body)) continue;
    m_speculative.push_back({{p.a.shape, p.b.shape}, in.settings.margin + p.a.maxTravel + p.b.maxTravel});
  }
  // Keep the largest margin of the parts of two shapes.
  std::sort(m_speculative.begin(), m_speculative.end(), [](const SpeculativePair& p, const SpeculativePair& q) {
    return std::tie(p.shapes, q.margin) < std::tie(q.shapes, p.margin);
  });
  m_speculative.erase(
      std::unique(m_speculative.begin(), m_speculative.end(),
                  [](const SpeculativePair& p, const SpeculativePair& q) { return p.shapes == q.shapes; }),
      m_speculative.end());
}

template <int D>
void ContinuousPass<D>::begin(const ContinuousInput<D>& in) {
  if (in.runsIn(CcdPhase::after)) m_start = in.table.bodies.pose;
}

// The body's motion in the step just solved. A pose does not show whole turns: of all rotations with this end pose,
// take the one nearest to the body's angular velocity.
template <int D>
Motion<D> ContinuousPass<D>::sweepOf(const ContinuousInput<D>& in, std::size_t body) const {
  const Pose<D>&from = m_start[body], &to = in.table.bodies.pose[body];
  constexpr Real kWhole = Real(6.28318530717958647693);
  Ang<D> turn = turnOf(to.q * from.q.inverse());
  const Ang<D> meant = in.table.bodies.motion[body].w * in.dt;
  const Real angle = turn.norm();
  const Ang<D> axis = angle > 0 ? Ang<D>(turn / angle) : Ang<D>(meant.normalized());
  const Real more = std::round((meant.dot(axis) - angle) / kWhole);
  if (more != 0 && std::isfinite(more)) turn += more * kWhole * axis;
  return {(to.p - from.p) / in.dt, turn / in.dt};
}

// The pair's motion from a time on; bodies already stopped do not move.
template <int D>
FastPair<D> ContinuousPass<D>::pairFrom(const ContinuousInput<D>& in, const typename FastParts<D>::Pair& p,
                                        const BodySweeps<D>& sweeps, Real from) const {
  const auto motionOf = [&](const typename FastParts<D>::Part& part) {
    ShapeMotion<D> motion = sweeps.of(part.body, part.X_CP);
    const Real stop = m_stop[static_cast<std::size_t>(part.body)];
    motion.X_WC = motion.bodyAt(std::min(from, stop));
    if (stop <= from) motion.motion = {};
    return motion;
  };
  const auto goesOn = [&](const typename FastParts<D>::Part& part) {
    return part.fast && in.table.bodies.active(part.body) && m_stop[static_cast<std::size_t>(part.body)] == kNever;
  };
  const bool swap = p.a.view.kind > p.b.view.kind;
  const auto &a = swap ? p.b : p.a, &b = swap ? p.a : p.b;
  return {{a.view, b.view, motionOf(a), motionOf(b)}, a.radii, b.radii, goesOn(a), goesOn(b)};
}

// Handles times of impact in order. The first one of a body ends its step, and the step of all bodies jointed to it, or
// the joints would tear. Later pairs of a stopped body are computed again.
template <int D>
void ContinuousPass<D>::stopAtImpacts(const ContinuousInput<D>& in, std::span<const Manifold<D>> manifolds,
                                      std::span<const JointRecord<D>> joints, const ContactGraph<D>& graph) {
  if (!in.runsIn(CcdPhase::after)) return;
  Profiler::Scope scope(in.profiler, "continuous");
  Bodies<D>& bodies = in.table.bodies;
  m_motions.assign(m_start.size(), {});
  for (std::size_t i = 0; i < m_start.size(); ++i) {
    if (bodies.used[i] && bodies.awake[i] && bodies.type[i] != BodyType::fixed) m_motions[i] = sweepOf(in, i);
  }
  const BodySweeps<D> sweeps{m_start, m_motions, in.dt};
  const auto pairs = fastPairs(in, sweeps);
  if (pairs.empty()) return;

  m_stop.assign(bodies.pose.size(), kNever);
  m_questions.clear(), m_events.clear(), m_pairsOf.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (in.nonColliding.contains(pairs[i].a.body, pairs[i].b.body) || vetoed<D>(manifolds, pairs[i])) continue;
    const FastPair<D> question = pairFrom(in, pairs[i], sweeps, 0);
    if (!question.fastA && !question.fastB) continue;
    m_questions.push_back(question), m_events.push_back({kNever, i, kNever});
    for (const std::int32_t body : {pairs[i].a.body, pairs[i].b.body}) m_pairsOf.emplace_back(body, i);
  }
  std::sort(m_pairsOf.begin(), m_pairsOf.end());
  m_times.assign(m_questions.size(), kNever);
  WorkDone& work = in.profiler.frame().work;
  in.method.timesOfImpact(m_questions, in.dt, m_times, work);
  for (std::size_t k = 0; k < m_times.size(); ++k) m_events[k].t = m_times[k];
  std::erase_if(m_events, [&](const ToiEvent& m) { return !(m.t < in.dt); });
  std::make_heap(m_events.begin(), m_events.end());

  const auto firstStop = [&](const typename FastParts<D>::Pair& p) {
    return std::min(m_stop[static_cast<std::size_t>(p.a.body)], m_stop[static_cast<std::size_t>(p.b.body)]);
  };
  const auto stop = [&](std::int32_t slot, Real t) {
    const auto body = static_cast<std::size_t>(slot);
    if (!bodies.active(slot) || m_stop[body] != kNever) return;
    m_stop[body] = t, bodies.pose[body] = sweeps.of(slot, {}).bodyAt(t);
    ++work[WorkCount::stops], in.profiler.frame().lostTime += in.dt - t;
    m_stopped.push_back(slot);
  };
  while (!m_events.empty()) {
    std::pop_heap(m_events.begin(), m_events.end());
    const ToiEvent now = m_events.back();
    m_events.pop_back();
    const auto& p = pairs[now.pair];
    if (firstStop(p) != now.asked) continue;  // stale: a newer event of this pair exists
    m_stopped.clear();
    for (const auto* part : {&p.a, &p.b}) {
      if (part->fast) stop(part->body, now.t);
    }
    for (std::size_t i = 0; i < m_stopped.size(); ++i) {  // grows in the loop
      for (const std::int32_t joint : graph.jointsOf(m_stopped[i])) {
        const JointRecord<D>& j = joints[static_cast<std::size_t>(joint)];
        if (j.bodyA >= 0) stop(j.bodyA, now.t);
        stop(j.bodyB, now.t);
      }
    }
    for (const std::int32_t body : m_stopped) {
      for (auto of = std::lower_bound(m_pairsOf.begin(), m_pairsOf.end(), std::pair(body, std::size_t(0)));
           of != m_pairsOf.end() && of->first == body; ++of) {
        const FastPair<D> again = pairFrom(in, pairs[of->second], sweeps, now.t);
        if (!again.fastA && !again.fastB) continue;
        Real later = kNever;
        in.method.timesOfImpact({&again, 1}, in.dt - now.t, {&later, 1}, work);
        if (!(now.t + later < in.dt)) continue;
        m_events.push_back({now.t + later, of->second, now.t});
        std::push_heap(m_events.begin(), m_events.end());
      }
    }
  }
}

template class ContinuousPass<2>;
template class ContinuousPass<3>;

}}  // namespace lpc::LPC_PRECISION
