// SPDX-License-Identifier: Zlib
// Where rays enter shapes, with which normal, and which bodies they hit in a world.
#include <gtest/gtest.h>

#include "framework/shape/support_map.h"
#include "tests/check_property.h"
#include "tests/generators.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace ray_test { namespace {

constexpr Real kInfinite = std::numeric_limits<Real>::infinity();
constexpr Real kNotANumber = std::numeric_limits<Real>::quiet_NaN();

// --- the normal -----------------------------------------------------------------------------------------------------

// A normal is valid at a point of a convex shape's surface if the whole shape lies behind the plane through the point.
// Support functions check it; they share no code with rays.
template <int D, class Enter>
void normalsSupport(Enter enter) {
  const Shape<D> s = *shapes<D>();
  const auto X = *poses<D>(sizeof(Real) == 8 ? Real(3) : 3 * sizeOf(s));
  RapidCheckDraw draw;
  const Real size = sizeOf(s);
  const Vec<D> from = X.p + size * (2 * drawDirection<D>(draw) + drawVector<D>(draw));
  const Vec<D> aim = X.p + size * draw.pick({Real(0), Real(0.2), Real(0.9)}) * drawVector<D>(draw);
  const Vec<D> d = aim - from;
  const RayEntry<D> entry = enter(s.view(), X, from, d);
  if (entry.t < 0) RC_ASSERT(entry.normal.isZero(0));
  if (containsPoint(s.view(), X, from)) {
    RC_ASSERT(entry.t == 0 && entry.normal.isZero(0));
  } else if (entry.t >= 0) {
    const Vec<D>& n = entry.normal;
    RC_ASSERT(std::abs(n.norm() - 1) <= 8 * kEps);
    RC_ASSERT(n.dot(d) <= 64 * kEps * d.norm());
    const Vec<D> at = from + entry.t * d;
    const Real beyond = X.p.dot(n) + supportValue(s.view(), Vec<D>(X.q.inverse() * n)) - at.dot(n);
    RC_ASSERT(beyond <= 400 * kEps * (size + X.p.norm() + from.norm() + d.norm()));
  }
}
template <int D>
void normals() {
  const auto right = [](const ShapeView<D>& s, const Pose<D>& X, const Vec<D>& p, const Vec<D>& d) {
    return rayEntry(s, X, p, d, Real(10));
  };
  check(
      "normal of entry", [&] { normalsSupport<D>(right); }, 300);
  expectFalsified("the way back", [&] {
    normalsSupport<D>([&](const ShapeView<D>& s, const Pose<D>& X, const Vec<D>& p, const Vec<D>& d) {
      RayEntry<D> e = right(s, X, p, d);
      if (e.normal.any()) e.normal = -d.normalized();
      return e;
    });
  });
  expectFalsified("inwards", [&] {
    normalsSupport<D>([&](const ShapeView<D>& s, const Pose<D>& X, const Vec<D>& p, const Vec<D>& d) {
      RayEntry<D> e = right(s, X, p, d);
      e.normal = -e.normal;
      return e;
    });
  });
  expectFalsified("in the shape's frame", [&] {
    normalsSupport<D>([&](const ShapeView<D>& s, const Pose<D>& X, const Vec<D>& p, const Vec<D>& d) {
      RayEntry<D> e = right(s, X, p, d);
      e.normal = X.q.inverse() * e.normal;
      return e;
    });
  });
}
TEST(Ray, NormalsSupportTheShape2) { normals<2>(); }
TEST(Ray, NormalsSupportTheShape3) { normals<3>(); }

template <int D>
void enters(const Shape<D>& shape, const Vec<D>& p, const Vec<D>& d, double t, const Vec<D>& n, const char* what) {
  const RayEntry<D> entry = rayEntry(shape.view(), Pose<D>{}, p, d, Real(100));
  EXPECT_NEAR(double(entry.t), t, 16 * double(kEps)) << what << D;
  EXPECT_LE((entry.normal - n).norm(), 16 * kEps) << what << D << ": " << entry.normal.transpose();
}

