// SPDX-License-Identifier: Zlib
// M8: properties of every hull, on random clouds and on inputs that broke other engines.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "framework/math/check.h"
#include "framework/shape/shape.h"
#include "framework/shape/shape_tolerances.h"
#include "tests/check_property.h"
#include "tests/generators.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace polytope_test { namespace {

template <int D>
using Points = std::vector<Vec<D>>;
template <int D>
using Hull = std::shared_ptr<const Polytope<D>>;

template <int D>
Hull<D> hullOf(const Points<D>& points) {
  return convexHull(std::span<const Vec<D>>(points));
}

// Rounding of the coordinates.
template <int D>
Real roundingOf(const Points<D>& points) {
  Real largest = 0;
  for (const Vec<D>& p : points) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  return 64 * kEps * largest;
}

template <int D>
using Key = std::array<Real, D>;
template <int D>
std::set<Key<D>> asSet(const Points<D>& points) {
  std::set<Key<D>> out;
  for (const Vec<D>& p : points) {
    Key<D> key;
    for (int k = 0; k < D; ++k) key[static_cast<std::size_t>(k)] = p[k];
    out.insert(key);
  }
  return out;
}

// Checks everything that the header promises; an empty text if it holds.
std::string wrong(const Points<2>& points, const Polytope<2>& hull) {
  const std::size_t n = hull.vertices.size();
  if (n < 3 || hull.normals.size() != n) return "counts";
  const auto given = asSet<2>(points);
  const Real rounding = roundingOf<2>(points);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec<2>&a = hull.vertices[i], &b = hull.vertices[(i + 1) % n], &c = hull.vertices[(i + 2) % n];
    if (!given.count({a[0], a[1]})) return "a vertex that was not given";
    if (std::abs(hull.normals[i].norm() - 1) > 4 * kEps) return "a normal that is not unit";
    if (std::abs(hull.normals[i].dot(b - a)) > 8 * kEps * (b - a).norm()) return "a normal that is not normal";
    if (hull.normals[i].dot(c - b) >= 0) return "no turn to the left";
    for (const Vec<2>& p : points) {
      if (hull.normals[i].dot(p - a) > rounding) return "a point outside";
    }
  }
  return "";
}
bool isDented(const Polytope<3>& hull, const Polytope<3>::Face& face) {
  const int n = face.end - face.begin;
  const auto corner = [&](int i) -> const Vec<3>& {
    return hull.vertices[static_cast<std::size_t>(hull.loop[static_cast<std::size_t>(face.begin + i % n)])];
  };
  for (int i = 0; i < n; ++i) {
    const Vec<3> in = corner(i + 1) - corner(i), out = corner(i + 2) - corner(i + 1);
    if (in.cross(out).dot(face.normal) < -1e-9 * in.norm() * out.norm()) return true;
  }
  return false;
}
std::string wrong(const Points<3>& points, const Polytope<3>& hull) {
  const auto given = asSet<3>(points);
  const Real rounding = roundingOf<3>(points);
  const auto vertex = [&](int i) -> const Vec<3>& { return hull.vertices[static_cast<std::size_t>(i)]; };
  for (const Vec<3>& v : hull.vertices) {
    if (!given.count({v[0], v[1], v[2]})) return "a vertex that was not given";
  }
  if (hull.vertices.size() + hull.faces.size() != hull.edges.size() + 2) return "Euler";
  std::vector<int> uses(hull.vertices.size());
  std::set<std::pair<int, int>> directed;
  for (const auto& face : hull.faces) {
    if (face.end - face.begin < 3) return "a face with two corners";
    if (std::abs(face.normal.norm() - 1) > 8 * kEps) return "a normal that is not unit";
    Vec<3> area = Vec<3>::Zero();
    for (int i = face.begin; i < face.end; ++i) {
      const int a = hull.loop[static_cast<std::size_t>(i)];
      const int b = hull.loop[static_cast<std::size_t>(i + 1 < face.end ? i + 1 : face.begin)];
      ++uses[static_cast<std::size_t>(a)];
      if (!directed.insert({a, b}).second) return "an edge used twice in one direction";
      const Vec<3>& base = vertex(hull.loop[static_cast<std::size_t>(face.begin)]);
      area += Vec<3>(vertex(a) - base).cross(Vec<3>(vertex(b) - base));
      if (std::abs(face.normal.dot(vertex(a)) - face.offset) > rounding) return "a corner off its face";
    }
    if (!(area.dot(face.normal) > 0)) return "a face turned inwards";
    if (isDented(hull, face)) return "a face whose loop turns inwards";
    for (const Vec<3>& p : points) {
      if (face.normal.dot(p) - face.offset > rounding) return "a point outside";
    }
  }
  if (std::any_of(uses.begin(), uses.end(), [](int u) { return u < 3; })) return "a vertex with two faces";
  if (2 * hull.edges.size() != directed.size()) return "edges and loops differ";
  for (const auto& e : hull.edges) {
    if (!directed.count({e.v0, e.v1}) || !directed.count({e.v1, e.v0})) return "an edge of no face";
    if (e.faceA == e.faceB || e.faceA < 0 || e.faceB < 0) return "an edge without two faces";
    const auto& face = hull.faces[static_cast<std::size_t>(e.faceA)];
    bool follows = false;
    for (int i = face.begin; i < face.end; ++i) {
      follows = follows || (hull.loop[static_cast<std::size_t>(i)] == e.v0 &&
                            hull.loop[static_cast<std::size_t>(i + 1 < face.end ? i + 1 : face.begin)] == e.v1);
    }
    if (!follows) return "an edge against its faceA";
  }
  if (hull.spokes.size() != directed.size()) return "edges and neighbours differ";
  for (int v = 0; v < static_cast<int>(hull.vertices.size()); ++v) {
    if (static_cast<int>(hull.spokesOf(v).size()) != uses[static_cast<std::size_t>(v)]) return "a neighbour is missing";
    for (const auto& s : hull.spokesOf(v)) {
      const auto& e = hull.edges[static_cast<std::size_t>(s.edge)];
      if (std::minmax(e.v0, e.v1) != std::minmax(v, s.to)) return "a neighbour across another edge";
    }
  }
  return "";
}

