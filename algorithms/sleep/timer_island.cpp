// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <limits>

#include "algorithms/sleep/wake_rules.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Sleeping of Box2D 2 (b2Island::Solve): an island of touching or jointed bodies sleeps when each body has been slow
// for some time, and wakes as a whole. An awake body wakes everything that it touches, at any speed, so impacts,
// supports and loads need no rules. Three differences: the island waits while position correction opens deep contacts,
// but not for errors of joints, which a policy does not see; a moving platform keeps its island awake at any speed; and
// an island may sleep only if something that cannot fall holds it, because in weak gravity a throw is slow for longer
// than any time limit. A body that hangs on a spring or is wedged between walls therefore stays awake.
template <int D>
class TimerIsland final : public SleepPolicy<D> {
 public:
  struct Params {
    Real linear = Real(0.05);                  // of Box2D 3; Box2D 2 has 0.01
    Real angular = Real(0.03490658503988659);  // 2 degrees
    Real time = Real(0.5);
    Real wakeSeparation = Real(0.05);
    void visit(ParamVisitor& v) {
      v.real("linear", linear, 0, Real(1e6), "m/s", "a body faster than this restarts its timer");
      v.real("angular", angular, 0, Real(1e6), "rad/s", "a body that rotates faster than this restarts its timer");
      v.real("time", time, 0, Real(1e6), "s", "time for which all bodies of an island must be slow before it sleeps");
      v.real("wake_separation", wakeSeparation, 0, Real(1e6), "m/s", "wakes when a contact opens faster than this");
    }
  };
  explicit TimerIsland(const Params& params) : m_params(params), m_rules(params.wakeSeparation) {}

  static AlgorithmInfo info() {
    return {.name = "timer_island",
            .summary = "an island of contacts and joints sleeps when all its bodies have been slow for a while",
            .paper = "box2d",
            .complexity = "bodies + contacts + joints",
            .guarantee = Guarantee::approximate,
            .failures = {
                {"one body of a pile does not come to rest", "no body of the pile may sleep", "Sleep.OthersMaySleep"},
                {"a light body comes to rest against sleeping bodies", "the whole island wakes",
                 "Sleep.GentleTouchWakesNobody"},
                {"a body moves by position correction alone", "it falls asleep before its joint error is corrected",
                 "Sleep.CreeperStaysAwake"},
                {"a body rolls slower than `linear` and `angular`", "it falls asleep while moving",
                 "Sleep.SlowRollerStaysAwake"}}};
  }

  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>> memory) override {
    const IndexedSpan<const std::int32_t> island = in.graph.islands();
    m_rules.byEvents(in, awake);
    m_held.assign(awake.size(), 0);
    m_falls.assign(awake.size(), 0);
    const auto each = [&](const auto& visit) {
      for (std::size_t i = 0; i < awake.size(); ++i) {
        if (sleep::dynamic(in, static_cast<std::int32_t>(i))) visit(i, sleep::index(island[i]));
      }
    };
    const bool weight = in.gravity.squaredNorm() > 0;
    each([&](std::size_t i, std::size_t of) {
      if (weight && in.bodies.gravityScale[i] != 0) m_falls[of] = 1;
    });
    each([&](std::size_t i, std::size_t of) {
      if (in.bodies.pinned[i]) m_falls[of] = 0;
    });
    for (const Manifold<D>& m : in.manifolds) {
      if (m.ignored) continue;
      for (const auto& [from, to] : {std::pair(m.bodyA, m.bodyB), std::pair(m.bodyB, m.bodyA)}) {
        if (sleep::dynamic(in, from) || !sleep::dynamic(in, to)) continue;
        if (sleep::platform(in, from)) m_held[to] = 1;
        if (sleep::carries(in, m, from)) m_falls[island[to]] = 0;
      }
    }
    for (const JointRecord<D>& j : in.joints) {  // also joints to the world, which has no slot
      const bool a = sleep::dynamic(in, j.bodyA), b = sleep::dynamic(in, j.bodyB);
      if (j.active() && a != b) m_falls[island[a ? j.bodyA : j.bodyB]] = 0;
    }
    sleep::forHeld(in, [&](std::int32_t body, std::int32_t holder) {
      if (sleep::moves(in, holder)) m_held[body] = 1;
    });
    // Per island: first whether any body is awake, then the shortest rest time of its bodies.
    m_rested.assign(awake.size(), -1);
    each([&](std::size_t i, std::size_t of) {
      if (awake[i] || m_held[i]) m_rested[of] = 1;
    });
    each([&](std::size_t i, std::size_t of) {
      if (m_rested[of] > 0) m_rules.wake(in, awake, static_cast<std::int32_t>(i));
    });
    m_rested.assign(awake.size(), std::numeric_limits<Real>::infinity());
    each([&](std::size_t i, std::size_t of) {
      const Motion<D>& motion = in.bodies.motion[i];
      const bool slow = motion.v.norm() <= m_params.linear && motion.w.norm() <= m_params.angular;
      const bool rests = !m_rules.woken()[i] && !m_rules.pushedOut()[i];
      const bool waits = slow && in.bodies.canSleep[i] && rests && !m_held[i];
      memory[i][0] = waits && awake[i] ? memory[i][0] + in.dt : Real(0);
      m_rested[of] = std::min(m_rested[of], memory[i][0]);
    });
    // Rounded to the nearest step, so that sums of rounded steps count.
    each([&](std::size_t i, std::size_t of) {
      const Real shortest = m_rested[of];
      if (m_falls[of] || !awake[i] || !(shortest > 0)) return;
      if (shortest >= m_params.time - in.dt / 2) awake[i] = 0, memory[i][0] = 0;
    });
  }

 private:
  Params m_params;
  sleep::WakeRules<D> m_rules;
  IndexedVector<std::uint8_t> m_held;   // by slot: held by a body that forces do not move
  IndexedVector<std::uint8_t> m_falls;  // by island: has weight and is not held
  IndexedVector<Real> m_rested;         // by island
};

}  // namespace

LPC_REGISTER(SleepPolicy, TimerIsland, 2, 3);

}}  // namespace lpc::LPC_PRECISION
