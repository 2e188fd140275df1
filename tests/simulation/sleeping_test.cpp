// SPDX-License-Identifier: Zlib
// Sleeping in whole worlds (S5), for every policy: which bodies sleep and wake, and that nothing else changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "framework/world/invariants.h"
#include "tests/every_solver.h"
#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace sleeping_test { namespace {

constexpr Real kDt = Real(1) / 60;

template <int D>
BodyDef<D> cube(double x, double y) {
  return body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(x, y));
}

template <int D>
struct Tower {
  World<D> world;
  BodyHandle ground;
  std::vector<BodyHandle> boxes;
  explicit Tower(const std::string& sleep, double gap = 0) : world(Pipeline::parse("sleep=" + sleep)) {
    ground = addGround(world);
    for (int i = 0; i < 5; ++i) boxes.push_back(world.add(cube<D>(0, 0.5 + gap + (1 + gap) * i)));
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) world.step(kDt);
  }
  // Until all bodies sleep, if the policy lets them. A policy that waits for a tower to stop swaying needs several
  // seconds.
  int settle() {
    run(300);
    for (int i = 0; i < 600 && sleepers() < 5; ++i) world.step(kDt);
    return sleepers();
  }
  int sleepers() const {
    int n = 0;
    for (const BodyHandle& b : boxes) n += world.valid(b) && !world.awake(b);
    return n;
  }
  Real height(int i) const { return world.pose(boxes[static_cast<std::size_t>(i)]).p[1]; }
  std::set<std::pair<int, int>> touching() const {
    std::set<std::pair<int, int>> pairs;
    for (const Manifold<D>& m : world.manifolds()) pairs.emplace(m.bodyA, m.bodyB);
    return pairs;
  }
};

// Boxes released slightly above each other. Each ends at the same place as without sleeping, touches the same bodies,
// and loses hardly any energy: at most that of 1.5 m/s. Sleeping bodies do not creep.
template <int D>
bool restsAsWithoutIt(const std::string& policy) {
  Tower<D> subject(policy, 0.03), awake("none", 0.03);
  subject.run(300), awake.run(300);
  for (int i = 0; i < 5; ++i) {
    if (std::abs(subject.height(i) - awake.height(i)) > 4 * kLinearSlop) return false;
  }
  const double energy = invariants(awake.world).kinetic - invariants(subject.world).kinetic;
  if (subject.touching() != awake.touching() || std::abs(energy) > 1e-3) return false;
  if (subject.sleepers() < 5) return subject.sleepers() == 0;
  const auto hash = subject.world.hash();
  subject.run(100);
  return subject.world.hash() == hash;
}

template <int D>
bool towerSleeps(const std::string& policy) {
  Tower<D> tower(policy);
  tower.settle();
  tower.world.step(kDt);
  return tower.sleepers() == 5 && tower.world.profiler().frame().work[WorkCount::rowUpdates] == 0;
}

// The lowest box is removed: the others fall by its height and may sleep again.
template <int D>
bool nobodyHangsInTheAir(const std::string& policy) {
  Tower<D> tower(policy);
  const int before = tower.settle();
  tower.world.remove(tower.boxes[0]);
  tower.run(90);
  for (int i = 1; i < 5; ++i) {
    if (std::abs(tower.height(i) - (Real(i) - Real(0.5))) > Real(0.1)) return false;
  }
  tower.run(300);
  return tower.sleepers() == std::min(before, 4);
}

// A beam lies on two posts, and a ball hangs from it on a pivot. When the pivot is removed while they sleep, the ball
// falls, under every solver.
template <int D>
bool nobodyHangsOnARemovedJoint(const std::string& policy) {
  for (const Registered* solver : Registry::instance().list(StageKind::solver, D)) {
    if (!competes(*solver)) continue;
    World<D> world(Pipeline::parse("sleep=" + policy + " solver=" + solver->info.name));
    for (const int x : {-2, 2}) {
      Vec<D> half = Vec<D>::Constant(Real(0.5));
      half[1] = 5;
      world.add(body<D>(Shape<D>::box(half), at<D>(x, 4.5), BodyType::fixed));
    }
    Vec<D> half = Vec<D>::Constant(Real(0.5));
    half[0] = 3;
    const BodyHandle beam = world.add(body<D>(Shape<D>::box(half), at<D>(0, 10)));
    const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, 8.5)));
    const JointHandle joint = world.add(pivot<D>(beam, ball, at<D>(0, 9.5)));
    for (int i = 0; i < 300; ++i) world.step(kDt);
    if (std::abs(world.pose(ball).p[1] - Real(8.5)) > Real(0.1)) return false;
    world.remove(joint);
    for (int i = 0; i < 60; ++i) world.step(kDt);
    if (world.pose(ball).p[1] > 5 || std::abs(world.pose(beam).p[1] - 10) > Real(0.1)) return false;
  }
  return true;
}

