// SPDX-License-Identifier: Zlib
// What every sleep policy must do, each in a small world. Each function returns whether the policy passes, so that
// tests can show that planted bugs fail.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/stage/stage_sleep.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace sleep_test {

inline constexpr Real kG = Real(9.81), kDt = Real(1) / 60;

// A small world without a solver: the test sets velocities and contacts.
template <int D>
struct Stage {
  Bodies<D> bodies;
  std::vector<Manifold<D>> manifolds;
  std::vector<JointRecord<D>> joints;
  std::vector<SleepEvent> events;
  Vec<D> gravity = -kG * Vec<D>::Unit(1);
  Real dt = kDt;
  WorkDone work;

  int add(BodyType type, bool awake = true, Real mass = 1) {
    bodies.pose.push_back({}), bodies.motion.push_back({});
    bodies.mass.push_back(type == BodyType::dynamic ? mass : Real(0));
    bodies.type.push_back(type), bodies.used.push_back(1), bodies.awake.push_back(awake);
    bodies.canSleep.push_back(type == BodyType::dynamic), bodies.sleep.push_back({}), bodies.gravityScale.push_back(1);
    bodies.pinned.push_back(0);
    return bodies.size() - 1;
  }
  void touch(int a, int b, const Vec<D>& n_AB, Real separation = 0) {
    Manifold<D> m;
    m.bodyA = a, m.bodyB = b, m.normal = n_AB, m.count = 1, m.points[0].separation = separation;
    manifolds.push_back(m);
  }
  void stack(int lower, int upper) { touch(lower, upper, Vec<D>::Unit(1)); }
  void join(int a, int b) {
    JointRecord<D> j;
    j.kind = createStage<JointKind<D>>(Spec{"pivot", {}});
    j.bodyA = a, j.bodyB = b;
    joints.push_back(j);
  }
  // One decision of the policy, and the world's reaction: velocities of bodies that fell asleep become zero.
  void decide(SleepPolicy<D>& policy) {
    const std::vector<std::uint8_t> before = bodies.awake;
    ContactGraph<D> graph;
    graph.reset(bodies, manifolds, joints, work);
    policy.decide({dt, bodies, manifolds, joints, events, Real(0.2), gravity, work, graph}, bodies.awake, bodies.sleep);
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (before[i] && !bodies.awake[i]) bodies.motion[i] = {};
    }
    events.clear();
  }
  bool awake(int i) const { return bodies.awake[static_cast<std::size_t>(i)] != 0; }
  Motion<D>& motion(int i) { return bodies.motion[static_cast<std::size_t>(i)]; }
};

template <int D>
bool staysAwakeInFlight(SleepPolicy<D>& policy) {
  Stage<D> s;
  const int ball = s.add(BodyType::dynamic), wall = s.add(BodyType::fixed);
  const int lower = s.add(BodyType::dynamic), upper = s.add(BodyType::dynamic);
  s.touch(ball, wall, Vec<D>::Unit(0));  // the ball flies up along a wall
  s.stack(lower, upper);                 // two boxes fly together, one on top of the other
  const int ground = s.add(BodyType::fixed), balloon = s.add(BodyType::dynamic);
  s.bodies.gravityScale.back() = -1;  // is thrown down, touches the ground and rises
  s.stack(ground, balloon);
  for (int step = -60; step <= 60; ++step) {
    for (const int i : {ball, lower, upper}) s.motion(i).v = -kG * kDt * Real(step) * Vec<D>::Unit(1);
    s.motion(balloon).v = -s.motion(ball).v;
    s.decide(policy);
    for (const int i : {ball, lower, upper, balloon}) {
      if (!s.awake(i)) return false;
    }
  }
  return true;
}

// A ball thrown on a small moon is slow for a long time but never at rest.
template <int D>
bool staysAwakeInWeakGravity(SleepPolicy<D>& policy) {
  Stage<D> s;
  s.gravity = -Real(0.1) * Vec<D>::Unit(1);
  const int ball = s.add(BodyType::dynamic);
  for (int step = -300; step <= 300; ++step) {
    s.motion(ball).v = Real(step) * kDt * s.gravity;
    s.decide(policy);
    if (!s.awake(ball)) return false;
  }
  return true;
}

