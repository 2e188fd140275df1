// SPDX-License-Identifier: Zlib
// A climb along a hull's edges ends at the same vertex as a search of all vertices, or reports that it is not certain.
#include "algorithms/pair_query/core/hull_climb.h"

#include <gtest/gtest.h>

#include "framework/shape/support_map.h"
#include "framework/stage/stage_narrowphase.h"
#include "oracles/corpus/hard_pairs.h"
#include "tests/draw.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace hull_climb_test {

using namespace pair_query;

std::size_t drawIn(Draw& draw, std::size_t count) {
  return static_cast<std::size_t>(draw.below(static_cast<int>(count)));
}

/// Hulls that are hardly convex: of the hard families, of points on a grid, turned (coplanar within rounding, four and
/// more corners of a face), with two large faces, and thin. Also round ones.
std::vector<Polytope<3>> hulls(bool round) {
  PlainDraw draw(3);
  std::vector<Polytope<3>> out;
  for (int n = 0; n < 200; ++n) {
    const Rot<3> q = drawRotation<3>(draw);
    const Vec<3> away = n % 2 ? 5 * drawVector<3>(draw) : Vec<3>(Vec<3>::Zero());
    std::vector<Vec<3>> points;
    const auto add = [&](const Vec<3>& p) { points.push_back(q * p + away); };
    if (round) {
      for (int i = 0; i < 8 + n; ++i) {
        const Vec<3> v = drawVector<3>(draw);
        add(v / std::max(v.norm(), Real(1e-3)));
      }
    } else {
      out.push_back(*hardPair<3>(ShapeKind::polytope, ShapeKind::polytope, 5, n).a.view().hull);
      for (int i = 0; n % 3 == 0 && i < 60; ++i) add(Vec<3>((3 * drawVector<3>(draw)).array().round()));
      for (int i = 0; n % 3 == 1 && i < 8 + n / 4; ++i) {  // a prism
        const Vec<3> v = Rot<3>::vector({0, 0, Real(0.2) * Real(i)}) * Vec<3>(1, 0, Real(0.3));
        add(v), add(Vec<3>(v[0], v[1], -v[2]));
      }
      for (int i = 0; n % 3 == 2 && i < 30; ++i) add(drawVector<3>(draw).cwiseProduct(Vec<3>(1, 1, Real(1e-3))));
    }
    out.push_back(*convexHull(points));
  }
  return out;
}

/// Any directions, and directions with several support points: normals of faces, and between two of them, off by
/// roundings.
std::vector<Vec<3>> directions(const Polytope<3>& hull, Draw& draw) {
  std::vector<Vec<3>> out;
  const auto leaning = [&](const Vec<3>& n) {
    out.push_back(n);
    for (const Real roundings : {Real(1), Real(30)}) out.push_back(n + roundings * kEps * drawVector<3>(draw));
  };
  for (int i = 0; i < 20; ++i) out.push_back(Real(3) * drawDirection<3>(draw));
  for (std::size_t i = 0; i < 20; ++i) {
    const auto& e = hull.edges[drawIn(draw, hull.edges.size())];
    const Vec<3>& nA = hull.faces[static_cast<std::size_t>(e.faceA)].normal;
    const Vec<3>& nB = hull.faces[static_cast<std::size_t>(e.faceB)].normal;
    leaning(nA), leaning(nA + draw.real(0, 1) * (nB - nA));
  }
  return out;
}

// One end of each edge loses the other end as its neighbour.
void unlink(Polytope<3>& hull) {
  for (auto& s : hull.spokes) s.to = hull.edges[static_cast<std::size_t>(s.edge)].v0;
}

