// SPDX-License-Identifier: Zlib
#include "framework/world/body_queries.h"

#include "framework/shape/support_map.h"
#include "framework/stage/registry.h"
#include "tests/check_property.h"
#include "tests/generators.h"
#include "tests/world_parts.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace body_queries_test { namespace {

/// The gap that counts as contact in a cast, relative to the size (TimeOfImpactAnswer), with a factor for the sizes
/// here.
constexpr double kTouch = sizeof(Real) == 8 ? 2e-8 : 2e-3;
constexpr Real kInf = std::numeric_limits<Real>::infinity();

template <class T>
struct BodyQueriesTest : testing::Test {};
TYPED_TEST_SUITE(BodyQueriesTest, BothDimensions);

// A ball at the origin, and a body of two balls at x = 4 and x = 8, the second of category 2.
template <int D>
struct Gallery : Inhabitants<D> {
  BodyQueries<D> queries{this->table};
  BodyHandle one, two;
  Gallery() {
    one = this->handle(this->ball(at<D>(0, 0)));
    BodyDef<D> def = body<D>(Shape<D>::sphere(1), at<D>(4, 0));
    def.shapes.push_back({.shape = Shape<D>::sphere(1), .X_BS = {at<D>(4, 0), {}}});
    def.shapes[1].category = 2, def.shapes[1].userData = 7;
    two = this->handle(this->add(def));
    this->table.sync(false);
  }
};

TYPED_TEST(BodyQueriesTest, PointsAndBoxesMeetExactShapesOncePerBody) {
  constexpr int D = TypeParam::D;
  Gallery<D> g;
  EXPECT_EQ(g.queries.at(at<D>(0.5, 0.5)), std::vector<BodyHandle>{g.one});
  EXPECT_TRUE(g.queries.at(at<D>(0.9, 0.9)).empty());  // inside its bounding box only
  EXPECT_EQ(g.queries.at(at<D>(8, 0)), std::vector<BodyHandle>{g.two});
  const auto boxed = [&](double x, double y) { return Aabb<D>{at<D>(x, -0.1, -0.1), at<D>(y, 0.1, 0.1)}; };
  EXPECT_EQ(g.queries.overlap(boxed(0, 9)), (std::vector<BodyHandle>{g.one, g.two}));
  EXPECT_TRUE(g.queries.overlap(boxed(1.5, 2.5)).empty());
  EXPECT_TRUE(g.queries.contains(1, at<D>(8, 0)));
  EXPECT_FALSE(g.queries.contains(1, at<D>(6, 0)));
  EXPECT_TRUE(g.queries.intersects(1, boxed(6, 7.5)));
  EXPECT_FALSE(g.queries.intersects(1, boxed(0, 2)));
}

TYPED_TEST(BodyQueriesTest, ARayMeetsShapesInTheOrderOfTheirEntries) {
  constexpr int D = TypeParam::D;
  Gallery<D> g;
  const auto hits = g.queries.rayAll(at<D>(10, 0), at<D>(-1, 0), 100);
  ASSERT_EQ(hits.size(), 3u);
  EXPECT_EQ(hits[0].body, g.two);
  EXPECT_EQ(hits[0].shape, 1);
  EXPECT_EQ(hits[0].userData, 7u);
  EXPECT_NEAR(hits[0].t, 1, 1e-6);
  EXPECT_NEAR(hits[0].normal[0], 1, 1e-6);
  EXPECT_NEAR(hits[1].t, 5, 1e-6);
  EXPECT_EQ(hits[2].body, g.one);
  const auto first = g.queries.rayFirst(at<D>(10, 0), at<D>(-1, 0), 100);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->t, hits[0].t);
  EXPECT_FALSE(g.queries.rayFirst(at<D>(10, 0), at<D>(1, 0), 100));
  EXPECT_EQ(g.queries.rayAll(at<D>(10, 0), at<D>(-1, 0), 4).size(), 1u);
  QueryFilter<D> filter{.mask = 1};
  EXPECT_EQ(g.queries.rayAll(at<D>(10, 0), at<D>(-1, 0), 100, filter).size(), 2u);
  filter.accepts = [&](BodyHandle body, const ShapeRecord<D>&) { return body != g.two; };
  EXPECT_EQ(g.queries.rayAll(at<D>(10, 0), at<D>(-1, 0), 100, filter).size(), 1u);
  EXPECT_NE(refusalOf([&] { g.queries.rayAll(at<D>(0, 0), at<D>(1, 0), -1); }), "");
  EXPECT_NE(refusalOf([&] { g.queries.rayAll(at<D>(0, 0), at<D>(std::nan(""), 0), 1); }), "");
}

// --- moved shapes and closest points --------------------------------------------------------------------------------