template <int D>
void knownNormals() {
  const Vec<D> x = Vec<D>::Unit(0), y = Vec<D>::Unit(1), none = Vec<D>::Zero();
  const Real half = Real(0.5), diagonal = std::sqrt(half);
  const Vec<D> cube = Vec<D>::Constant(1);
  enters<D>(Shape<D>::sphere(1), -3 * x, x, 2, -x, "ball");
  enters<D>(Shape<D>::sphere(1), diagonal * y - 3 * x, x, 3 - std::sqrt(0.5), diagonal * (y - x), "ball at 45 degrees");
  enters<D>(Shape<D>::sphere(1), y / 2, x, 0, none, "from inside");
  enters<D>(Shape<D>::sphere(1), 3 * x, x, -1, none, "away");
  enters<D>(Shape<D>::box(cube), 4 * y + x / 2, -2 * y, 1.5, y, "box");
  enters<D>(Shape<D>::box(cube), 3 * y - 2 * x, x - y, 2, y, "box, obliquely");
  enters<D>(Shape<D>::box(cube, half), 4 * y, -y, 2.5, y, "rounded box");
  enters<D>(Shape<D>::box(cube, half), 3 * (x + y), -(x + y), 2 - std::sqrt(0.125), diagonal * (x + y), "its edge");
  enters<D>(Shape<D>::capsule(1, half), 4 * y + x / 2, -y, 3.5, y, "capsule's side");
  enters<D>(Shape<D>::capsule(1, half), 4 * x, -x, 2.5, x, "capsule's end");
  enters<D>(Shape<D>::plane(), 2 * y, x - y, 2, y, "plane");
  const std::vector<Real> sizes = D == 2 ? std::vector<Real>{2, 1} : std::vector<Real>{2, 1, 1};
  const auto ellipsoid = Shape<D>::curved(ShapeKind::ellipsoid, sizes);
  const RayEntry<D> top = rayEntry(ellipsoid.view(), Pose<D>{}, Vec<D>(4 * y), Vec<D>(-y), Real(100));
  EXPECT_NEAR(double(top.t), 3, 1e4 * double(kEps));
  EXPECT_LE((top.normal - y).norm(), std::sqrt(kEps));
}
TEST(Ray, NormalsInClosedForm) {
  knownNormals<2>(), knownNormals<3>();
  const Vec<2> up(0, 1), left(-1, 0);
  enters<2>(Shape<2>::segment(1), Vec<2>(0, 2), Vec<2>(0, -1), 2, up, "segment from above");
  enters<2>(Shape<2>::segment(1), Vec<2>(0, -2), Vec<2>(0, 1), 2, -up, "segment from below");
  enters<2>(Shape<2>::segment(1), Vec<2>(-3, 0), Vec<2>(1, 0), 2, left, "segment along itself");
  const std::vector<Vec<2>> corners = {{0, 0}, {2, 0}, {0, 2}};
  const Vec<2> slope = Vec<2>(1, 1).normalized();
  enters<2>(Shape<2>::polytope(corners), Vec<2>(2, 2), Vec<2>(-1, -1), 1, slope, "triangle");
  enters<2>(Shape<2>::polytope(corners, std::sqrt(Real(0.5))), Vec<2>(2, 2), Vec<2>(-1, -1), 0.5, slope, "rounded one");
  const std::vector<Vec<3>> tetrahedron = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}};
  enters<3>(Shape<3>::polytope(tetrahedron), Vec<3>(2, 2, 2), Vec<3>(-1, -1, -1), 1, Vec<3>(1, 1, 1).normalized(),
            "3D");
}

