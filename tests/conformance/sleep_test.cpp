// SPDX-License-Identifier: Zlib
// Every registered sleep policy, in both dimensions, on hand-made inputs. A failure that info().failures declares must
// be observed.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/planted_bugs/sleep_bugs.h"
#include "tests/sleep_duties.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace sleep_test {

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

// For each duty, a planted policy that lacks just this duty must fail.
template <int D>
void twinsFail() {
  AveragesOnly<D> dreamer;
  EXPECT_FALSE(staysAwakeInFlight<D>(dreamer));
  EXPECT_FALSE(staysAwakeInWeakGravity<D>(dreamer));
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
  EXPECT_FALSE(draggedSupportWakes<D>(wall));
  EXPECT_FALSE(creepingSupportWakes<D>(wall));
  EXPECT_FALSE(stackWakesAsAWhole<D>(wall));
  EXPECT_FALSE(pendulumSleeps<D>(wall));
  CountsSteps<D> steps;
  EXPECT_FALSE(sleepsBySeconds<D>(steps));
  // The book's method alone fails the duties that the report had to add, and further ones that LPC requires.
  BookAlone<D> book;
  EXPECT_FALSE(staysAwakeInFlight<D>(book));
  EXPECT_FALSE(wakesWhenSupportGoes<D>(book));
  EXPECT_FALSE(wakesByTheUser<D>(book));
  EXPECT_FALSE(blowsGoThrough<D>(book));
  EXPECT_FALSE(liftWakesAStack<D>(book));
  EXPECT_FALSE(platformsTakeAlong<D>(book));
  EXPECT_FALSE(vetoedContactsAreNone<D>(book));
  EXPECT_FALSE(nobodySleepsOnASledge<D>(book));
  EXPECT_FALSE(steadySliderStaysAwake<D>(book));
  IslandOfTheGround<D> everybody;
  EXPECT_FALSE(othersMaySleep<D>(everybody));
  EXPECT_FALSE(gentleTouchWakesNobody<D>(everybody));
  // A planted policy has the properties that no policy of ours has, so they are possible.
  CountsSeconds<D> seconds;
  EXPECT_TRUE(slowSliderStaysAwake<D>(seconds) && sleepsBySeconds<D>(seconds) && pendulumSleeps<D>(seconds));
  EXPECT_TRUE(slowRollerStaysAwake<D>(seconds));
}
TEST(Sleep, PlantedBugsAreCaught) { twinsFail<2>(), twinsFail<3>(); }