// Point clouds that are hard: lattices (many coplanar points), repeated points, slivers, far away, tiny, huge.
template <int D>
Points<D> drawCloud(Draw& draw) {
  Points<D> points = drawPoints<D>(draw);
  const int kind = draw.below(4);
  const int n = draw.below(30);
  for (int i = 0; i < n; ++i) {
    Vec<D> p;
    for (int k = 0; k < D; ++k) p[k] = kind == 1 ? Real(draw.below(4)) - 1 : 2 * draw.signedUnit();
    if (kind == 2) p *= 2 / std::max(p.norm(), Real(1e-3));  // on a circle or sphere
    if (kind == 3) p = points[static_cast<std::size_t>(draw.below(static_cast<int>(points.size())))];
    points.push_back(p);
  }
  const Rot<D> q = draw.coin() ? drawRotation<D>(draw) : Rot<D>{};
  // Never thinner than a hundred times the rounding of the coordinates: such clouds are rejected, as they must be.
  const bool wide = sizeof(Real) == 8;
  const Real scale = drawScale(draw), thin = draw.pick({Real(1), Real(0.01), wide ? Real(1e-4) : Real(0.1)});
  const Vec<D> offset = scale * draw.pick({Real(0), Real(10), wide ? Real(1000) : Real(1)}) * drawVector<D>(draw);
  for (Vec<D>& p : points) {
    p[0] *= thin;
    p = q * Vec<D>(scale * p) + offset;
  }
  return points;
}
template <int D>
Gen<Points<D>> clouds() {
  return Gen<Points<D>>(drawCloud<D>);
}

template <int D>
void hulls() {
  check(
      "M8",
      [] {
        const auto points = *clouds<D>();
        const auto hull = hullOf<D>(points);
        RC_ASSERT(wrong(points, *hull) == "");
        // The hull of a hull is the same hull.
        const auto again = hullOf<D>(hull->vertices);
        RC_ASSERT(asSet<D>(again->vertices) == asSet<D>(hull->vertices));
      },
      1000);
}

template <int D>
using HullOf = Points<D> (*)(const Points<D>&);
template <int D>
Points<D> right(const Points<D>& points) {
  return hullOf<D>(points)->vertices;
}

// M8: in general position the order of the points does not matter. In a tie, another point may be chosen.
template <int D>
void orderIsNothing(HullOf<D> verticesOf) {
  RapidCheckDraw draw;
  Points<D> points = drawPoints<D>(draw);
  const auto before = asSet<D>(verticesOf(points));
  for (std::size_t i = points.size(); i > 1; --i) {
    std::swap(points[i - 1], points[static_cast<std::size_t>(draw.below(static_cast<int>(i)))]);
  }
  RC_ASSERT(asSet<D>(verticesOf(points)) == before);
}

// Features keep their numbers: vertices have the order of the given points, in 2D counter-clockwise from the first one.
template <int D>
void vertexOrder(HullOf<D> verticesOf) {
  RapidCheckDraw draw;
  const Points<D> points = drawPoints<D>(draw), vertices = verticesOf(points);
  const auto place = [&](const Vec<D>& v) { return std::find(points.begin(), points.end(), v) - points.begin(); };
  if (D == 3) {
    RC_ASSERT(std::is_sorted(vertices.begin(), vertices.end(), [&](auto& a, auto& b) { return place(a) < place(b); }));
  } else {
    for (const Vec<D>& v : vertices) RC_ASSERT(place(vertices[0]) <= place(v));
  }
}

