// SPDX-License-Identifier: Zlib
#include "framework/world/body_table.h"

#include "tests/world_parts.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace body_table_test { namespace {

template <class T>
struct BodyTableTest : testing::Test {};
TYPED_TEST_SUITE(BodyTableTest, BothDimensions);

// A box with a ball beside it; every field differs from its default.
template <int D>
BodyDef<D> odd() {
  BodyDef<D> def = body<D>(Shape<D>::box(Vec<D>::Constant(1)), at<D>(3, 4));
  def.shapes[0].X_BS.p = at<D>(1, 0);
  def.shapes.push_back({.shape = Shape<D>::sphere(1), .X_BS = {at<D>(-3, 0), {}}, .density = 2, .friction = 0.25f});
  def.shapes[1].category = 4, def.shapes[1].mask = 5, def.shapes[1].userData = 6;
  def.velocity = at<D>(1, 2), def.gravityScale = Real(0.5), def.userData = 7, def.canSleep = false;
  def.angularVelocity[kAngDim<D> - 1] = 3;
  return def;
}

TYPED_TEST(BodyTableTest, AddTakesTheLowestFreeSlotAndOldHandlesStayInvalid) {
  constexpr int D = TypeParam::D;
  Inhabitants<D> in;
  for (int i = 0; i < 3; ++i) in.ball(at<D>(3 * i, 0));
  const BodyHandle first = in.handle(0);
  in.table.remove(0), in.table.remove(1);
  EXPECT_EQ(in.table.count(), 1);
  EXPECT_EQ(in.table.shapes[0].body, -1);
  EXPECT_EQ(in.ball(at<D>(0, 0)), 0u);
  EXPECT_FALSE(in.table.valid(first));
  EXPECT_NE(refusalOf([&] { in.table.slotOf(first); }), "");
  EXPECT_EQ(in.table.slotOf(in.handle(0)), 0u);
  in.table.clear();
  EXPECT_EQ(in.table.count(), 0);
  EXPECT_EQ(in.ball(at<D>(0, 0)), 0u);
}

TYPED_TEST(BodyTableTest, DefinitionsRoundTrip) {
  constexpr int D = TypeParam::D;
  Inhabitants<D> in;
  in.ball(at<D>(9, 9));
  const BodyDef<D> def = odd<D>(), is = in.table.definition(in.add(def));
  EXPECT_NEAR((is.X_WB.p - def.X_WB.p).norm(), 0, 1e-6);
  EXPECT_EQ(is.velocity, def.velocity);
  EXPECT_EQ(is.angularVelocity, def.angularVelocity);
  EXPECT_EQ(is.gravityScale, def.gravityScale);
  EXPECT_EQ(is.userData, def.userData);
  EXPECT_EQ(is.canSleep, def.canSleep);
  EXPECT_FALSE(is.mass);
  ASSERT_EQ(is.shapes.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_TRUE(is.shapes[k].shape.same(def.shapes[k].shape));
    EXPECT_NEAR((is.shapes[k].X_BS.p - def.shapes[k].X_BS.p).norm(), 0, 1e-6);
    EXPECT_EQ(is.shapes[k].density, def.shapes[k].density);
    EXPECT_EQ(is.shapes[k].friction, def.shapes[k].friction);
    EXPECT_EQ(is.shapes[k].category, def.shapes[k].category);
    EXPECT_EQ(is.shapes[k].mask, def.shapes[k].mask);
    EXPECT_EQ(is.shapes[k].userData, def.shapes[k].userData);
  }
}

// One shape is removed, one stays, one is added. The body's motion continues about its new centre of mass, and the kept
// shape stays in place.
TYPED_TEST(BodyTableTest, ARewrittenBodyKeepsSlotMotionAndShapes) {
  constexpr int D = TypeParam::D;
  Inhabitants<D> in;
  const std::size_t i = in.add(odd<D>());
  const Pose<D> X_WB = in.table.frame(i);
  const std::int32_t kept = in.table.shapesOf(i)[1], gone = in.table.shapesOf(i)[0];
  const Vec<D> ball = in.table.bodies.pose[i] * in.table.shapes[static_cast<std::size_t>(kept)].X_CS.p;
  const Vec<D> centre = in.table.bodies.pose[i].p;
  BodyDef<D> def = in.table.definition(i);
  def.shapes[0] = {.shape = Shape<D>::sphere(2), .X_BS = {at<D>(5, 0), {}}};
  const CheckedBody<D> w = checkBody(def);
  const auto match = in.table.match(i, w.shapes);
  EXPECT_EQ(match.removed, std::vector<std::size_t>{static_cast<std::size_t>(gone)});
  EXPECT_EQ(match.kept, (std::vector<std::size_t>{BodyTable<D>::kNew, static_cast<std::size_t>(kept)}));
  const Vec<D> by = in.table.rewrite(i, def, w, match);
  EXPECT_GT(by.norm(), 0.1);
  EXPECT_NEAR((in.table.bodies.pose[i].p - centre - X_WB.q * by).norm(), 0, 1e-5);
  EXPECT_NEAR((in.table.frame(i).p - X_WB.p).norm(), 0, 1e-5);
  EXPECT_NEAR((in.table.bodies.pose[i] * in.table.shapes[static_cast<std::size_t>(kept)].X_CS.p - ball).norm(), 0,
              1e-5);
  EXPECT_EQ(in.table.shapes[static_cast<std::size_t>(kept)].index, 1);
  EXPECT_EQ(in.table.shapesOf(i).size(), 2u);
  // The velocity at the old centre is unchanged.
  const Vec<D> v = in.table.bodies.motion[i].v - cross(in.table.bodies.motion[i].w, Vec<D>(X_WB.q * by));
  EXPECT_NEAR((v - at<D>(1, 2)).norm(), 0, 1e-5);
}

