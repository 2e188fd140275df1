// SPDX-License-Identifier: Zlib
#include "framework/shape/shape.h"

#include <gtest/gtest.h>

#include "framework/math/check.h"
#include "framework/shape/support_map.h"
#include "framework/stage/stage_broadphase.h"
#include "oracles/referee/referee.h"
#include "tests/check_property.h"
#include "tests/direction_search.h"
#include "tests/generators.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace shape_test { namespace {

template <int D>
Real support(const Shape<D>& s, const Pose<D>& X, const Vec<D>& d) {
  return X.p.dot(d) + supportValue(s.view(), Vec<D>(X.q.inverse() * d));
}
template <int D>
Vec<D> supportPoint(const Shape<D>& s, const Pose<D>& X, const Vec<D>& d) {
  return X * coreSupport(s.view(), Vec<D>(X.q.inverse() * d)) + s.view().radius * d;
}

// Proofs that share no code with the tested functions. Inside: a mean of points of the shape, pulled inwards by a
// millionth.
template <int D>
Vec<D> provenInside(const Shape<D>& s, const Pose<D>& X) {
  RapidCheckDraw draw;
  Vec<D> p = supportPoint(s, X, drawDirection<D>(draw)), middle = Vec<D>::Zero();
  if (s.view().hull) {
    for (const Vec<D>& v : s.view().hull->vertices) middle += v / Real(s.view().hull->vertices.size());
  }
  middle = X * middle;
  for (int i = 0; i < 2; ++i) p += draw.real(0, 1) * (supportPoint(s, X, drawDirection<D>(draw)) - p);
  const Real inwards = Real(1e-6) + 64 * kEps * (1 + X.p.norm() / sizeOf(s));
  return p + inwards * (middle - p);
}
// Outside: beyond a supporting plane, anywhere over it.
template <int D>
Vec<D> provenOutside(const Shape<D>& s, const Pose<D>& X) {
  RapidCheckDraw draw;
  const Vec<D> n = drawDirection<D>(draw);
  const Real gap = sizeOf(s) * draw.pick({Real(0.1), Real(0.001), Real(1e-5), Real(1)}) + 64 * kEps * (1 + X.p.norm());
  const Vec<D> aside = sizeOf(s) * draw.pick({Real(0), Real(0.1), Real(1)}) * drawVector<D>(draw);
  return supportPoint(s, X, n) + gap * n + (aside - aside.dot(n) * n);
}

// A float cannot resolve a millimetre at a distance of three metres.
template <int D>
Gen<Pose<D>> placesOf(const Shape<D>& s) {
  return poses<D>(sizeof(Real) == 8 ? Real(3) : 3 * sizeOf(s));
}

TEST(Shape, RefusesBadSizes) {
  const Real inf = std::numeric_limits<Real>::infinity(), nan = std::numeric_limits<Real>::quiet_NaN();
  for (const Real bad : {Real(-1), inf, nan}) {
    EXPECT_THROW(Shape<2>::sphere(bad), UserError);
    EXPECT_THROW(Shape<3>::box(Vec<3>(1, bad, 1)), UserError);
    EXPECT_THROW(Shape<3>::box(Vec<3>(1, 1, 1), bad), UserError);
    EXPECT_THROW(Shape<3>::capsule(bad, 1), UserError);
    EXPECT_THROW(Shape<3>::capsule(1, bad), UserError);
    EXPECT_THROW(Shape<2>::segment(bad), UserError);
  }
  EXPECT_THROW(Shape<2>::box(Vec<2>(1, 0)), UserError);
  EXPECT_THROW(Shape<2>::capsule(1, 0), UserError);
  EXPECT_THROW(Shape<2>::segment(0), UserError);
  EXPECT_THROW(Shape<3>::segment(1), UserError);
  EXPECT_THROW(Shape<3>::polytope(std::shared_ptr<const Polytope<3>>()), UserError);
  EXPECT_NO_THROW(Shape<2>::sphere(0));
  try {
    Shape<2>::sphere(-1);
  } catch (const UserError& e) {
    EXPECT_NE(std::string(e.what()).find("sphere: radius is -1"), std::string::npos) << e.what();
  }
}