template <int D>
void orders() {
  check("M8 order of the points", [] { orderIsNothing<D>(right<D>); });
  expectFalsified("M8 of a hull that forgets the last point", [] {
    orderIsNothing<D>([](const Points<D>& points) {
      const bool enough = points.size() > D + 2;
      return right<D>(enough ? Points<D>(points.begin(), points.end() - 1) : points);
    });
  });
  check("order of the vertices", [] { vertexOrder<D>(right<D>); });
  expectFalsified("order of the vertices turned round", [] {
    vertexOrder<D>([](const Points<D>& points) {
      const Points<D> v = right<D>(points);
      return Points<D>(v.rbegin(), v.rend());
    });
  });
}
TEST(Hull, Orders2) { orders<2>(); }
TEST(Hull, Orders3) { orders<3>(); }

TEST(Hull, RandomClouds2) { hulls<2>(); }
TEST(Hull, RandomClouds3) { hulls<3>(); }

TEST(Hull, PlantedBugsAreCaught) {
  expectFalsified("2D: a vertex on an edge is kept", [] {
    Points<2> points = {{0, 0}, {2, 0}, {0, 2}};
    auto hull = *hullOf<2>(points);
    RapidCheckDraw draw;
    const Vec<2> middle = (hull.vertices[0] + hull.vertices[1]) / 2;
    points.push_back(middle);
    if (draw.coin()) {
      hull.vertices.insert(hull.vertices.begin() + 1, middle),
          hull.normals.insert(hull.normals.begin(), hull.normals[0]);
    }
    RC_ASSERT(wrong(points, hull) == "");
  });
  const auto break3 = [](const char* what, auto bug) {
    expectFalsified(what, [bug] {
      RapidCheckDraw draw;
      const Points<3> points = drawPoints<3>(draw);
      auto hull = *hullOf<3>(points);
      bug(hull);
      RC_ASSERT(wrong(points, hull) == "");
    });
  };
  break3("3D: a face is missing", [](Polytope<3>& h) { h.faces.pop_back(); });
  break3("3D: a normal points inwards", [](Polytope<3>& h) { h.faces[0].normal *= -1, h.faces[0].offset *= -1; });
  break3("3D: a loop is clockwise", [](Polytope<3>& h) { std::swap(h.loop[0], h.loop[1]); });
  break3("3D: a face lies a little inside", [](Polytope<3>& h) { h.faces[0].offset -= Real(1e-4); });
  break3("3D: an edge names the wrong face", [](Polytope<3>& h) { std::swap(h.edges[0].faceA, h.edges[0].faceB); });
  break3("3D: a vertex has another's neighbour", [](Polytope<3>& h) { std::swap(h.spokes.front(), h.spokes.back()); });
}

// A plate about `roundings` times the coordinates' rounding thick. The largest coordinate, which sets the rounding,
// lies between 0.8 and 1.7.
Points<3> drawPlate(std::uint64_t seed, Real roundings) {
  PlainDraw draw(seed);
  const Rot<3> q = drawRotation<3>(draw);
  Points<3> points;
  for (int n = 8 + draw.below(16); n > 0; --n) {
    points.push_back(
        q * Vec<3>(draw.signedUnit(), draw.signedUnit(), draw.signedUnit() * roundings * Real(kHullRounding) / 2));
  }
  return points;
}

// A merged point may lie on the other side of the plate.
TEST(Hull, PlatesHaveNoDents) {
  int dented = 0;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    const auto hull = hullOf<3>(drawPlate(seed, 200));
    EXPECT_EQ(hull->vertices.size() + hull->faces.size(), hull->edges.size() + 2);
    for (const auto& face : hull->faces) dented += isDented(*hull, face);
  }
  EXPECT_EQ(dented, 0);
}

// Qhull never returns for some of these plates.
TEST(Hull, ThinnerPlatesAreRefused) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    try {
      hullOf<3>(drawPlate(seed, 10));
      ADD_FAILURE() << seed;
    } catch (const UserError& e) {
      EXPECT_STREQ(e.what(), "convex hull: all points lie in one plane within rounding");
    }
  }
}