// A point of a surface and the normal there: a ray that comes from the outer side enters at that point, from any
// distance. No ray is solved for; the point of the surface is chosen first. `bend`: largest curvature there (1/m).
template <int D>
void entersAt(const Shape<D>& shape, const Vec<D>& at, const Vec<D>& n, Real bend, Draw& draw) {
  Vec<D> d = drawDirection<D>(draw);
  if (d.dot(n) > 0) d = -d;
  if (d.dot(n) > Real(-0.1)) d = -n;
  const Real far = std::pow(Real(10), draw.real(-2, sizeof(Real) == 8 ? 6 : 1)),
             speed = draw.pick({Real(1), Real(1000)});
  const RayEntry<D> entry = rayEntry(shape.view(), Pose<D>{}, Vec<D>(at - far * d), Vec<D>(speed * d), kInfinite);
  const Real slip = 64 * kEps * (far + boundingRadius(shape.view())) / -d.dot(n);
  ASSERT_NEAR(double(entry.t * speed), double(far), double(slip)) << shapeKindName(shape.kind()) << D;
  ASSERT_LE((entry.normal - n).norm(), 64 * kEps + slip * bend)
      << shapeKindName(shape.kind()) << D << ", from " << far << " m along " << d.transpose();
}
void entersBodiesOfRevolution(Draw& draw) {
  const Real h = draw.real(0.2, 3), r = draw.real(0.2, 3), round = draw.pick({Real(0), Real(0.3)});
  const std::vector<Real> sizes = {h, r};
  const Real turn = draw.real(0, 6.28), slope = std::hypot(2 * h, r);
  const auto around = [&](Real x, Real out) { return Vec<3>(x, out * std::cos(turn), out * std::sin(turn)); };
  const auto enters = [&](ShapeKind kind, const Vec<3>& on, const Vec<3>& n, Real bend) {
    entersAt<3>(Shape<3>::curved(kind, sizes, round), Vec<3>(on + round * n), n, bend, draw);
  };
  const Real share = draw.real(0.01, 0.99), lean = draw.real(0, 1.57);
  enters(ShapeKind::cylinder, around(h * (2 * share - 1), r), around(0, 1), 1 / r);
  enters(ShapeKind::cylinder, around(h, r * share), Vec<3>(1, 0, 0), 0);
  enters(ShapeKind::cone, around(h - 2 * h * share, r * share), around(r, 2 * h) / slope, 1 / (r * share));
  enters(ShapeKind::cone, around(-h, r * share), Vec<3>(-1, 0, 0), 0);
  if (!(round > 0)) return;  // on a sharp rim or tip any normal between those of the faces is right
  const Real tip = std::atan2(r, 2 * h) + lean * (1 - std::atan2(r, 2 * h) / Real(1.5708));
  enters(ShapeKind::cylinder, around(-h, r), around(-std::sin(lean), std::cos(lean)), 1 / round + 1 / r);
  enters(ShapeKind::cone, around(-h, r), around(-std::sin(lean), std::cos(lean)), 1 / round + 1 / r);
  enters(ShapeKind::cone, Vec<3>(h, 0, 0), around(std::sin(tip), std::cos(tip)), 1 / round);
}
template <int D>
void entersEllipsoids(Draw& draw) {
  const Vec<D> half = drawHalf<D>(draw), on = drawDirection<D>(draw), n = on.cwiseQuotient(half).normalized();
  const Real round = draw.pick({Real(0), Real(0.3)}), least = half.minCoeff();
  const std::vector<Real> sizes(half.data(), half.data() + D);
  entersAt<D>(Shape<D>::curved(ShapeKind::ellipsoid, sizes, round), Vec<D>(on.cwiseProduct(half) + round * n), n,
              half.maxCoeff() / (least * least), draw);
}
TEST(Ray, EntersCurvedKindsAtTheirSurfaceWithItsNormal) {
  PlainDraw draw(39);
  for (int i = 0; i < 300 && !testing::Test::HasFatalFailure(); ++i) {
    entersBodiesOfRevolution(draw), entersEllipsoids<2>(draw), entersEllipsoids<3>(draw);
  }
}
TEST(Ray, CurvedKindsAlongTheirAxesAndEdges) {
  const std::vector<Real> sizes = {1, Real(0.5)};
  const auto cylinder = Shape<3>::curved(ShapeKind::cylinder, sizes), cone = Shape<3>::curved(ShapeKind::cone, sizes);
  const Vec<3> x(1, 0, 0), y(0, 1, 0), side = Vec<3>(1, 4, 0).normalized(), none(0, 0, 0);
  enters<3>(cylinder, 3 * y + Real(0.3) * x, -y, 2.5, y, "cylinder, from above");
  enters<3>(cylinder, 3 * x, -x, 2, x, "cylinder, along its axis");
  enters<3>(cylinder, 3 * x + y / 2, -x, 2, x, "cylinder, along a line of its side");
  enters<3>(cylinder, 3 * y + x, -y, 2.5, y, "cylinder, in the plane of its end");
  enters<3>(cylinder, 3 * y + Real(1.001) * x, -y, -1, none, "cylinder, past its end");
  enters<3>(cylinder, Vec<3>(-3, 0, Real(0.5001)), x, -1, none, "cylinder, past its side");
  enters<3>(cylinder, Vec<3>(-3, 0, Real(0.4999)), x, 2, -x, "cylinder, inside its side");
  enters<3>(cylinder, Vec<3>(0, Real(0.2), 0), y, 0, none, "cylinder, from inside");
  enters<3>(cone, 3 * y, -y, 2.75, side, "cone, from above");
  enters<3>(cone, 3 * x, -x, 2, x, "cone, onto its tip along its axis");
  enters<3>(cone, x - 3 * y, y, 3, Vec<3>(1, -4, 0).normalized(), "cone, onto its tip from the side");
  enters<3>(cone, x + Vec<3>(3, -3, 0), Vec<3>(-1, 1, 0), 3, Vec<3>(1, -1, 0).normalized(), "cone, onto its tip");
  enters<3>(cone, -3 * x, x, 2, -x, "cone, along its axis");
  enters<3>(cone, -3 * x + y / 4, x, 2, -x, "cone, onto its base");
  enters<3>(cone, 3 * x + y / 4, -x, 3, side, "cone, onto its side along its axis");
  enters<3>(cone, 3 * x - y / 2, Vec<3>(-4, 1, 0), 0.5, Vec<3>(4, -1, 0).normalized(),
            "cone, along a line of its side");
  enters<3>(cone, Vec<3>(1, 3, 0), -y + Real(1e-3) * x, -1, none, "cone, past its tip");
}

