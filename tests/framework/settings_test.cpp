// SPDX-License-Identifier: Zlib
// User settings affect everything that is made afterwards, and nothing else.
#include "framework/world/settings.h"

#include <gtest/gtest.h>

#include "framework/scene/scene_spec.h"
#include "framework/stage/registry.h"
#include "framework/world/world.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace settings_test { namespace {

using test::expectCaught;

template <int D>
bool alike(const WorldSettings<D>& a, const WorldSettings<D>& b) {
  return a.gravity == b.gravity && a.restitutionThreshold == b.restitutionThreshold && a.margin == b.margin &&
         a.model == b.model && a.mixing == b.mixing && a.sleepingContacts == b.sleepingContacts;
}
template <int D>
bool alike(const ShapeDef<D>& a, const ShapeDef<D>& b) {
  return a.density == b.density && a.friction == b.friction && a.restitution == b.restitution &&
         a.category == b.category && a.mask == b.mask && a.X_BS.p == b.X_BS.p;
}

template <int D>
void defaults() {
  const Settings s;
  const ShapeDef<D> own;
  EXPECT_TRUE(alike(s.world<D>(), WorldSettings<D>{}));
  EXPECT_TRUE(alike(s.shape<D>(own.shape), own));
  EXPECT_EQ(s.pipeline(), Pipeline{});
  EXPECT_EQ(s.dt, SceneSpec<D>{}.dt);
  EXPECT_FALSE(s.air<D>().has_value());
  Settings anew;
  anew.sleepingContacts = true;
  EXPECT_TRUE(anew.world<D>().sleepingContacts);
  EXPECT_FALSE(alike(anew.world<D>(), WorldSettings<D>{}));
  for (Settings other : {Settings::lpc2009(D), [] {
                           Settings bent;
                           bent.gravity = -9;
                           return bent;
                         }()}) {
    expectCaught("another gravity", alike(other.world<D>(), WorldSettings<D>{}));
  }
  expectCaught("another restitution", alike(Settings::lpc2009(D).shape<D>(own.shape), own));
}
TEST(Settings, DefaultsAreThoseOfWorldsAndShapes) { defaults<2>(), defaults<3>(); }

// Values of A.3.6 of the report; A.4 for the mixing of a pair's materials.
TEST(Settings, OfTheReport) {
  const Settings s = Settings::lpc2009();
  EXPECT_EQ(s.density, 1);
  EXPECT_EQ(s.restitution, Real(0.4));
  EXPECT_EQ(s.friction, Real(0.5));
  EXPECT_EQ(s.gravity, Real(-9.8));
  EXPECT_EQ(s.dt, Real(1) / 60);
  EXPECT_EQ(kLinearSlop, Real(0.005)) << "the report's penetrationEpsilon";
  EXPECT_EQ(s.restitutionThreshold, Real(0.2));
  EXPECT_EQ(s.mixing, MixRules{});
  EXPECT_FALSE(s.airResistance);
  EXPECT_EQ(s.pipeline().text(), Pipeline::parse("broadphase=region_tree contacts=rounded_polygon cache=by_feature "
                                                 "solver=split_solver{velocity=catto,position=split_impulse} "
                                                 "sleep=split_average{linear=1.5,angular=0.01,bias=0.5}")
                                     .text());
  EXPECT_EQ(Settings::lpc2009(3).pipeline()[StageKind::contacts].name, "sat_clip");
  EXPECT_EQ(Settings::named("2009").gravity, s.gravity);
  try {
    Settings::named("2008");
    FAIL();
  } catch (const UserError& e) {
    EXPECT_STREQ(e.what(), "unknown settings '2008'; did you mean '2009'? valid: 2009");
  }
}

TEST(Settings, SwitchAlgorithms) {
  Settings s = Settings::lpc2009();
  s.severalContacts = s.cacheContacts = s.sleeping = s.useRestitution = false;
  EXPECT_EQ(s.pipeline()[StageKind::contacts].name, "deepest_point");
  EXPECT_EQ(s.pipeline()[StageKind::cache].name, "none");
  EXPECT_EQ(s.pipeline()[StageKind::sleep].name, "none");
  EXPECT_FALSE(s.world<2>().model.restitution);
  s.sleeping = true, s.linearSleepSpeed = Real(0.25), s.angularSleepSpeed = Real(0.5), s.sleepBias = Real(0.75);
  EXPECT_EQ(s.pipeline()[StageKind::sleep].text(), "split_average{linear=0.25,angular=0.5,bias=0.75}");
}

template <int D>
BodyHandle addBox(World<D>& world, const Settings& s) {
  BodyDef<D> box;
  box.X_WB.p = 5 * Vec<D>::Unit(1);
  box.shapes.push_back(s.shape<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5)))));
  return world.add(box);
}

