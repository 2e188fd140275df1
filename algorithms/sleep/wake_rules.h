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

/// While a deep contact opens faster than this (m/s), position correction is at work: a slop per second.
inline constexpr Real kRepairSpeed = kLinearSlop;

template <int D>
bool dynamic(const SleepInput<D>& in, std::int32_t slot) {
  return slot >= 0 && in.bodies.used[slot] && in.bodies.type[slot] == BodyType::dynamic;
}

template <int D>
bool moves(const SleepInput<D>& in, std::int32_t slot) {
  const Motion<D>& m = in.bodies.motion[slot];
  return m.v.squaredNorm() > 0 || m.w.squaredNorm() > 0;
}

/// Whether a kinematic body moves. It carries its load along at any speed; sleepers would let it slide away under them
/// or through them.
template <int D>
bool platform(const SleepInput<D>& in, std::int32_t slot) {
  return in.bodies.type[slot] == BodyType::kinematic && moves(in, slot);
}

template <int D>
Real smallestSeparation(const Manifold<D>& m) {
  Real nearest = kContactMargin;
  for (int i = 0; i < m.count; ++i) nearest = std::min(nearest, m.points[i].separation);
  return nearest;
}

/// Whether `from` carries the other body of this contact: pushes it against the other body's own gravity. Without
/// gravity any touch counts.
template <int D>
bool carries(const SleepInput<D>& in, const Manifold<D>& m, std::int32_t from) {
  const std::int32_t to = from == m.bodyA ? m.bodyB : m.bodyA;
  if (smallestSeparation(m) > kLinearSlop) return false;  // near, but carries nothing
  const Real g = in.gravity.norm(), share = in.bodies.gravityScale[to];
  const Real down = share * m.normal.dot(in.gravity) * (from == m.bodyB ? Real(1) : Real(-1));
  return !(g > 0 && share != 0 && down < Real(0.1) * std::abs(share) * g);
}

/// Velocity of a point of a body; the point is given in the body's frame.
template <int D>
Vec<D> velocityAt(const SleepInput<D>& in, std::int32_t slot, const Vec<D>& local) {
  const Motion<D>& motion = in.bodies.motion[slot];
  return motion.v + cross(motion.w, Vec<D>(in.bodies.pose[slot].q * local));
}

/// Largest speed (m/s) of `from` along the faces of this contact: a support that slides away under a sleeper.
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

/// Calls f(body, holder) for each joint between a dynamic body and one that forces do not move.
template <int D, class F>
void forHeld(const SleepInput<D>& in, const F& f) {
  for (const JointRecord<D>& j : in.joints) {
    if (!j.active() || j.bodyA < 0 || dynamic(in, j.bodyA) == dynamic(in, j.bodyB)) continue;
    dynamic(in, j.bodyA) ? f(j.bodyA, j.bodyB) : f(j.bodyB, j.bodyA);
  }
}

/// Recency-weighted average, stored less two thresholds: zero, as in a new body, means "just woken" (the book and the
/// 2009 report then set two thresholds). It is capped at ten thresholds, so that a fast body calms down soon. Returns
/// whether the average is below the threshold.
inline bool recentAverage(Real& stored, Real bias, Real now, Real threshold) {
  const Real mean = bias * (stored + 2 * threshold) + (1 - bias) * now;
  stored = std::min(mean, 10 * threshold) - 2 * threshold;
  return mean < threshold;
}

