// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/math/tolerances.h"
#include "framework/stage/stage_sleep.h"

namespace lpc { inline namespace LPC_PRECISION { namespace sleep {

inline std::size_t index(std::int32_t slot) { return static_cast<std::size_t>(slot); }

template <int D>
bool dynamic(const SleepInput<D>& in, std::int32_t slot) {
  return slot >= 0 && in.bodies.used[slot] && in.bodies.type[slot] == BodyType::dynamic;
}

template <int D>
bool moves(const SleepInput<D>& in, std::int32_t slot) {
  const Motion<D>& m = in.bodies.motion[slot];
  return m.v.squaredNorm() > 0 || m.w.squaredNorm() > 0;
}

/// A kinematic body that moves: it takes its load along at any speed, and would slide away under sleepers, or
/// through them.
template <int D>
bool platform(const SleepInput<D>& in, std::int32_t slot) {
  return in.bodies.type[slot] == BodyType::kinematic && moves(in, slot);
}

/// Whether `from` carries the other body of this contact: pushes it against its own share of gravity; without any a
/// touch will do.
template <int D>
bool carries(const SleepInput<D>& in, const Manifold<D>& m, std::int32_t from) {
  const std::int32_t to = from == m.bodyA ? m.bodyB : m.bodyA;
  Real nearest = kContactMargin;
  for (int i = 0; i < m.count; ++i) nearest = std::min(nearest, m.points[i].separation);
  if (nearest > kLinearSlop) return false;  // near, but it does not carry
  const Real g = in.gravity.norm(), share = in.bodies.gravityScale[to];
  const Real down = share * m.normal.dot(in.gravity) * (from == m.bodyB ? Real(1) : Real(-1));
  return !(g > 0 && share != 0 && down < Real(0.1) * std::abs(share) * g);
}

/// Velocity of a point of a body, which is given in its own frame.
template <int D>
Vec<D> velocityAt(const SleepInput<D>& in, std::int32_t slot, const Vec<D>& local) {
  const Motion<D>& motion = in.bodies.motion[slot];
  return motion.v + cross(motion.w, Vec<D>(in.bodies.pose[slot].q * local));
}

/// How fast `from` moves along the faces of this contact at the worst point, m/s: what slides away under a sleeper.
template <int D>
Real slide(const SleepInput<D>& in, const Manifold<D>& m, std::int32_t from) {
  Real worst = 0;
  for (int i = 0; i < m.count; ++i) {
    const ContactPoint<D>& c = m.points[i];
    const Vec<D> v = velocityAt(in, from, from == m.bodyA ? c.localA : c.localB);
    worst = std::max(worst, (v - v.dot(m.normal) * m.normal).norm());
  }
  return worst;
}

/// f(body, holder) for each joint of a dynamic body with one that goes its own way.
template <int D, class F>
void forHeld(const SleepInput<D>& in, const F& f) {
  for (const JointRecord<D>& j : in.joints) {
    if (!j.active() || j.bodyA < 0 || dynamic(in, j.bodyA) == dynamic(in, j.bodyB)) continue;
    dynamic(in, j.bodyA) ? f(j.bodyA, j.bodyB) : f(j.bodyB, j.bodyA);
  }
}

/// A recency-weighted average, held less two thresholds: zeros, as a new body has them, mean "has just been woken" (the
/// book and the 2009 report set an average of two thresholds then). Ten thresholds are the most, so that a fast one
/// soon calms down. True when it is below the threshold.
inline bool recentAverage(Real& stored, Real bias, Real now, Real threshold) {
  const Real mean = bias * (stored + 2 * threshold) + (1 - bias) * now;
  stored = std::min(mean, 10 * threshold) - 2 * threshold;
  return mean < threshold;
}

/// Who wakes, and who of those that are calm may sleep: what is common to policies that ask each body by itself. Added
/// to the rules of the 2009 report (6.5.1), because averages alone fall asleep in the air (with a threshold of 1.5 m/s
/// every throw has 18 steps that are slow enough):
/// - only a body that stands on something fixed, directly or over others, may fall asleep;
/// - a blow wakes at once all those whom it can reach with enough speed: a sleeper weighs infinitely, so a neighbour
///   left asleep would throw the blow back; a platform that moves reaches all of its load, at any speed;
/// - a support that slides away wakes what stands on it up to the top, and nobody falls asleep on one that would wake
///   him in the next step: its distance does not change, and sleepers would hold it like a wall;
/// - bodies that are jointed sleep and wake together.
/// Their use in a step: byEvents, byBlows, bySlides, byJoints, fallAsleep.
template <int D>
class WakeRules {
 public:
  explicit WakeRules(Real wakeSeparation) : m_wakeSeparation(wakeSeparation) {}