TEST(Hull, MergesCoplanarTriangles) {
  Points<3> cube;
  for (int bits = 0; bits < 27; ++bits) {  // a lattice: points inside, on faces and on edges
    cube.emplace_back(Real(bits % 3), Real(bits / 3 % 3), Real(bits / 9));
  }
  for (const Rot<3>& q : {Rot<3>{}, Rot<3>::vector(Vec<3>(Real(0.3), Real(-1), Real(0.7)))}) {
    for (const Real offset : {Real(0), Real(1000)}) {
      Points<3> moved;
      for (const Vec<3>& p : cube) moved.push_back(q * p + Vec<3>::Constant(offset));
      const auto hull = hullOf<3>(moved);
      EXPECT_EQ(hull->vertices.size(), 8u);
      EXPECT_EQ(hull->faces.size(), 6u);
      EXPECT_EQ(hull->edges.size(), 12u);
      EXPECT_EQ(wrong(moved, *hull), "");
    }
  }
}

TEST(Hull, FineCircleIsNotEatenUp) {
  // Dropping each vertex near the line of its neighbours would drop all of them, one after the other.
  Points<2> circle;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const Rot<2> q = Rot<2>::angle(6.283185307179586 * i / n);
    circle.emplace_back(q.c, q.s);
  }
  const auto hull = hullOf<2>(circle);
  EXPECT_EQ(wrong(hull->vertices, *hull), "");
  Real worst = 0;
  for (std::size_t i = 0; i < hull->vertices.size(); ++i) {
    const Real out = 1 - hull->normals[i].dot(hull->vertices[i]);
    worst = std::max(worst, out);
  }
  EXPECT_LT(worst, Real(1e-5));
}

template <int D>
void refuses(const Points<D>& points, const std::string& text) {
  try {
    hullOf<D>(points);
    ADD_FAILURE() << "accepted; expected: " << text;
  } catch (const UserError& e) {
    EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
  }
}

TEST(Hull, RefusesPointsWithoutVolume) {
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  refuses<2>({{0, 0}, {1, 0}}, "2 points given; valid: at least 3");
  refuses<3>({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, "3 points given; valid: at least 4");
  refuses<2>({{0, 0}, {1, nan}, {1, 1}}, "point 1 is not finite");
  refuses<2>({{1, 1}, {1, 1}, {1, 1}}, "the points span");
  refuses<2>({{0, 0}, {1, 1}, {2, 2}, {3, 3}}, "on one line");
  // Collinear except for the rounding of the coordinates (box2d #728, dyn4j #76).
  refuses<2>({{0, 0}, {Real(0.1), Real(0.3)}, {Real(0.2), Real(0.6)}, {Real(0.7), Real(2.1)}}, "on one line");
  refuses<3>({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, "on one line");
  refuses<3>({{0, 0, 1}, {1, 0, 1}, {2, 5, 1}, {3, 1, 1}}, "in one plane");
  // Range 1e45 (cannon): rejected as a double; a float cannot hold it.
  if (sizeof(Real) == 8) refuses<2>({{Real(-1e200), 0}, {Real(1e200), 0}, {0, Real(1e200)}}, "the points span");
}

// A hull filled in by the caller has vertices, edges and faces; derived data is computed when the shape is made.
TEST(Hull, HandMadeHullsGetTheirNeighbours) {
  const Hull<3> whole = hullOf<3>({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  Polytope<3> hand = *whole;
  hand.spokes.clear(), hand.firstSpoke.clear();
  const Shape<3> made = Shape<3>::polytope(std::make_shared<const Polytope<3>>(hand));
  EXPECT_EQ(made.view().hull->firstSpoke, whole->firstSpoke);
  EXPECT_EQ(made.view().hull->slack, whole->slack);
  hand.edges[0].v0 = 4;
  EXPECT_THROW(Shape<3>::polytope(std::make_shared<const Polytope<3>>(hand)), UserError);
}

TEST(Hull, SmallAndFar) {
  const Real far = sizeof(Real) == 8 ? Real(1e6) : Real(1e3), size = sizeof(Real) == 8 ? Real(1e-3) : Real(0.1);
  Points<3> points;
  for (int bits = 0; bits < 8; ++bits) {
    points.emplace_back(far + Real(bits & 1) * size, far + Real(bits >> 1 & 1) * size, far + Real(bits >> 2) * size);
  }
  const auto hull = hullOf<3>(points);
  EXPECT_EQ(hull->faces.size(), 6u);
  EXPECT_EQ(wrong(points, *hull), "");
  refuses<3>({{far, far, far},
              {far * (1 + 2 * kEps), far, far},
              {far, far * (1 + 2 * kEps), far},
              {far, far, far * (1 + 2 * kEps)}},
             "within rounding");
}

TEST(Hull, ManyPoints) {
  PlainDraw draw(5);
  Points<3> points;
  for (int i = 0; i < 1000; ++i) {
    const Vec<3> p = drawVector<3>(draw);
    points.push_back(p / std::max(p.norm(), Real(1e-3)));
  }
  const auto hull = hullOf<3>(points);
  EXPECT_EQ(wrong(points, *hull), "");
  EXPECT_GE(hull->vertices.size(), 900u);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::polytope_test
