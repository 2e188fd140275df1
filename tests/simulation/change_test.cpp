// SPDX-License-Identifier: Zlib
// Bodies that are changed, merged and split after they were added; gravity and stages that change at run time.
#include <gtest/gtest.h>

#include "framework/shape/shape_between.h"
#include "framework/world/invariants.h"
#include "tests/draw.h"
#include "tests/every_solver.h"
#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace change_test { namespace {

constexpr Real kDt = Real(1) / 60;
constexpr double kRounding = sizeof(Real) == 8 ? 1e-12 : 1e-4;

template <class T>
struct ChangeTest : testing::Test {};
template <int Dim>
struct In {
  static constexpr int D = Dim;
};
using Dimensions = testing::Types<In<2>, In<3>>;
TYPED_TEST_SUITE(ChangeTest, Dimensions);

template <int D>
WorldSettings<D> weightless() {
  WorldSettings<D> s;
  s.gravity.setZero();
  return s;
}

template <int D>
BodyDef<D> drawBody(Draw& draw) {
  BodyDef<D> def;
  def.X_WB = drawPose<D>(draw, 3);
  def.velocity = drawPose<D>(draw, 2).p;
  def.angularVelocity = Ang<D>::Constant(draw.real(-2, 2));
  def.pinned = draw.below(4) == 0, def.rotatable = draw.below(4) != 0;
  def.gravityScale = draw.real(-1, 2);
  def.userData = static_cast<std::uint64_t>(draw.below(100));
  if (draw.below(6) == 0) def.type = draw.below(2) ? BodyType::fixed : BodyType::kinematic;
  for (int n = 1 + draw.below(3); n > 0; --n) {
    ShapeDef<D> s{.shape = draw.below(2) ? Shape<D>::box(Vec<D>::Constant(Real(0.3)), 0) : Shape<D>::sphere(Real(0.4)),
                  .X_BS = drawPose<D>(draw, 1),
                  .density = draw.real(0.5, 3)};
    s.friction = draw.real(0, 1), s.restitution = draw.real(0, 1);
    s.mask = draw.below(3) ? ~0u : 2u;
    def.shapes.push_back(s);
  }
  if (draw.below(3) == 0) {
    def.mass = MassProperties<D>{.mass = 2, .center = drawPose<D>(draw, 1).p};
    def.mass->inertia.setIdentity();
  }
  return def;
}

template <int D>
using Change = std::function<void(World<D>&, BodyHandle, const BodyDef<D>&)>;

// A changed body behaves as if it had been added in its new form.
template <int D>
void isAsIfAddedSo(Draw& draw, const Change<D>& change) {
  World<D> changed, added;
  const BodyDef<D> first = drawBody<D>(draw), then = drawBody<D>(draw);
  for (World<D>* w : {&changed, &added}) addHeap<D>(*w, 3, 1);
  const BodyHandle body = changed.add(first);
  added.add(then);
  change(changed, body, then);
  for (int i = 0; i < 20; ++i) changed.step(kDt), added.step(kDt);
  RC_ASSERT(changed.hash() == added.hash());
  const auto i = static_cast<std::size_t>(body.slot);
  RC_ASSERT(changed.bodies().mass[i] == added.bodies().mass[i]);
  RC_ASSERT(changed.bodies().userData[i] == added.bodies().userData[i]);
}

