// SPDX-License-Identifier: Zlib
// Every registered sleep policy, in both dimensions, on hand-made inputs. What a policy says in info().failures that it
// fails, it must be seen to fail.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "framework/stage_sleep.h"
#include "tests/planted_bugs/sleep_twins.h"

namespace lpc::inline LPC_PRECISION::test {
namespace sleep_test {

constexpr Real kG = Real(9.81), kDt = Real(1) / 60;

// A little world without a solver: the test says who moves how and who touches whom.
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
    bodies.canSleep.push_back(type == BodyType::dynamic), bodies.sleep.push_back({});
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
  // One decision, and what the world does after it.
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

// --- what every policy owes; each returns whether it holds, so that wrong twins can be seen to fail ------------------

template <int D>
bool staysAwakeInFlight(SleepPolicy<D>& policy) {
  Stage<D> s;
  const int ball = s.add(BodyType::dynamic), wall = s.add(BodyType::fixed);
  const int lower = s.add(BodyType::dynamic), upper = s.add(BodyType::dynamic);
  s.touch(ball, wall, Vec<D>::Unit(0));  // the ball flies up along a wall
  s.stack(lower, upper);                 // two boxes fly together, one on the other
  for (int step = -60; step <= 60; ++step) {
    for (const int i : {ball, lower, upper}) s.motion(i).v = -kG * kDt * Real(step) * Vec<D>::Unit(1);
    s.decide(policy);
    if (!s.awake(ball) || !s.awake(lower) || !s.awake(upper)) return false;
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

// A blow on a row of sleepers reaches the last one in the same step: a sleeper is a wall.
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

// Steps until body i sleeps, -1 when it does not within 600.
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

// A slider that gains speed all the time.
template <int D>
bool slowSliderStaysAwake(SleepPolicy<D>& policy) {
  int ground, body;
  auto s = resting<D>(ground, body);
  const auto faster = [&](int step) { s.motion(body).v[0] = Real(0.05) * static_cast<Real>(step); };
  return stepsToSleep<D>(policy, s, body, faster) == -1;
}

// Put right by a position resolver, a centimetre a step, without any velocity.
template <int D>
bool creeperStaysAwake(SleepPolicy<D>& policy) {
  int ground, body;
  auto s = resting<D>(ground, body);
  const auto creep = [&](int) { s.bodies.pose[static_cast<std::size_t>(body)].p[0] += Real(0.01); };
  return stepsToSleep<D>(policy, s, body, creep) == -1;
}

// A ton leans on a sleeper.
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

// Half the step, the same time to sleep, to a step.
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

// What hangs still may sleep.
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
                               {"Sleep.StaysAwakeWhenFast", staysAwakeWhenFast<D>},
                               {"Sleep.NeverAgainstWill", neverSleepsAgainstWill<D>},
                               {"Sleep.WakesWhenSupportGoes", wakesWhenSupportGoes<D>},
                               {"Sleep.WakesByTheUser", wakesByTheUser<D>},
                               {"Sleep.BlowsGoThrough", blowsGoThrough<D>},
                               {"Sleep.SlowSliderStaysAwake", slowSliderStaysAwake<D>},
                               {"Sleep.CreeperStaysAwake", creeperStaysAwake<D>},
                               {"Sleep.SlowPushWakes", slowPushWakes<D>},
                               {"Sleep.BySeconds", sleepsBySeconds<D>},
                               {"Sleep.PendulumSleeps", pendulumSleeps<D>}};

template <int D>
std::unique_ptr<SleepPolicy<D>> make(const std::string& spec) {
  return createStage<SleepPolicy<D>>(Spec::parse(spec));
}

template <int D>
void conform() {
  const auto policies = Registry::instance().list(StageKind::sleep, D);
  ASSERT_GE(policies.size(), 2u);
  for (const Registered* r : policies) {
    for (const FailureMode& f : r->info.failures) {
      const bool known = std::any_of(std::begin(kDuties<D>), std::end(kDuties<D>),
                                     [&](const Duty<D>& duty) { return f.test == duty.name; });
      EXPECT_TRUE(known) << r->info.name << " names " << f.test;
    }
    for (const Duty<D>& duty : kDuties<D>) {
      bool declared = false;
      for (const FailureMode& f : r->info.failures) declared = declared || f.test == duty.name;
      EXPECT_EQ(duty.holds(*make<D>(r->info.name)), !declared) << r->info.name << " in " << D << "D: " << duty.name;
    }
  }
}
TEST(Sleep, EveryPolicy2) { conform<2>(); }
TEST(Sleep, EveryPolicy3) { conform<3>(); }

// Each duty is broken by a twin that lacks just what it asks for.
template <int D>
void twinsFail() {
  AveragesOnly<D> dreamer;
  EXPECT_FALSE(staysAwakeInFlight<D>(dreamer));
  EXPECT_FALSE(neverSleepsAgainstWill<D>(dreamer));
  SleepsAtOnce<D> sleepyhead;
  EXPECT_FALSE(staysAwakeWhenFast<D>(sleepyhead));
  EXPECT_FALSE(wakesWhenSupportGoes<D>(sleepyhead));
  EXPECT_FALSE(wakesByTheUser<D>(sleepyhead));
  EXPECT_FALSE(slowSliderStaysAwake<D>(sleepyhead));
  EXPECT_FALSE(creeperStaysAwake<D>(sleepyhead));
  WakesOnlyTheStruck<D> wall;
  EXPECT_FALSE(blowsGoThrough<D>(wall));
  EXPECT_FALSE(slowPushWakes<D>(wall));
  EXPECT_FALSE(pendulumSleeps<D>(wall));
  CountsSteps<D> steps;
  EXPECT_FALSE(sleepsBySeconds<D>(steps));
  // And what no policy of ours can do is possible.
  CountsSeconds<D> seconds;
  EXPECT_TRUE(slowSliderStaysAwake<D>(seconds) && sleepsBySeconds<D>(seconds) && pendulumSleeps<D>(seconds));
}
TEST(Sleep, PlantedBugsAreCaught) { twinsFail<2>(), twinsFail<3>(); }

// --- split_average --------------------------------------------------------------------------------------------------

template <int D>
int splitAverageSleeps(Stage<D>& s, int i, const std::string& spec = "split_average",
                       const std::function<void(int)>& move = {}) {
  return stepsToSleep<D>(*make<D>(spec), s, i, move);
}

template <int D>
void times() {
  int ground, body;
  // From two thresholds, halved each step: exactly one threshold after one step, less after two.
  auto s = resting<D>(ground, body);
  EXPECT_EQ(splitAverageSleeps<D>(s, body), 2);
  // b^n * 2 < 1 for b = 0.9: n = 7.
  s = resting<D>(ground, body);
  EXPECT_EQ(splitAverageSleeps<D>(s, body, "split_average{bias=0.9}"), 7);
  // However fast it was, the average is at most ten thresholds: 10 / 2^n < 1 for n = 4.
  s = resting<D>(ground, body);
  EXPECT_EQ(splitAverageSleeps<D>(s, body, "split_average",
                                  [&](int step) { s.motion(body).v[0] = step <= 10 ? Real(1000) : Real(0); }),
            14);
  // Each threshold by itself.
  s = resting<D>(ground, body);
  EXPECT_EQ(splitAverageSleeps<D>(s, body, "split_average", [&](int) { s.motion(body).w[0] = Real(0.011); }), -1);
  s = resting<D>(ground, body);
  EXPECT_EQ(splitAverageSleeps<D>(s, body, "split_average", [&](int) { s.motion(body).v[0] = Real(1.51); }), -1);
  s = resting<D>(ground, body);
  EXPECT_NE(
      splitAverageSleeps<D>(s, body, "split_average{angular=0.1}", [&](int) { s.motion(body).w[0] = Real(0.011); }),
      -1);
}
TEST(SplitAverage, TimeToSleep) { times<2>(), times<3>(); }

template <int D>
void supports() {
  {  // a pile sleeps from the ground up to its top in the same step, whatever the order of slots
    Stage<D> s;
    const int top = s.add(BodyType::dynamic), middle = s.add(BodyType::dynamic), ground = s.add(BodyType::fixed);
    s.touch(top, middle, -Vec<D>::Unit(1)), s.touch(middle, ground, -Vec<D>::Unit(1));
    EXPECT_EQ(splitAverageSleeps<D>(s, top), 2);
    EXPECT_FALSE(s.awake(middle));
  }
  {  // near is not carried
    Stage<D> s;
    const int ground = s.add(BodyType::fixed), body = s.add(BodyType::dynamic);
    s.touch(ground, body, Vec<D>::Unit(1), Real(0.015));
    EXPECT_EQ(splitAverageSleeps<D>(s, body), -1);
  }
  {  // a vetoed contact does not carry
    int ground, body;
    auto s = resting<D>(ground, body);
    s.manifolds[0].ignored = 1;
    EXPECT_EQ(splitAverageSleeps<D>(s, body), -1);
  }
  {  // without gravity any touch will do
    Stage<D> s;
    s.gravity.setZero();
    const int wall = s.add(BodyType::fixed), body = s.add(BodyType::dynamic);
    s.touch(wall, body, Vec<D>::Unit(0));
    EXPECT_EQ(splitAverageSleeps<D>(s, body), 2);
  }
  {  // nobody sleeps on a moving platform, and one that starts takes its sleepers along
    Stage<D> s;
    const int platform = s.add(BodyType::kinematic), body = s.add(BodyType::dynamic);
    s.stack(platform, body);
    EXPECT_EQ(splitAverageSleeps<D>(s, body), 2);
    s.motion(platform).v = Real(0.1) * Vec<D>::Unit(0);
    s.decide(*make<D>("split_average"));
    EXPECT_TRUE(s.awake(body));
    EXPECT_EQ(splitAverageSleeps<D>(s, body), -1);
  }
}
TEST(SplitAverage, SleepsOnlyWhereCarried) { supports<2>(), supports<3>(); }

template <int D>
void joints() {
  Stage<D> s;
  const int ground = s.add(BodyType::fixed), left = s.add(BodyType::dynamic), right = s.add(BodyType::dynamic);
  s.stack(ground, left), s.join(left, right);
  const auto policy = make<D>("split_average");
  for (int step = 0; step < 100; ++step) {
    s.motion(right).v[0] = 3;
    s.decide(*policy);
    EXPECT_TRUE(s.awake(left)) << "its partner moves";
  }
  s.motion(right) = {};
  for (int step = 0; step < 100; ++step) s.decide(*policy);
  EXPECT_FALSE(s.awake(left) || s.awake(right));
  s.events.push_back({SleepEvent::contactLost, right, -1, 0});
  s.decide(*policy);
  EXPECT_TRUE(s.awake(left) && s.awake(right));
}
TEST(SplitAverage, JointedBodiesSleepTogether) { joints<2>(), joints<3>(); }

template <int D>
void gentle() {
  for (const Real mass : {Real(1), Real(0.001)}) {
    Stage<D> s;
    const int ground = s.add(BodyType::fixed), ball = s.add(BodyType::dynamic, true, mass);
    const int struck = s.add(BodyType::dynamic, false), behind = s.add(BodyType::dynamic, false);
    s.touch(ball, struck, Vec<D>::Unit(0)), s.touch(struck, behind, Vec<D>::Unit(0));
    s.stack(ground, struck), s.stack(ground, behind);
    const auto policy = make<D>("split_average");
    s.motion(ball).v = Real(0.19) * Vec<D>::Unit(0);  // slower than what bounces
    s.decide(*policy);
    EXPECT_FALSE(s.awake(struck));
    s.motion(ball).v = Real(0.3) * Vec<D>::Unit(0);
    s.decide(*policy);
    EXPECT_TRUE(s.awake(struck));
    EXPECT_EQ(s.awake(behind), mass > Real(0.5)) << "a pea wakes whom it hits and nobody behind";
  }
}
TEST(SplitAverage, BlowsWakeAsFarAsTheyReach) { gentle<2>(), gentle<3>(); }

}  // namespace sleep_test
}  // namespace lpc::inline LPC_PRECISION::test
