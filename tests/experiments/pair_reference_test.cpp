// SPDX-License-Identifier: Zlib
// The brute-force distance that pair queries are judged by is itself judged: by closed forms and by its own bound.
#include "experiments/trial/pair_reference.h"

#include <gtest/gtest.h>

#include "framework/random.h"
#include "framework/support_map.h"

namespace lpc::inline LPC_PRECISION {
namespace {

template <int D>
Pose<D> at(std::initializer_list<Real> p) {
  Pose<D> x;
  int d = 0;
  for (Real v : p) x.p[d++] = v;
  return x;
}

TEST(PairReference, closedForms) {
  const auto ball = Shape<3>::sphere(1), point = Shape<3>::sphere(0);
  EXPECT_NEAR(bruteForceDistance(ball.view(), ball.view(), at<3>({3, 4, 0})), 3, 1e-15);
  EXPECT_NEAR(bruteForceDistance(ball.view(), ball.view(), at<3>({0.5, 0, 0})), -1.5, 1e-15);
  EXPECT_NEAR(bruteForceDistance(ball.view(), ball.view(), at<3>({0, 0, 0})), -2, 1e-15);
  const auto cube = Shape<3>::box(Vec<3>(1, 1, 1));
  EXPECT_NEAR(bruteForceDistance(cube.view(), point.view(), at<3>({2, 3, 4})), std::sqrt(1 + 4 + 9), 1e-14);
  EXPECT_NEAR(bruteForceDistance(cube.view(), point.view(), at<3>({0.25, 0, 0.5})), -0.5, 1e-15);
  EXPECT_NEAR(bruteForceDistance(cube.view(), cube.view(), at<3>({1.5, 0.25, 0})), -0.5, 1e-15);
  // Edge against edge, crossing at right angles: the distance is along z.
  Pose<3> x = at<3>({0, 0, 4});
  x.q = Rot<3>::vector(Vec<3>(3.14159265358979323846 / 4, 0, 0));
  Pose<3> tilt;
  tilt.q = Rot<3>::vector(Vec<3>(0, 3.14159265358979323846 / 4, 0));
  EXPECT_NEAR(bruteForceDistance(cube.view(), cube.view(), tilt.inverse() * x), 4 - 2 * std::sqrt(2.0), 1e-14);
  const auto rod = Shape<3>::capsule(2, 0.5);
  Pose<3> across = at<3>({0, 0, 3});
  across.q = Rot<3>::vector(Vec<3>(0, 0, 1));
  EXPECT_NEAR(bruteForceDistance(rod.view(), rod.view(), across), 2, 1e-14);
  EXPECT_NEAR(bruteForceDistance(rod.view(), rod.view(), at<3>({0.5, 0, 0})), -1, 1e-14) << "on one line, overlapping";
  const auto stick = Shape<2>::segment(1);
  Pose<2> crossed;
  crossed.q = Rot<2>::angle(3.14159265358979323846 / 2);
  EXPECT_NEAR(bruteForceDistance(stick.view(), stick.view(), crossed), -1, 1e-15);
}

// Never above the truth: no direction may show a larger gap. A planted, too small candidate set must be seen to fail.
TEST(PairReference, noSampledDirectionBeatsIt) {
  Random random(3);
  int beaten = 0;
  for (int i = 0; i < 40; ++i) {
    std::vector<Vec<3>> points;
    for (int k = 0; k < 9; ++k)
      points.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const auto hull = Shape<3>::polytope(points);
    const auto box = Shape<3>::box(Vec<3>(random.uniform(0.2, 1), random.uniform(0.2, 1), random.uniform(0.2, 1)));
    Pose<3> x = at<3>({random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)});
    x.q = Rot<3>::vector(Vec<3>(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)));
    const double distance = bruteForceDistance(hull.view(), box.view(), x);
    const auto gap = [&](const Vec<3>& n) {
      const Vec<3> back = x.q.inverse() * Vec<3>(-n);
      return -supportValue(hull.view(), n) - supportValue(box.view(), back) - x.p.dot(-n);
    };
    double axesOnly = -1e9;
    for (int d = 0; d < 3; ++d) axesOnly = std::max({axesOnly, gap(Vec<3>::Unit(d)), gap(-Vec<3>::Unit(d))});
    for (int k = 0; k < 500; ++k) {
      Vec<3> n(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      if (n.norm() < 0.1) continue;
      n.normalize();
      ASSERT_LE(gap(n), distance + 1e-13);
      beaten += gap(n) > axesOnly + 1e-13;
    }
  }
  EXPECT_GT(beaten, 0) << "the sampling finds nothing";
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
