// SPDX-License-Identifier: Zlib
// Sleeping in whole worlds (S5): who sleeps, who wakes, and that nothing else changes.
#include <gtest/gtest.h>

#include "framework/world.h"
#include "tests/small_worlds.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

constexpr Real kDt = Real(1) / 60;

template <int D>
Pipeline pipeline(const std::string& sleep) {
  return Pipeline::parse("sleep=" + sleep);
}

template <int D>
BodyDef<D> cube(double x, double y) {
  return body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(x, y));
}

template <int D>
struct Tower {
  World<D> world;
  Handle ground;
  std::vector<Handle> boxes;
  explicit Tower(const std::string& sleep, int height = 5) : world(pipeline<D>(sleep)) {
    ground = addGround(world);
    for (int i = 0; i < height; ++i) boxes.push_back(world.add(cube<D>(0, 0.5 + i)));
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) world.step(kDt);
  }
  int sleepers() const {
    int n = 0;
    for (const Handle& b : boxes) n += world.valid(b) && !world.awake(b);
    return n;
  }
  Real height(int i) const { return world.pose(boxes[static_cast<std::size_t>(i)]).p[1]; }
};

template <class T>
class Sleeping : public testing::Test {};
template <int N>
struct Dim {
  static constexpr int D = N;
};
using Dims = testing::Types<Dim<2>, Dim<3>>;
TYPED_TEST_SUITE(Sleeping, Dims);

TYPED_TEST(Sleeping, ATowerFallsAsleepWhereItStood) {
  constexpr int D = TypeParam::D;
  Tower<D> asleep("split_average"), awake("none");
  asleep.run(300), awake.run(300);
  EXPECT_EQ(asleep.sleepers(), 5);
  EXPECT_EQ(awake.sleepers(), 0) << "none is the planted bug of this test";
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(asleep.height(i), awake.height(i), 4 * double(kLinearSlop)) << i;
  const auto hash = asleep.world.hash();
  asleep.run(100);
  EXPECT_EQ(asleep.world.hash(), hash) << "sleepers do not creep";
}

TYPED_TEST(Sleeping, NobodyHangsInTheAir) {
  constexpr int D = TypeParam::D;
  Tower<D> tower("split_average");
  tower.run(300);
  ASSERT_EQ(tower.sleepers(), 5);
  tower.world.remove(tower.boxes[0]);
  tower.run(90);
  for (int i = 1; i < 5; ++i) EXPECT_NEAR(tower.height(i), i - 0.5, 0.1) << i << " was left hanging";
  tower.run(300);
  EXPECT_EQ(tower.sleepers(), 4) << "and they sleep again";
}

TYPED_TEST(Sleeping, TheGroundIsMovedAway) {
  constexpr int D = TypeParam::D;
  Tower<D> tower("split_average");
  tower.run(300);
  tower.world.setPose(tower.ground, Pose<D>{Vec<D>(-100 * Vec<D>::Unit(1)), {}});
  tower.run(90);
  for (int i = 0; i < 5; ++i) EXPECT_LT(tower.height(i), i - 5) << i << " hangs";
}

// Thrown up along a wall, and two boxes on each other in the air: the same bits as without sleeping, top of the flight
// included.
TYPED_TEST(Sleeping, ThrowsAreNotStopped) {
  constexpr int D = TypeParam::D;
  const auto fly = [](const std::string& sleep) {
    World<D> world(pipeline<D>(sleep));
    auto wall = body<D>(Shape<D>::box(Real(20) * Vec<D>::Ones()), at<D>(-20.5, 0));
    wall.type = BodyType::fixed;
    world.add(wall);
    auto along = cube<D>(0, 0), lower = cube<D>(5, 0), upper = cube<D>(5, 1);
    for (auto* b : {&along, &lower, &upper}) b->velocity = 5 * Vec<D>::Unit(1);
    world.add(along), world.add(lower), world.add(upper);
    for (int i = 0; i < 70; ++i) world.step(kDt);
    return world.hash();
  };
  EXPECT_EQ(fly("split_average"), fly("none"));
}

// A row of sleepers is struck: the last one moves as it does when nobody sleeps.
TYPED_TEST(Sleeping, BlowsGoThroughARow) {
  constexpr int D = TypeParam::D;
  const auto strike = [](const std::string& sleep) {
    World<D> world(pipeline<D>(sleep));
    addGround(world);
    Handle last;
    for (int i = 0; i < 5; ++i) last = world.add(cube<D>(i, 0.5));
    for (int i = 0; i < 120; ++i) world.step(kDt);
    EXPECT_EQ(world.awake(last), sleep == "none");
    auto hammer = cube<D>(-3, 0.5);
    hammer.velocity = 10 * Vec<D>::Unit(0);
    world.add(hammer);
    for (int i = 0; i < 60; ++i) world.step(kDt);
    return world.pose(last).p[0] - 4;
  };
  // With the report's 1.5 m/s the boxes would freeze as sliders do (SplitAverage.FailsOnSlowSlider).
  const Real awake = strike("none"), asleep = strike("split_average{linear=0.1}");
  EXPECT_GT(awake, Real(0.05));
  EXPECT_NEAR(asleep, awake, awake / 10);
}

// MuJoCo's two tests: who is far away plays no part, asleep or awake.
TYPED_TEST(Sleeping, FarBodiesDoNotMatter) {
  constexpr int D = TypeParam::D;
  const auto heights = [](bool visitor) {
    Tower<D> tower("split_average");
    if (visitor) {
      auto ball = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(50, 30));
      ball.velocity = 3 * Vec<D>::Unit(0);
      tower.world.add(ball);
    }
    tower.run(200);
    std::vector<Real> out;
    for (int i = 0; i < 5; ++i) out.push_back(tower.height(i));
    return out;
  };
  EXPECT_EQ(heights(true), heights(false));
}

TYPED_TEST(Sleeping, SleepersLetTheirStepRest) {
  constexpr int D = TypeParam::D;
  Tower<D> tower("split_average");
  tower.run(300);
  tower.world.step(kDt);
  EXPECT_EQ(tower.world.profiler().frame().work[Count::rowUpdates], 0u);
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
