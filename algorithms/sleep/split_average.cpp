// SPDX-License-Identifier: Zlib
#include <algorithm>

#include "framework/stage_sleep.h"
#include "framework/tolerances.h"

namespace lpc::inline LPC_PRECISION {
namespace {

// Sleeping of the 2009 report (6.5, 6.5.1): a recency-weighted average of the speed and one of the angular speed, each
// with its own threshold, and bodies that wake when their support goes. Added to it, because averages alone fall asleep
// in the air (with a threshold of 1.5 m/s every throw has 18 steps that are slow enough):
// - only a body that stands on something fixed, directly or over others, may fall asleep;
// - a blow wakes at once all those whom it can reach with enough speed: a sleeper weighs infinitely, so a neighbour
// left
//   asleep would throw the blow back;
// - bodies that are jointed sleep and wake together.
template <int D>
class SplitAverage final : public SleepPolicy<D> {
 public:
  struct Params {
    Real linear = Real(1.5);
    Real angular = Real(0.01);
    Real bias = Real(0.5);
    Real wakeSeparation = Real(0.05);
    void visit(ParamVisitor& v) {
      v.real("linear", linear, 0, Real(1e6), "m/s", "falls asleep below this average speed");
      v.real("angular", angular, 0, Real(1e6), "rad/s", "and below this average angular speed");
      v.real("bias", bias, 0, Real(0.999), "1", "weight of the average so far against the present step, per step");
      v.real("wake_separation", wakeSeparation, 0, Real(1e6), "m/s", "wakes when a contact opens faster than this");
    }
  };
  explicit SplitAverage(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "split_average",
            .summary = "two recency-weighted averages of speed; wakes by blows and when support goes",
            .paper = "lpc2009",
            .complexity = "bodies + contacts; sweeps over the contacts while somebody may fall asleep",
            .guarantee = Guarantee::approximate,
            .failures = {{"a body slides, without turning, slower than `linear`", "it freezes on the slope",
                          "Sleep.SlowSliderStaysAwake"},
                         {"a body is moved by the repair of positions alone",
                          "it falls asleep before its joint has closed", "Sleep.CreeperStaysAwake"},
                         {"a sleeper is pushed slower than the restitution threshold, or its load grows",
                          "it stands like a wall", "Sleep.SlowPushWakes"},
                         {"the time step is halved", "the averages forget twice as fast", "Sleep.BySeconds"},
                         {"a body hangs on joints alone", "it never falls asleep", "Sleep.PendulumSleeps"}}};
  }

  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>> memory) override {
    const std::size_t n = awake.size();
    m_woken.assign(n, 0);
    m_group = in.graph.jointedGroups();
    wakeByEvents(in, awake);
    wakeByBlows(in, awake);
    wakeJointed(in, awake);
    average(in, awake, memory);
    fallAsleep(in, awake);
  }

 private:
  static std::size_t index(std::int32_t slot) { return static_cast<std::size_t>(slot); }
  static bool dynamic(const SleepInput<D>& in, std::int32_t slot) {
    return slot >= 0 && in.bodies.used[index(slot)] && in.bodies.type[index(slot)] == BodyType::dynamic;
  }
  static bool moves(const SleepInput<D>& in, std::int32_t slot) {
    const Motion<D>& m = in.bodies.motion[index(slot)];
    return m.v.squaredNorm() > 0 || m.w.squaredNorm() > 0;
  }

  void wake(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::int32_t slot) {
    if (!dynamic(in, slot) || awake[index(slot)]) return;
    awake[index(slot)] = 1;
    m_woken[index(slot)] = 1;
  }

  // What users did is marked first, so that the contacts are walked once for all of it.
  void wakeByEvents(const SleepInput<D>& in, std::span<std::uint8_t> awake) {
    bool changed = false;
    m_flag.assign(awake.size(), 0);
    in.work[WorkCount::eventVisits] += in.events.size();
    for (const SleepEvent& e : in.events) {
      switch (e.kind) {
        case SleepEvent::bodyRemoved:
        case SleepEvent::jointRemoved:
        case SleepEvent::contactLost:
          wake(in, awake, e.body);
          break;
        case SleepEvent::userChange:
          // What the user does to a body, also to a static one, reaches those who touch it. The body itself was woken
          // by the world already.
          if (dynamic(in, e.body)) m_woken[index(e.body)] = 1;
          m_flag[index(e.body)] = 1, changed = true;
          break;
        case SleepEvent::contactBegun:
          break;  // a blow is judged by the contact itself, begun or not
        case SleepEvent::separationGrown:
          if (e.speed > double(m_params.wakeSeparation)) wake(in, awake, e.body);
          break;
      }
    }
    if (!changed) return;
    in.work[WorkCount::eventVisits] += in.manifolds.size() + in.joints.size();
    for (const Manifold<D>& m : in.manifolds) {
      if (m_flag[index(m.bodyA)]) wake(in, awake, m.bodyB);
      if (m_flag[index(m.bodyB)]) wake(in, awake, m.bodyA);
    }
    forHeld(in, [&](std::int32_t body, std::int32_t holder) {
      if (m_flag[index(holder)]) wake(in, awake, body);
    });
  }