TYPED_TEST(ChangeTest, AChangedBodyEqualsOneAddedInThatForm) {
  constexpr int D = TypeParam::D;
  const Change<D> right = [](World<D>& w, BodyHandle b, const BodyDef<D>& def) { w.change(b, def); };
  check("a changed body lives as if it had been added so", [&] {
    RapidCheckDraw draw;
    isAsIfAddedSo<D>(draw, right);
  });
  const Change<D> keepsItsWeight = [](World<D>& w, BodyHandle b, BodyDef<D> def) {
    const auto i = static_cast<std::size_t>(b.slot);
    const MassProperties<D> was{.mass = w.bodies().mass[i], .center = w.bodies().center[i]};
    if (was.mass > 0) def.mass = was;
    w.change(b, def);
  };
  expectFalsified("a changed body that keeps its weight", [&] {
    RapidCheckDraw draw;
    isAsIfAddedSo<D>(draw, keepsItsWeight);
  });
  const Change<D> forgetsGravity = [](World<D>& w, BodyHandle b, BodyDef<D> def) {
    def.gravityScale = w.definition(b).gravityScale;
    w.change(b, def);
  };
  expectFalsified("a changed body that keeps its share of gravity", [&] {
    RapidCheckDraw draw;
    isAsIfAddedSo<D>(draw, forgetsGravity);
  });
}

template <int D>
struct Ends final : ContactListener<D> {
  int begins = 0, ends = 0;
  bool begin(const World<D>&, const Manifold<D>&) override { return ++begins, true; }
  void end(const World<D>&, const Manifold<D>&) override { ++ends; }
};

// A body with two feet on the ground and a joint: when one foot goes, the contact of the other and the joint stay.
template <int D>
bool keepsWhatIsLeft(const Change<D>& change) {
  World<D> world;
  addGround(world);
  BodyDef<D> def;
  def.X_WB.p = at<D>(0, 0.5);
  for (const double x : {-1, 1}) def.shapes.push_back({.shape = Shape<D>::sphere(Real(0.5)), .X_BS = {at<D>(x, 0)}});
  const BodyHandle body = world.add(def), load = world.add(test::body<D>(Shape<D>::sphere(Real(0.2)), at<D>(0, 3)));
  world.add(pivot<D>(body, load, at<D>(0, 2)));
  Ends<D> heard;
  world.addListener(body, &heard);
  for (int i = 0; i < 10; ++i) world.step(kDt);
  const Real before = stateInvariants(world).jointError;
  BodyDef<D> less = world.definition(body);
  less.shapes.pop_back();
  change(world, body, less);
  const bool same = world.valid(body) && stateInvariants(world).jointError <= before + kRounding;
  world.step(kDt);
  return same && heard.begins == 2 && heard.ends == 1 && world.manifolds().size() == 1;
}

TYPED_TEST(ChangeTest, AShapeGoesAndTheRestStays) {
  constexpr int D = TypeParam::D;
  EXPECT_TRUE(keepsWhatIsLeft<D>([](World<D>& w, BodyHandle b, const BodyDef<D>& def) { w.change(b, def); }));
  expectCaught("a body is changed by removing it and adding another",
               keepsWhatIsLeft<D>([](World<D>& w, BodyHandle b, const BodyDef<D>& def) { w.remove(b), w.add(def); }));
}

TYPED_TEST(ChangeTest, AnUnchangedDefinitionOnlyWakes) {
  constexpr int D = TypeParam::D;
  World<D> changed, woken;
  for (World<D>* w : {&changed, &woken}) {
    addHeap<D>(*w, 6, 2);
    for (int i = 0; i < 60; ++i) w->step(kDt);
  }
  for (std::int32_t i = 0; i < changed.bodies().size(); ++i) {
    changed.change(changed.handle(i), changed.definition(changed.handle(i)));
    woken.wake(woken.handle(i));
  }
  for (int i = 0; i < 60; ++i) changed.step(kDt), woken.step(kDt);
  EXPECT_EQ(changed.hash(), woken.hash());
}