template <int D>
bool staysAwakeWhenFast(SleepPolicy<D>& policy) {
  Stage<D> s;
  const int ground = s.add(BodyType::fixed), slider = s.add(BodyType::dynamic), top = s.add(BodyType::dynamic);
  s.stack(ground, slider), s.stack(ground, top);
  for (int step = 0; step < 200; ++step) {
    s.motion(slider).v = 20 * Vec<D>::Unit(0), s.motion(top).w[0] = 20;
    s.decide(policy);
    if (!s.awake(slider) || !s.awake(top)) return false;
  }
  return true;
}

template <int D>
bool neverSleepsAgainstWill(SleepPolicy<D>& policy) {
  Stage<D> s;
  const int ground = s.add(BodyType::fixed), body = s.add(BodyType::dynamic);
  s.bodies.canSleep[static_cast<std::size_t>(body)] = 0;
  s.stack(ground, body);
  for (int step = 0; step < 200; ++step) s.decide(policy);
  return s.awake(body) && s.awake(ground);
}

template <int D>
bool wakesWhenSupportGoes(SleepPolicy<D>& policy) {
  for (const auto kind :
       {SleepEvent::bodyRemoved, SleepEvent::jointRemoved, SleepEvent::contactLost, SleepEvent::separationGrown}) {
    Stage<D> s;
    const int other = s.add(BodyType::dynamic), sleeper = s.add(BodyType::dynamic, false);
    if (kind == SleepEvent::separationGrown) s.stack(other, sleeper);
    s.events.push_back({kind, sleeper, other, 0.16});
    s.decide(policy);
    if (!s.awake(sleeper)) return false;
  }
  return true;
}

template <int D>
bool wakesByTheUser(SleepPolicy<D>& policy) {
  Stage<D> s;
  const int ground = s.add(BodyType::fixed), sleeper = s.add(BodyType::dynamic, false);
  s.stack(ground, sleeper);
  s.events.push_back({SleepEvent::userChange, ground, -1, 0});  // the ground is moved away
  s.decide(policy);
  return s.awake(sleeper);
}

// A blow on a row of sleeping bodies reaches the last one in the same step. A sleeping body acts like a static one, so
// the solver does not pass the blow on.
template <int D>
bool blowsGoThrough(SleepPolicy<D>& policy) {
  Stage<D> s;
  const int ground = s.add(BodyType::fixed);
  std::vector<int> row;
  for (int i = 0; i < 5; ++i) row.push_back(s.add(BodyType::dynamic, i == 0));
  for (std::size_t i = 1; i < row.size(); ++i) s.touch(row[i - 1], row[i], Vec<D>::Unit(0));
  for (const int i : row) s.stack(ground, i);
  s.motion(row[0]).v = 2 * Vec<D>::Unit(0);
  s.events.push_back({SleepEvent::contactBegun, row[1], row[0], 2.0});
  s.decide(policy);
  for (const int i : row) {
    if (!s.awake(i)) return false;
  }
  return true;
}

// Steps until body i sleeps; -1 if it does not within 600.
template <int D>
int stepsToSleep(SleepPolicy<D>& policy, Stage<D>& s, int i, const std::function<void(int)>& move = {}) {
  for (int step = 1; step <= 600; ++step) {
    if (move) move(step);
    s.decide(policy);
    if (!s.awake(i)) return step;
  }
  return -1;
}
template <int D>
Stage<D> resting(int& ground, int& body) {
  Stage<D> s;
  ground = s.add(BodyType::fixed), body = s.add(BodyType::dynamic);
  s.stack(ground, body);
  return s;
}

// A slider that keeps accelerating.
template <int D>
bool slowSliderStaysAwake(SleepPolicy<D>& policy) {
  int ground, body;
  auto s = resting<D>(ground, body);
  const auto faster = [&](int step) { s.motion(body).v[0] = Real(0.05) * static_cast<Real>(step); };
  return stepsToSleep<D>(policy, s, body, faster) == -1;
}

