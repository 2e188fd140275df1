// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <limits>

#include "algorithms/sleep/wake_rules.h"

namespace lpc::inline LPC_PRECISION {
namespace {

// Sleeping of Box2D 2 (b2Island::Solve): bodies that touch or are jointed, an island, sleep when each of them has been
// slow for some time, and wake together. One who is awake wakes whom he touches, at any speed, so that nobody need ask
// for blows, supports or loads. Not taken over: that an island waits until its position errors are repaired, which a
// policy does not see; and a platform, however slow, keeps its island awake here.
template <int D>
class TimerIsland final : public SleepPolicy<D> {
 public:
  struct Params {
    Real linear = Real(0.05);                  // of Box2D 3; 2 has 0.01
    Real angular = Real(0.03490658503988659);  // 2 degrees
    Real time = Real(0.5);
    Real wakeSeparation = Real(0.05);
    void visit(ParamVisitor& v) {
      v.real("linear", linear, 0, Real(1e6), "m/s", "a body faster than this begins to wait anew");
      v.real("angular", angular, 0, Real(1e6), "rad/s", "and one that turns faster than this");
      v.real("time", time, 0, Real(1e6), "s", "for which everybody in an island must have been slow");
      v.real("wake_separation", wakeSeparation, 0, Real(1e6), "m/s", "wakes when a contact opens faster than this");
    }
  };
  explicit TimerIsland(const Params& params) : m_params(params), m_rules(params.wakeSeparation) {}

  static AlgorithmInfo info() {
    return {.name = "timer_island",
            .summary = "islands of contacts and joints in which everybody has been slow for a while",
            .paper = "box2d",
            .complexity = "bodies + contacts + joints",
            .guarantee = Guarantee::approximate,
            .failures = {
                {"one body of a heap does not come to rest", "nobody in it may sleep", "Sleep.OthersMaySleep"},
                {"a light body comes to rest against sleepers", "all that are connected with them wake",
                 "Sleep.GentleTouchWakesNobody"},
                {"a body is moved by the repair of positions alone", "it falls asleep before its joint has closed",
                 "Sleep.CreeperStaysAwake"},
                {"a body floats, or is thrown in weak gravity", "it hangs in the air", "Sleep.StaysAwakeInWeakGravity"},
                {"a body rolls on slower than `linear` and `angular`", "it freezes on its way",
                 "Sleep.SlowRollerStaysAwake"}}};
  }

  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>> memory) override {
    const std::span<const std::int32_t> island = in.graph.islands();
    m_rules.byEvents(in, awake);
    m_held.assign(awake.size(), 0);
    for (const Manifold<D>& m : in.manifolds) {
      if (m.ignored) continue;
      if (sleep::platform(in, m.bodyA)) m_held[sleep::index(m.bodyB)] = 1;
      if (sleep::platform(in, m.bodyB)) m_held[sleep::index(m.bodyA)] = 1;
    }
    sleep::forHeld(in, [&](std::int32_t body, std::int32_t holder) {
      if (sleep::moves(in, holder)) m_held[sleep::index(body)] = 1;
    });
    const auto each = [&](const auto& visit) {
      for (std::size_t i = 0; i < awake.size(); ++i) {
        if (sleep::dynamic(in, static_cast<std::int32_t>(i))) visit(i, m_rested[sleep::index(island[i])]);
      }
    };
    // By island: first whether anybody is awake in it, then the shortest rest of its bodies.
    m_rested.assign(awake.size(), -1);
    each([&](std::size_t i, Real& any) { any = awake[i] || m_held[i] ? Real(1) : any; });
    each([&](std::size_t i, const Real& any) {
      if (any > 0) m_rules.wake(in, awake, static_cast<std::int32_t>(i));
    });
    m_rested.assign(awake.size(), std::numeric_limits<Real>::infinity());
    each([&](std::size_t i, Real& shortest) {
      const Motion<D>& motion = in.bodies.motion[i];
      const bool slow = motion.v.norm() <= m_params.linear && motion.w.norm() <= m_params.angular;
      const bool waits = slow && in.bodies.canSleep[i] && !m_rules.woken()[i] && !m_held[i];
      memory[i][0] = waits && awake[i] ? memory[i][0] + in.dt : Real(0);
      shortest = std::min(shortest, memory[i][0]);
    });
    // To the nearest step, so that sums of rounded steps count.
    each([&](std::size_t i, const Real& shortest) {
      if (awake[i] && shortest > 0 && shortest >= m_params.time - in.dt / 2) awake[i] = 0, memory[i][0] = 0;
    });
  }

 private:
  Params m_params;
  sleep::WakeRules<D> m_rules;
  std::vector<std::uint8_t> m_held;  // by slot: by something that goes its own way
  std::vector<Real> m_rested;        // by island
};

}  // namespace

LPC_REGISTER(SleepPolicy, TimerIsland, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