// A sleeping body is towed by a joint. It stays awake as long as the tug moves, however slowly, and it wakes when the
// user moves the tug.
template <int D>
bool sleepersAreTowed(const std::string& policy) {
  World<D> world(Pipeline::parse("sleep=" + policy));
  addGround(world);
  const BodyHandle box = world.add(cube<D>(0, Real(0.5)));
  const BodyHandle tug = world.add(body<D>(Shape<D>::sphere(Real(0.1)), at<D>(3, 0.5), BodyType::kinematic));
  world.add(JointDef<D>{.kind = "distance",
                        .bodyA = tug,
                        .bodyB = box,
                        .X_WJ = {at<D>(3, 0.5), {}},
                        .X_WJb = Pose<D>{at<D>(0, 0.5), {}}});
  const auto run = [&](int steps) {
    for (int i = 0; i < steps; ++i) world.step(kDt);
    return world.pose(box).p[0];
  };
  if (std::abs(run(300)) > Real(0.01)) return false;
  world.setMotion(tug, {at<D>(0.1, 0), Ang<D>::Zero()});
  if (std::abs(run(600) - 1) > Real(0.02)) return false;
  world.setMotion(tug, Motion<D>{});
  run(300);
  world.setPose(tug, {at<D>(4.5, 0.5), {}});
  return run(1) > Real(1.05);
}

// Three boxes sleep on a sledge that is pulled away, slowly or fast. They move as if they had been awake. A load that
// stayed asleep would brake the sledge like a static body.
template <int D>
bool sledgesTakeTheirLoad(const std::string& policy) {
  const auto draw = [](const std::string& sleep, Real speed, bool& asleep) {
    World<D> world(Pipeline::parse("sleep=" + sleep));
    addGround(world);
    Vec<D> half = Vec<D>::Constant(1);
    half[1] = Real(0.25);
    const BodyHandle sledge = world.add(body<D>(Shape<D>::box(half), at<D>(0, 0.25)));
    const BodyHandle tug = world.add(body<D>(Shape<D>::sphere(Real(0.1)), at<D>(4, 0.25), BodyType::kinematic));
    world.add(JointDef<D>{.kind = "distance",
                          .bodyA = tug,
                          .bodyB = sledge,
                          .X_WJ = {at<D>(4, 0.25), {}},
                          .X_WJb = Pose<D>{at<D>(0, 0.25), {}}});
    std::vector<BodyHandle> load;
    for (int i = 0; i < 3; ++i) load.push_back(world.add(cube<D>(0, 1.0 + i)));
    const auto sleeps = [&] {
      return std::none_of(load.begin(), load.end(), [&](const BodyHandle& b) { return world.awake(b); });
    };
    for (int i = 0; i < 300 || (i < 900 && !sleeps()); ++i) world.step(kDt);
    asleep = sleeps();
    world.setMotion(tug, {at<D>(double(speed), 0), Ang<D>::Zero()});
    for (int i = 0; i < 120; ++i) world.step(kDt);
    std::vector<Real> behind;
    for (const BodyHandle& b : load) behind.push_back(world.pose(sledge).p[0] - world.pose(b).p[0]);
    return behind;
  };
  for (const Real speed : {Real(0.1), Real(0.4)}) {
    bool sleeps = false, never = false;
    const auto subject = draw(policy, speed, sleeps), awake = draw("none", speed, never);
    for (std::size_t i = 0; i < subject.size(); ++i) {
      if (std::abs(subject[i] - awake[i]) > 4 * kLinearSlop) return false;
    }
    if (!sleeps && policy != "none") return false;  // otherwise this tests nothing
  }
  return true;
}