  // f(body, holder) for each joint of a dynamic body with one that goes its own way.
  template <class F>
  static void forHeld(const SleepInput<D>& in, const F& f) {
    for (const JointRecord<D>& j : in.joints) {
      if (!j.active() || j.bodyA < 0 || dynamic(in, j.bodyA) == dynamic(in, j.bodyB)) continue;
      dynamic(in, j.bodyA) ? f(j.bodyA, j.bodyB) : f(j.bodyB, j.bodyA);
    }
  }

  // Speed of approach at the worst point, m/s.
  static Real approach(const SleepInput<D>& in, const Manifold<D>& m) {
    Real worst = 0;
    const auto a = index(m.bodyA), b = index(m.bodyB);
    for (int i = 0; i < m.count; ++i) {
      const ContactPoint<D>& c = m.points[index(i)];
      const Vec<D> rA = in.bodies.pose[a].q * c.localA, rB = in.bodies.pose[b].q * c.localB;
      const Vec<D> v = in.bodies.motion[b].v + cross(in.bodies.motion[b].w, rB) - in.bodies.motion[a].v -
                       cross(in.bodies.motion[a].w, rA);
      worst = std::max(worst, -v.dot(m.normal));
    }
    return worst;
  }

  // How much faster than the striker the struck one can be: 2M/(M+m) after an elastic blow.
  static Real passedOn(const SleepInput<D>& in, std::int32_t from, std::int32_t to) {
    const Real striker = in.bodies.mass[index(from)], struck = in.bodies.mass[index(to)];
    return striker > 0 ? 2 * striker / (striker + struck) : Real(2);
  }