template <int D>
Pose<D> turnedAt(const Vec<D>& p, Real angle) {
  if constexpr (D == 2) {
    return {p, Rot<2>::angle(angle)};
  } else {
    return {p, Rot<3>::vector(Vec<3>(0, 0, angle))};
  }
}

// A square of half extent 1 that moves towards +x with its corner first meets a wall, a ball and the plane.
TYPED_TEST(BodyQueriesTest, ACastHitsWhereClosedFormsSay) {
  constexpr int D = TypeParam::D;
  World<D> world;
  const BodyHandle wall = world.add(ShapeDef<D>{.shape = Shape<D>::box(at<D>(0.5, 3, 3)), .X_BS = {at<D>(10, 0), {}}});
  const double corner = std::sqrt(2.0);
  const auto square = Shape<D>::box(at<D>(1, 1, 1));
  const auto hit = world.castFirst(square, turnedAt<D>(at<D>(0, 0), Real(0.25 * M_PI)), at<D>(20, 0));
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->body, wall);
  EXPECT_NEAR(hit->t, (9.5 - corner) / 20, kTouch);
  EXPECT_LE((hit->normal - at<D>(-1, 0)).norm(), kTouch);
  EXPECT_NEAR(hit->point[0], 9.5, kTouch);
  EXPECT_NEAR(hit->point[1], 0, kTouch);
  EXPECT_FALSE(world.castFirst(square, {}, at<D>(8, 0))) << "ends before the wall";
  EXPECT_FALSE(world.castFirst(square, {at<D>(0, 4.01), {}}, at<D>(20, 0))) << "passes above";
  const auto touching = world.castFirst(square, {at<D>(9, 0), {}}, at<D>(-1, 0));
  ASSERT_TRUE(touching);
  EXPECT_EQ(touching->t, 0);
  // A ball of radius 1 against a ball of radius 2, 1.8 m off its path: the centres are 3 m apart, 2.4 m along x.
  const BodyHandle ball = world.add(ShapeDef<D>{.shape = Shape<D>::sphere(2), .X_BS = {at<D>(5, 1.8), {}}});
  const auto round = world.castFirst(Shape<D>::sphere(1), {}, at<D>(8, 0));
  ASSERT_TRUE(round);
  EXPECT_EQ(round->body, ball);
  EXPECT_NEAR(round->t, 2.6 / 8, kTouch);
  EXPECT_LE((round->normal - at<D>(-0.8, -0.6)).norm(), kTouch);
  EXPECT_LE((round->point - at<D>(3.4, 0.6)).norm(), kTouch);
  const BodyHandle ground = world.add(ShapeDef<D>{.shape = Shape<D>::plane(), .X_BS = {at<D>(0, -5), {}}});
  const auto down = world.castFirst(square, turnedAt<D>(at<D>(0, 0), Real(0.25 * M_PI)), at<D>(0, -8));
  ASSERT_TRUE(down);
  EXPECT_EQ(down->body, ground);
  EXPECT_NEAR(down->t, (5 - corner) / 8, kTouch);
  EXPECT_LE((down->normal - at<D>(0, 1)).norm(), kTouch);
  EXPECT_NE(refusalOf([&] { world.castFirst(Shape<D>::plane(), {}, at<D>(1, 0)); }), "");
  EXPECT_NE(refusalOf([&] { world.castFirst(square, {}, at<D>(std::nan(""), 0)); }), "");
}

TYPED_TEST(BodyQueriesTest, ClosestBodyAndOverlapByShape) {
  constexpr int D = TypeParam::D;
  Gallery<D> g;
  const auto near = g.queries.closest(at<D>(6, 0.75), kInf);
  ASSERT_TRUE(near);
  EXPECT_EQ(near->body, g.two);
  EXPECT_NEAR(near->distance, std::hypot(2, 0.75) - 1, 8 * kEps);
  EXPECT_EQ(near->shape, 0) << "both balls are equally far: the first";
  const auto other = g.queries.closest(at<D>(6, 0.75), kInf, QueryFilter<D>{.mask = 2});
  ASSERT_TRUE(other);
  EXPECT_EQ(other->shape, 1);
  EXPECT_EQ(other->userData, 7u);
  EXPECT_LE((other->point - (at<D>(8, 0) + at<D>(-2, 0.75) / Real(std::hypot(2, 0.75)))).norm(), 16 * kEps);
  EXPECT_FALSE(g.queries.closest(at<D>(6, 0.75), Real(1.1)));
  EXPECT_EQ(g.queries.closest(at<D>(0.5, 0), 1)->distance, 0);
  EXPECT_NE(refusalOf([&] { g.queries.closest(at<D>(0, 0), -1); }), "");
  const auto probe = Shape<D>::box(at<D>(0.5, 0.5, 0.5));
  // The box's corner (edge in 3D) is at sqrt(1/2) from its centre.
  const Real angle = Real(0.25 * M_PI), reach = std::sqrt(Real(0.5));
  EXPECT_EQ(g.queries.overlap(probe, turnedAt<D>(at<D>(double(1 + reach) - 1e-3, 0), angle)),
            std::vector<BodyHandle>{g.one});
  EXPECT_TRUE(g.queries.overlap(probe, turnedAt<D>(at<D>(double(1 + reach) + 1e-3, 0), angle)).empty());
  EXPECT_EQ(g.queries.overlap(Shape<D>::sphere(4), {at<D>(2, 0), {}}), (std::vector<BodyHandle>{g.one, g.two}));
  EXPECT_NE(refusalOf([&] { g.queries.overlap(Shape<D>::plane(), Pose<D>{}); }), "");
}

