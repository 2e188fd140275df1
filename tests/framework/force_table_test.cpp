// SPDX-License-Identifier: Zlib
#include "framework/world/force_table.h"

#include "tests/world_parts.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace force_table_test { namespace {

template <class T>
struct ForceTableTest : testing::Test {};
TYPED_TEST_SUITE(ForceTableTest, BothDimensions);

template <int D>
ForceDef<D> spring(BodyHandle a, BodyHandle b) {
  return {.kind = springKind(10), .bodyA = a, .bodyB = b};
}

template <int D>
struct Push final : ForceGenerator<D> {
  void apply(const ForceState<D>&, Real t, std::span<Wrench<D>> out) const override {
    for (Wrench<D>& w : out) w.force[0] += t;
  }
};

TYPED_TEST(ForceTableTest, AStepHasGravityThePushOfItsUserAndAllForces) {
  constexpr int D = TypeParam::D;
  Inhabitants<D> in;
  ForceTable<D> forces;
  const std::size_t a = in.ball(at<D>(0, 0)), b = in.ball(at<D>(3, 0));
  in.table.bodies.gravityScale[b] = 2;
  in.table.userForces[a].force = at<D>(0, 5);
  const auto sum = [&] {
    const StepForces<D> all(in.table, forces, {at<D>(0, -10), Real(0.1), 0});
    std::vector<Wrench<D>> out(2);
    all.eval({in.table.bodies, in.table.bodies.pose, in.table.bodies.motion}, 7, out);
    return out;
  };
  const Real m = in.table.bodies.mass[a];
  EXPECT_NEAR((sum()[a].force - at<D>(0, double(5 - 10 * m))).norm(), 0, 1e-4);
  EXPECT_NEAR((sum()[b].force - at<D>(0, double(-20 * m))).norm(), 0, 1e-4);
  const ForceHandle pull = forces.add(spring<D>(in.handle(a), in.handle(b)), in.table);
  EXPECT_NEAR(sum()[a].force[0], 30, 1e-4);
  EXPECT_NEAR(sum()[b].force[0], -30, 1e-4);
  forces.remove(pull, in.table);
  EXPECT_NE(refusalOf([&] { forces.remove(pull, in.table); }), "");
  forces.generators.push_back(std::make_shared<Push<D>>());
  EXPECT_NEAR(sum()[a].force[0], 7, 1e-4);
}

TYPED_TEST(ForceTableTest, BodiesThatAForceActsOnWake) {
  constexpr int D = TypeParam::D;
  Inhabitants<D> in;
  ForceTable<D> forces;
  std::array<std::size_t, 3> bodies;
  for (std::size_t i = 0; i < 3; ++i) bodies[i] = in.ball(at<D>(3 * double(i), 0));
  const auto sleep = [&] { in.table.bodies.awake.assign(3, 0), in.table.events.clear(); };
  sleep();
  const ForceHandle pull = forces.add(spring<D>(in.handle(0), in.handle(1)), in.table);
  EXPECT_EQ(in.table.bodies.awake, (std::vector<std::uint8_t>{1, 1, 0}));
  EXPECT_EQ(in.table.events.size(), 2u);
  sleep();
  forces.remove(pull, in.table);
  EXPECT_EQ(in.table.bodies.awake, (std::vector<std::uint8_t>{1, 1, 0}));
  sleep();
  const ForceHandle again = forces.add(spring<D>(in.handle(0), in.handle(1)), in.table);
  EXPECT_EQ(again.slot, pull.slot);
  forces.add(spring<D>(in.handle(1), in.handle(2)), in.table);
  forces.removeAllOf(0, in.table);
  EXPECT_FALSE(forces.records[0].kind);
  EXPECT_TRUE(forces.records[1].kind);
  sleep();
  forces.add({.kind = dragKind(1, 0)}, in.table);  // on all bodies
  EXPECT_EQ(in.table.bodies.awake, (std::vector<std::uint8_t>{1, 1, 1}));
}

TYPED_TEST(ForceTableTest, EndsStayWhereTheyAreWhenBodiesChange) {
  constexpr int D = TypeParam::D;
  Inhabitants<D> in;
  ForceTable<D> forces;
  for (int i = 0; i < 3; ++i) in.ball(at<D>(3 * i, 0));
  for (const std::size_t to : {std::size_t(1), std::size_t(2)}) {
    ForceDef<D> def = spring<D>(in.handle(0), in.handle(to));
    def.anchorB = at<D>(0.5, 0.25);
    forces.add(def, in.table);
  }
  const auto end = [&](std::size_t f) {
    const ForceRecord<D>& r = forces.records[f];
    return Vec<D>(in.table.bodies.pose[static_cast<std::size_t>(r.bodyB)] * r.localB);
  };
  const Vec<D> first = end(0), second = end(1), by = at<D>(0.25, -0.5);
  in.table.bodies.pose[1].p += by;
  forces.moveCenter(1, by, in.table.visits);
  EXPECT_NEAR((end(0) - first).norm(), 0, 1e-6);
  EXPECT_NEAR((end(1) - second).norm(), 0, 1e-6);
  forces.reassign(1, 2, in.table.bodies);
  EXPECT_EQ(forces.records[0].bodyB, 2);
  EXPECT_NEAR((end(0) - first).norm(), 0, 1e-6);
  forces.reassign(0, 2, in.table.bodies);  // between the two: removed with the body
  EXPECT_EQ(forces.records[0].bodyA, 0);
}

TYPED_TEST(ForceTableTest, ContactsAreKeptForForcesThatReadThem) {
  constexpr int D = TypeParam::D;
  Inhabitants<D> in;
  ForceTable<D> forces;
  in.ball(at<D>(0, 0));
  const std::vector<Manifold<D>> manifolds(2);
  forces.keepContacts(manifolds);
  EXPECT_TRUE(forces.lastContacts().empty());
  forces.add({.kind = "rolling_resistance"}, in.table);
  forces.keepContacts(manifolds);
  EXPECT_EQ(forces.lastContacts().size(), 2u);
  forces.clear(in.table.visits);
  forces.keepContacts(manifolds);
  EXPECT_TRUE(forces.lastContacts().empty());
}

}}}}}  // namespace lpc::LPC_PRECISION::test::force_table_test