// A new centre of mass keeps the rigid motion, before any force acts.
TYPED_TEST(ChangeTest, ANewCentreKeepsTheMotion) {
  constexpr int D = TypeParam::D;
  World<D> world({}, weightless<D>());
  BodyDef<D> def = body<D>(Shape<D>::sphere(1), at<D>(2, 1));
  def.velocity = at<D>(1, 2), def.angularVelocity = Ang<D>::Constant(3);
  const BodyHandle b = world.add(def);
  const Vec<D> place = at<D>(5, 1), was = def.velocity + cross(def.angularVelocity, Vec<D>(place - def.X_WB.p));
  def = world.definition(b);
  def.shapes.push_back({.shape = Shape<D>::sphere(1), .X_BS = {at<D>(6, 0)}});
  world.change(b, def);
  EXPECT_NEAR((world.bodies().pose[0].p - place).norm(), 0, kRounding);  // halfway between the two spheres
  EXPECT_NEAR((world.motion(b).v - was).norm(), 0, kRounding);
  EXPECT_NEAR((world.pose(b).p - at<D>(2, 1)).norm(), 0, kRounding);
}

template <int D>
using Merge = std::function<void(World<D>&, BodyHandle, BodyHandle)>;

template <int D>
void keepsMomenta(Draw& draw, const Merge<D>& merge) {
  World<D> world({}, weightless<D>());
  std::array<BodyHandle, 2> bodies;
  for (BodyHandle& b : bodies) {
    BodyDef<D> def = drawBody<D>(draw);
    def.type = BodyType::dynamic, def.pinned = false, def.rotatable = true;
    b = world.add(def);
  }
  const StateInvariants<D> before = stateInvariants(world);
  const std::size_t shapes = world.definition(bodies[0]).shapes.size() + world.definition(bodies[1]).shapes.size();
  merge(world, bodies[0], bodies[1]);
  const StateInvariants<D> after = stateInvariants(world);
  RC_ASSERT((after.momentum - before.momentum).norm() <= 100 * kRounding);
  RC_ASSERT((after.angularMomentum - before.angularMomentum).norm() <= 1000 * kRounding);
  RC_ASSERT(after.kinetic <= before.kinetic + 1000 * kRounding);  // as in any inelastic impact
  RC_ASSERT(world.bodyCount() == 1);
  RC_ASSERT(world.definition(bodies[0]).shapes.size() == shapes);
}

TYPED_TEST(ChangeTest, MergedKeepsMomenta) {
  constexpr int D = TypeParam::D;
  check("two bodies that are merged keep both momenta", [] {
    RapidCheckDraw draw;
    keepsMomenta<D>(draw, [](World<D>& w, BodyHandle a, BodyHandle b) { w.merge(a, b); });
  });
  expectFalsified("merged bodies that go on as the first did", [] {
    RapidCheckDraw draw;
    keepsMomenta<D>(draw, [](World<D>& w, BodyHandle a, BodyHandle b) {
      const BodyDef<D> first = w.definition(a);
      w.merge(a, b);
      w.setMotion(a, {first.velocity, first.angularVelocity});
    });
  });
}

TYPED_TEST(ChangeTest, SplitPartsKeepMoving) {
  constexpr int D = TypeParam::D;
  World<D> world({}, weightless<D>());
  BodyDef<D> def;
  def.X_WB.p = at<D>(1, 2);
  def.velocity = at<D>(1, -1), def.angularVelocity = Ang<D>::Constant(2), def.rotatable = true;
  for (const double x : {-1, 0, 2}) {
    def.shapes.push_back({.shape = Shape<D>::sphere(Real(0.4)), .X_BS = {at<D>(x, 0)}, .density = Real(1 + x * x)});
  }
  const BodyHandle whole = world.add(def);
  const StateInvariants<D> before = stateInvariants(world);
  const std::vector<BodyHandle> parts = world.splitByShape(whole);
  const StateInvariants<D> after = stateInvariants(world);
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_EQ(parts[0], whole);
  EXPECT_EQ(world.bodyCount(), 3);
  EXPECT_NEAR((after.momentum - before.momentum).norm(), 0, 100 * kRounding);
  EXPECT_NEAR((after.angularMomentum - before.angularMomentum).norm(), 0, 1000 * kRounding);
  EXPECT_NEAR(after.kinetic, before.kinetic, 1000 * kRounding);
  world.merge(parts[0], parts[1]), world.merge(parts[0], parts[2]);
  EXPECT_NEAR(stateInvariants(world).kinetic, before.kinetic, 1000 * kRounding);
}