/// Rules shared by the policies that judge each body alone: which bodies wake, and which calm ones may sleep. Averages
/// alone let bodies fall asleep in the air: with a threshold of 1.5 m/s each throw has 18 slow steps. These rules are
/// added to those of the 2009 report (6.5.1):
/// - Only a body that stands on something fixed, directly or through others, may fall asleep.
/// - An impact wakes at once every body that it can reach with enough speed. A sleeper has infinite mass, so a
/// neighbour left asleep would reflect the impact. A moving platform wakes its whole load, at any speed.
/// - A support that slides away wakes everything on it up to the top, and no body falls asleep on a support that would
/// wake it in the next step. The distance to such a support does not change, and sleepers would hold it like a wall.
/// A body on a support that is taken away wakes once its own support leaves it: a stack falls as a wave (6.5.1).
/// - A body that appears inside a sleeper, slower than an impact, wakes the sleeper and all bodies in contact with it,
/// directly or through others. While position correction pushes a body out of another, no body in contact with it,
/// directly or through others, falls asleep.
/// - Jointed bodies sleep and wake together.
/// Call order in a step: byEvents, byBlows, bySlides, byJoints, fallAsleep.
template <int D>
class WakeRules {
 public:
  explicit WakeRules(Real wakeSeparation) : m_wakeSeparation(wakeSeparation) {}

  /// By slot, since byEvents(): bodies that were woken or that the user changed. Their averages restart.
  std::span<const std::uint8_t> woken() const { return m_woken; }
  /// By slot, since byEvents(): bodies that position correction pushes out of others.
  std::span<const std::uint8_t> pushedOut() const { return m_pushedOut; }

  void wake(const SleepInput<D>& in, IndexedSpan<std::uint8_t> awake, std::int32_t slot) {
    if (!dynamic(in, slot) || awake[slot]) return;
    awake[slot] = 1;
    m_woken[slot] = 1;
  }

  // Marks all user changes first, so that one pass over the contacts serves all of them.
  void byEvents(const SleepInput<D>& in, IndexedSpan<std::uint8_t> awake) {
    m_woken.assign(awake.size(), 0);
    bool changed = false;
    m_flag.assign(awake.size(), 0), m_carried.assign(awake.size(), 0);
    m_dropped.assign(awake.size(), 0), m_pushedOut.assign(awake.size(), 0), m_met.clear();
    in.work[WorkCount::eventVisits] += in.events.size();
    for (const SleepEvent& e : in.events) {
      switch (e.kind) {
        case SleepEvent::bodyRemoved:
        case SleepEvent::jointRemoved:
        case SleepEvent::contactLost:
          wake(in, awake, e.body);
          break;
        case SleepEvent::userChange:
          // A user's change of a body, also of a static one, wakes the bodies that touch it. The world has already
          // woken the body itself.
          if (dynamic(in, e.body)) m_woken[e.body] = 1;
          m_flag[e.body] = 1, changed = true;
          break;
        case SleepEvent::contactBegun:
          m_met.push_back(std::minmax(e.body, e.other));
          break;  // an impact is judged by its contact, new or old
        case SleepEvent::separationGrown:
          if (e.speed > double(m_wakeSeparation)) wake(in, awake, e.body);
          if (e.speed > double(kRepairSpeed)) m_pushedOut[e.body] = 1;
          break;
        case SleepEvent::bodyAdded:
          break;  // wakes sleepers by its contacts
      }
    }
    byOverlaps(in, awake);
    if (!changed) return;
    in.work[WorkCount::eventVisits] += in.manifolds.size() + in.joints.size();
    for (const Manifold<D>& m : in.manifolds) {
      if (m.ignored) continue;
      for (const auto& [at, other] : {std::pair(m.bodyA, m.bodyB), std::pair(m.bodyB, m.bodyA)}) {
        if (!m_flag[at] || !dynamic(in, other)) continue;
        wake(in, awake, other);
        (dynamic(in, at) ? m_dropped : m_carried)[other] = 1;
      }
    }
    forHeld(in, [&](std::int32_t body, std::int32_t holder) {
      if (m_flag[holder]) wake(in, awake, body);
    });
  }

  // An impact is judged by byBlows().
  void byOverlaps(const SleepInput<D>& in, IndexedSpan<std::uint8_t> awake) {
    if (m_met.empty()) return;
    std::sort(m_met.begin(), m_met.end());
    in.work[WorkCount::eventVisits] += in.manifolds.size();
    for (const Manifold<D>& m : in.manifolds) {
      if (m.ignored || !(smallestSeparation(m) < -kLinearSlop)) continue;
      if (!std::binary_search(m_met.begin(), m_met.end(), std::pair(m.bodyA, m.bodyB))) continue;
      if (approach(in, m) > in.restitutionThreshold) continue;
      for (const std::int32_t body : {m.bodyA, m.bodyB}) wake(in, awake, body), m_carried[body] = 1;
    }
  }

