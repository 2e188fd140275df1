// SPDX-License-Identifier: Zlib
// Joints in a world: they break, they let bodies sleep and wake them, they report their error.
#include <gtest/gtest.h>

#include "framework/math/worse.h"
#include "framework/world/invariants.h"
#include "tests/every_solver.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace joints_test { namespace {

constexpr Real kDt = Real(1) / 60;
const char* const kSolvers[] = {"solver=split_solver", "solver=split_solver{velocity=naive}",
                                "solver=split_solver{velocity=millington}", "solver=soft_step"};

/// A ball of 1 kg, 0.5 m wide, hangs from the world on a joint `kind` that breaks at `share` of its weight.
template <int D>
struct Hanging {
  World<D> world;
  BodyHandle ball;
  JointHandle joint;

  Hanging(const std::string& pipeline, const std::string& kind, Real share) : world(Pipeline::parse(pipeline)) {
    BodyDef<D> def = body<D>(Shape<D>::sphere(Real(0.25)), at<D>(0, 0));
    def.shapes[0].density = 1 / (D == 2 ? Real(0.19634954) : Real(0.06544985));
    ball = world.add(def);
    JointDef<D> hook{.kind = kind, .bodyB = ball, .X_WJ = {at<D>(0, 1), {}}, .breakForce = share * Real(9.81)};
    if (kind.starts_with("distance")) hook.X_WJb = Pose<D>{at<D>(0, 0), {}};
    joint = world.add(hook);
  }
};

template <int D>
void breaks() {
  for (const char* solver : kSolvers) {
    for (const char* kind : {"pivot", "hinge", "weld", "distance", "distance{mode=rope}"}) {
      SCOPED_TRACE(std::string(solver) + " " + kind);
      Hanging<D> strong(solver, kind, Real(1.1)), weak(solver, kind, Real(0.9));
      for (int i = 0; i < 60; ++i) strong.world.step(kDt), weak.world.step(kDt);
      EXPECT_FALSE(strong.world.joints()[0].broken);
      EXPECT_GT(strong.world.pose(strong.ball).p[1], -0.02);
      EXPECT_TRUE(weak.world.joints()[0].broken);
      EXPECT_LT(weak.world.pose(weak.ball).p[1], -4.5) << "it falls freely";
      weak.world.remove(weak.joint);
      EXPECT_THROW(weak.world.remove(weak.joint), UserError);
    }
  }
}
TEST(Joints, BreakAboveTheirForceAndNotBelow2) { breaks<2>(); }
TEST(Joints, BreakAboveTheirForceAndNotBelow3) { breaks<3>(); }

// A weld holds a lever: the force is within its limit, the torque is not.
template <int D>
void breaksByTorque() {
  for (const Real limit : {Real(0.8), Real(1.2)}) {
    World<D> world;
    BodyDef<D> def = body<D>(Shape<D>::sphere(Real(0.25)), at<D>(2, 0));
    const BodyHandle ball = world.add(def);
    const Real moment = 2 * Real(9.81) * world.mass(ball);
    world.add(JointDef<D>{.kind = "weld", .bodyB = ball, .breakTorque = limit * moment});
    for (int i = 0; i < 30; ++i) world.step(kDt);
    EXPECT_EQ(world.joints()[0].broken, limit < 1) << limit;
  }
}
TEST(Joints, BreakAboveTheirTorque) { breaksByTorque<2>(), breaksByTorque<3>(); }

// A joint disables the collision of its bodies; once it is broken, they collide.
TEST(Joints, BrokenJointsLetBodiesCollide) {
  World<2> world(Pipeline::parse("sleep=split_average"));
  addGround(world);
  const BodyHandle low = world.add(body<2>(Shape<2>::box({Real(0.5), Real(0.5)}), at<2>(0, 0.5)));
  const BodyHandle high = world.add(body<2>(Shape<2>::box({Real(0.5), Real(0.5)}), at<2>(0, 1.2)));  // it overlaps
  world.add(JointDef<2>{.kind = "weld", .bodyA = low, .bodyB = high, .X_WJ = {at<2>(0, 1), {}}, .breakForce = 100});
  for (int i = 0; i < 300; ++i) world.step(kDt);
  EXPECT_NEAR(world.pose(high).p[1], 1.2, 0.02);
  EXPECT_FALSE(world.awake(high));
  world.setMotion(low, {at<2>(3, 0), Ang<2>::Zero()});
  world.setMotion(high, {at<2>(-3, 0), Ang<2>::Zero()});
  for (int i = 0; i < 120; ++i) world.step(kDt);
  EXPECT_TRUE(world.joints()[0].broken);
  EXPECT_GT((world.pose(high).p - world.pose(low).p).norm(), 0.95) << "they collide again";
}