// A ray of infinite length misses what a finite ray misses.
template <int D>
void missedForEver() {
  const Vec<D> up = Vec<D>::Unit(1), far = Vec<D>(5 * Vec<D>::Ones());
  const std::vector<Real> sizes(D, Real(1));
  for (const Shape<D>& shape :
       {Shape<D>::sphere(1), Shape<D>::box(Vec<D>::Ones()), Shape<D>::box(Vec<D>::Ones(), Real(0.5)),
        Shape<D>::capsule(1, 1), Shape<D>::plane(), Shape<D>::curved(ShapeKind::ellipsoid, sizes)}) {
    EXPECT_EQ(rayEntry(shape.view(), Pose<D>{}, far, up, kInfinite).t, -1) << static_cast<int>(shape.kind()) << D;
    EXPECT_EQ(rayEntry(shape.view(), Pose<D>{}, far, Vec<D>(Vec<D>::Unit(0)), kInfinite).t, -1) << D;
  }
  World<D> world;
  world.add(body<D>(Shape<D>::sphere(1), at<D>(0, 0)));
  EXPECT_TRUE(world.rayAll(at<D>(0, Real(1.9)), at<D>(1, -1), kInfinite).empty()) << "through its box, past it";
}
TEST(Ray, InfiniteRaysMissAsFiniteOnes) { missedForEver<2>(), missedForEver<3>(); }

// --- in a world -----------------------------------------------------------------------------------------------------