// A joint keeps its zero angle and its anchors when its body is merged or split.
TYPED_TEST(ChangeTest, JointsFollow) {
  constexpr int D = TypeParam::D;
  World<D> world;
  const BodyHandle a = world.add(body<D>(Shape<D>::sphere(Real(0.4)), at<D>(0, 0)));
  const BodyHandle b = world.add(body<D>(Shape<D>::sphere(Real(0.4)), at<D>(2, 0)));
  world.add(JointDef<D>{.kind = "hinge{lower=-0.4,upper=0.4}", .bodyB = b, .X_WJ = {at<D>(3, 0), {}}});
  world.add(pivot<D>(a, b, at<D>(1, 0)));
  for (int i = 0; i < 20; ++i) world.step(kDt);
  const double before = stateInvariants(world).jointError;
  world.merge(a, b);
  EXPECT_EQ(std::count_if(world.joints().begin(), world.joints().end(), [](const auto& j) { return j.active(); }), 1);
  EXPECT_NEAR(stateInvariants(world).jointError, before, 100 * kRounding + before);
  for (int i = 0; i < 300; ++i) world.step(kDt);
  EXPECT_LT(stateInvariants(world).jointError, 0.01);
  const Rot<D> q = world.pose(a).q;
  EXPECT_LT(double(turnOf(q).norm()), 0.5);  // limits count from the angle at which the joint was made
}

// A new material also applies to existing contacts, whatever the cache keeps.
TYPED_TEST(ChangeTest, ANewMaterialAppliesToExistingContacts) {
  constexpr int D = TypeParam::D;
  for (const Registered* cache : Registry::instance().list(StageKind::cache, D)) {
    if (!competes(*cache)) continue;
    World<D> world(Pipeline::parse("cache=" + cache->info.name));
    addGround(world);
    const BodyHandle box = world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0.5)));
    for (int i = 0; i < 30; ++i) world.step(kDt);
    BodyDef<D> def = world.definition(box);
    def.shapes[0].friction = 0, def.velocity = at<D>(3, 0);
    world.change(box, def);
    for (int i = 0; i < 30; ++i) world.step(kDt);
    EXPECT_NEAR(world.motion(box).v[0], 3, 1e-5) << cache->info.name;
  }
}

TYPED_TEST(ChangeTest, ABodyMadeStaticLosesStaticContacts) {
  constexpr int D = TypeParam::D;
  World<D> world;
  addGround(world);
  const BodyHandle box = world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0.5)));
  Ends<D> heard;
  world.addListener(&heard);
  for (int i = 0; i < 10; ++i) world.step(kDt);
  BodyDef<D> def = world.definition(box);
  def.type = BodyType::fixed;
  world.change(box, def);
  world.step(kDt);
  EXPECT_TRUE(world.manifolds().empty());
  EXPECT_EQ(heard.ends, 1);
}

TYPED_TEST(ChangeTest, AMouseJointUsesTheChangedMass) {
  constexpr int D = TypeParam::D;
  std::array<Real, 2> reached{};
  for (const bool later : {false, true}) {
    World<D> world({}, weightless<D>());
    BodyDef<D> light = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, 0)), heavy = light;
    heavy.shapes[0].density = 100;
    const BodyHandle ball = world.add(later ? light : heavy);
    world.add(JointDef<D>{.kind = "mouse{hertz=2,max_force=1e9}",
                          .bodyB = ball,
                          .X_WJ = {at<D>(1, 0), {}},
                          .X_WJb = Pose<D>{at<D>(0, 0), {}}});
    if (later) world.change(ball, heavy);
    for (int i = 0; i < 30; ++i) world.step(kDt);
    reached[later] = world.pose(ball).p[0];
  }
  EXPECT_NEAR(reached[0], reached[1], 1e-4);
}