template <int D>
bool groundIsMovedAway(const std::string& policy) {
  Tower<D> tower(policy);
  tower.settle();
  tower.world.setPose(tower.ground, Pose<D>{Vec<D>(-100 * Vec<D>::Unit(1)), {}});
  tower.run(90);
  for (int i = 0; i < 5; ++i) {
    if (tower.height(i) > Real(i - 5)) return false;
  }
  return true;
}

// A box thrown up along a wall and two stacked boxes in flight: the same bits as without sleeping, including the apex.
template <int D>
bool throwsAreNotStopped(const std::string& policy) {
  const auto fly = [](const std::string& sleep) {
    World<D> world(Pipeline::parse("sleep=" + sleep));
    world.add(body<D>(Shape<D>::box(Real(20) * Vec<D>::Ones()), at<D>(-20.5, 0), BodyType::fixed));
    auto along = cube<D>(0, 0), lower = cube<D>(5, 0), upper = cube<D>(5, 1);
    for (auto* b : {&along, &lower, &upper}) b->velocity = 5 * Vec<D>::Unit(1);
    world.add(along), world.add(lower), world.add(upper);
    for (int i = 0; i < 70; ++i) world.step(kDt);
    return world.hash();
  };
  return fly(policy) == fly("none");
}

// A sleeping row is struck from the side, a sleeping stack from above: one step after the blow all are awake.
template <int D>
bool blowsWakeARow(const std::string& policy) {
  const auto strike = [&](bool upright) {
    World<D> world(Pipeline::parse("sleep=" + policy));
    addGround(world);
    std::vector<BodyHandle> row;
    for (int i = 0; i < 5; ++i) row.push_back(world.add(upright ? cube<D>(0, 4.5 - i) : cube<D>(i, 0.5)));
    const auto allSleep = [&] {
      return std::none_of(row.begin(), row.end(), [&](const BodyHandle& b) { return world.awake(b); });
    };
    for (int i = 0; i < 120 || (i < 900 && !allSleep()); ++i) world.step(kDt);
    auto hammer = upright ? cube<D>(0, 8) : cube<D>(-3, 0.5);
    hammer.velocity = upright ? at<D>(0, -10) : at<D>(10, 0);
    const BodyHandle h = world.add(hammer);
    for (int i = 0; i < 60; ++i) {
      world.step(kDt);
      for (const Manifold<D>& m : world.manifolds()) {
        const bool struck = m.bodyB == h.slot && m.bodyA == row[0].slot;
        if (!struck || !(m.points[0].impulse[0] > 0)) continue;
        return std::all_of(row.begin(), row.end(), [&](const BodyHandle& b) { return world.awake(b); });
      }
    }
    return false;
  };
  return strike(false) && strike(true);
}

// Three boxes rest on a lift. It starts at 10 cm/s, too slow for a blow, and carries them as if they were awake.
template <int D>
bool liftsTakeAStackAlong(const std::string& policy) {
  World<D> world(Pipeline::parse("sleep=" + policy));
  Vec<D> half = Vec<D>::Constant(2);
  half[1] = Real(0.5);
  const BodyHandle lift = world.add(body<D>(Shape<D>::box(half), at<D>(0, -0.5), BodyType::kinematic));
  std::vector<BodyHandle> boxes;
  for (int i = 0; i < 3; ++i) boxes.push_back(world.add(cube<D>(0, 0.5 + i)));
  for (int i = 0; i < 300; ++i) world.step(kDt);
  world.setMotion(lift, {at<D>(0, 0.1), Ang<D>::Zero()});
  for (int i = 0; i < 60; ++i) {
    world.step(kDt);
    for (const Manifold<D>& m : world.manifolds()) {
      for (int k = 0; k < m.count; ++k) {
        if (m.points[static_cast<std::size_t>(k)].separation < -2 * kLinearSlop) return false;
      }
    }
  }
  for (int i = 0; i < 3; ++i) {
    if (std::abs(world.pose(boxes[static_cast<std::size_t>(i)]).p[1] - Real(0.6 + i)) > 4 * kLinearSlop) return false;
  }
  return true;
}

