// SPDX-License-Identifier: Zlib
#include "framework/world/joint_table.h"

#include "framework/world/non_colliding_pairs.h"
#include "tests/world_parts.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace joint_table_test { namespace {

template <class T>
struct JointTableTest : testing::Test {};
TYPED_TEST_SUITE(JointTableTest, BothDimensions);

// Three balls in a row, the first static, each jointed to the next.
template <int D>
struct Chain : Inhabitants<D> {
  JointTable<D> joints;
  std::array<std::size_t, 3> bodies;
  std::array<JointHandle, 2> links;

  explicit Chain(const std::string& kind = "pivot") {
    for (std::size_t i = 0; i < 3; ++i) {
      bodies[i] = this->ball(at<D>(3 * double(i), 0), i == 0 ? BodyType::fixed : BodyType::dynamic);
    }
    for (std::size_t i = 0; i < 2; ++i) {
      JointDef<D> def = pivot<D>(this->handle(bodies[i]), this->handle(bodies[i + 1]), at<D>(3 * double(i) + 1.5, 0));
      def.kind = kind;
      links[i] = joints.add(def, this->table);
    }
    this->table.events.clear();
  }
  // World positions of a joint's two anchors.
  std::array<Vec<D>, 2> anchors(std::size_t joint) const {
    const JointRecord<D>& j = joints.records[joint];
    return {poseOf(this->table.bodies, j.bodyA) * j.X_CaJ.p, poseOf(this->table.bodies, j.bodyB) * j.X_CbJ.p};
  }
};

TYPED_TEST(JointTableTest, JointsAreListedByBodyAndNotifyOnRemoval) {
  constexpr int D = TypeParam::D;
  Chain<D> c;
  EXPECT_EQ(c.joints.of(c.bodies[1]).size(), 2u);
  EXPECT_EQ(c.joints.of(c.bodies[2]).size(), 1u);
  c.joints.remove(c.links[0], c.table);
  ASSERT_EQ(c.table.events.size(), 2u);
  EXPECT_EQ(c.table.events[0].kind, SleepEvent::jointRemoved);
  EXPECT_EQ(c.table.events[0].body, 0);
  EXPECT_EQ(c.table.events[1].body, 1);
  EXPECT_NE(refusalOf([&] { c.joints.remove(c.links[0], c.table); }), "");
  EXPECT_EQ(c.joints.of(c.bodies[1]).size(), 1u);
  // The slot is reused; the old handle stays invalid.
  const JointHandle next = c.joints.add(pivot<D>(c.handle(c.bodies[0]), c.handle(c.bodies[2]), at<D>(1, 0)), c.table);
  EXPECT_EQ(next.slot, c.links[0].slot);
  EXPECT_NE(next.generation, c.links[0].generation);
  c.joints.removeAllOf(c.bodies[2], c.table);
  EXPECT_TRUE(c.joints.of(c.bodies[0]).empty() && c.joints.of(c.bodies[1]).empty());
}

TYPED_TEST(JointTableTest, AJointNeedsTwoBodiesOfWhichOneMoves) {
  constexpr int D = TypeParam::D;
  Inhabitants<D> in;
  JointTable<D> joints;
  const BodyHandle fixed = in.handle(in.ball(at<D>(0, 0), BodyType::fixed)),
                   other = in.handle(in.ball(at<D>(3, 0), BodyType::fixed));
  EXPECT_NE(refusalOf([&] { joints.add(pivot<D>(fixed, other, at<D>(0, 0)), in.table); }), "");
  EXPECT_NE(refusalOf([&] { joints.add(pivot<D>(fixed, fixed, at<D>(0, 0)), in.table); }), "");
  EXPECT_NE(refusalOf([&] { joints.add(pivot<D>({}, fixed, at<D>(0, 0)), in.table); }), "");
  EXPECT_TRUE(joints.records.empty());
  BodyDef<D> def = body<D>(Shape<D>::sphere(1), at<D>(6, 0));
  def.awake = false;
  const std::size_t sleeper = in.add(def);
  joints.add(pivot<D>(fixed, in.handle(sleeper), at<D>(3, 0)), in.table);
  EXPECT_TRUE(in.table.bodies.awake[sleeper]);
  EXPECT_NE(refusalOf([&] { joints.requireMoving(sleeper, in.table); }), "");
}