  // Works in rounds, so that the order of contacts has no effect: each round uses the speeds that bodies woken in the
  // previous round pass to sleepers. No body wakes twice, so the loop ends.
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
      // Whatever a platform or the user's hand carries along wakes everything that touches it, at any speed.
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

  // Which body carries which is decided once a step, so that the order of contacts has no effect.
  void bySlides(const SleepInput<D>& in, IndexedSpan<std::uint8_t> awake) {
    m_flag.assign(m_dropped.begin(), m_dropped.end());
    bool again = std::find(m_flag.begin(), m_flag.end(), 1) != m_flag.end();
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

  /// Puts the bodies of `calm` to sleep that nothing keeps awake; removes from `calm` those that platforms and holders
  /// keep awake.
  void fallAsleep(const SleepInput<D>& in, IndexedSpan<std::uint8_t> calm, IndexedSpan<std::uint8_t> awake) {
    if (std::find(calm.begin(), calm.end(), 1) == calm.end()) return;
    keepPushed(in, calm);
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
    // A jointed group may sleep when all its bodies are calm and one of them stands on something fixed.
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
  // A sleeper would act as a wall on the way out.
  void keepPushed(const SleepInput<D>& in, IndexedSpan<std::uint8_t> calm) {
    bool again = std::find(m_pushedOut.begin(), m_pushedOut.end(), 1) != m_pushedOut.end();
    const auto passOn = [&](const Manifold<D>& m, std::int32_t from, std::int32_t to) {
      if (!m_pushedOut[from] || m_pushedOut[to] || smallestSeparation(m) > kLinearSlop) return;
      if (dynamic(in, from)) m_pushedOut[to] = 1, again = true;
    };
    while (std::exchange(again, false)) forContacts(in, passOn), forContactsBack(in, passOn);
    for (std::size_t i = 0; i < calm.size(); ++i) {
      if (m_pushedOut[i]) calm[i] = 0;
    }
  }
  // Calls f(manifold, from, to) for each contact of a dynamic body `to`, in both directions.
  template <class F>
  static void forContacts(const SleepInput<D>& in, const F& f) {
    for (const Manifold<D>& m : in.manifolds) atContact(in, m, f);
  }
  // The same from last to first, so that one pass goes through a pile whatever the order of its slots.
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

  // Approach speed (m/s) at the fastest point.
  static Real approach(const SleepInput<D>& in, const Manifold<D>& m) {
    Real worst = 0;
    for (int i = 0; i < m.count; ++i) {
      const ContactPoint<D>& c = m.points[i];
      const Vec<D> v = velocityAt(in, m.bodyB, c.localB) - velocityAt(in, m.bodyA, c.localA);
      worst = std::max(worst, -v.dot(m.normal));
    }
    return worst;
  }

  // How much faster than the striking body the struck one can become: 2M/(M+m), after an elastic impact.
  static Real passedOn(const SleepInput<D>& in, std::int32_t from, std::int32_t to) {
    const Real striker = in.bodies.mass[from], struck = in.bodies.mass[to];
    return striker > 0 ? 2 * striker / (striker + struck) : Real(2);
  }

  // Finds bodies that stand on something fixed: on static bodies, on sleepers, or on a body that itself stands.
  // Fixed-point iteration by forward and backward sweeps; two suffice for a pile with slots in order of height.
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
  IndexedVector<std::uint8_t> m_woken, m_carried, m_stands, m_flag, m_front, m_dropped, m_pushedOut;
  std::vector<std::pair<std::int32_t, std::int32_t>> m_met;  // pairs of bodies in new contact
  IndexedSpan<const std::int32_t> m_group;                   // group of jointed bodies; -1 if a body is not dynamic
  IndexedVector<Real> m_speed, m_next;
};

}}}  // namespace lpc::LPC_PRECISION::sleep
