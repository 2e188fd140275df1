// SPDX-License-Identifier: Zlib
#include "framework/world/continuous_pass.h"

#include "framework/world/joint_table.h"
#include "tests/world_parts.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace continuous_pass_test { namespace {

template <class T>
struct ContinuousPassTest : testing::Test {};
TYPED_TEST_SUITE(ContinuousPassTest, BothDimensions);

// Balls fly along x for one second, without a solver: each moves by its velocity.
template <int D>
struct Flight : Inhabitants<D> {
  std::unique_ptr<ContinuousCollision<D>> method;
  ContinuousPass<D> pass;
  NonCollidingPairs nonColliding;
  JointTable<D> joints;
  std::vector<Manifold<D>> manifolds;
  ContactGraph<D> graph;

  explicit Flight(const std::string& name) : method(createStage<ContinuousCollision<D>>({name, {}})) {}
  std::size_t fly(double x, double speed) {
    const std::size_t i = this->ball(at<D>(x, 0));
    this->table.bodies.motion[i].v = at<D>(speed, 0);
    return i;
  }
  std::size_t wall(double x) {  // to x + 0.2
    Vec<D> half = Vec<D>::Constant(5);
    half[0] = Real(0.1);
    return this->add(body<D>(Shape<D>::box(half), at<D>(x + 0.1, 0), BodyType::fixed));
  }
  ContinuousInput<D> input() { return {1, *method, this->table, this->settings, nonColliding, this->profiler}; }
  void run() {
    this->table.sync(false);
    pass.begin(input());
    Bodies<D>& b = this->table.bodies;
    for (std::size_t i = 0; i < b.pose.size(); ++i) {
      if (b.active(static_cast<int>(i))) b.pose[i].p += b.motion[i].v;
    }
    graph.reset(b, manifolds, joints.records, this->profiler.frame().work);
    pass.stopAtImpacts(input(), manifolds, joints.records, graph);
    this->table.boxes.markAllStale();
  }
  double x(std::size_t body) const { return double(this->table.bodies.pose[body].p[0]); }
  double work(WorkCount what) { return double(this->profiler.frame().work[what]); }
};

constexpr double kClose = 0.02;  // m: largest distance or depth of a stopped body at the body that it met

TYPED_TEST(ContinuousPassTest, AFastBallStopsAtAWallAndASlowOneGoesOn) {
  constexpr int D = TypeParam::D;
  Flight<D> f("cast");
  f.wall(10);
  const std::size_t fast = f.fly(0, 40);
  const std::size_t slow = f.ball(at<D>(8.5, 0));
  f.table.bodies.pose[slow].p[1] = 3, f.table.bodies.motion[slow].v = at<D>(0.2, 0);
  f.run();
  EXPECT_NEAR(f.x(fast), 9, kClose);
  EXPECT_NEAR(f.x(slow), 8.7, 1e-5);
  EXPECT_EQ(f.work(WorkCount::stops), 1);
  EXPECT_NEAR(f.profiler.frame().lostTime, 1 - 9. / 40, 1e-3);
}

TYPED_TEST(ContinuousPassTest, NothingIsStoppedWithoutContinuousCollision) {
  constexpr int D = TypeParam::D;
  for (const char* name : {"cast", "none", "speculative"}) {
    Flight<D> f(name);
    f.settings.model.continuous = name != std::string("cast");
    f.wall(10);
    const std::size_t fast = f.fly(0, 40);
    f.table.sync(false);
    f.pass.findSpeculativePairs(f.input());
    EXPECT_EQ(f.pass.speculativePairs().size(), name == std::string("speculative") ? 1u : 0u);
    f.run();
    EXPECT_NEAR(f.x(fast), 40, 1e-4);
  }
}

TYPED_TEST(ContinuousPassTest, VetoedAndJointedPairsPassThroughEachOther) {
  constexpr int D = TypeParam::D;
  for (const bool veto : {false, true}) {
    Flight<D> f("cast");
    const std::size_t wall = f.wall(10), fast = f.fly(0, 40);
    if (veto) {
      Manifold<D>& m = f.manifolds.emplace_back();
      m.bodyA = m.shapeA = static_cast<std::int32_t>(wall), m.bodyB = m.shapeB = static_cast<std::int32_t>(fast);
      m.ignored = 1;
    } else {
      f.joints.add(pivot<D>(f.handle(wall), f.handle(fast), at<D>(5, 0)), f.table);
      f.nonColliding.read(std::span<const JointRecord<D>>(f.joints.records));
    }
    f.run();
    EXPECT_NEAR(f.x(fast), 40, 1e-4);
  }
}