// A ball of 1 kg reaches the end of its rope at speed v and is stopped within one step. This takes the force m v / dt,
// however many sub-steps there are.
TEST(Joints, BreakByTheWholeStep) {
  for (const char* solver : kSolvers) {
    for (const Real share : {Real(0.9), Real(1.1)}) {
      SCOPED_TRACE(std::string(solver) + " " + std::to_string(share));
      World<2> world(Pipeline::parse(solver), {.gravity = Vec<2>::Zero()});
      BodyDef<2> def = body<2>(Shape<2>::sphere(Real(0.25)), at<2>(0, 0));
      def.shapes[0].density = 1 / Real(0.19634954);
      const BodyHandle ball = world.add(def);
      world.setMotion(ball, {at<2>(0, -2), Ang<2>::Zero()});
      world.add(JointDef<2>{.kind = "distance{mode=rope}",
                            .bodyB = ball,
                            .X_WJ = {at<2>(0, 1), {}},
                            .X_WJb = Pose<2>{at<2>(0, 0), {}},
                            .breakForce = share * 2 / kDt});
      for (int i = 0; i < 3; ++i) world.step(kDt);
      EXPECT_EQ(bool(world.joints()[0].broken), share < 1);
    }
  }
}

// The load of a sleeping body was measured in a step of another length.
TEST(Joints, SleepersDoNotBreak) {
  World<2> world(Pipeline::parse("sleep=split_average"));
  addGround(world);
  const BodyHandle low = world.add(body<2>(Shape<2>::box({Real(0.5), Real(0.5)}), at<2>(0, 0.5)));
  const BodyHandle side = world.add(body<2>(Shape<2>::box({Real(0.2), Real(0.2)}), at<2>(0.7, 0.8)));  // in the air
  const Real weight = world.mass(side) * Real(9.81);
  world.add(JointDef<2>{
      .kind = "weld", .bodyA = low, .bodyB = side, .X_WJ = {at<2>(0.5, 0.8), {}}, .breakForce = Real(1.5) * weight});
  for (int i = 0; i < 300; ++i) world.step(kDt);
  ASSERT_FALSE(world.awake(side));
  for (int i = 0; i < 10; ++i) world.step(kDt / 4);
  EXPECT_FALSE(world.joints()[0].broken);
}

// Joints that the model switches off keep no body awake.
TEST(Joints, ThatAreSwitchedOffKeepNoBodyAwake) {
  for (const bool joints : {false, true}) {
    WorldSettings<2> settings;
    settings.model.joints = joints;
    World<2> world(Pipeline::parse("sleep=split_average"), settings);
    addGround(world);
    const BodyHandle box = world.add(body<2>(Shape<2>::box({Real(0.5), Real(0.5)}), at<2>(0, 0.5)));
    const BodyHandle tug = world.add(body<2>(Shape<2>::sphere(Real(0.1)), at<2>(3, 0.5), BodyType::kinematic));
    world.add(
        JointDef<2>{.kind = "distance{mode=rope,length=9}", .bodyA = tug, .bodyB = box, .X_WJ = {at<2>(3, 0.5), {}}});
    world.setMotion(tug, {at<2>(0.01, 0), Ang<2>::Zero()});
    for (int i = 0; i < 300; ++i) world.step(kDt);
    EXPECT_EQ(world.awake(box), joints);
  }
}

// A rope that was taut and is now slack has no row and so no impulse.
TEST(Joints, WithoutRowsHaveNoImpulse) {
  for (const char* solver : {"solver=split_solver", "solver=soft_step"}) {
    Hanging<2> hanging(solver, "distance{mode=rope,length=1}", 100);
    for (int i = 0; i < 10; ++i) hanging.world.step(kDt);
    const JointRecord<2>& rope = hanging.world.joints()[0];
    EXPECT_LT(rope.impulse[0], 0) << solver;
    hanging.world.setPose(hanging.ball, {at<2>(0, 1), {}});
    hanging.world.setMotion(hanging.ball, Motion<2>{});
    hanging.world.step(kDt);
    EXPECT_EQ(rope.impulse[0], 0) << solver;
    EXPECT_EQ(rope.memory[0], 0) << solver;
  }
}