TEST(Shape, Names) {
  for (int k = 0; k < kShapeKinds; ++k) {
    EXPECT_EQ(shapeKindFromName(shapeKindName(static_cast<ShapeKind>(k))), static_cast<ShapeKind>(k));
  }
  try {
    shapeKindFromName("prism");
    FAIL();
  } catch (const UserError& e) {
    EXPECT_STREQ(e.what(),
                 "unknown shape 'prism'; valid: sphere, capsule, segment, box, polytope, cylinder, "
                 "ellipsoid, plane, cone, triangle, custom");
  }
}

TEST(Shape, CopiesShareTheHull) {
  const std::vector<Vec<2>> points = {{0, 0}, {2, 0}, {0, 1}};
  Shape<2> copy = Shape<2>::sphere(1);
  {
    const auto original = Shape<2>::polytope(points);
    copy = original;
  }
  EXPECT_EQ(copy.view().hull->vertices.size(), 3u);
}

// --- bounding box and radius ----------------------------------------------------------------------------------------

template <int D, class Box>
void boxIsTight(Box boxOf) {
  const Shape<D> s = *shapes<D>();
  const auto X = *placesOf<D>(s);
  const Aabb<D> box = boxOf(s.view(), X);
  const Real tolerance = 16 * kEps * (sizeOf(s) + X.p.norm());
  for (int k = 0; k < D; ++k) {
    RC_ASSERT(std::abs(box.hi[k] - support(s, X, Vec<D>(Vec<D>::Unit(k)))) <= tolerance);
    RC_ASSERT(std::abs(box.lo[k] + support(s, X, Vec<D>(-Vec<D>::Unit(k)))) <= tolerance);
  }
}
template <int D>
void boxes() {
  check(
      "box is tight", [] { boxIsTight<D>([](auto& s, auto& X) { return boundingBox(s, X); }); }, 300);
  expectFalsified("box of the ball around it", [] {
    boxIsTight<D>([](const ShapeView<D>& s, const Pose<D>& X) { return Aabb<D>{X.p, X.p}.grown(boundingRadius(s)); });
  });
  check("radius", [] {
    const Shape<D> s = *shapes<D>();
    const Real r = boundingRadius(s.view());
    const Real widest = maxOverDirections<D>([&](const Vec<D>& d) { return supportValue(s.view(), d); });
    RC_ASSERT(widest <= r * (1 + 8 * kEps));
    RC_ASSERT(widest >= Real(0.9) * r);
    RC_ASSERT(s.reach() == r);
  });
}
TEST(Shape, BoundingBox) { boxes<2>(), boxes<3>(); }

template <int D>
void measures() {
  const Shape<D> box = Shape<D>::box(Vec<D>::Constant(Real(0.5))), ball = Shape<D>::sphere(Real(0.25));
  const Pose<D> aside{Vec<D>(2 * Vec<D>::Unit(0)), {}};
  const std::vector<ShapePart<D>> flat = {{box, {}}, {box, aside}}, round = {{box, {}}, {ball, aside}};
  EXPECT_TRUE(box.flat() && Shape<D>::plane().flat() && Shape<D>::compound(flat).flat());
  EXPECT_FALSE(ball.flat() || Shape<D>::box(Vec<D>::Constant(1), Real(0.1)).flat() || Shape<D>::compound(round).flat());
  EXPECT_EQ(Shape<D>::compound(flat).reach(), 2 + box.reach());
  EXPECT_EQ(Shape<D>::compound(round).reach(), Real(2.25));
}
TEST(Shape, ReachAndFlatnessAreThoseOfAllParts) { measures<2>(), measures<3>(); }

// --- points ---------------------------------------------------------------------------------------------------------