// Of two balls in a row the first hits the static body. The second then stops at the first one's final position.
TYPED_TEST(ContinuousPassTest, ImpactsHappenInTimeOrder) {
  constexpr int D = TypeParam::D;
  Flight<D> f("cast");
  const std::size_t second = f.fly(-4, 40);
  f.wall(10);
  const std::size_t first = f.fly(0, 40);
  f.run();
  EXPECT_NEAR(f.x(first), 9, kClose);
  EXPECT_NEAR(f.x(second), 7, kClose);
  EXPECT_EQ(f.work(WorkCount::stops), 2);
}

// A body far from the static body is stopped with the body that it is jointed to.
TYPED_TEST(ContinuousPassTest, JointedBodiesStopTogether) {
  constexpr int D = TypeParam::D;
  Flight<D> f("cast");
  f.wall(10);
  const std::size_t fast = f.fly(0, 40), held = f.ball(at<D>(0, 20)), alone = f.ball(at<D>(0, 30));
  for (const std::size_t i : {held, alone}) f.table.bodies.motion[i].v = at<D>(40, 0);
  f.joints.add(pivot<D>(f.handle(fast), f.handle(held), at<D>(0, 10)), f.table);
  f.nonColliding.read(std::span<const JointRecord<D>>(f.joints.records));
  f.run();
  EXPECT_NEAR(f.x(fast), 9, kClose);
  EXPECT_NEAR(f.x(held), 9, kClose);
  EXPECT_NEAR(f.x(alone), 40, 1e-4);
}

// Two balls fly at each other, and a joint stops one early. They touch at its final position, not halfway.
TYPED_TEST(ContinuousPassTest, ImpactsAreRecomputedAfterAStop) {
  constexpr int D = TypeParam::D;
  Flight<D> f("cast");
  const std::size_t first = f.fly(0, 40), second = f.fly(30, -40), mate = f.ball(at<D>(30, 20));
  f.table.bodies.motion[mate].v = at<D>(-40, 0);
  f.ball(at<D>(25, 20), BodyType::fixed);
  f.joints.add(pivot<D>(f.handle(second), f.handle(mate), at<D>(30, 10)), f.table);
  f.nonColliding.read(std::span<const JointRecord<D>>(f.joints.records));
  f.run();
  EXPECT_NEAR(f.x(mate), 27, kClose);
  EXPECT_NEAR(f.x(second), 27, kClose);
  EXPECT_NEAR(f.x(first), 25, 2 * kClose);
}

TYPED_TEST(ContinuousPassTest, MarginsAheadCoverTheMotionOfBoth) {
  constexpr int D = TypeParam::D;
  Flight<D> f("speculative");
  f.wall(10);
  f.fly(0, 40), f.fly(18, -8);
  f.table.sync(false);
  f.pass.findSpeculativePairs(f.input());
  const auto speculative = f.pass.speculativePairs();
  ASSERT_EQ(speculative.size(), 3u);
  EXPECT_EQ(speculative[0].shapes, (ShapePair{0, 1}));
  EXPECT_NEAR(speculative[0].margin, f.settings.margin + 40, 1e-3);
  EXPECT_EQ(speculative[2].shapes, (ShapePair{1, 2}));
  EXPECT_NEAR(speculative[2].margin, f.settings.margin + 48, 1e-3);
  f.settings.model.continuous = false;
  f.pass.findSpeculativePairs(f.input());
  EXPECT_TRUE(f.pass.speculativePairs().empty());
}

// A large ball takes the slot of a small one; the same motion is short for it.
TYPED_TEST(ContinuousPassTest, AForgottenShapeIsMeasuredAgain) {
  constexpr int D = TypeParam::D;
  Flight<D> f("speculative");
  f.wall(20);
  const std::size_t small = f.fly(10, 4);
  f.table.sync(false);
  f.pass.findSpeculativePairs(f.input());  // measures it; its path ends short of the static body
  f.table.remove(small);
  const std::size_t large = f.add(body<D>(Shape<D>::sphere(10), at<D>(10, 0)));
  f.table.bodies.motion[large].v = at<D>(4, 0);
  f.pass.forget(static_cast<std::size_t>(f.table.shapesOf(large)[0]));
  f.table.sync(false);
  f.pass.findSpeculativePairs(f.input());
  EXPECT_EQ(f.pass.speculativePairs().size(), 0u);
}

}}}}}  // namespace lpc::LPC_PRECISION::test::continuous_pass_test