// A box sleeps on a gate at rest until a listener vetoes their contact.
template <int D>
bool vetoesLetFall(const std::string& policy) {
  struct Gate final : ContactListener<D> {
    bool open = false;
    bool begin(const World<D>&, const Manifold<D>&) override { return !open; }
    bool persist(const World<D>&, const Manifold<D>&) override { return !open; }
  } listener;
  World<D> world(Pipeline::parse("sleep=" + policy));
  world.addListener(&listener);
  Vec<D> half = Vec<D>::Constant(2);
  half[1] = Real(0.5);
  world.add(body<D>(Shape<D>::box(half), at<D>(0, -0.5), BodyType::kinematic));
  const BodyHandle box = world.add(cube<D>(0, 0.5));
  for (int i = 0; i < 300; ++i) world.step(kDt);
  if (std::abs(world.pose(box).p[1] - Real(0.5)) > Real(0.1)) return false;
  listener.open = true;
  for (int i = 0; i < 60; ++i) world.step(kDt);
  return world.pose(box).p[1] < -3;
}

// A sleeping body reacts to every change by the user as an awake one does.
template <int D>
bool userWakes(const std::string& policy) {
  const auto after = [&](int what) {
    World<D> world(Pipeline::parse("sleep=" + policy));
    addGround(world);
    const BodyHandle box = world.add(cube<D>(0, 0.5));
    for (int i = 0; i < 300; ++i) world.step(kDt);
    if (what == 0) world.setMotion(box, {at<D>(4, 0), Ang<D>::Zero()});
    if (what == 1) world.setPose(box, {at<D>(0, 5), {}});
    for (int i = 0; i < 6; ++i) {
      if (what == 2) world.applyForce(box, at<D>(20, 0), world.pose(box).p);
      world.step(kDt);
    }
    return world.pose(box).p;
  };
  // All faster than any policy's rest: sliding, falling, and pushed against friction, for a tenth of a second.
  return after(0)[0] > Real(0.3) && after(1)[1] < Real(4.99) && after(2)[0] > Real(0.03);
}

// MuJoCo's two tests: distant bodies do not matter, asleep or awake.
template <int D>
bool farBodiesDoNotMatter(const std::string& policy) {
  const auto heights = [&](bool visitor) {
    Tower<D> tower(policy);
    if (visitor) {
      auto ball = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(50, 30));
      ball.velocity = 3 * Vec<D>::Unit(0);
      tower.world.add(ball);
    }
    tower.run(200);
    std::vector<Real> out;
    for (int i = 0; i < 5; ++i) out.push_back(tower.height(i));
    out.push_back(Real(tower.sleepers()));
    return out;
  };
  return heights(true) == heights(false);
}

template <int D>
struct Named {
  const char* name;
  bool (*holds)(const std::string& policy);
  const char* bug;  // of planted_sleep
};
template <int D>
std::vector<Named<D>> properties() {
  return {{"Sleeping.RestsAsWithoutIt", restsAsWithoutIt<D>, "adrift"},
          {"Sleeping.NobodyHangsInTheAir", nobodyHangsInTheAir<D>, "deaf"},
          {"Sleeping.NobodyHangsOnARemovedJoint", nobodyHangsOnARemovedJoint<D>, "deaf_to_joints"},
          {"Sleeping.SleepersAreTowed", sleepersAreTowed<D>, "wall"},
          {"Sleeping.SledgesTakeTheirLoad", sledgesTakeTheirLoad<D>, "slips"},
          {"Sleeping.GroundIsMovedAway", groundIsMovedAway<D>, "deaf"},
          {"Sleeping.ThrowsAreNotStopped", throwsAreNotStopped<D>, "nowhere"},
          {"Sleeping.BlowsWakeARow", blowsWakeARow<D>, "wall"},
          {"Sleeping.LiftsTakeAStackAlong", liftsTakeAStackAlong<D>, "wall"},
          {"Sleeping.VetoesLetFall", vetoesLetFall<D>, "deaf"},
          {"Sleeping.UserWakes", userWakes<D>, "nowhere"},
          {"Sleeping.FarBodiesDoNotMatter", farBodiesDoNotMatter<D>, "crowd"}};
}

template <int D>
void everyPolicy() {
  for (const Named<D>& p : properties<D>()) {
    for (const Registered* r : Registry::instance().list(StageKind::sleep, D)) {
      if (!competes(*r)) continue;
      EXPECT_TRUE(p.holds(r->info.name)) << p.name << ' ' << r->info.name << ' ' << D << 'D';
    }
    const std::string bug = "planted_sleep{bug=" + std::string(p.bug) + "}";
    expectCaught(std::string(p.name) + ' ' + bug + ' ' + std::to_string(D) + 'D', p.holds(bug));
  }
}
TEST(Sleeping, EveryPolicy2) { everyPolicy<2>(); }
TEST(Sleeping, EveryPolicy3) { everyPolicy<3>(); }