// Three balls in a row along x, of categories 1, 2 and 4. The last is rotated, so its frame differs from the world's.
template <int D>
std::array<BodyHandle, 3> threeBalls(World<D>& world) {
  std::array<BodyHandle, 3> out;
  for (std::size_t i = 0; i < 3; ++i) {
    BodyDef<D> def = body<D>(Shape<D>::sphere(1), at<D>(4.0 * static_cast<double>(i), 0));
    def.userData = 100 + i, def.shapes[0].userData = 200 + i, def.shapes[0].category = 1u << i;
    out[i] = world.add(def);
  }
  Rot<D> turned;
  if constexpr (D == 2) {
    turned = Rot<2>::angle(0.8);
  } else {
    turned = Rot<3>::vector(Vec<3>(Real(0.8), 0, Real(0.5)));
  }
  world.setPose(out[2], {at<D>(8, 0), turned});
  return out;
}
template <int D>
std::vector<std::uint64_t> metBy(const World<D>& world, const QueryFilter<D>& filter) {
  std::vector<std::uint64_t> out;
  for (const BodyRayHit<D>& hit : world.rayAll(at<D>(-5, 0), at<D>(1, 0), 100, filter)) out.push_back(hit.userData);
  return out;
}
template <int D>
void worldRays() {
  World<D> world;
  const auto balls = threeBalls(world);
  const auto hits = world.rayAll(at<D>(-5, 0), at<D>(2, 0), kInfinite);
  ASSERT_EQ(hits.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(hits[i].body, balls[i]);
    EXPECT_EQ(hits[i].shape, 0);
    EXPECT_EQ(hits[i].userData, 200 + i);
    EXPECT_EQ(world.userData(hits[i].body), 100 + i);
    EXPECT_NEAR(double(hits[i].t), 2 + 2 * double(i), 1e-5);
    EXPECT_LE((hits[i].normal - at<D>(-1, 0)).norm(), 1e-5);
  }
  using Met = std::vector<std::uint64_t>;
  EXPECT_EQ(metBy<D>(world, {}), (Met{200, 201, 202})) << "as a shape of category 1 that collides with all";
  EXPECT_EQ(metBy<D>(world, {.mask = 4u | 1u}), (Met{200, 202}));
  EXPECT_EQ(metBy<D>(world, {.mask = 0}), Met{});
  const auto notMyself = [&](BodyHandle h, const ShapeRecord<D>&) { return h != balls[0]; };
  EXPECT_EQ(metBy<D>(world, {.accepts = notMyself}), (Met{201, 202}));
  EXPECT_EQ(metBy<D>(world, {.mask = 3, .accepts = notMyself}), Met{201});
  const auto byData = [](BodyHandle, const ShapeRecord<D>& s) { return s.userData == 202; };
  const auto first = world.rayFirst(at<D>(-5, 0), at<D>(1, 0), 100, QueryFilter<D>{.accepts = byData});
  ASSERT_TRUE(first) << "the first of those who are meant";
  EXPECT_EQ(first->body, balls[2]);
  BodyDef<D> shy = body<D>(Shape<D>::sphere(1), at<D>(-3, 0));
  shy.shapes[0].mask = 2;
  world.add(shy);
  EXPECT_EQ(metBy<D>(world, {}).size(), 3u) << "it collides with category 2 only";
  EXPECT_EQ(metBy<D>(world, {.category = 2}).size(), 4u);
  EXPECT_EQ(world.rayAll(at<D>(-5, 0), at<D>(1, 0), 100).size(), 4u) << "without a filter every shape";
}
TEST(Ray, WorldRaysReturnNormalsAndUserDataAndFilter) { worldRays<2>(), worldRays<3>(); }

