// SPDX-License-Identifier: Zlib
// Curved shapes on floors, a box and a plane: bodies that stand keep standing, bodies that lie keep lying.
#include <gtest/gtest.h>

#include <sstream>

#include "framework/shape/curved_core.h"
#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace curved_rest_test { namespace {

constexpr Real kDt = Real(1) / 60, kQuarterTurn = Real(1.57079632679489661923);

template <int D>
void addFloor(World<D>& world, bool plane) {
  BodyDef<D> def;
  def.type = BodyType::fixed;
  ShapeDef<D> shape;
  if (plane) {
    shape.shape = Shape<D>::plane();
  } else {
    Vec<D> half = Vec<D>::Constant(10);
    half[1] = 1;
    shape.shape = Shape<D>::box(half);
    def.X_WB.p[1] = -1;
  }
  def.shapes.push_back(shape);
  world.add(def);
}

// Cosine of the tilt of the body's axis, and the distance moved (m), after ten seconds.
struct Moved {
  Real cosine, way;
};
Moved restsOn(const std::string& contacts, bool plane, bool standing) {
  World<3> world(Pipeline::parse("contacts=" + contacts));
  addFloor(world, plane);
  const Real sizes[2] = {Real(0.5), Real(0.3)};
  Pose<3> X{{0, standing ? Real(0.5) : Real(0.3), 0}, {}};
  if (standing) X.q = Rot<3>::vector({0, 0, kQuarterTurn});
  BodyDef<3> def = test::body<3>(Shape<3>::curved(ShapeKind::cylinder, sizes), X.p);
  def.X_WB.q = X.q;
  const BodyHandle body = world.add(def);
  for (int i = 0; i < 600; ++i) world.step(kDt);
  const Pose<3> now = world.pose(body);
  const Vec<3> axis(1, 0, 0);
  return {(now.q * axis).dot(X.q * axis), (now.p - X.p).norm()};
}

TEST(CurvedRest, CylindersStandAndLieForTenSeconds) {
  for (const bool plane : {false, true}) {
    for (const bool standing : {true, false}) {
      const Moved moved = restsOn("query_clip", plane, standing);
      EXPECT_GE(moved.cosine, 1 - Real(1e-6)) << plane << standing;
      EXPECT_LE(moved.way, kLinearSlop) << plane << standing;
    }
  }
  // One contact point cannot support an end face: with the generator that gives one point the body falls.
  const Moved fell = restsOn("deepest_point", false, true);
  expectCaught("CurvedRest one point", fell.cosine >= 1 - Real(1e-6) && fell.way <= kLinearSlop);
}

template <int D>
void ellipsoidsRest() {
  for (const char* contacts : {"query_clip", "deepest_point"}) {
    World<D> world(Pipeline::parse(std::string("contacts=") + contacts));
    addFloor(world, true);
    std::vector<Real> sizes(static_cast<std::size_t>(D), Real(0.5));
    sizes[1] = Real(0.25);
    const BodyHandle body = world.add(test::body<D>(Shape<D>::curved(ShapeKind::ellipsoid, sizes), at<D>(0, 0.25)));
    for (int i = 0; i < 600; ++i) world.step(kDt);
    EXPECT_NEAR(world.pose(body).p[1], 0.25, kLinearSlop);
    EXPECT_NEAR(world.pose(body).p[0], 0, 1e-3);
  }
}
TEST(CurvedRest, EllipsoidsRestOnTheirFlatSide) { ellipsoidsRest<2>(), ellipsoidsRest<3>(); }

// Every generator supports planes: a box dropped on one comes to rest at its height.
template <int D>
void planeCarries() {
  for (const Registered* r : Registry::instance().list(StageKind::contacts, D)) {
    if (r->info.role != AlgorithmRole::competitor || r->info.name.starts_with("planted")) continue;
    World<D> world(Pipeline::parse("contacts=" + r->info.name));
    addFloor(world, true);
    const BodyHandle box = world.add(test::body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(3, 0.6)));
    const BodyHandle ball = world.add(test::body<D>(Shape<D>::sphere(Real(0.5)), at<D>(-3, 0.6)));
    for (int i = 0; i < 240; ++i) world.step(kDt);
    EXPECT_NEAR(world.pose(ball).p[1], 0.5, kLinearSlop) << r->info.name;
    if (r->info.name != "deepest_point") {
      EXPECT_NEAR(world.pose(box).p[1], 0.5, kLinearSlop) << r->info.name;
    }
  }
}
TEST(Plane, CarriesWithEveryGenerator) { planeCarries<2>(), planeCarries<3>(); }

template <int D>
void planeAnswers() {
  World<D> world;
  addFloor(world, true);
  Vec<D> low = Vec<D>::Zero(), high = Vec<D>::Zero();
  low[1] = -5, high[1] = 5, low[0] = high[0] = 1000;
  EXPECT_EQ(world.at(low).size(), 1u);
  EXPECT_EQ(world.at(high).size(), 0u);
  const Vec<D> one = Vec<D>::Constant(1);
  EXPECT_EQ(world.overlap({low - one, low + one}).size(), 1u);
  EXPECT_EQ(world.overlap({high - one, high + one}).size(), 0u);
  const auto hit = world.rayFirst(high, Vec<D>(-Vec<D>::Unit(1)), 100);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 5, 1e-4);
  EXPECT_FALSE(world.rayFirst(high, Vec<D>(Vec<D>::Unit(1)), 100));
  addFloor(world, true);  // two planes never make contact
  BodyDef<D> moving;
  moving.shapes.emplace_back();
  moving.shapes.back().shape = Shape<D>::plane();
  try {
    world.add(moving);
    ADD_FAILURE() << "a plane that moves";
  } catch (const UserError& e) {
    EXPECT_NE(std::string(e.what()).find("a plane on a moving body"), std::string::npos);
  }
}
TEST(Plane, AnswersPointsBoxesAndRays) { planeAnswers<2>(), planeAnswers<3>(); }

// A run saved, loaded and continued equals a run only continued, with a curved core and a plane in the world.
TEST(CurvedRest, SavedIsContinued) {
  const auto make = [] { return std::make_unique<World<3>>(Pipeline::parse("contacts=query_clip")); };
  const auto world = make(), loaded = make();
  addFloor(*world, true);
  const Real sizes[2] = {Real(0.5), Real(0.3)}, half[3] = {Real(0.5), Real(0.3), Real(0.4)};
  world->add(test::body<3>(Shape<3>::curved(ShapeKind::cylinder, sizes), at<3>(0, 1)));
  world->add(test::body<3>(Shape<3>::curved(ShapeKind::ellipsoid, half, Real(0.05)), at<3>(0.2, 2.5)));
  for (int i = 0; i < 60; ++i) world->step(kDt);
  std::stringstream file;
  world->save(file);
  loaded->load(file);
  for (int i = 0; i < 60; ++i) world->step(kDt), loaded->step(kDt);
  EXPECT_EQ(world->hash(), loaded->hash());
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::curved_rest_test