// Random shapes: at the hit the shapes touch, and the plane through the point across the normal separates them.
// Support functions check it. A hit is missed only where the shapes stay apart.
template <int D, class Cast>
void castsTouch(Cast cast) {
  const Shape<D> a = *shapes<D>(), b = *shapes<D>();
  if (a.kind() == ShapeKind::plane || b.kind() == ShapeKind::plane) return;
  const Real size = sizeOf(a) + sizeOf(b);
  const Pose<D> X_WB = *poses<D>(sizeof(Real) == 8 ? Real(3) : 3 * size);
  Pose<D> X_WA = *poses<D>(1);
  RapidCheckDraw draw;
  X_WA.p = X_WB.p + size * (2 * drawDirection<D>(draw) + drawVector<D>(draw));
  const Vec<D> aim = X_WB.p + size * draw.pick({Real(0), Real(0.3), Real(0.8)}) * drawVector<D>(draw);
  const Vec<D> displacement = 2 * (aim - X_WA.p);
  World<D> world;
  world.add(ShapeDef<D>{.shape = b, .X_BS = X_WB});
  const auto overlapsAt = [&](Real t) {
    return !world.overlap(a, Pose<D>{Vec<D>(X_WA.p + t * displacement), X_WA.q}).empty();
  };
  if (overlapsAt(0)) return;
  const auto hit = cast(world, a, X_WA, displacement);
  if (!hit) {
    for (const Real t : {Real(0.2), Real(0.4), Real(0.5), Real(0.6), Real(0.8), Real(1)}) RC_ASSERT(!overlapsAt(t));
    return;
  }
  for (const Real part : {Real(0.3), Real(0.6), Real(0.9)}) RC_ASSERT(!overlapsAt(part * hit->t));
  RC_ASSERT(std::abs(hit->normal.norm() - 1) <= 16 * kEps);
  const auto beyond = [&](const Shape<D>& s, const Pose<D>& X, const Vec<D>& n) {
    return X.p.dot(n) + supportValue(s.view(), Vec<D>(X.q.inverse() * n)) - hit->point.dot(n);
  };
  const Real error = Real(sizeof(Real) == 8 ? 1e-6 : 1e-3) * size;
  const Real behind = beyond(b, X_WB, hit->normal);
  const Real before = beyond(a, {Vec<D>(X_WA.p + hit->t * displacement), X_WA.q}, -hit->normal);
  RC_ASSERT(std::abs(behind) <= error);
  RC_ASSERT(std::abs(before) <= error);
}
TYPED_TEST(BodyQueriesTest, CastsTouchAndSeparate) {
  constexpr int D = TypeParam::D;
  const auto cast = [](const World<D>& world, const Shape<D>& a, const Pose<D>& X_WA, const Vec<D>& displacement) {
    return world.castFirst(a, X_WA, displacement);
  };
  check(
      "cast", [&] { castsTouch<D>(cast); }, 200);
  expectFalsified("the normal into the target", [&] {
    castsTouch<D>([&](const auto&... arguments) {
      auto hit = cast(arguments...);
      if (hit) hit->normal = -hit->normal;
      return hit;
    });
  });
  expectFalsified("a late hit", [&] {
    castsTouch<D>([&](const auto&... arguments) {
      auto hit = cast(arguments...);
      if (hit) hit->t += Real(0.01);
      return hit;
    });
  });
  expectFalsified("the point on the other side", [&] {
    castsTouch<D>([&](const World<D>& world, const Shape<D>& a, const Pose<D>& X, const Vec<D>& displacement) {
      auto hit = cast(world, a, X, displacement);
      if (hit) hit->point -= Real(0.1) * sizeOf(a) * hit->normal;
      return hit;
    });
  });
}

}}}}}  // namespace lpc::LPC_PRECISION::test::body_queries_test
