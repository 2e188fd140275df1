// SPDX-License-Identifier: Zlib
// Computations on several vertices or faces at a time give the same numbers as one at a time.
#include <gtest/gtest.h>

#include <utility>

#include "algorithms/pair_query/core/hull_support.h"
#include "algorithms/pair_query/core/touching_boxes3.h"
#include "algorithms/pair_query/gjk/face_planes.h"
#include "tests/draw.h"
#include "tests/each_target.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace hull_lanes_test {

using namespace pair_query;

using Search = std::size_t (*)(const std::vector<Vec<3>>&, const Vec<3>&);

// Equals coreSupport on vertices of a grid, where many are equally far, and on others.
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
TEST(HullLanes, FarthestVertexEqualsTheScan) {
  forEachTarget([](std::int64_t target) { EXPECT_TRUE(findsTheSame(farthestVertex)) << hwy::TargetName(target); });
  expectCaught("of vertices that are equally far the last", findsTheSame(lastFarthest));
}

// Support points of two hulls with few vertices and with many, also in repeated queries: the numbers of the vectors'
// own arithmetic.
using PairSearch = HullSupport (*)(HullPair&, const CorePair<3>&, const Vec<3>&);

bool supportsAreVectors(PairSearch search) {
  PlainDraw draw(8);
  HullPair hulls;
  for (int n = 0; n < 300; ++n) {
    const bool onGrid = n % 2 == 0;
    const auto place = [&] {
      const Vec<3> v = drawVector<3>(draw);
      return onGrid ? Vec<3>((2 * v).array().round()) : v;
    };
    Polytope<3> a, b;
    for (int i = 0, count = 1 + draw.below(n % 3 == 0 ? 20 : 70); i < count; ++i) a.vertices.push_back(place());
    for (int i = 0, count = 1 + draw.below(70); i < count; ++i) b.vertices.push_back(place());
    PairView<3> view;
    view.a.kind = view.b.kind = ShapeKind::polytope, view.a.hull = &a, view.b.hull = &b;
    view.X_AB = {drawVector<3>(draw), drawRotation<3>(draw)};
    const CorePair<3> pair(view);
    hulls.begin(a.vertices, b.vertices);
    for (int i = 0; i < 4; ++i) {
      const Vec<3> d = place();
      int onA = -1, onB = -1;
      const Vec<3> v = coreSupport(view.b, Vec<3>(-(pair.r.transpose() * d)), &onB), u = coreSupport(view.a, d, &onA);
      const HullSupport found = search(hulls, pair, d);
      if (found.a != static_cast<std::size_t>(onA) || found.b != static_cast<std::size_t>(onB)) return false;
      if (found.point != Vec<3>((pair.p + pair.r * v) - u) || found.point != pair.support(d)) return false;
    }
  }
  return true;
}
HullSupport asked(HullPair& hulls, const CorePair<3>& pair, const Vec<3>& n) {
  return hulls.support(pair.p, pair.r, n);
}
// Planted bug: a later pair is answered with the vertices of the first.
HullSupport askedStale(HullPair& hulls, const CorePair<3>& pair, const Vec<3>& n) {
  static HullPair first;
  static std::array<Polytope<3>, 2> kept;  // a HullPair keeps references to the vertices
  static bool begun = false;
  if (!std::exchange(begun, true)) {
    kept = {*pair.a.hull, *pair.b.hull};
    first.begin(kept[0].vertices, kept[1].vertices);
  }
  return (pair.p[0] > 0 ? first : hulls).support(pair.p, pair.r, n);
}
HullSupport askedFromTheOtherEnd(HullPair& hulls, const CorePair<3>& pair, const Vec<3>& n) {
  HullSupport found = hulls.support(pair.p, pair.r, n);
  const Vec<3> v = pair.r * pair.b.hull->vertices[found.b];
  found.point = pair.p + (v - pair.a.hull->vertices[found.a]);
  return found;
}
TEST(HullLanes, SupportPointsEqualVectorArithmetic) {
  forEachTarget([](std::int64_t target) { EXPECT_TRUE(supportsAreVectors(asked)) << hwy::TargetName(target); });
  expectCaught("rows of a pair before", supportsAreVectors(askedStale));
  expectCaught("three numbers added in another order", supportsAreVectors(askedFromTheOtherEnd));
}

// Vertices near the farthest: those of a scan, in its order.
using Gather = void (*)(const std::vector<Vec<3>>&, const Vec<3>&, Real, std::vector<Vec<3>>&);

bool gathersTheSame(Gather gather) {
  PlainDraw draw(9);
  std::vector<Vec<3>> vertices, found, near;
  for (int n = 0; n < 1000; ++n) {
    const auto onGrid = [&] { return Vec<3>((2 * drawVector<3>(draw)).array().round()); };
    vertices.clear(), found.clear(), near.clear();
    for (int i = 0, count = 1 + draw.below(40); i < count; ++i) vertices.push_back(onGrid());
    const Vec<3> d = onGrid();
    const Real band = Real(draw.below(3));
    Real farthest = vertices[0].dot(d);
    for (const Vec<3>& v : vertices) farthest = std::max(farthest, v.dot(d));
    for (const Vec<3>& v : vertices) {
      if (v.dot(d) >= farthest - band) near.push_back(v);
    }
    gather(vertices, d, band, found);
    if (found != near) return false;
  }
  return true;
}
void gatherInside(const std::vector<Vec<3>>& vertices, const Vec<3>& d, Real band, std::vector<Vec<3>>& out) {
  verticesWithin(vertices, d, band > 0 ? std::nextafter(band, Real(0)) : band, out);
}
TEST(HullLanes, VerticesNearTheFarthestEqualTheScan) {
  forEachTarget([](std::int64_t target) { EXPECT_TRUE(gathersTheSame(verticesWithin)) << hwy::TargetName(target); });
  expectCaught("those on the border of the band are left out", gathersTheSame(gatherInside));
}

// Planes of fans of each size equal those of single triangles, to the last bit.
bool planesAreTriples(void (*spoil)(FacePlanes&)) {
  PlainDraw draw(6);
  for (int n = 0; n < 2000; ++n) {
    const int count = 1 + draw.below(FacePlanes::kFan);
    FacePlanes planes;
    std::vector<Vec<3>> ring;
    const Vec<3> apex = drawVector<3>(draw);
    for (int k = 0; k < 3; ++k) planes.apex[static_cast<std::size_t>(k)] = apex[k];
    for (std::size_t i = 0; i <= static_cast<std::size_t>(count); ++i) {
      ring.push_back(i > 0 && draw.below(10) == 0 ? ring.back() : drawVector<3>(draw));
      for (std::size_t k = 0; k < 3; ++k) planes.ring[k][i] = ring[i][static_cast<int>(k)];
    }
    planes.find(count);
    spoil(planes);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const Triple a(ring[i]), b(ring[i + 1]), c(apex);
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
TEST(HullLanes, PlanesEqualThoseOfSingleFaces) {
  forEachTarget(
      [](std::int64_t target) { EXPECT_TRUE(planesAreTriples([](FacePlanes&) {})) << hwy::TargetName(target); });
  expectCaught("a plane that is off by one rounding",
               planesAreTriples([](FacePlanes& f) { f.offset[0] = std::nextafter(f.offset[0], Real(9)); }));
}

// Triples give the same numbers as Eigen's vectors, on which results depend.
TEST(HullLanes, TriplesEqualVectors) {
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
    // Products with a matrix: Eigen computes two rows at a time.
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
}}}  // namespace lpc::LPC_PRECISION::test