TYPED_TEST(ChangeTest, AForceOnAMergedBodyMovesTheWhole) {
  constexpr int D = TypeParam::D;
  World<D> world({}, weightless<D>());
  const BodyHandle a = world.add(body<D>(Shape<D>::sphere(Real(0.4)), at<D>(0, 0)));
  const BodyHandle b = world.add(body<D>(Shape<D>::sphere(Real(0.4)), at<D>(2, 0)));
  world.applyForce(b, at<D>(0, 60), world.pose(b).p);
  world.merge(a, b);
  world.step(kDt);
  EXPECT_NEAR(world.motion(a).v[1], 60 * kDt / world.mass(a), 1e-4);
  EXPECT_GT(world.motion(a).w[D == 3 ? 2 : 0], 0);  // at its right half
}

// The rolling resistance of a ball depends on its own load, not on what other bodies load onto the floor.
TYPED_TEST(ChangeTest, RollingResistanceUsesTheBallsOwnLoad) {
  constexpr int D = TypeParam::D;
  std::array<Real, 2> speed{};
  for (const int others : {0, 60}) {
    World<D> world;
    const BodyHandle ground = addGround(world);
    BodyDef<D> wide = world.definition(ground);
    wide.shapes[0].shape = Shape<D>::box(D == 2 ? at<D>(500, 1) : at<D>(500, 1, 5));
    world.change(ground, wide);
    const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0, 0.5)));
    for (int i = 0; i < others; ++i) world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(50 + 2 * i, 0.5)));
    world.add(ForceDef<D>{.kind = "rolling_resistance{coefficient=0.02}"});
    Ang<D> spin = Ang<D>::Zero();
    spin[kAngDim<D> - 1] = -4;
    world.setMotion(ball, {at<D>(2, 0), spin});
    for (int i = 0; i < 120; ++i) world.step(kDt);
    speed[others > 0] = world.motion(ball).v[0];
  }
  EXPECT_LT(speed[0], 1.8);
  EXPECT_NEAR(speed[0], speed[1], 1e-3);
}

// A spring keeps its attachment point when its body is merged or its centre of mass moves.
TYPED_TEST(ChangeTest, ForcesFollow) {
  constexpr int D = TypeParam::D;
  World<D> world({}, weightless<D>());
  const BodyHandle a = world.add(body<D>(Shape<D>::sphere(Real(0.4)), at<D>(0, 0)));
  const BodyHandle b = world.add(body<D>(Shape<D>::sphere(Real(0.4)), at<D>(2, 0)));
  world.add(ForceDef<D>{.kind = "spring{stiffness=10}", .bodyB = b, .anchorA = at<D>(2, 3), .anchorB = at<D>(0, 1)});
  world.add(ForceDef<D>{.kind = "spring{stiffness=10}", .bodyA = a, .bodyB = b});
  world.merge(a, b);
  EXPECT_EQ(std::count_if(world.forces().begin(), world.forces().end(), [](const auto& f) { return f.kind; }), 1);
  world.step(kDt);  // 2 m of extension upwards at (2, 1): force and torque about (1, 0)
  EXPECT_NEAR(world.motion(a).v[1], 20 * kDt / world.mass(a), 1e-5);
  EXPECT_NEAR(world.motion(a).v[0], 0, 1e-6);
  EXPECT_GT(world.motion(a).w[D == 3 ? 2 : 0], 0);
}