// A position resolver moves the body by 1 cm a step; its velocity stays zero.
template <int D>
bool creeperStaysAwake(SleepPolicy<D>& policy) {
  int ground, body;
  auto s = resting<D>(ground, body);
  const auto creep = [&](int) { s.bodies.pose[static_cast<std::size_t>(body)].p[0] += Real(0.01); };
  return stepsToSleep<D>(policy, s, body, creep) == -1;
}

// Slides steadily at 0.2 m/s, which is not rest.
template <int D>
bool steadySliderStaysAwake(SleepPolicy<D>& policy) {
  int ground, body;
  auto s = resting<D>(ground, body);
  return stepsToSleep<D>(policy, s, body, [&](int) { s.motion(body).v[0] = Real(0.2); }) == -1;
}

// A ball of 0.5 m radius rolls at 1 cm/s forever.
template <int D>
bool slowRollerStaysAwake(SleepPolicy<D>& policy) {
  int ground, ball;
  auto s = resting<D>(ground, ball);
  const auto roll = [&](int) { s.motion(ball).v[0] = Real(0.01), s.motion(ball).w[kAngDim<D> - 1] = Real(0.02); };
  return stepsToSleep<D>(policy, s, ball, roll) == -1;
}

// A wheel spins in place on a resting box.
template <int D>
bool othersMaySleep(SleepPolicy<D>& policy) {
  int ground, box;
  auto s = resting<D>(ground, box);
  const int wheel = s.add(BodyType::dynamic);
  s.stack(box, wheel);
  return stepsToSleep<D>(policy, s, box, [&](int) { s.motion(wheel).w[0] = 20; }) != -1;
}

// A pea comes to rest against one of two sleeping bodies at 5 cm/s. The report (9.4.3) saw such touches wake whole
// heaps.
template <int D>
bool gentleTouchWakesNobody(SleepPolicy<D>& policy) {
  Stage<D> s;
  const int ground = s.add(BodyType::fixed), pea = s.add(BodyType::dynamic, true, Real(0.001));
  const int touched = s.add(BodyType::dynamic, false), behind = s.add(BodyType::dynamic, false);
  s.touch(pea, touched, Vec<D>::Unit(0)), s.touch(touched, behind, Vec<D>::Unit(0));
  s.stack(ground, touched), s.stack(ground, behind);
  s.motion(pea).v = Real(0.05) * Vec<D>::Unit(0);
  s.events.push_back({SleepEvent::contactBegun, touched, pea, 0.05});
  s.decide(policy);
  return !s.awake(touched) && !s.awake(behind);
}

// Three sleeping bodies on a lift that starts more slowly than a blow, or on a ground that the user moves.
template <int D>
bool liftWakesAStack(SleepPolicy<D>& policy) {
  for (const bool byHand : {false, true}) {
    Stage<D> s;
    const int lift = s.add(byHand ? BodyType::fixed : BodyType::kinematic);
    std::vector<int> stack;
    for (int i = 0; i < 3; ++i) stack.push_back(s.add(BodyType::dynamic, false));
    s.stack(lift, stack[0]), s.stack(stack[0], stack[1]), s.stack(stack[1], stack[2]);
    s.events.push_back({SleepEvent::userChange, lift, -1, 0});
    if (!byHand) s.motion(lift).v = Real(0.1) * Vec<D>::Unit(1);
    s.decide(policy);
    for (const int i : stack) {
      if (!s.awake(i)) return false;
    }
  }
  return true;
}

// A moving lift touches a sleeping body, or tows it by a joint.
template <int D>
bool platformsTakeAlong(SleepPolicy<D>& policy) {
  for (const bool jointed : {false, true}) {
    Stage<D> s;
    const int lift = s.add(BodyType::kinematic), sleeper = s.add(BodyType::dynamic, false);
    jointed ? s.join(lift, sleeper) : s.stack(lift, sleeper);
    s.motion(lift).v = Real(1e-3) * Vec<D>::Unit(1);
    for (int step = 0; step < 200; ++step) {
      s.motion(sleeper).v = s.motion(lift).v;
      s.decide(policy);
      if (!s.awake(sleeper)) return false;
    }
  }
  return true;
}