  // In rounds, so that the order of contacts leaves no trace: the speeds that reach sleepers from those who were woken
  // in the round before. Nobody is woken twice, so it ends.
  void wakeByBlows(const SleepInput<D>& in, std::span<std::uint8_t> awake) {
    m_speed.assign(awake.size(), 0);
    m_front.assign(awake.size(), 0);
    for (const Manifold<D>& m : in.manifolds) {
      if (m.ignored) continue;
      const bool wakesB = awake[index(m.bodyA)] && dynamic(in, m.bodyB) && !awake[index(m.bodyB)];
      const bool wakesA = awake[index(m.bodyB)] && dynamic(in, m.bodyA) && !awake[index(m.bodyA)];
      if (!wakesA && !wakesB) continue;
      const std::int32_t from = wakesB ? m.bodyA : m.bodyB, to = wakesB ? m.bodyB : m.bodyA;
      if (!moves(in, from)) continue;
      // A moving platform takes its load along at any speed.
      const bool platform = in.bodies.type[index(from)] == BodyType::kinematic;
      const Real speed = approach(in, m);
      if (speed > in.restitutionThreshold) {
        m_speed[index(to)] = std::max(m_speed[index(to)], speed * passedOn(in, from, to));
      } else if (platform) {
        m_woken[index(to)] = 1;
      }
    }
    bool again = false;
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (m_speed[i] > 0) m_front[i] = 1, again = true;
      if (m_front[i] || m_woken[i]) awake[i] = 1, m_woken[i] = 1;
    }
    while (again) {
      again = false;
      m_next.assign(awake.size(), 0);
      for (const Manifold<D>& m : in.manifolds) {
        if (m.ignored) continue;
        for (const auto& [from, to] : {std::pair(m.bodyA, m.bodyB), std::pair(m.bodyB, m.bodyA)}) {
          if (!m_front[index(from)] || !dynamic(in, to) || awake[index(to)]) continue;
          const Real speed = m_speed[index(from)];
          if (!(speed > in.restitutionThreshold)) continue;
          m_next[index(to)] = std::max(m_next[index(to)], speed * passedOn(in, from, to));
        }
      }
      for (std::size_t i = 0; i < awake.size(); ++i) {
        m_front[i] = m_next[i] > 0;
        if (!m_front[i]) continue;
        m_speed[i] = m_next[i], awake[i] = 1, m_woken[i] = 1, again = true;
      }
    }
  }

  void wakeJointed(const SleepInput<D>& in, std::span<std::uint8_t> awake) {
    if (in.joints.empty()) return;
    forHeld(in, [&](std::int32_t body, std::int32_t holder) {
      if (moves(in, holder)) wake(in, awake, body);
    });
    m_flag.assign(awake.size(), 0);
    for (std::size_t i = 0; i < awake.size(); ++i) {
      const auto slot = static_cast<std::int32_t>(i);
      const bool restless = dynamic(in, slot) && awake[i] && moves(in, slot);
      if (dynamic(in, slot) && (m_woken[i] || restless)) m_flag[index(m_group[i])] = 1;
    }
    for (std::size_t i = 0; i < awake.size(); ++i) {
      const auto slot = static_cast<std::int32_t>(i);
      if (dynamic(in, slot) && m_flag[index(m_group[i])]) wake(in, awake, slot);
    }
  }

  // Memory holds each average less two thresholds: zeros, as a new body has them, mean "has just been woken" (the
  // report sets an average of two thresholds then). Ten thresholds are the most, so that a fast one soon calms down.
  void average(const SleepInput<D>& in, std::span<const std::uint8_t> awake, std::span<std::array<Real, 2>> memory) {
    m_calm.assign(awake.size(), 0);
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (!dynamic(in, static_cast<std::int32_t>(i))) continue;
      if (m_woken[i] || !awake[i]) {
        memory[i] = {};
        continue;
      }
      const auto update = [&](Real& stored, Real speed, Real threshold) {
        const Real mean = m_params.bias * (stored + 2 * threshold) + (1 - m_params.bias) * speed;
        stored = std::min(mean, 10 * threshold) - 2 * threshold;
        return mean < threshold;
      };
      const Motion<D>& motion = in.bodies.motion[i];
      const bool slow = update(memory[i][0], motion.v.norm(), m_params.linear);
      const bool still = update(memory[i][1], motion.w.norm(), m_params.angular);
      m_calm[i] = slow && still && in.bodies.canSleep[i];
    }
  }

  // Who stands on something fixed: static bodies, sleepers, and whoever rests on one who stands. Fixed point by sweeps
  // to and fro, two for a pile whose slots rise or fall with height.
  void findSupported(const SleepInput<D>& in, std::span<const std::uint8_t> awake) {
    m_stands.assign(awake.size(), 0);
    for (std::size_t i = 0; i < awake.size(); ++i) {
      const auto slot = static_cast<std::int32_t>(i);
      m_stands[i] = in.bodies.used[i] && (dynamic(in, slot) ? !awake[i] : !moves(in, slot));
    }
    const Real g = in.gravity.norm();
    const auto visit = [&](const Manifold<D>& m) {
      if (m.ignored || bool(m_stands[index(m.bodyA)]) == bool(m_stands[index(m.bodyB)])) return false;
      const std::int32_t from = m_stands[index(m.bodyA)] ? m.bodyA : m.bodyB;
      const std::int32_t to = from == m.bodyA ? m.bodyB : m.bodyA;
      if (!dynamic(in, to)) return false;
      Real nearest = kContactMargin;
      for (int i = 0; i < m.count; ++i) nearest = std::min(nearest, m.points[index(i)].separation);
      if (nearest > kLinearSlop) return false;  // near, but it does not carry
      // Carried means pushed against gravity; without gravity any touch will do.
      const Real down = m.normal.dot(in.gravity) * (from == m.bodyB ? Real(1) : Real(-1));
      if (g > 0 && down < Real(0.1) * g) return false;
      m_stands[index(to)] = 1;
      return true;
    };
    for (bool again = true; again;) {
      again = false;
      for (const Manifold<D>& m : in.manifolds) again = visit(m) || again;
      for (std::size_t i = in.manifolds.size(); again && i-- > 0;) visit(in.manifolds[i]);
    }
  }

  void fallAsleep(const SleepInput<D>& in, std::span<std::uint8_t> awake) {
    if (std::find(m_calm.begin(), m_calm.end(), 1) == m_calm.end()) return;
    findSupported(in, awake);
    // A moving platform would slide away under its sleepers, or through them.
    for (const Manifold<D>& m : in.manifolds) {
      for (const auto& [at, other] : {std::pair(m.bodyA, m.bodyB), std::pair(m.bodyB, m.bodyA)}) {
        if (in.bodies.type[index(other)] == BodyType::kinematic && moves(in, other)) m_calm[index(at)] = 0;
      }
    }
    forHeld(in, [&](std::int32_t body, std::int32_t holder) {
      if (moves(in, holder)) m_calm[index(body)] = 0;
    });
    // A jointed group may sleep when all of it is calm and somebody in it stands.
    m_flag.assign(awake.size(), 0);
    m_next.assign(awake.size(), 0);
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (!dynamic(in, static_cast<std::int32_t>(i))) continue;
      if (awake[i] && !m_calm[i]) m_flag[index(m_group[i])] = 1;
      if (m_stands[i]) m_next[index(m_group[i])] = 1;
    }
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (!m_calm[i]) continue;
      const std::size_t group = index(m_group[i]);
      if (!m_flag[group] && m_next[group] > 0) awake[i] = 0;
    }
  }

  Params m_params;
  // Scratch of one decision, by body slot.
  std::vector<std::uint8_t> m_woken, m_calm, m_stands, m_flag, m_front;
  std::span<const std::int32_t> m_group;  // of jointed bodies; -1 where a body is not dynamic
  std::vector<Real> m_speed, m_next;
};

}  // namespace

LPC_REGISTER(SleepPolicy, SplitAverage, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