// Fall speeds after one second in a world made before a change of settings and in one made after it.
template <int D>
void afterwards() {
  Settings s;
  s.gravity = -8;
  World<D> before(s.pipeline(), s.world<D>());
  const BodyHandle light = addBox<D>(before, s);
  s.gravity = -2, s.density = 3, s.friction = Real(0.1);
  World<D> after(s.pipeline(), s.world<D>());
  const BodyHandle heavy = addBox<D>(after, s), late = addBox<D>(before, s);
  for (int i = 0; i < 64; ++i) before.step(Real(1) / 64), after.step(Real(1) / 64);
  const auto falls = [](const World<D>& world, BodyHandle body, Real speed) {
    return std::abs(world.motion(body).v[1] + speed) < Real(1e-3);
  };
  EXPECT_TRUE(falls(before, light, 8));
  EXPECT_TRUE(falls(after, heavy, 2));
  EXPECT_TRUE(falls(before, late, 8)) << "a shape does not bring its world's settings";
  expectCaught("a change that reaches a world that is there", falls(before, light, 2));
  EXPECT_EQ(before.mass(light), 1);
  EXPECT_EQ(after.mass(heavy), 3);
  EXPECT_EQ(before.mass(late), 3);
  EXPECT_EQ(before.shapes()[0].friction, Real(0.5));
  EXPECT_EQ(before.shapes()[1].friction, Real(0.1));
}
TEST(Settings, AffectOnlyLaterObjects) { afterwards<2>(), afterwards<3>(); }

// v' = -c v / m: exp(-0.5) of the speed remains after one second, within 1 % with 64 steps.
TEST(Settings, AirSlows) {
  Settings s;
  s.gravity = 0, s.airResistance = true, s.linearDrag = Real(0.5), s.quadraticDrag = 0;
  World<2> world(s.pipeline(), s.world<2>());
  world.add(s.air<2>().value());
  const BodyHandle box = addBox<2>(world, s);
  world.setMotion(box, {.v = Vec<2>(4, 0)});
  for (int i = 0; i < 64; ++i) world.step(Real(1) / 64);
  EXPECT_NEAR(world.motion(box).v[0], 4 * 0.60653, 0.02);
}

template <int D>
void rests() {
  const Settings s = Settings::lpc2009(D);
  World<D> world(s.pipeline(), s.world<D>());
  BodyDef<D> ground;
  ground.type = BodyType::fixed;
  ground.X_WB.p = -Vec<D>::Unit(1);
  Vec<D> half = Vec<D>::Constant(10);
  half[1] = 1;
  ground.shapes.push_back(s.shape<D>(Shape<D>::box(half)));
  world.add(ground);
  const BodyHandle box = addBox<D>(world, s);
  Real lowest = 5, highest = 0;  // after the first bounce
  for (int i = 0; i < 300; ++i) {
    world.step(s.dt);
    lowest = std::min(lowest, world.pose(box).p[1]);
    if (lowest < Real(0.6)) highest = std::max(highest, world.pose(box).p[1]);
  }
  EXPECT_NEAR(world.pose(box).p[1], 0.5, 0.01);
  EXPECT_NEAR(highest - Real(0.5), 4.5 * 0.4 * 0.4, 0.1) << "it bounces with 0.4 of its speed";
  EXPECT_FALSE(world.awake(box));
}
TEST(Settings, OfTheReportDropABox) { rests<2>(), rests<3>(); }

// Depth, after two seconds, of a box that starts 18 mm deep in its ground.
Real depthAfter(const Settings& s) {
  World<2> world(s.pipeline(), s.world<2>());
  world.add(BodyDef<2>::fixed(s.shape<2>(Shape<2>::box({10, 1})), {{0, -1}}));
  const BodyHandle box = addBox<2>(world, s);
  world.setPose(box, {{0, Real(0.482)}, {}});
  for (int i = 0; i < 120; ++i) world.step(s.dt);
  return Real(0.5) - world.pose(box).p[1];
}

// Each position resolver and solver with a slop parameter: smaller depths stay, larger ones are corrected.
TEST(Settings, SlopReachesEveryPositionResolver) {
  std::vector<std::string> solvers;
  for (const auto& [key, entry] : Registry::instance().all()) {
    const auto& [stage, dimension, name] = key;
    if (dimension != 2 || !Registry::instance().parameter(stage, name, "slop")) continue;
    if (stage == StageKind::position) solvers.push_back("split_solver{position=" + name + "}");
    if (stage == StageKind::solver) solvers.push_back(name);
  }
  ASSERT_GE(solvers.size(), 9u);
  for (const std::string& solver : solvers) {
    Settings keeps, pushes, planted;
    keeps.stages[StageKind::solver] = pushes.stages[StageKind::solver] = Spec::parse(solver);
    planted.stages = keeps.stages;
    keeps.slop = Real(0.02), pushes.slop = Real(0.001);
    EXPECT_NEAR(depthAfter(keeps), 0.018, 0.0025) << solver;
    EXPECT_NEAR(depthAfter(pushes), 0.001, 0.0025) << solver;
    expectCaught(solver + ": a slop that reaches nobody", std::abs(depthAfter(planted) - Real(0.018)) < Real(0.0025));
  }
  Settings s;
  s.slop = Real(0.02);
  EXPECT_EQ(s.pipeline()[StageKind::solver].find("position")->find("slop")->name, "0.02") << "of the default";
  for (const char* solver : {"soft_step", "split_solver{position=none}"}) {
    s.stages[StageKind::solver] = Spec::parse(solver);
    EXPECT_THROW(s.pipeline(), UserError) << solver;
  }
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::settings_test