TYPED_TEST(ChangeTest, InvalidChangesAreRefusedAndChangeNothing) {
  constexpr int D = TypeParam::D;
  World<D> world;
  const BodyHandle a = world.add(body<D>(Shape<D>::sphere(1), at<D>(0, 0)));
  const BodyHandle post = world.add(body<D>(Shape<D>::sphere(1), at<D>(5, 0), BodyType::fixed));
  world.add(pivot<D>(post, a, at<D>(3, 0)));
  const std::string before = saved(world);
  const auto refused = [&](const auto& act) {
    EXPECT_THROW(act(), UserError);
    EXPECT_EQ(saved(world), before);
  };
  const auto with = [&](const auto& edit) {
    BodyDef<D> def = world.definition(a);
    edit(def);
    refused([&] { world.change(a, def); });
  };
  with([](BodyDef<D>& d) { d.shapes.clear(); });
  with([](BodyDef<D>& d) { d.shapes[0].shape = Shape<D>::plane(); });
  with([](BodyDef<D>& d) { d.type = BodyType::fixed; });  // its joint would connect two immovable bodies
  with([](BodyDef<D>& d) { d.gravityScale = std::numeric_limits<Real>::quiet_NaN(); });
  with([](BodyDef<D>& d) { d.mass = MassProperties<D>{.mass = -1}; });
  with([](BodyDef<D>& d) {
    d.mass = MassProperties<D>{.mass = 1};
    d.mass->inertia.setConstant(-1);
  });
  refused([&] { world.merge(a, a); });
  refused([&] { world.merge(a, post); });
  refused([&] { world.setPipeline(Pipeline::parse("contacts=rounded_polgon")); });
  refused([&] { world.setGravity(Vec<D>::Constant(std::numeric_limits<Real>::infinity())); });
}

TYPED_TEST(ChangeTest, GravityOfABodyAndOfTheWorld) {
  constexpr int D = TypeParam::D;
  World<D> world;
  std::vector<BodyHandle> bodies;
  for (const double scale : {1., 0., -1., 0.5}) {
    BodyDef<D> def = body<D>(Shape<D>::sphere(Real(0.1)), at<D>(10 * scale, 0));
    def.gravityScale = static_cast<Real>(scale);
    bodies.push_back(world.add(def));
  }
  world.step(kDt);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(world.motion(bodies[i]).v[1], -9.81 * (std::array{1., 0., -1., 0.5})[i] * double(kDt), 1e-5);
  }
  world.setGravity(at<D>(3, 0));
  const Real before = world.motion(bodies[0]).v[0];
  world.step(kDt);
  EXPECT_NEAR(world.motion(bodies[0]).v[0] - before, 3 * double(kDt), 1e-5);
}

TYPED_TEST(ChangeTest, MassSetByTheUserIsUsed) {
  constexpr int D = TypeParam::D;
  World<D> world({}, weightless<D>());
  BodyDef<D> def = body<D>(Shape<D>::sphere(1), at<D>(0, 0));
  def.mass = MassProperties<D>{.mass = 4, .center = at<D>(1, 0)};
  def.mass->inertia.setIdentity();
  const BodyHandle b = world.add(def);
  BodyDef<D> bare;  // a point mass
  bare.X_WB.p = at<D>(9, 0), bare.mass = MassProperties<D>{.mass = 2};
  const BodyHandle p = world.add(bare);
  EXPECT_EQ(world.mass(b), 4);
  world.applyImpulse(b, at<D>(0, 8), at<D>(1, 0));  // at the centre of mass: no rotation
  world.applyImpulse(p, at<D>(0, 8), at<D>(0, 0));
  EXPECT_EQ(world.motion(b).v, at<D>(0, 2));
  EXPECT_EQ(world.motion(b).w.norm(), 0);
  EXPECT_EQ(world.motion(p).v, at<D>(0, 4));
  EXPECT_EQ(world.motion(p).w.norm(), 0);
  world.applyImpulse(b, at<D>(0, 4), at<D>(2, 0));
  EXPECT_NEAR(world.motion(b).w[D == 3 ? 2 : 0], 4, kRounding);
  world.step(kDt);
  EXPECT_TRUE(world.definition(b).mass);
  EXPECT_THROW(world.add(BodyDef<D>{}), UserError);  // dynamic, but without shapes or mass
  EXPECT_NO_THROW(world.add(BodyDef<D>{.type = BodyType::fixed}));
}