template <int D>
void refusedRays() {
  World<D> world;
  threeBalls(world);
  const auto refused = [&](const Vec<D>& p, const Vec<D>& d, Real maxT) {
    try {
      world.rayAll(p, d, maxT);
      return std::string();
    } catch (const UserError& e) {
      return std::string(e.what());
    }
  };
  const Vec<D> x = at<D>(1, 0);
  EXPECT_EQ(refused(kNotANumber * x, x, 1), "ray: its start or direction is not finite");
  EXPECT_EQ(refused(x, kInfinite * x, 1), "ray: its start or direction is not finite");
  EXPECT_EQ(refused(x, x, -1), "ray: maxT is -1.000000; valid: a number >= 0");
  EXPECT_TRUE(refused(x, x, kNotANumber).ends_with("; valid: a number >= 0"));
  for (const Real start : {Real(0), Real(2)}) {
    EXPECT_EQ(refused(at<D>(start, 0), at<D>(0, 0), 1),
              "ray: its direction is zero; valid: any other direction, of any length");
  }
}
TEST(Ray, InvalidRaysAreRefused) { refusedRays<2>(), refusedRays<3>(); }

// A ray in 2^e times the direction hits the same bodies, with the same normals, at 2^-e times the parameters.
template <int D>
void anyLength() {
  World<D> world(Pipeline::parse("contacts=query_clip"));  // for the ellipsoid
  threeBalls(world);
  world.add(body<D>(Shape<D>::capsule(1, Real(0.5)), at<D>(-3, 2)));
  world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5)), Real(0.1)), at<D>(3, -2)));
  world.add(body<D>(Shape<D>::curved(ShapeKind::ellipsoid, std::vector<Real>(D, Real(0.75))), at<D>(-3, -2)));
  constexpr int kMost = std::numeric_limits<Real>::max_exponent - 4;
  const auto times = [](const Vec<D>& v, int e) {
    return Vec<D>(v.unaryExpr([e](Real x) { return std::ldexp(x, e); }));
  };
  PlainDraw draw(3);
  int hits = 0;
  for (int i = 0; i < 120; ++i) {
    const Vec<D> p = 5 * drawDirection<D>(draw), d = 4 * drawVector<D>(draw) - p;
    const auto expected = world.rayAll(p, d, 2);
    hits += static_cast<int>(expected.size());
    for (const int e : {-kMost + 20, -kMost / 2, kMost / 2, kMost}) {
      const auto found = world.rayAll(p, times(d, e), std::ldexp(Real(2), -e));
      ASSERT_EQ(found.size(), expected.size()) << i << ": 2^" << e;
      for (std::size_t k = 0; k < found.size(); ++k) {
        EXPECT_EQ(found[k].body, expected[k].body);
        EXPECT_EQ(found[k].t, std::ldexp(expected[k].t, -e));
        EXPECT_EQ(found[k].normal, expected[k].normal);
      }
    }
  }
  EXPECT_GT(hits, 20);
}
TEST(Ray, ItsDirectionMayHaveAnyLength) { anyLength<2>(), anyLength<3>(); }

// In a compound, the part that the ray enters first gives the normal.
template <int D>
void compoundNormals() {
  World<D> world;
  const Vec<D> half = Vec<D>::Constant(Real(0.5));
  const std::vector<ShapePart<D>> parts = {{Shape<D>::sphere(1), {at<D>(0, -1), {}}}, {Shape<D>::box(half), {}}};
  BodyDef<D> def = body<D>(Shape<D>::compound(parts), at<D>(3, 0));
  def.shapes[0].userData = 7;
  world.add(def);
  const auto above = world.rayAll(at<D>(3.25, 5), at<D>(0, -1), 100);
  ASSERT_EQ(above.size(), 1u);
  EXPECT_EQ(above[0].userData, 7u);
  EXPECT_LE((above[0].normal - at<D>(0, 1)).norm(), 1e-6);
  const auto below = world.rayAll(at<D>(3, -5), at<D>(0, 1), 100);
  ASSERT_EQ(below.size(), 1u);
  EXPECT_LE((below[0].normal - at<D>(0, -1)).norm(), 1e-6);
}
TEST(Ray, TheFirstPartOfACompoundGivesTheNormal) { compoundNormals<2>(), compoundNormals<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::ray_test