template <int D, class Contains>
void pointsAgree(Contains contains) {
  const Shape<D> s = *shapes<D>();
  const auto X = *placesOf<D>(s);
  if (s.kind() != ShapeKind::segment) RC_ASSERT(contains(s.view(), X, provenInside(s, X)));  // a segment has no inside
  RC_ASSERT(!contains(s.view(), X, provenOutside(s, X)));
}
template <int D>
void points() {
  check(
      "contains point", [] { pointsAgree<D>([](auto& s, auto& X, const auto& p) { return containsPoint(s, X, p); }); },
      400);
  expectFalsified(
      "corners are not rounded",
      [] {
        pointsAgree<D>([](const ShapeView<D>& s, const Pose<D>& X, const Vec<D>& p) {
          if (s.kind != ShapeKind::box) return containsPoint(s, X, p);
          const Vec<D> local = X.inverse() * p;
          return (local.cwiseAbs().array() <= s.half.array() + s.radius).all();
        });
      },
      400);
}
TEST(Shape, ContainsPoint) { points<2>(), points<3>(); }

TEST(Shape, ClosedAtTheSurface) {
  const Pose<3> X;
  const auto box = Shape<3>::box(Vec<3>(1, 2, 3));
  EXPECT_TRUE(containsPoint(box.view(), X, Vec<3>(1, 2, 3)));
  EXPECT_FALSE(containsPoint(box.view(), X, Vec<3>(1 + 2 * kEps, 2, 3)));
  EXPECT_TRUE(containsPoint(Shape<3>::sphere(2).view(), X, Vec<3>(0, -2, 0)));
  EXPECT_TRUE(containsPoint(Shape<3>::sphere(0).view(), X, Vec<3>(0, 0, 0)));
  const auto segment = Shape<2>::segment(1);
  EXPECT_TRUE(containsPoint(segment.view(), Pose<2>{}, Vec<2>(-1, 0)));
  EXPECT_FALSE(containsPoint(segment.view(), Pose<2>{}, Vec<2>(0, Real(1e-9))));
  const std::vector<Vec<2>> triangle = {{0, 0}, {4, 0}, {0, 3}};
  EXPECT_TRUE(containsPoint(Shape<2>::polytope(triangle).view(), Pose<2>{}, Vec<2>(2, 0)));
  EXPECT_TRUE(overlapsBox(box.view(), X, {Vec<3>(1, 2, 3), Vec<3>(9, 9, 9)}));
  EXPECT_FALSE(overlapsBox(box.view(), X, {Vec<3>(1 + 2 * kEps, 2, 3), Vec<3>(9, 9, 9)}));
}

// --- boxes ----------------------------------------------------------------------------------------------------------

template <int D, class Overlaps>
void boxesAgree(Overlaps overlaps) {
  const Shape<D> s = *shapes<D>();
  const auto X = *placesOf<D>(s);
  RapidCheckDraw draw;
  Vec<D> half, shift;
  for (int k = 0; k < D; ++k) {
    half[k] = sizeOf(s) * draw.real(0, 1) * draw.pick({Real(1), Real(0.01), Real(100)});
    shift[k] = half[k] * draw.signedUnit();
  }
  // A box around an inner point, and a box with its nearest corner, edge or face beyond a supporting plane.
  const Vec<D> in = provenInside(s, X) + shift;
  const Real room = 8 * kEps * (in.norm() + half.norm());
  if (s.kind() != ShapeKind::segment) {
    RC_ASSERT(overlaps(s.view(), X, Aabb<D>{Vec<D>(in - half), Vec<D>(in + half)}.grown(room)));
  }
  const Vec<D> n = drawDirection<D>(draw);
  const Real gap = sizeOf(s) * draw.pick({Real(0.1), Real(0.001), Real(1e-5), Real(1)}) + 100 * room;
  Vec<D> out = supportPoint(s, X, n) + gap * n;
  for (int k = 0; k < D; ++k) out[k] += n[k] > 0 ? half[k] : n[k] < 0 ? -half[k] : shift[k];
  RC_ASSERT(!overlaps(s.view(), X, Aabb<D>{Vec<D>(out - half), Vec<D>(out + half)}));
}
template <int D>
void boxOverlaps() {
  check(
      "overlaps box", [] { boxesAgree<D>([](auto& s, auto& X, const auto& b) { return overlapsBox(s, X, b); }); }, 300);
  expectFalsified("by bounding boxes",
                  [] { boxesAgree<D>([](auto& s, auto& X, const auto& b) { return boundingBox(s, X).overlaps(b); }); });
  expectFalsified("when a corner of the box is inside", [] {
    boxesAgree<D>([](const ShapeView<D>& s, const Pose<D>& X, const Aabb<D>& b) {
      for (int bits = 0; bits < 1 << D; ++bits) {
        Vec<D> p;
        for (int k = 0; k < D; ++k) p[k] = (bits >> k) & 1 ? b.hi[k] : b.lo[k];
        if (containsPoint(s, X, p)) return true;
      }
      return false;
    });
  });
}
TEST(Shape, OverlapsBox2) { boxOverlaps<2>(); }
TEST(Shape, OverlapsBox3) { boxOverlaps<3>(); }