// The visits needed to wake a pile of n are counted: the event, each contact for it, and each contact again in each
// round that passes it on. The cause is a ground that the user moves, or a sledge that slides away below.
template <int D>
std::uint64_t visitsOfWaking(SleepPolicy<D>& policy, int n, bool sledge) {
  Stage<D> s;
  std::vector<int> pile = {s.add(sledge ? BodyType::dynamic : BodyType::fixed)};
  for (int i = 0; i < n; ++i) {
    pile.push_back(s.add(BodyType::dynamic, false));
    s.stack(pile[static_cast<std::size_t>(i)], pile.back());
  }
  if (sledge) {
    s.motion(pile[0]).v = Real(0.15) * Vec<D>::Unit(0);
  } else {
    s.events.push_back({SleepEvent::userChange, pile[0], -1, 0});
  }
  s.decide(policy);
  for (const int i : pile) EXPECT_TRUE(s.awake(i)) << i;
  return s.work[WorkCount::eventVisits];
}
template <int D>
void wakesAreCounted() {
  for (const char* policy : {"split_average", "millington"}) {
    for (const int n : {1, 4, 20}) {
      const auto each = static_cast<std::uint64_t>(n);
      // Blows: one level a round, and a last round that finds none. Slides: up and down the pile, and once more.
      EXPECT_EQ(visitsOfWaking<D>(*make<D>(policy), n, false), 1 + each + each * each) << policy << ' ' << n;
      EXPECT_EQ(visitsOfWaking<D>(*make<D>(policy), n, true), (n > 1 ? 4 : 2) * each) << policy << ' ' << n;
    }
  }
}
TEST(Sleep, VisitsOfWakingAreCounted) { wakesAreCounted<2>(), wakesAreCounted<3>(); }

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
  // From any speed, the average is at most ten thresholds: 10 / 2^n < 1 for n = 4.
  s = resting<D>(ground, body);
  EXPECT_EQ(splitAverageSleeps<D>(s, body, "split_average",
                                  [&](int step) { s.motion(body).v[0] = step <= 10 ? Real(1000) : Real(0); }),
            14);
  // Each threshold alone.
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
  {  // a pile falls asleep from the ground to its top in one step, in any order of slots
    Stage<D> s;
    const int top = s.add(BodyType::dynamic), middle = s.add(BodyType::dynamic), ground = s.add(BodyType::fixed);
    s.touch(top, middle, -Vec<D>::Unit(1)), s.touch(middle, ground, -Vec<D>::Unit(1));
    EXPECT_EQ(splitAverageSleeps<D>(s, top), 2);
    EXPECT_FALSE(s.awake(middle));
  }
  {  // a body near a support is not carried
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
  {  // without gravity any touch suffices
    Stage<D> s;
    s.gravity.setZero();
    const int wall = s.add(BodyType::fixed), body = s.add(BodyType::dynamic);
    s.touch(wall, body, Vec<D>::Unit(0));
    EXPECT_EQ(splitAverageSleeps<D>(s, body), 2);
  }
  {  // no sleep on a moving platform; a platform that starts wakes the bodies on it
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
TEST(SplitAverage, SleepsOnlyOnASupport) { supports<2>(), supports<3>(); }

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
    s.motion(ball).v = Real(0.19) * Vec<D>::Unit(0);  // slower than the restitution threshold
    s.decide(*policy);
    EXPECT_FALSE(s.awake(struck));
    s.motion(ball).v = Real(0.3) * Vec<D>::Unit(0);
    s.decide(*policy);
    EXPECT_TRUE(s.awake(struck));
    EXPECT_EQ(s.awake(behind), mass > Real(0.5)) << "a pea wakes whom it hits and nobody behind";
  }
}
TEST(SplitAverage, ImpactsWakeAsFarAsTheyReach) { gentle<2>(), gentle<3>(); }

// A body that slides below a sleeper wakes it and the bodies on it. A body beside or above it does not.
template <int D>
void slides() {
  const auto woken = [](const std::string& spec, const auto& build) {
    Stage<D> s;
    const int mover = s.add(BodyType::dynamic), sleeper = s.add(BodyType::dynamic, false);
    const int above = s.add(BodyType::dynamic, false), beside = s.add(BodyType::dynamic, false);
    const int top = s.add(BodyType::dynamic, false);
    // The upper contacts first: in this order a single pass would not suffice.
    s.stack(above, top), s.stack(sleeper, above), s.touch(sleeper, beside, Vec<D>::Unit(0));
    build(s, mover, sleeper);
    s.decide(*make<D>(spec));
    EXPECT_EQ(s.awake(sleeper), s.awake(above));
    EXPECT_EQ(s.awake(sleeper), s.awake(top));
    EXPECT_FALSE(s.awake(beside)) << "it stands on something else";
    return s.awake(sleeper);
  };
  const auto below = [&](Real speed) {
    return [=](Stage<D>& s, int mover, int sleeper) {
      s.stack(mover, sleeper), s.motion(mover).v = speed * Vec<D>::Unit(0);
    };
  };
  for (const std::string name : {"split_average", "millington"}) {
    EXPECT_TRUE(woken(name, below(Real(0.051))));
    EXPECT_FALSE(woken(name, below(Real(0.049))));
    EXPECT_FALSE(woken(name + "{wake_separation=1}", below(Real(0.9))));
    EXPECT_FALSE(woken(name, [](Stage<D>& s, int mover, int sleeper) {
      s.stack(sleeper, mover), s.motion(mover).v = Vec<D>::Unit(0);
    })) << "above";
    EXPECT_FALSE(woken(name, [](Stage<D>& s, int mover, int sleeper) {
      s.touch(mover, sleeper, Vec<D>::Unit(0)), s.motion(mover).v = Vec<D>::Unit(1);
    })) << "beside";
    EXPECT_FALSE(woken(name, [](Stage<D>& s, int mover, int sleeper) {
      s.touch(mover, sleeper, Vec<D>::Unit(1), Real(0.015)), s.motion(mover).v = Vec<D>::Unit(0);
    })) << "near";
    EXPECT_FALSE(woken(name, [](Stage<D>& s, int mover, int sleeper) {
      s.stack(mover, sleeper), s.manifolds.back().ignored = 1, s.motion(mover).v = Vec<D>::Unit(0);
    })) << "vetoed";
    // A roller: its top moves twice as fast as its middle. A shape of half a metre turns at 0.2 rad/s.
    EXPECT_TRUE(woken(name, [](Stage<D>& s, int mover, int sleeper) {
      s.stack(mover, sleeper), s.manifolds.back().points[0].localA = Real(0.5) * Vec<D>::Unit(1);
      s.motion(mover).w[kAngDim<D> - 1] = Real(0.2);
    })) << "turning";
  }
}
TEST(SplitAverage, SlidingSupportsWakeTheBodiesOnThem) { slides<2>(), slides<3>(); }