// A new joint may pull in its first step.
TEST(Joints, NewOnesWakeSleepers) {
  World<2> world(Pipeline::parse("sleep=split_average"));
  addGround(world);
  const BodyHandle box = world.add(body<2>(Shape<2>::box({Real(0.5), Real(0.5)}), at<2>(0, 0.5)));
  for (int i = 0; i < 300; ++i) world.step(kDt);
  ASSERT_FALSE(world.awake(box));
  world.add(JointDef<2>{.kind = "distance{mode=spring,length=0,stiffness=200}",
                        .bodyB = box,
                        .X_WJ = {at<2>(0, 3), {}},
                        .X_WJb = Pose<2>{at<2>(0, 0.5), {}}});
  for (int i = 0; i < 60; ++i) world.step(kDt);
  EXPECT_GT(world.pose(box).p[1], 0.6);
}

TEST(Joints, ErrorsInMetresAndRadiansAreSeparate) {
  World<3> world;
  const BodyHandle a = world.add(body<3>(Shape<3>::sphere(1), at<3>(0, 0)));
  const BodyHandle b = world.add(body<3>(Shape<3>::sphere(1), at<3>(2, 0)));
  world.add(JointDef<3>{.kind = "weld", .bodyA = a, .bodyB = b, .X_WJ = {at<3>(2, 0), {}}});
  world.setPose(b, {at<3>(2, Real(0.25)), Rot<3>::vector(Vec<3>(0, 0, Real(0.1)))});
  const StateInvariants<3> now = stateInvariants<3>(world);
  EXPECT_NEAR(now.jointError, 0.25, 1e-6);
  EXPECT_NEAR(now.jointTurn, 0.1, 1e-6);
}

// A motor turns a crank of 0.5 m; a coupler of 2 m and a rocker as long as the crank close the loop with the world. No
// translation of the bars closes it again once their angles have errors. Returns the largest joint error of seven
// seconds, m.
template <int D>
double loopError(const std::string& solver) {
  World<D> world(Pipeline::parse("solver=" + solver));
  const Vec<D> corners[] = {at<D>(0, 0), at<D>(0, 0.5), at<D>(2, 0.5), at<D>(2, 0)};
  const auto hinge = [&](BodyHandle a, BodyHandle b, int corner, const char* kind) {
    world.add(JointDef<D>{.kind = kind, .bodyA = a, .bodyB = b, .X_WJ = {corners[corner], {}}});
  };
  BodyHandle last{};
  for (int i = 0; i < 3; ++i) {
    const Vec<D> half = (corners[i + 1] - corners[i]).cwiseAbs() / 2 + Vec<D>::Constant(Real(0.05));
    BodyDef<D> bar = body<D>(Shape<D>::box(half), (corners[i] + corners[i + 1]) / 2);
    bar.shapes[0].mask = 0;
    const BodyHandle next = world.add(bar);
    hinge(last, next, i, i == 0 ? "hinge{motor_speed=6.3,motor_torque=1000}" : "hinge");
    last = next;
  }
  hinge(BodyHandle{}, last, 3, "hinge");
  double worst = 0;
  for (int i = 0; i < 420; ++i) {
    world.step(kDt);
    worst = worse(worst, double(stateInvariants<D>(world).jointError));
  }
  return worst;
}
template <int D>
void loopsStayClosed() {
  for (const std::string& solver : everySolver<D>(true)) {
    const bool plain = solver.find('{') == solver.npos, position = solver.find("{position=") != solver.npos;
    if (!plain && !position) continue;
    EXPECT_EQ(loopError<D>(solver) > 0.05, declares<D>(solver, "JointError.Shrinks")) << solver << ", " << D << 'D';
  }
}
TEST(Joints, LoopsStayClosed2) { loopsStayClosed<2>(); }
TEST(Joints, LoopsStayClosed3) { loopsStayClosed<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::joints_test