TEST(Shape, OverlapsUnboundedBox) {
  const Real inf = std::numeric_limits<Real>::infinity();
  const auto s = Shape<3>::capsule(1, Real(0.5));
  EXPECT_TRUE(overlapsBox(s.view(), Pose<3>{}, {Vec<3>(-inf, -inf, -inf), Vec<3>(inf, inf, inf)}));
  EXPECT_TRUE(overlapsBox(s.view(), Pose<3>{}, {Vec<3>(-inf, -inf, -inf), Vec<3>(inf, Real(-0.4), inf)}));
  EXPECT_FALSE(overlapsBox(s.view(), Pose<3>{}, {Vec<3>(-inf, -inf, -inf), Vec<3>(inf, Real(-0.6), inf)}));
  EXPECT_FALSE(overlapsBox(s.view(), Pose<3>{}, Aabb<3>{}));
}

// --- rays -----------------------------------------------------------------------------------------------------------

template <int D, class Cast>
void raysAgree(Cast cast) {
  const Shape<D> s = *shapes<D>();
  const auto X = *placesOf<D>(s);
  RapidCheckDraw draw;
  const Vec<D> p = provenOutside(s, X);
  const bool aimed = draw.coin() && s.kind() != ShapeKind::segment;
  const Vec<D> d = (aimed ? provenInside(s, X) : provenOutside(s, X)) - p;
  const Real t = cast(s.view(), X, p, d, Real(10));
  if (aimed) RC_ASSERT(t >= 0 && t <= 1);
  if (t >= 0) {
    // The entry lies on the surface: never outside, except for rounding of the point itself.
    const Vec<D> entry = p + t * d;
    const Real rounding = 200 * kEps * (sizeOf(s) + X.p.norm() + p.norm() + d.norm());
    for (int i = 0; i < 20; ++i) {
      const Vec<D> n = drawDirection<D>(draw);
      RC_ASSERT(entry.dot(n) - support(s, X, n) <= rounding);
    }
    RC_ASSERT(cast(s.view(), X, p, d, t * Real(0.999)) < 0);  // too short
  }
  // The ray enters nothing earlier: the referee finds no earlier point deeper inside than rounding. containsPoint
  // cannot decide this, because of the point's own rounding where a ray grazes the surface.
  const Real end = t >= 0 ? t * (1 - Real(1e-4)) : Real(10);
  for (int i = 0; i <= 40; ++i) {
    Pose<D> X_WP;
    X_WP.p = p + (end * Real(i) / 40) * d;
    const Real reach = sizeOf(s) + X.p.norm() + X_WP.p.norm() + p.norm();
    RC_ASSERT(referee(s.view(), X, Shape<D>::sphere(0).view(), X_WP).hi >= -double(200 * kEps * reach));
  }
}
template <int D>
void rays() {
  check(
      "cast ray",
      [] { raysAgree<D>([](auto& s, auto& X, auto& p, auto& d, Real t) { return rayEntry(s, X, p, d, t).t; }); }, 300);
  expectFalsified("against the bounding box", [] {
    raysAgree<D>([](auto& s, auto& X, auto& p, auto& d, Real t) { return castRay(boundingBox(s, X), p, d, t); });
  });
  expectFalsified("without the rounded edges", [] {
    raysAgree<D>([](const ShapeView<D>& s, const Pose<D>& X, const Vec<D>& p, const Vec<D>& d, Real t) {
      ShapeView<D> core = s;
      if (core.kind == ShapeKind::box || core.hull) core.radius = 0;
      return rayEntry(core, X, p, d, t).t;
    });
  });
}
TEST(Shape, CastRay2) { rays<2>(); }
TEST(Shape, CastRay3) { rays<3>(); }