TEST(Sleeping, ATowerFallsAsleepAndCostsNothing) {
  for (const Registered* r : Registry::instance().list(StageKind::sleep, 2)) {
    if (!competes(*r)) continue;
    const bool sleeps = r->info.name != "none";
    EXPECT_EQ(towerSleeps<2>(r->info.name), sleeps) << r->info.name;
    EXPECT_EQ(towerSleeps<3>(r->info.name), sleeps) << r->info.name;
  }
}

// If all bodies sleep, no bounding box is tested, and contacts are neither generated nor copied: they stay in place in
// memory.
template <int D>
bool sleepersAreLeftAlone(bool anew) {
  WorldSettings<D> settings;
  settings.sleepingContacts = anew;
  World<D> world(Pipeline::parse("sleep=split_average"), settings);
  addGround(world);
  for (int i = 0; i < 6; ++i) world.add(cube<D>(i / 2, 0.5 + i % 2));
  for (int i = 0; i < 300; ++i) world.step(kDt);
  EXPECT_EQ(world.profiler().frame().awake, 0);
  EXPECT_GT(world.manifolds().size(), 5u);
  const Manifold<D>* const where = world.manifolds().data();
  world.step(kDt);
  const WorkDone& work = world.profiler().frame().work;
  return world.manifolds().data() == where && work[WorkCount::boxTests] == 0 && work[WorkCount::sortMoves] == 0;
}
template <int D>
void leftAlone() {
  EXPECT_TRUE(sleepersAreLeftAlone<D>(false));
  expectCaught("contacts of sleepers that are made anew", sleepersAreLeftAlone<D>(true));
}
TEST(Sleeping, SleepersAreLeftAlone) { leftAlone<2>(), leftAlone<3>(); }

// The loads of a sleeping body's contacts stay, also if the contacts are generated again in each step.
template <int D>
void loadsStay() {
  for (const char* cache : {"by_feature", "by_distance", "recycling"}) {
    for (const bool anew : {false, true}) {
      WorldSettings<D> settings;
      settings.sleepingContacts = anew;
      World<D> world(Pipeline::parse(std::string("sleep=split_average cache=") + cache), settings);
      addGround(world);
      const BodyHandle box = world.add(cube<D>(0, 0.5));
      for (int i = 0; i < 120; ++i) world.step(kDt);
      ASSERT_FALSE(world.awake(box));
      double load = 0;
      for (const Manifold<D>& m : world.manifolds()) {
        for (int k = 0; k < m.count; ++k) load += double(m.points[static_cast<std::size_t>(k)].load);
      }
      const double weight = double(world.bodies().mass[static_cast<std::size_t>(box.slot)]) *
                            double(settings.gravity.norm()) * double(kDt);
      EXPECT_NEAR(load, weight, 0.05 * weight) << cache << " " << anew;
    }
  }
}
TEST(Sleeping, LoadsOfSleepersStay) { loadsStay<2>(), loadsStay<3>(); }

// The last box of a struck sleeping row moves as far as without sleeping. With the report's 1.5 m/s the boxes would
// freeze like sliders (Sleep.SlowSliderStaysAwake).
template <int D>
void blowsGoThroughARow() {
  const auto strike = [](const std::string& sleep) {
    World<D> world(Pipeline::parse("sleep=" + sleep));
    addGround(world);
    BodyHandle last;
    for (int i = 0; i < 5; ++i) last = world.add(cube<D>(i, 0.5));
    for (int i = 0; i < 120; ++i) world.step(kDt);
    EXPECT_EQ(world.awake(last), sleep == "none");
    auto hammer = cube<D>(-3, 0.5);
    hammer.velocity = 10 * Vec<D>::Unit(0);
    world.add(hammer);
    for (int i = 0; i < 60; ++i) world.step(kDt);
    return world.pose(last).p[0] - 4;
  };
  const Real awake = strike("none"), asleep = strike("split_average{linear=0.1}");
  EXPECT_GT(awake, Real(0.05));
  EXPECT_NEAR(asleep, awake, awake / 10);
}
TEST(Sleeping, BlowsGoThroughARow) { blowsGoThroughARow<2>(), blowsGoThroughARow<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::sleeping_test