struct Climbs {
  int asked = 0, stopped = 0, wrong = 0;
};
template <class Spoil>
Climbs climbs(bool round, Spoil spoil) {
  Climbs out;
  PlainDraw draw(4);
  for (Polytope<3>& hull : hulls(round)) {
    spoil(hull);
    ShapeView<3> shape;
    shape.kind = ShapeKind::polytope, shape.hull = &hull;
    for (const Vec<3>& d : directions(hull, draw)) {
      int scanned = -1;
      coreSupport(shape, d, &scanned);
      const int top = climbToFarthest(hull, d, static_cast<int>(drawIn(draw, hull.vertices.size())));
      ++out.asked, out.stopped += top < 0, out.wrong += top >= 0 && top != scanned;
    }
  }
  return out;
}

TEST(HullClimb, EqualsAScanOfAllVertices) {
  const auto none = [](Polytope<3>&) {};
  const Climbs hard = climbs(false, none), round = climbs(true, none);
  std::printf("%d of %d climbs on hard hulls and %d of %d on round ones know no end\n", hard.stopped, hard.asked,
              round.stopped, round.asked);
  EXPECT_EQ(hard.wrong, 0);
  EXPECT_EQ(round.wrong, 0);
  EXPECT_LT(hard.stopped, hard.asked / 2);
  EXPECT_LT(round.stopped, round.asked / 100);
  const auto blind = [](Polytope<3>& hull) { hull.slack = 0; };
  expectCaught("what is as high within rounding is not looked around", climbs(false, blind).wrong == 0);
  expectCaught("neighbours are missing", climbs(true, unlink).wrong == 0);
}

// With `support=climb`, gjk_epa queries the same directions, gives the same answers and does the same work as with a
// scan. The pairs move, so that the climb starts from remembered vertices.
bool climbsAsItScans(bool unlinked) {
  const auto scan = createStage<PairQuery<3>>(Spec::parse("gjk_epa"));
  const auto climb = createStage<PairQuery<3>>(Spec::parse("gjk_epa{support=climb}"));
  PlainDraw draw(6);
  bool same = true;
  const auto drawHull = [&] {
    std::vector<Vec<3>> points;
    const bool grid = draw.coin();
    for (int i = 120 + draw.below(100); i > 0; --i) {
      const Vec<3> v = drawVector<3>(draw);
      points.push_back(grid ? Vec<3>((6 * v).array().round()) : Vec<3>(6 * v / std::max(v.norm(), Real(1e-3))));
    }
    const Rot<3> q = drawRotation<3>(draw);
    for (Vec<3>& p : points) p = q * p;
    auto hull = std::make_shared<Polytope<3>>(*convexHull(points));
    if (unlinked) unlink(*hull);
    return Shape<3>::polytope(std::move(hull));
  };
  for (int n = 0; n < 60; ++n) {
    const Shape<3> a = drawHull(), b = drawHull();
    Pose<3> X{12 * drawDirection<3>(draw), drawRotation<3>(draw)};
    const Vec<3> way = drawVector<3>(draw), turn = drawVector<3>(draw) / 10;
    PairMemory scanned, climbed;
    for (int step = 0; step < 20; ++step) {
      const PairView<3> pair{a.view(), b.view(), X};
      PairAnswer<3> s, c;
      WorkDone scanWork, climbWork;
      scan->query({&pair, 1}, QueryNeed::closestPoints, {&s, 1}, {&scanned, 1}, scanWork);
      climb->query({&pair, 1}, QueryNeed::closestPoints, {&c, 1}, {&climbed, 1}, climbWork);
      same = same && s.distance == c.distance && s.normal == c.normal && s.pA == c.pA && s.status == c.status &&
             scanned == climbed && scanWork.counts == climbWork.counts;
      X.p += way, X.q = integrateRotation(X.q, turn);
    }
  }
  return same;
}
TEST(HullClimb, GjkClimbsAsItScans) {
  EXPECT_TRUE(climbsAsItScans(false));
  expectCaught("gjk_epa climbs where neighbours are missing", climbsAsItScans(true));
}

}  // namespace hull_climb_test
}}}  // namespace lpc::LPC_PRECISION::test