TYPED_TEST(BodyTableTest, KindsAreCountedByTheirParts) {
  constexpr int D = TypeParam::D;
  const auto box = static_cast<std::size_t>(ShapeKind::box), sphere = static_cast<std::size_t>(ShapeKind::sphere);
  Inhabitants<D> in;
  const std::size_t i = in.add(odd<D>()), j = in.ball(at<D>(9, 9));
  EXPECT_TRUE(in.table.kinds()[box] && in.table.kinds()[sphere]);
  const CheckedBody<D> ball = checkBody(body<D>(Shape<D>::sphere(1), at<D>(0, 0)));
  EXPECT_TRUE(in.table.kindsWith(ball, -1)[box]);
  EXPECT_FALSE(in.table.kindsWith(ball, static_cast<std::int32_t>(i))[box]);
  in.table.remove(i);
  EXPECT_FALSE(in.table.kinds()[box]);
  EXPECT_TRUE(in.table.kinds()[sphere]);
  in.table.remove(j);
  EXPECT_FALSE(in.table.kinds()[sphere]);
}

TYPED_TEST(BodyTableTest, ChangedBodiesWakeAndGetANewBox) {
  constexpr int D = TypeParam::D;
  Inhabitants<D> in;
  BodyDef<D> def = body<D>(Shape<D>::sphere(1), at<D>(0, 0));
  def.awake = false;
  const std::size_t i = in.add(def);
  in.table.sync(false);
  EXPECT_FALSE(in.table.boxes.active(0));
  in.table.bodies.pose[i].p = at<D>(5, 0);
  in.table.sync(false);
  EXPECT_NEAR(in.table.boxes.proxies().box(0).center()[0], 0, 1e-6);
  in.table.wake(i);
  EXPECT_TRUE(in.table.bodies.awake[i]);
  ASSERT_EQ(in.table.events.size(), 1u);
  EXPECT_EQ(in.table.events[0].kind, SleepEvent::userChange);
  in.table.wake(i);  // it is awake
  EXPECT_EQ(in.table.events.size(), 1u);
  in.table.sync(false);
  EXPECT_TRUE(in.table.boxes.active(0));
  EXPECT_NEAR(in.table.boxes.proxies().box(0).center()[0], 5, 1e-6);
  const std::vector<std::uint8_t> before = in.table.bodies.awake;
  in.table.bodies.awake[i] = 0, in.table.bodies.motion[i].v = at<D>(1, 1);
  in.table.stopSleepers(before);
  EXPECT_EQ(in.table.bodies.motion[i].v, at<D>(0, 0));
}

TYPED_TEST(BodyTableTest, InverseMassesAreZeroForBodiesThatForcesDoNotMove) {
  constexpr int D = TypeParam::D;
  Inhabitants<D> in;
  const std::size_t free = in.ball(at<D>(0, 0)), fixed = in.ball(at<D>(3, 0), BodyType::fixed);
  BodyDef<D> def = body<D>(Shape<D>::sphere(1), at<D>(6, 0));
  def.pinned = true;
  const std::size_t pinned = in.add(def);
  def.pinned = false, def.awake = false;
  const std::size_t asleep = in.add(def);
  in.table.bodies.invMass.assign(4, 9);
  in.table.bodies.invInertia.assign(4, Inertia<D>::Constant(9));
  in.table.refreshMasses(true);
  const Bodies<D>& b = in.table.bodies;
  EXPECT_NEAR(b.invMass[free] * b.mass[free], 1, 1e-6);
  EXPECT_EQ(b.invMass[pinned], 0);
  EXPECT_GT(b.invInertia[free].norm(), 0);
  EXPECT_GT(b.invInertia[pinned].norm(), 0);
  for (const std::size_t i : {fixed, asleep}) {
    EXPECT_EQ(b.invMass[i], 0);
    EXPECT_EQ(b.invInertia[i].norm(), 0);
  }
}

// All derived data follow from the arrays alone, as after loading.
TYPED_TEST(BodyTableTest, DerivedDataFollowFromTheArrays) {
  constexpr int D = TypeParam::D;
  Inhabitants<D> in, copy;
  for (int i = 0; i < 4; ++i) in.add(odd<D>());
  in.table.remove(1);
  copy.table.bodies = in.table.bodies, copy.table.shapes = in.table.shapes, copy.table.userForces = in.table.userForces;
  copy.table.recount();
  copy.table.index(*copy.broadphase, copy.settings.margin);
  EXPECT_EQ(copy.table.count(), 3);
  EXPECT_EQ(copy.table.hash(), in.table.hash());
  EXPECT_EQ(copy.ball(at<D>(0, 0)), in.ball(at<D>(0, 0)));
  EXPECT_EQ(copy.table.shapesOf(1)[0], in.table.shapesOf(1)[0]);
  EXPECT_EQ(copy.table.shapesOf(3).size(), 2u);
  EXPECT_EQ(copy.table.kinds(), in.table.kinds());
  copy.table.sync(false), in.table.sync(false);
  std::vector<ProxyPair> a, b;
  WorkDone work;
  copy.table.boxes.findPairs(a, work), in.table.boxes.findPairs(b, work);
  EXPECT_EQ(a, b);
  EXPECT_FALSE(a.empty());
}

}}}}}  // namespace lpc::LPC_PRECISION::test::body_table_test