// --- millington -----------------------------------------------------------------------------------------------------

template <int D>
void bookTimes() {
  int ground, body;
  const auto steps = [&](Stage<D>& s, const std::string& spec, const std::function<void(int)>& move = {}) {
    return stepsToSleep<D>(*make<D>(spec), s, body, move);
  };
  // From two thresholds to less than one: 2 b^t < 1, after a second for the book's half, 6.58 s for 0.9; to a step.
  auto s = resting<D>(ground, body);
  EXPECT_NEAR(steps(s, "millington"), 60, 1);
  s = resting<D>(ground, body);
  EXPECT_NEAR(steps(s, "millington{bias=0.9}"), 60 * 6.578813, 1);
  // From any speed, the average is at most ten thresholds: 10 b^t < 1 after 3.32 s.
  s = resting<D>(ground, body);
  EXPECT_NEAR(steps(s, "millington", [&](int step) { s.motion(body).v[0] = step <= 10 ? Real(1000) : Real(0); }),
              10 + 60 * 3.321928, 1);
  // The squares of both speeds are added with equal weight.
  for (const auto& [v, w, sleeps] : {std::tuple(0.54, 0.0, true),
                                     {0.0, 0.54, true},
                                     {0.56, 0.0, false},
                                     {0.0, 0.56, false},
                                     {0.4, 0.3, true},
                                     {0.4, 0.4, false}}) {
    s = resting<D>(ground, body);
    const int after = steps(s, "millington",
                            [&, v = v, w = w](int) { s.motion(body).v[0] = Real(v), s.motion(body).w[0] = Real(w); });
    EXPECT_EQ(after != -1, sleeps) << v << ' ' << w;
  }
}
TEST(Millington, TimeToSleep) { bookTimes<2>(), bookTimes<3>(); }

// --- timer_island ---------------------------------------------------------------------------------------------------

template <int D>
void timers() {
  int ground, body;
  const auto steps = [&](Stage<D>& s, const std::string& spec, const std::function<void(int)>& move = {}) {
    return stepsToSleep<D>(*make<D>(spec), s, body, move);
  };
  auto s = resting<D>(ground, body);
  EXPECT_EQ(steps(s, "timer_island"), 30);  // half a second
  s = resting<D>(ground, body);
  EXPECT_EQ(steps(s, "timer_island{time=2}"), 120);
  s = resting<D>(ground, body);
  EXPECT_EQ(steps(s, "timer_island{time=0}"), 1);
  // One fast step restarts the timer.
  s = resting<D>(ground, body);
  EXPECT_EQ(steps(s, "timer_island", [&](int step) { s.motion(body).v[0] = step == 29 ? Real(0.06) : Real(0); }), 59);
  for (const auto& [v, w, sleeps] : {std::tuple(0.049, 0.034, true), {0.051, 0.0, false}, {0.0, 0.036, false}}) {
    for (const char* spec : {"timer_island", "timer_island{time=0}"}) {
      s = resting<D>(ground, body);
      const int after =
          steps(s, spec, [&, v = v, w = w](int) { s.motion(body).v[0] = Real(v), s.motion(body).w[0] = Real(w); });
      EXPECT_EQ(after != -1, sleeps) << spec << ' ' << v << ' ' << w;
    }
  }
}
TEST(TimerIsland, TimeToSleep) { timers<2>(), timers<3>(); }