  /// By slot, since byEvents(): who was woken, and whom the user changed. Their memory begins anew.
  std::span<const std::uint8_t> woken() const { return m_woken; }

  void wake(const SleepInput<D>& in, IndexedSpan<std::uint8_t> awake, std::int32_t slot) {
    if (!dynamic(in, slot) || awake[slot]) return;
    awake[slot] = 1;
    m_woken[slot] = 1;
  }

  // What users did is marked first, so that the contacts are walked once for all of it.
  void byEvents(const SleepInput<D>& in, IndexedSpan<std::uint8_t> awake) {
    m_woken.assign(awake.size(), 0);
    bool changed = false;
    m_flag.assign(awake.size(), 0), m_carried.assign(awake.size(), 0);
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
          if (dynamic(in, e.body)) m_woken[e.body] = 1;
          m_flag[e.body] = 1, changed = true;
          break;
        case SleepEvent::contactBegun:
          break;  // a blow is judged by the contact itself, begun or not
        case SleepEvent::separationGrown:
          if (e.speed > double(m_wakeSeparation)) wake(in, awake, e.body);
          break;
      }
    }
    if (!changed) return;
    in.work[WorkCount::eventVisits] += in.manifolds.size() + in.joints.size();
    for (const Manifold<D>& m : in.manifolds) {
      if (m.ignored) continue;
      for (const auto& [at, other] : {std::pair(m.bodyA, m.bodyB), std::pair(m.bodyB, m.bodyA)}) {
        if (!m_flag[at]) continue;
        wake(in, awake, other);
        if (!dynamic(in, at)) m_carried[other] = 1;
      }
    }
    forHeld(in, [&](std::int32_t body, std::int32_t holder) {
      if (m_flag[holder]) wake(in, awake, body);
    });
  }

  // In rounds, so that the order of contacts leaves no trace: the speeds that reach sleepers from those who were woken
  // in the round before. Nobody is woken twice, so it ends.
  void byBlows(const SleepInput<D>& in, IndexedSpan<std::uint8_t> awake) {
    m_speed.assign(awake.size(), 0);
    m_front.assign(awake.size(), 0);
    for (const Manifold<D>& m : in.manifolds) {
      if (m.ignored) continue;
      if (platform(in, m.bodyA)) m_carried[m.bodyB] = 1;
      if (platform(in, m.bodyB)) m_carried[m.bodyA] = 1;
      const bool wakesB = awake[m.bodyA] && dynamic(in, m.bodyB) && !awake[m.bodyB];
      const bool wakesA = awake[m.bodyB] && dynamic(in, m.bodyA) && !awake[m.bodyA];
      if (!wakesA && !wakesB) continue;
      const std::int32_t from = wakesB ? m.bodyA : m.bodyB, to = wakesB ? m.bodyB : m.bodyA;
      if (!moves(in, from)) continue;
      const Real speed = approach(in, m);
      if (speed > in.restitutionThreshold) {
        m_speed[to] = std::max(m_speed[to], speed * passedOn(in, from, to));
      }
    }
    bool again = false;
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (m_speed[i] > 0 || m_woken[i]) awake[i] = 1, m_woken[i] = 1;
      // What a platform or the user's hand takes along takes all along that touches it, at any speed.
      if (m_carried[i] && dynamic(in, static_cast<std::int32_t>(i))) {
        wake(in, awake, static_cast<std::int32_t>(i));
        m_speed[i] = std::numeric_limits<Real>::infinity();
      }
      if (m_speed[i] > 0) m_front[i] = 1, again = true;
    }
    while (again) {
      again = false;
      in.work[WorkCount::eventVisits] += in.manifolds.size();
      m_next.assign(awake.size(), 0);
      for (const Manifold<D>& m : in.manifolds) {
        if (m.ignored) continue;
        for (const auto& [from, to] : {std::pair(m.bodyA, m.bodyB), std::pair(m.bodyB, m.bodyA)}) {
          if (!m_front[from] || !dynamic(in, to) || awake[to]) continue;
          const Real speed = m_speed[from];
          if (!(speed > in.restitutionThreshold)) continue;
          m_next[to] = std::max(m_next[to], speed * passedOn(in, from, to));
        }
      }
      for (std::size_t i = 0; i < awake.size(); ++i) {
        m_front[i] = m_next[i] > 0;
        if (!m_front[i]) continue;
        m_speed[i] = m_next[i], awake[i] = 1, m_woken[i] = 1, again = true;
      }
    }
  }