// A tug pulls a slab by a joint, from under three sleeping bodies stacked on it.
template <int D>
struct Sledge : Stage<D> {
  int tug, slab;
  std::vector<int> load;
  explicit Sledge(bool asleep) {
    const int ground = this->add(BodyType::fixed);
    tug = this->add(BodyType::kinematic), slab = this->add(BodyType::dynamic);
    this->stack(ground, slab), this->join(tug, slab);
    for (int i = 0; i < 3; ++i) {
      load.push_back(this->add(BodyType::dynamic, !asleep));
      this->stack(i == 0 ? slab : load[static_cast<std::size_t>(i) - 1], load.back());
    }
  }
  void pull(SleepPolicy<D>& policy, Real speed) {
    this->motion(tug).v = this->motion(slab).v = speed * Vec<D>::Unit(0);
    this->decide(policy);
  }
  bool allAwake() const {
    return std::all_of(load.begin(), load.end(), [&](int i) { return this->awake(i); });
  }
};
template <int D>
bool draggedSupportWakes(SleepPolicy<D>& policy) {
  Sledge<D> s(true);
  s.pull(policy, Real(0.5));
  return s.allAwake();
}
// So slow that resting bodies move as fast while a solver settles them.
template <int D>
bool creepingSupportWakes(SleepPolicy<D>& policy) {
  Sledge<D> s(true);
  for (int step = 0; step < 60; ++step) s.pull(policy, Real(0.02));
  return s.allAwake();
}
// A body that sleeps while it moves with its support would be woken in the next step and move in jerks.
template <int D>
bool nobodySleepsOnASledge(SleepPolicy<D>& policy) {
  Sledge<D> s(false);
  for (int step = 0; step < 200; ++step) {
    for (const int i : s.load) s.motion(i).v = Real(0.1) * Vec<D>::Unit(0);
    s.pull(policy, Real(0.1));
    if (!s.allAwake()) return false;
  }
  return true;
}

// The ground below a stack of sleepers is gone.
template <int D>
bool stackWakesAsAWhole(SleepPolicy<D>& policy) {
  Stage<D> s;
  const int ground = s.add(BodyType::fixed), low = s.add(BodyType::dynamic, false);
  const int middle = s.add(BodyType::dynamic, false), top = s.add(BodyType::dynamic, false);
  s.stack(low, middle), s.stack(middle, top);
  s.events.push_back({SleepEvent::contactLost, low, ground});
  s.decide(policy);
  return s.awake(low) && s.awake(middle) && s.awake(top);
}

// A vetoed contact with a fast body has no effect.
template <int D>
bool vetoedContactsAreNone(SleepPolicy<D>& policy) {
  const auto sleeps = [&](bool touching) {
    Stage<D> s;
    const int wall = s.add(BodyType::fixed), sleeper = s.add(BodyType::dynamic, false);
    const int fast = s.add(BodyType::dynamic), platform = s.add(BodyType::kinematic);
    s.stack(wall, sleeper);
    for (const int other : {fast, platform}) {
      s.motion(other).v = 20 * Vec<D>::Unit(0);
      if (touching) s.touch(other, sleeper, Vec<D>::Unit(0)), s.manifolds.back().ignored = 1;
    }
    s.decide(policy);
    return !s.awake(sleeper);
  };
  if (sleeps(true) != sleeps(false)) return false;
  // A vetoed contact does not keep a body from falling asleep either.
  Stage<D> s;
  const int ground = s.add(BodyType::fixed), box = s.add(BodyType::dynamic), lift = s.add(BodyType::kinematic);
  s.stack(ground, box);
  s.touch(lift, box, Vec<D>::Unit(0)), s.manifolds.back().ignored = 1;
  s.motion(lift).v = Vec<D>::Unit(0);
  Stage<D> alone = s;
  alone.manifolds.pop_back();
  for (int step = 0; step < 120; ++step) s.decide(policy);
  for (int step = 0; step < 120; ++step) alone.decide(policy);
  return s.awake(box) == alone.awake(box);
}