// Two stacks on one ground are two islands. Contacts and joints connect; the ground and a lift at rest do not.
template <int D>
void islands() {
  for (const bool bridged : {false, true}) {
    Stage<D> s;
    const int ground = s.add(BodyType::fixed), lift = s.add(BodyType::kinematic);
    const int low = s.add(BodyType::dynamic), high = s.add(BodyType::dynamic), far = s.add(BodyType::dynamic);
    s.stack(ground, low), s.stack(low, high), s.stack(ground, far);
    s.stack(lift, high), s.stack(lift, far);
    if (bridged) s.join(high, far);
    const auto policy = make<D>("timer_island");
    for (int step = 0; step < 100; ++step) {
      s.motion(far).v[0] = 1;
      s.decide(*policy);
      EXPECT_TRUE(s.awake(far));
    }
    EXPECT_EQ(s.awake(low), bridged);
    EXPECT_EQ(s.awake(high), bridged);
    s.motion(far) = {};
    for (int step = 0; step < 100; ++step) s.decide(*policy);
    EXPECT_FALSE(s.awake(low) || s.awake(high) || s.awake(far));
    s.events.push_back({SleepEvent::contactLost, low, -1, 0});
    s.decide(*policy);
    EXPECT_TRUE(s.awake(low) && s.awake(high)) << "as a whole";
    EXPECT_EQ(s.awake(far), bridged);
  }
}
TEST(TimerIsland, SleepsAndWakesAsAWhole) { islands<2>(), islands<3>(); }

// Two bodies jointed to each other only are falling. To sleep, one of them needs a support: a floor, the world, a pin,
// or no gravity on both. A wall, a vetoed floor and a floor that is only near do not count.
template <int D>
void hanging() {
  using Change = std::function<void(Stage<D>&, int ground, int body)>;
  const auto sleeps = [](const Change& change) {
    Stage<D> s;
    const int ground = s.add(BodyType::fixed), other = s.add(BodyType::dynamic), body = s.add(BodyType::dynamic);
    s.join(other, body);
    change(s, ground, body);
    return stepsToSleep<D>(*make<D>("timer_island"), s, other) != -1;
  };
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  EXPECT_FALSE(sleeps([](Stage<D>&, int, int) {}));
  EXPECT_FALSE(sleeps([](Stage<D>& s, int ground, int body) { s.touch(ground, body, Vec<D>::Unit(0)); })) << "a wall";
  EXPECT_FALSE(sleeps([](Stage<D>& s, int ground, int body) { s.touch(ground, body, -Vec<D>::Unit(1)); }))
      << "a ceiling";
  EXPECT_FALSE(sleeps([](Stage<D>& s, int ground, int body) { s.stack(ground, body), s.manifolds.back().ignored = 1; }))
      << "vetoed";
  EXPECT_FALSE(sleeps([](Stage<D>& s, int ground, int body) { s.touch(ground, body, Vec<D>::Unit(1), Real(0.015)); }))
      << "near";
  EXPECT_FALSE(sleeps([&](Stage<D>& s, int, int body) { s.bodies.gravityScale[at(body)] = 0; })) << "one has weight";
  EXPECT_TRUE(sleeps([](Stage<D>& s, int ground, int body) { s.stack(ground, body); }));
  EXPECT_TRUE(sleeps([](Stage<D>& s, int ground, int body) { s.touch(body, ground, -Vec<D>::Unit(1)); }));
  EXPECT_TRUE(sleeps([](Stage<D>& s, int ground, int body) { s.join(ground, body); }));
  EXPECT_TRUE(sleeps([](Stage<D>& s, int, int body) { s.join(-1, body); })) << "the world";
  EXPECT_TRUE(sleeps([&](Stage<D>& s, int, int body) { s.bodies.pinned[at(body)] = 1; })) << "a pin";
  EXPECT_TRUE(sleeps([](Stage<D>& s, int, int) { s.gravity.setZero(); }));
}
TEST(TimerIsland, SleepsOnlyWhereHeld) { hanging<2>(), hanging<3>(); }

}  // namespace sleep_test
}}}  // namespace lpc::LPC_PRECISION::test