TYPED_TEST(ChangeTest, ImpulsesMoveDynamicBodies) {
  constexpr int D = TypeParam::D;
  World<D> world({}, weightless<D>());
  BodyDef<D> def = body<D>(Shape<D>::sphere(1), at<D>(0, 0));
  def.pinned = true;
  const BodyHandle pinned = world.add(def);
  def.pinned = false, def.rotatable = false, def.X_WB.p = at<D>(9, 0);
  const BodyHandle stiff = world.add(def);
  const BodyHandle wall = world.add(ShapeDef<D>{.shape = Shape<D>::sphere(1), .X_BS = {at<D>(20, 0)}});
  EXPECT_EQ(world.bodies().type[static_cast<std::size_t>(wall.slot)], BodyType::fixed);
  for (const BodyHandle h : {pinned, stiff, wall}) {
    world.applyImpulse(h, at<D>(1, 1), world.pose(h).p + at<D>(1, 0));
    world.applyAngularImpulse(h, Ang<D>::Constant(1));
  }
  EXPECT_EQ(world.motion(pinned).v.norm(), 0);
  EXPECT_GT(world.motion(pinned).w.norm(), 0);
  EXPECT_GT(world.motion(stiff).v.norm(), 0);
  EXPECT_EQ(world.motion(stiff).w.norm(), 0);
  EXPECT_EQ(world.motion(wall).v.norm() + world.motion(wall).w.norm(), 0);
}

// Replaces the method of each stage by every algorithm while the world runs.
TYPED_TEST(ChangeTest, StagesAreExchangedAtRunTime) {
  constexpr int D = TypeParam::D;
  for (const StageKind kind : kWorldStages) {
    for (const Registered* r : Registry::instance().list(kind, D)) {
      if (!competes(*r)) continue;
      World<D> world(Pipeline::parse("sleep=split_average"));
      addHeap<D>(world, 4, 3);
      for (int i = 0; i < 30; ++i) world.step(kDt);
      Pipeline other = world.pipeline();
      other[kind] = Spec::parse(r->info.name);
      try {
        world.setPipeline(other);
      } catch (const UserError&) {
        continue;  // it does not support these shapes
      }
      for (int i = 0; i < 60; ++i) world.step(kDt);
      EXPECT_EQ(world.pipeline()[kind].name, r->info.name);
      const StateInvariants<D> state = stateInvariants(world);
      EXPECT_TRUE(state.finite && state.maxSpeed < 30) << stageName(kind) << " " << r->info.name;
    }
  }
}

TYPED_TEST(ChangeTest, TheSameStagesAgainChangeNothing) {
  constexpr int D = TypeParam::D;
  World<D> exchanged, left;
  for (World<D>* w : {&exchanged, &left}) {
    addHeap<D>(*w, 5, 4);
    for (int i = 0; i < 60; ++i) w->step(kDt);
  }
  exchanged.setPipeline(exchanged.pipeline()), left.wakeAll();
  for (int i = 0; i < 60; ++i) exchanged.step(kDt), left.step(kDt);
  EXPECT_EQ(exchanged.hash(), left.hash());
}

TYPED_TEST(ChangeTest, QueriesOfOneBody) {
  constexpr int D = TypeParam::D;
  World<D> world;
  const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(1), at<D>(3, 0)));
  EXPECT_TRUE(world.contains(ball, at<D>(3.5, 0.5)));
  EXPECT_FALSE(world.contains(ball, at<D>(3.9, 0.9)));
  EXPECT_TRUE(world.intersects(ball, {at<D>(3.6, 0.6, -1), at<D>(5, 5, 1)}));
  EXPECT_FALSE(world.intersects(ball, {at<D>(3.8, 0.8, -1), at<D>(5, 5, 1)}));
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::change_test