// A mass of one ton leans on a sleeping body.
template <int D>
bool slowPushWakes(SleepPolicy<D>& policy) {
  Stage<D> s;
  const int ground = s.add(BodyType::fixed), pusher = s.add(BodyType::dynamic, true, 1000);
  const int sleeper = s.add(BodyType::dynamic, false);
  s.touch(pusher, sleeper, Vec<D>::Unit(0)), s.stack(ground, sleeper);
  for (int step = 0; step < 100 && !s.awake(sleeper); ++step) {
    s.motion(pusher).v = Real(0.19) * Vec<D>::Unit(0);
    s.decide(policy);
  }
  return s.awake(sleeper);
}

// With a quarter of the step length, the time to sleep stays the same within a step.
template <int D>
bool sleepsBySeconds(SleepPolicy<D>& policy) {
  const auto seconds = [&](Real dt) {
    int ground, body;
    auto s = resting<D>(ground, body);
    s.dt = dt;
    const int steps = stepsToSleep<D>(policy, s, body);
    return steps < 0 ? Real(1e9) : dt * static_cast<Real>(steps);
  };
  return std::abs(seconds(kDt) - seconds(kDt / 4)) < kDt;
}

// A body that hangs still may sleep.
template <int D>
bool pendulumSleeps(SleepPolicy<D>& policy) {
  Stage<D> s;
  const int ceiling = s.add(BodyType::fixed), bob = s.add(BodyType::dynamic);
  s.join(ceiling, bob);
  return stepsToSleep<D>(policy, s, bob) != -1;
}

template <int D>
struct Duty {
  const char* name;
  bool (*holds)(SleepPolicy<D>&);
};
template <int D>
constexpr Duty<D> kDuties[] = {{"Sleep.StaysAwakeInFlight", staysAwakeInFlight<D>},
                               {"Sleep.StaysAwakeInWeakGravity", staysAwakeInWeakGravity<D>},
                               {"Sleep.StaysAwakeWhenFast", staysAwakeWhenFast<D>},
                               {"Sleep.NeverAgainstWill", neverSleepsAgainstWill<D>},
                               {"Sleep.WakesWhenSupportGoes", wakesWhenSupportGoes<D>},
                               {"Sleep.WakesByTheUser", wakesByTheUser<D>},
                               {"Sleep.BlowsGoThrough", blowsGoThrough<D>},
                               {"Sleep.LiftWakesAStack", liftWakesAStack<D>},
                               {"Sleep.PlatformsTakeAlong", platformsTakeAlong<D>},
                               {"Sleep.VetoedContactsAreNone", vetoedContactsAreNone<D>},
                               {"Sleep.SlowSliderStaysAwake", slowSliderStaysAwake<D>},
                               {"Sleep.SteadySliderStaysAwake", steadySliderStaysAwake<D>},
                               {"Sleep.SlowRollerStaysAwake", slowRollerStaysAwake<D>},
                               {"Sleep.DraggedSupportWakes", draggedSupportWakes<D>},
                               {"Sleep.CreepingSupportWakes", creepingSupportWakes<D>},
                               {"Sleep.StackWakesAsAWhole", stackWakesAsAWhole<D>},
                               {"Sleep.NobodySleepsOnASledge", nobodySleepsOnASledge<D>},
                               {"Sleep.OthersMaySleep", othersMaySleep<D>},
                               {"Sleep.GentleTouchWakesNobody", gentleTouchWakesNobody<D>},
                               {"Sleep.CreeperStaysAwake", creeperStaysAwake<D>},
                               {"Sleep.SlowPushWakes", slowPushWakes<D>},
                               {"Sleep.BySeconds", sleepsBySeconds<D>},
                               {"Sleep.PendulumSleeps", pendulumSleeps<D>}};

}}}}  // namespace lpc::LPC_PRECISION::test::sleep_test