  // Who carries whom is a relation of the step, so that the order of contacts leaves no trace.
  void bySlides(const SleepInput<D>& in, IndexedSpan<std::uint8_t> awake) {
    m_flag.assign(awake.size(), 0);
    bool again = false;
    forContacts(in, [&](const Manifold<D>& m, std::int32_t from, std::int32_t to) {
      if (awake[to] || !awake[from] || !dynamic(in, from) || !moves(in, from)) return;
      if (slide(in, m, from) > m_wakeSeparation && carries(in, m, from)) m_flag[to] = 1, again = true;
    });
    if (!again) return;
    const auto passOn = [&](const Manifold<D>& m, std::int32_t from, std::int32_t to) {
      if (m_flag[from] && !m_flag[to] && carries(in, m, from)) m_flag[to] = 1, again = true;
    };
    while (std::exchange(again, false)) {
      in.work[WorkCount::eventVisits] += 2 * in.manifolds.size();
      forContacts(in, passOn), forContactsBack(in, passOn);
    }
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (m_flag[i]) wake(in, awake, static_cast<std::int32_t>(i));
    }
  }

  void byJoints(const SleepInput<D>& in, IndexedSpan<std::uint8_t> awake) {
    m_group = in.graph.jointedGroups();
    if (in.joints.empty()) return;
    forHeld(in, [&](std::int32_t body, std::int32_t holder) {
      if (moves(in, holder)) wake(in, awake, body);
    });
    m_flag.assign(awake.size(), 0);
    for (std::size_t i = 0; i < awake.size(); ++i) {
      const auto slot = static_cast<std::int32_t>(i);
      const bool restless = dynamic(in, slot) && awake[i] && moves(in, slot);
      if (dynamic(in, slot) && (m_woken[i] || restless)) m_flag[m_group[i]] = 1;
    }
    for (std::size_t i = 0; i < awake.size(); ++i) {
      const auto slot = static_cast<std::int32_t>(i);
      if (dynamic(in, slot) && m_flag[m_group[i]]) wake(in, awake, slot);
    }
  }

  /// Puts those of `calm` to sleep whom nothing keeps awake; takes out of it whom platforms and holders keep.
  void fallAsleep(const SleepInput<D>& in, IndexedSpan<std::uint8_t> calm, IndexedSpan<std::uint8_t> awake) {
    if (std::find(calm.begin(), calm.end(), 1) == calm.end()) return;
    findSupported(in, awake);
    for (const Manifold<D>& m : in.manifolds) {
      if (m.ignored) continue;
      for (const auto& [at, other] : {std::pair(m.bodyA, m.bodyB), std::pair(m.bodyB, m.bodyA)}) {
        if (platform(in, other)) calm[at] = 0;
      }
    }
    forHeld(in, [&](std::int32_t body, std::int32_t holder) {
      if (moves(in, holder)) calm[body] = 0;
    });
    // A jointed group may sleep when all of it is calm and somebody in it stands.
    m_flag.assign(awake.size(), 0);
    m_next.assign(awake.size(), 0);
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (!dynamic(in, static_cast<std::int32_t>(i))) continue;
      if (awake[i] && !calm[i]) m_flag[m_group[i]] = 1;
      if (m_stands[i]) m_next[m_group[i]] = 1;
    }
    const auto sleeps = [&](std::size_t i) { return !m_flag[m_group[i]] && m_next[m_group[i]] > 0; };
    bool again = true;
    const auto keepAwake = [&](const Manifold<D>& m, std::int32_t from, std::int32_t to) {
      if (!calm[to] || !dynamic(in, from) || !awake[from] || sleeps(index(from))) return;
      if (!(slide(in, m, from) > m_wakeSeparation) || !carries(in, m, from)) return;
      calm[to] = 0, m_flag[m_group[to]] = 1, again = true;
    };
    while (std::exchange(again, false)) forContacts(in, keepAwake), forContactsBack(in, keepAwake);
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (calm[i] && sleeps(i)) awake[i] = 0;
    }
  }

 private:
  // f(manifold, from, to) for each contact of a dynamic body `to`, both ways.
  template <class F>
  static void forContacts(const SleepInput<D>& in, const F& f) {
    for (const Manifold<D>& m : in.manifolds) atContact(in, m, f);
  }
  // The same from the last to the first, so that a pile is gone through at once whatever the order of its slots.
  template <class F>
  static void forContactsBack(const SleepInput<D>& in, const F& f) {
    for (std::size_t i = in.manifolds.size(); i-- > 0;) atContact(in, in.manifolds[i], f);
  }
  template <class F>
  static void atContact(const SleepInput<D>& in, const Manifold<D>& m, const F& f) {
    if (m.ignored) return;
    if (dynamic(in, m.bodyB)) f(m, m.bodyA, m.bodyB);
    if (dynamic(in, m.bodyA)) f(m, m.bodyB, m.bodyA);
  }

  // Speed of approach at the worst point, m/s.
  static Real approach(const SleepInput<D>& in, const Manifold<D>& m) {
    Real worst = 0;
    for (int i = 0; i < m.count; ++i) {
      const ContactPoint<D>& c = m.points[i];
      const Vec<D> v = velocityAt(in, m.bodyB, c.localB) - velocityAt(in, m.bodyA, c.localA);
      worst = std::max(worst, -v.dot(m.normal));
    }
    return worst;
  }

  // How much faster than the striker the struck one can be: 2M/(M+m) after an elastic blow.
  static Real passedOn(const SleepInput<D>& in, std::int32_t from, std::int32_t to) {
    const Real striker = in.bodies.mass[from], struck = in.bodies.mass[to];
    return striker > 0 ? 2 * striker / (striker + struck) : Real(2);
  }

  // Who stands on something fixed: static bodies, sleepers, and whoever rests on one who stands. Fixed point by sweeps
  // to and fro, two for a pile whose slots rise or fall with height.
  void findSupported(const SleepInput<D>& in, IndexedSpan<const std::uint8_t> awake) {
    m_stands.assign(awake.size(), 0);
    for (std::size_t i = 0; i < awake.size(); ++i) {
      const auto slot = static_cast<std::int32_t>(i);
      m_stands[i] = in.bodies.used[i] && (dynamic(in, slot) ? !awake[i] : !moves(in, slot));
    }
    const auto visit = [&](const Manifold<D>& m) {
      if (m.ignored || bool(m_stands[m.bodyA]) == bool(m_stands[m.bodyB])) return false;
      const std::int32_t from = m_stands[m.bodyA] ? m.bodyA : m.bodyB;
      const std::int32_t to = from == m.bodyA ? m.bodyB : m.bodyA;
      if (!dynamic(in, to) || !carries(in, m, from)) return false;
      m_stands[to] = 1;
      return true;
    };
    for (bool again = true; again;) {
      again = false;
      for (const Manifold<D>& m : in.manifolds) again = visit(m) || again;
      for (std::size_t i = in.manifolds.size(); again && i-- > 0;) visit(in.manifolds[i]);
    }
  }

  Real m_wakeSeparation;
  // Scratch of one decision, by body slot.
  IndexedVector<std::uint8_t> m_woken, m_carried, m_stands, m_flag, m_front;
  IndexedSpan<const std::int32_t> m_group;  // of jointed bodies; -1 where a body is not dynamic
  IndexedVector<Real> m_speed, m_next;
};

}}}  // namespace lpc::LPC_PRECISION::sleep