// The load is the impulse of the step over its length. A joint that breaks notifies its bodies; removing it later does
// not.
TYPED_TEST(JointTableTest, OverloadedJointsBreak) {
  constexpr int D = TypeParam::D;
  for (const Real dt : {Real(0.5), Real(0.25)}) {
    Chain<D> c;
    for (JointRecord<D>& j : c.joints.records) j.breakForce = 3, j.impulse[0] = 1;  // 2 N and 4 N
    c.joints.finish(c.table.bodies, dt, c.table.events);
    const bool breaks = dt < Real(0.3);
    for (const JointRecord<D>& j : c.joints.records) {
      EXPECT_EQ(j.active(), !breaks);
      EXPECT_EQ(j.impulse[0], breaks ? 0 : 1);
    }
    EXPECT_EQ(c.table.events.size(), breaks ? 4u : 0u);
    c.table.events.clear();
    c.joints.remove(c.links[0], c.table);
    EXPECT_EQ(c.table.events.size(), breaks ? 0u : 2u);
  }
  // Impulses from before the bodies fell asleep do not break a joint.
  Chain<D> c;
  for (JointRecord<D>& j : c.joints.records) j.breakForce = 3, j.impulse[0] = 1;
  for (const std::size_t i : c.bodies) c.table.bodies.awake[i] = 0;
  c.joints.finish(c.table.bodies, Real(0.01), c.table.events);
  EXPECT_TRUE(c.joints.records[0].active());
}

TYPED_TEST(JointTableTest, AHingeCountsWholeTurns) {
  constexpr int D = TypeParam::D;
  Chain<D> c("hinge");
  Ang<D> third = Ang<D>::Zero();
  third[kAngDim<D> - 1] = Real(6.28318530717958647693 / 3);
  for (int i = 0; i < 7; ++i) {
    Rot<D>& q = c.table.bodies.pose[c.bodies[1]].q;
    q = integrateRotation(q, third);
    c.joints.countTurns(c.table.bodies);
  }
  EXPECT_NEAR(c.joints.records[0].state[0], 7 * third[kAngDim<D> - 1], 1e-4);
}

TYPED_TEST(JointTableTest, AnchorsStayWhereTheyAreWhenBodiesChange) {
  constexpr int D = TypeParam::D;
  Chain<D> c;
  const auto first = c.anchors(0), second = c.anchors(1);
  // The centre of mass moves within the body.
  Pose<D>& x = c.table.bodies.pose[c.bodies[1]];
  x.q = integrateRotation(x.q, Ang<D>(Ang<D>::Constant(1)));
  const auto turned = c.anchors(1);
  const Vec<D> by = at<D>(0.25, -0.5);
  x.p += x.q * by;
  c.joints.moveCenter(c.bodies[1], by, c.table.visits);
  EXPECT_NEAR((c.anchors(1)[0] - turned[0]).norm(), 0, 1e-6);
  EXPECT_NEAR((c.anchors(0)[0] - first[0]).norm(), 0, 1e-6);
  // The joints move to the last body; the joint between the two stays and will be removed with the body.
  const auto before = c.anchors(0);
  c.joints.reassign(c.bodies[1], c.bodies[2], c.table);
  EXPECT_EQ(c.joints.records[0].bodyB, static_cast<std::int32_t>(c.bodies[2]));
  EXPECT_EQ(c.joints.records[1].bodyA, static_cast<std::int32_t>(c.bodies[1]));
  EXPECT_NEAR((c.anchors(0)[1] - before[1]).norm(), 0, 1e-6);
  EXPECT_NEAR((c.anchors(1)[1] - second[1]).norm(), 0, 1e-6);
  EXPECT_EQ(c.joints.of(c.bodies[2]).size(), 2u);
  EXPECT_EQ(c.joints.of(c.bodies[1]).size(), 1u);
}

TYPED_TEST(JointTableTest, JointedBodiesAreUnpairedUnlessTheyShallCollide) {
  constexpr int D = TypeParam::D;
  Chain<D> c;
  NonCollidingPairs nonColliding;
  const auto contains = [&](std::size_t a, std::size_t b) {
    return nonColliding.contains(static_cast<std::int32_t>(c.bodies[a]), static_cast<std::int32_t>(c.bodies[b]));
  };
  const std::span<const JointRecord<D>> joints = c.joints.records;
  nonColliding.read(joints);
  EXPECT_TRUE(contains(0, 1) && contains(1, 2));
  EXPECT_FALSE(contains(0, 2));
  c.joints.records[0].collide = 1;
  c.joints.breakJoint(1, c.table.events);
  nonColliding.read(joints);
  EXPECT_FALSE(contains(0, 1) || contains(1, 2));
}

TYPED_TEST(JointTableTest, CopiedRecordsAreListed) {
  constexpr int D = TypeParam::D;
  Chain<D> c;
  c.joints.remove(c.links[0], c.table);
  JointTable<D> copy;
  copy.records = c.joints.records;
  copy.recount(c.table.visits);
  EXPECT_EQ(copy.of(c.bodies[1]).size(), 1u);
  EXPECT_EQ(copy.add(pivot<D>({}, c.handle(c.bodies[1]), at<D>(0, 0)), c.table).slot, c.links[0].slot);
  copy.clear(c.table.visits);
  EXPECT_TRUE(copy.of(c.bodies[1]).empty());
  EXPECT_FALSE(copy.records[0].kind || copy.records[1].kind);
}

}}}}}  // namespace lpc::LPC_PRECISION::test::joint_table_test