TEST(Shape, RayAnswersInClosedForm) {
  const Pose<3> X;
  const Vec<3> z(0, 0, 1);
  EXPECT_EQ(rayEntry(Shape<3>::sphere(1).view(), X, Vec<3>(0, 0, -3), z, Real(10)).t, 2);
  EXPECT_EQ(rayEntry(Shape<3>::sphere(1).view(), X, Vec<3>(0, 0, -3), z, Real(1.9)).t, -1) << "too short";
  EXPECT_EQ(rayEntry(Shape<3>::sphere(1).view(), X, Vec<3>(0, 0, 3), z, Real(10)).t, -1) << "behind";
  EXPECT_EQ(rayEntry(Shape<3>::sphere(1).view(), X, Vec<3>(0, 0, Real(0.5)), z, Real(10)).t, 0) << "inside";
  EXPECT_EQ(rayEntry(Shape<3>::sphere(1).view(), X, Vec<3>(0, 0, 3), Vec<3>(0, 0, 0), Real(10)).t, -1)
      << "no direction";
  EXPECT_EQ(rayEntry(Shape<3>::box(Vec<3>(1, 1, 1), 1).view(), X, Vec<3>(0, 0, -4), z, Real(10)).t, 2);
  EXPECT_EQ(rayEntry(Shape<3>::capsule(2, 1).view(), X, Vec<3>(-5, 0, 0), Vec<3>(2, 0, 0), Real(10)).t, 1);
  EXPECT_EQ(rayEntry(Shape<3>::capsule(2, 1).view(), X, Vec<3>(1, 0, -4), z, Real(10)).t, 3);
  EXPECT_EQ(rayEntry(Shape<3>::box(Vec<3>(1, 1, 1)).view(), X, Vec<3>(1, 1, -4), z, Real(10)).t, 3) << "along an edge";
  const Pose<2> I;
  const auto segment = Shape<2>::segment(1);
  EXPECT_EQ(rayEntry(segment.view(), I, Vec<2>(0, 2), Vec<2>(0, -1), Real(10)).t, 2);
  EXPECT_EQ(rayEntry(segment.view(), I, Vec<2>(-3, 0), Vec<2>(1, 0), Real(10)).t, 2) << "along itself";
  EXPECT_EQ(rayEntry(segment.view(), I, Vec<2>(-3, 1), Vec<2>(1, 0), Real(10)).t, -1);
  // A small ball far away: the textbook discriminant reports a miss or is wrong by the ball's radius.
  const double far = sizeof(Real) == 8 ? 1e6 : 1e2, radius = sizeof(Real) == 8 ? 1e-3 : 1e-1;
  const Real t =
      rayEntry(Shape<3>::sphere(Real(radius)).view(), X, Vec<3>(0, Real(radius / 2), Real(-far)), z, Real(1e9)).t;
  EXPECT_NEAR(double(t), far - radius * std::sqrt(0.75), 4 * double(kEps) * far);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::shape_test
