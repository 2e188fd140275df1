// SPDX-License-Identifier: Zlib
#include "framework/world/body_queries.h"

#include "tests/world_parts.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace body_queries_test { namespace {

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
  RayFilter<D> filter{.mask = 1};
  EXPECT_EQ(g.queries.rayAll(at<D>(10, 0), at<D>(-1, 0), 100, &filter).size(), 2u);
  filter.accepts = [&](BodyHandle body, const ShapeRecord<D>&) { return body != g.two; };
  EXPECT_EQ(g.queries.rayAll(at<D>(10, 0), at<D>(-1, 0), 100, &filter).size(), 1u);
  EXPECT_NE(refusalOf([&] { g.queries.rayAll(at<D>(0, 0), at<D>(1, 0), -1); }), "");
  EXPECT_NE(refusalOf([&] { g.queries.rayAll(at<D>(0, 0), at<D>(std::nan(""), 0), 1); }), "");
}

}}}}}  // namespace lpc::LPC_PRECISION::test::body_queries_test
