// SPDX-License-Identifier: Zlib
// The outlines that a chart draws of a pair of shapes have the known areas, for every kind.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "framework/shape/curved_core.h"
#include "oracles/corpus/hard_pairs.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace outline_test { namespace {

using nlohmann::json;
constexpr double kPi = std::numbers::pi;

template <int D>
json outlines(const HardPair<D>& pair) {
  return json::parse("{\"dim\": " + std::to_string(D) + outlinesText<D>(pair) + "}");
}

// m^2; positive: counter-clockwise.
double areaOf(const json& points) {
  double twice = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const json &p = points[i], &q = points[(i + 1) % points.size()];
    twice += p[0].get<double>() * q[1].get<double>() - p[1].get<double>() * q[0].get<double>();
  }
  return twice / 2;
}

template <int D>
double areaOf(const Shape<D>& shape, const Pose<D>& pose = {}) {
  return areaOf(outlines<D>({.a = Shape<D>::sphere(1), .b = shape, .X_AB = pose})["outlineB"]);
}

TEST(Outline, HasTheAreaOfTheShadow) {
  const Pose<2> turned{{5, 5}, Rot<2>{Real(0.8), Real(0.6)}};
  const Vec<2> corners[] = {{0, 0}, {4, 0}, {0, 2}};
  const auto near = [](double found, double right) { return std::abs(found - right) < 0.005 * right; };
  EXPECT_TRUE(near(areaOf(Shape<2>::sphere(2)), 4 * kPi));
  EXPECT_TRUE(near(areaOf(Shape<2>::box({1, 2}), turned), 8));
  EXPECT_TRUE(near(areaOf(Shape<2>::box({1, 2}, 1)), 8 + 12 + kPi));
  EXPECT_TRUE(near(areaOf(Shape<2>::capsule(1, 1), turned), 4 + kPi));
  EXPECT_TRUE(near(areaOf(Shape<2>::ofCorners(ShapeKind::polytope, corners)), 4));
  const Real half[] = {3, 1}, round[] = {1, 1, 1};
  EXPECT_TRUE(near(areaOf(Shape<2>::curved(ShapeKind::ellipsoid, half)), 3 * kPi));
  EXPECT_TRUE(near(areaOf(Shape<3>::curved(ShapeKind::ellipsoid, round)), kPi)) << "from every side";
  expectCaught("outline: the core alone is drawn", near(areaOf(Shape<2>::box({1, 2})), 8 + 12 + kPi));
}

// The drawn ground near a ball has its edge under the ball, at the height of the plane.
TEST(Outline, HalfSpacesAreDrawnUnderTheOtherShape) {
  const json flat = outlines<2>({.a = Shape<2>::sphere(1), .b = Shape<2>::plane(), .X_AB = {{100, -3}, {}}});
  double top = -1e9, left = 1e9, right = -1e9;
  for (const json& p : flat["outlineB"]) {
    top = std::max(top, p[1].get<double>());
    left = std::min(left, p[0].get<double>()), right = std::max(right, p[0].get<double>());
  }
  EXPECT_NEAR(top, -3, 1e-9);
  EXPECT_LT(left, -1);
  EXPECT_GT(right, 1);
}

template <int D>
void everyKindHasOne() {
  int kinds = 0;
  for (int k = 0; k < kShapeKinds; ++k) {
    const auto kind = static_cast<ShapeKind>(k);
    if (!kindExists(kind, D)) continue;
    ++kinds;
    for (int i = 0; i < 20; ++i) {
      const json both = outlines<D>(hardPair<D>(ShapeKind::sphere, kind, 1, i));
      for (const char* side : {"outlineA", "outlineB"}) {
        const json& points = both[side];
        EXPECT_GE(points.size(), std::string(side) == "outlineB" && kind == ShapeKind::segment ? 1u : 2u)
            << side << " of " << shapeKindName(kind) << ' ' << i;
        EXPECT_GE(areaOf(points), -1e-4) << "counter-clockwise: " << shapeKindName(kind) << ' ' << i;
      }
    }
  }
  EXPECT_GE(kinds, D == 2 ? 7 : 9);
}
TEST(Outline, EveryKindHasAnOutline2) { everyKindHasOne<2>(); }
TEST(Outline, EveryKindHasAnOutline3) { everyKindHasOne<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::outline_test
