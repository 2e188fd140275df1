// SPDX-License-Identifier: Zlib
// What is done for several vertices or faces at a time gives the very numbers that one at a time gives.
#include <gtest/gtest.h>

#include "algorithms/pair_query/face_planes.h"
#include "algorithms/pair_query/hull_support.h"
#include "algorithms/pair_query/touching_boxes3.h"
#include "tests/draw.h"
#include "tests/each_target.h"
#include "tests/expect_caught.h"

namespace lpc::inline LPC_PRECISION::test {
namespace hull_lanes_test {

using namespace pair_query;

using Search = std::size_t (*)(const std::vector<Vec<3>>&, const Vec<3>&);

// As coreSupport finds them, of vertices on a grid, where many are equally far, and of others.
bool findsTheSame(Search search) {
  PlainDraw draw(5);
  for (std::size_t count = kManyVertices; count < 90; ++count) {
    for (const bool onGrid : {false, true}) {
      const auto place = [&] {
        const Vec<3> v = drawVector<3>(draw);
        return onGrid ? Vec<3>((2 * v).array().round()) : v;
      };
      Polytope<3> hull;
      for (std::size_t i = 0; i < count; ++i) hull.vertices.push_back(place());
      ShapeView<3> shape;
      shape.kind = ShapeKind::polytope, shape.hull = &hull;
      for (int i = 0; i < 50; ++i) {
        const Vec<3> d = place();
        int hint = -1;
        coreSupport(shape, d, &hint);
        if (search(hull.vertices, d) != static_cast<std::size_t>(hint)) return false;
      }
    }
  }
  return true;
}
std::size_t lastFarthest(const std::vector<Vec<3>>& vertices, const Vec<3>& d) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    if (vertices[i].dot(d) >= vertices[best].dot(d)) best = i;
  }
  return best;
}
TEST(HullLanes, FarthestVertexIsTheScans) {
  forEachTarget([](std::int64_t target) { EXPECT_TRUE(findsTheSame(farthestVertex)) << hwy::TargetName(target); });
  expectCaught("of vertices that are equally far the last", findsTheSame(lastFarthest));
}

// Planes of fans of each size, and those of triangles without one, to the last bit.
bool planesAreTriples(void (*spoil)(FacePlanes&)) {
  PlainDraw draw(6);
  const auto put = [](std::array<FacePlanes::Row, 3>& rows, std::size_t i, const Vec<3>& v) {
    for (std::size_t k = 0; k < 3; ++k) rows[k][i] = v[static_cast<int>(k)];
  };
  for (int n = 0; n < 2000; ++n) {
    const int count = 1 + draw.below(FacePlanes::kFan);
    FacePlanes planes;
    std::vector<std::array<Vec<3>, 3>> corners;
    for (int i = 0; i < count; ++i) {
      corners.push_back({drawVector<3>(draw), drawVector<3>(draw), drawVector<3>(draw)});
      if (draw.below(10) == 0) corners.back()[1] = corners.back()[0];
      const auto at = static_cast<std::size_t>(i);
      put(planes.a, at, corners[at][0]), put(planes.b, at, corners[at][1]), put(planes.c, at, corners[at][2]);
    }
    planes.find(count);
    spoil(planes);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Triple a(corners[i][0]), b(corners[i][1]), c(corners[i][2]);
      Triple normal = cross(b - a, c - a);
      if (planes.square[i] != dot(normal, normal)) return false;
      if (!makeUnit(normal)) continue;
      const bool alike = planes.outward[0][i] == normal.x && planes.outward[1][i] == normal.y &&
                         planes.outward[2][i] == normal.z &&
                         planes.offset[i] == std::max({dot(normal, a), dot(normal, b), dot(normal, c)});
      if (!alike) return false;
    }
  }
  return true;
}
TEST(HullLanes, PlanesAreThoseOfOneFace) {
  forEachTarget(
      [](std::int64_t target) { EXPECT_TRUE(planesAreTriples([](FacePlanes&) {})) << hwy::TargetName(target); });
  expectCaught("a plane that is off by one rounding",
               planesAreTriples([](FacePlanes& f) { f.offset[0] = std::nextafter(f.offset[0], Real(9)); }));
}

// As Eigen's vectors, whose numbers stand in results.
TEST(HullLanes, TripleIsAVector) {
  PlainDraw draw(7);
  int otherOrder = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vec<3> a = drawVector<3>(draw), b = drawVector<3>(draw);
    ASSERT_EQ(dot(Triple(a), Triple(b)), a.dot(b));
    ASSERT_EQ(cross(Triple(a), Triple(b)).vector(), a.cross(b));
    Vec<3> unit = a;
    Triple triple(a);
    ASSERT_EQ(makeUnit<3>(unit), makeUnit(triple));
    ASSERT_EQ(triple.vector(), unit);
    ASSERT_EQ((Triple(a) + Triple(b)).vector(), a + b);
    ASSERT_EQ(sumOfSizes(Triple(a)), a.lpNorm<1>());
    const Rot<3> q = Rot<3>::vector(b);
    ASSERT_EQ((q * Triple(a)).vector(), q * a);
    // Products with a matrix, of which Eigen takes two rows at a time.
    const Shape<3> ball = Shape<3>::sphere(1);
    const PairView<3> view{ball.view(), ball.view(), {b, q}};
    const CorePair<3> pair(view);
    const BoxPair3 boxes(pair);
    ASSERT_EQ(boxes.turned(Triple(a)).vector(), pair.r * a);
    ASSERT_EQ(boxes.back(Triple(a)).vector(), pair.r.transpose() * a);
    const Real x = a[0] * b[0], y = a[1] * b[1], z = a[2] * b[2];
    otherOrder += a.dot(b) != (sizeof(Real) == 8 ? x + (y + z) : (x + y) + z);
  }
  EXPECT_GT(otherOrder, 100) << "the order of additions would not be seen";
}

}  // namespace hull_lanes_test
}  // namespace lpc::inline LPC_PRECISION::test
