// SPDX-License-Identifier: Zlib
// Hulls far from the origin of their own frames, posed so that they are near each other. They are stored about their
// middles, so the error is relative to the scale of the posed shapes, whatever their frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "framework/math/random.h"
#include "framework/stage/stage_narrowphase.h"
#include "framework/world/world.h"
#include "oracles/referee/referee.h"
#include "tests/check_property.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace far_frames_test { namespace {

constexpr double kBound = sizeof(Real) == 8 ? 1e-13 : 1e-5;  // relative to the scale of the posed shapes

Rot<2> turned(const Ang<2>& v) { return Rot<2>::angle(v[0]); }
Rot<3> turned(const Ang<3>& v) { return Rot<3>::vector(v); }

template <int D>
class FarDrawer {
 public:
  explicit FarDrawer(std::uint64_t seed) : m_random(seed) {}

  Real uniform(double lo, double hi) { return static_cast<Real>(m_random.uniform(lo, hi)); }
  Vec<D> vector(double size) {
    Vec<D> v;
    for (Real& x : v) x = uniform(-size, size);
    return v;
  }
  /// A simplex and up to eight more points, about a metre wide.
  Shape<D> hull(const Vec<D>& away) {
    std::vector<Vec<D>> points(1, Vec<D>::Constant(Real(-0.5)));
    for (int k = 0; k < D; ++k) points.push_back(points[0]), points.back()[k] = Real(0.5);
    for (std::uint64_t n = m_random.below(9); n > 0; --n) points.push_back(vector(0.5));
    for (Vec<D>& p : points) p += away;
    return Shape<D>::polytope(std::span<const Vec<D>>(points), m_random.below(3) == 0 ? Real(0.1) : Real(0));
  }
  /// A shape with a point near its middle at `middle`: a hull far from its frame, or any other shape.
  ShapePart<D> part(bool far, const Vec<D>& middle) {
    Ang<D> v;
    for (Real& x : v) x = uniform(-2, 2);
    ShapePart<D> out;
    out.X_SP.q = turned(v);
    if (!far) {
      out.shape = m_random.below(2) ? Shape<D>::sphere(uniform(0.2, 1))
                                    : Shape<D>::box(Vec<D>(Vec<D>::Constant(uniform(0.2, 1))));
      out.X_SP.p = middle;
      return out;
    }
    Vec<D> away = vector(1);
    if (m_random.below(2)) away[0] = 0;  // along one axis, or two
    away *= static_cast<Real>(std::pow(10.0, m_random.uniform(1.5, 4))) / away.norm();
    out.shape = hull(away);
    out.X_SP.p = middle - out.X_SP.q * away;
    return out;
  }

 private:
  Random m_random;
};

template <int D>
struct FarPair {
  Shape<D> a, b;
  Pose<D> X_AB;
};

/// As bodies' parts are paired: both in one frame, here that of A's body.
template <int D>
FarPair<D> pairOf(const ShapePart<D>& a, const ShapePart<D>& b) {
  return {a.shape, b.shape, a.X_SP.inverse() * b.X_SP};
}

/// Relative to the scale of the posed shapes: error of the distance, or of the separation along the normal.
template <int D>
double errorOf(const PairQuery<D>& method, const FarPair<D>& pair) {
  const ShapeView<D>&a = pair.a.view(), &b = pair.b.view();
  const Interval truth = referee<D>(a, {}, b, pair.X_AB).interval();
  const PairAnswer<D> answer = queryPair(const_cast<PairQuery<D>&>(method), a, b, pair.X_AB);
  if (!answer.normal.allFinite() || !std::isfinite(double(answer.distance))) return 1;
  const double lacks =
      answer.normal.isZero(0)
          ? 0
          : truth.lo - separationAlong<D>(a, {}, b, pair.X_AB, answer.normal.template cast<double>()).hi;
  return std::max(truth.distanceTo(double(answer.distance)), lacks) / posedScale<D>(a, b, truth.middle());
}

template <int D, class Make>
double worstOf(const PairQuery<D>& method, Make&& make) {
  FarDrawer<D> drawer(31);
  double worst = 0;
  for (int i = 0; i < test::caseCount(400); ++i) {
    const ShapePart<D> a = drawer.part(true, Vec<D>::Zero()), b = drawer.part(i % 2 == 0, drawer.vector(1));
    const FarPair<D> pair = make(a, b);
    if (a.shape.view().kind > b.shape.view().kind) {
      worst = std::max(worst, errorOf(method, FarPair<D>{pair.b, pair.a, pair.X_AB.inverse()}));
    } else {
      worst = std::max(worst, errorOf(method, pair));
    }
  }
  return worst;
}

template <int D>
void hullsAreRight() {
  int methods = 0;
  for (const Registered* entry : Registry::instance().list(StageKind::pairQuery, D)) {
    const auto method = createStage<PairQuery<D>>(Spec{entry->info.name, {}});
    const bool all = method->supports(ShapeKind::sphere, ShapeKind::polytope) &&
                     method->supports(ShapeKind::box, ShapeKind::polytope) &&
                     method->supports(ShapeKind::polytope, ShapeKind::polytope);
    if (entry->info.role != AlgorithmRole::competitor || entry->info.guarantee != Guarantee::exact || !all) continue;
    ++methods;
    const double made =
        worstOf<D>(*method, [](const auto& a, const auto& b) { return pairOf<D>(centredPart(a), centredPart(b)); });
    const double given = worstOf<D>(*method, [](const auto& a, const auto& b) { return pairOf<D>(a, b); });
    std::printf("%dD %-10s far hulls: worst %.1e around their middles, %.1e in their frames\n", D,
                entry->info.name.c_str(), made, given);
    EXPECT_LE(made, kBound) << entry->info.name;
    test::expectCaught("far frames: " + entry->info.name + " of hulls as they are given", given <= kBound);
  }
  EXPECT_GE(methods, 2);
}
TEST(FarFrames, HullsAreRightByTheScaleOfThePosedShapes2) { hullsAreRight<2>(); }
TEST(FarFrames, HullsAreRightByTheScaleOfThePosedShapes3) { hullsAreRight<3>(); }

// Vertices are moved without rounding. The part stays in place but for the rounding of its pose.
template <int D>
void isWhereItWas(ShapePart<D> (*centre)(const ShapePart<D>&), bool& exact, double& off) {
  FarDrawer<D> drawer(5);
  exact = true, off = 0;
  for (int i = 0; i < 300; ++i) {
    const ShapePart<D> given = drawer.part(true, drawer.vector(1)), made = centre(given);
    const ShapeView<D>&before = given.shape.view(), &after = made.shape.view();
    EXPECT_EQ(after.radius, before.radius);
    EXPECT_LE(after.half.maxCoeff(),
              Real(11) * (boundingBox(after, Pose<D>{}).hi - boundingBox(after, Pose<D>{}).lo).maxCoeff());
    const double far = double(before.half.maxCoeff());
    for (const Vec<D>& v : after.hull->vertices) {
      double nearest = far;  // of the original vertices, in the world; vertices that rounding removed may be missing
      bool found = false;
      for (const Vec<D>& w : before.hull->vertices) {
        nearest = std::min(nearest, double((made.X_SP * v - given.X_SP * w).norm()));
        const Vec<D> moved = w - v;  // the same for all, where nothing was rounded
        found = found || (moved - (before.hull->vertices[0] - after.hull->vertices[0])).isZero(0) ||
                before.hull->vertices.size() != after.hull->vertices.size();
      }
      exact = exact && found, off = std::max(off, nearest / far);
    }
  }
}
template <int D>
void isWhereItWas() {
  bool exact = false;
  double off = 0;
  const double rounding = 16 * double(std::numeric_limits<Real>::epsilon());
  isWhereItWas<D>(&centredPart<D>, exact, off);
  EXPECT_TRUE(exact);
  EXPECT_LE(off, rounding);
  isWhereItWas<D>(
      [](const ShapePart<D>& part) -> ShapePart<D> {
        ShapePart<D> made = centredPart(part);
        made.X_SP.p = part.X_SP.p + part.X_SP.q.inverse() * (made.X_SP.p - part.X_SP.p);
        return made;
      },
      exact, off);
  test::expectCaught("far frames: an offset that is not turned by the pose", off <= rounding);
}
TEST(FarFrames, PartsKeepTheirPlace2) { isWhereItWas<2>(); }
TEST(FarFrames, PartsKeepTheirPlace3) { isWhereItWas<3>(); }

template <int D>
void nothingElseChanges() {
  FarDrawer<D> drawer(7);
  const auto same = [](const ShapePart<D>& given) {
    const ShapePart<D> made = centredPart(given);
    return made.shape.convex() && made.shape.view().hull == given.shape.view().hull && made.X_SP.p == given.X_SP.p &&
           made.X_SP.q.matrix() == given.X_SP.q.matrix();
  };
  for (int i = 0; i < 100; ++i) {
    const Vec<D> nine = Vec<D>(Vec<D>::Unit(0) * 9);
    EXPECT_TRUE(same({drawer.hull(nine), drawer.part(false, drawer.vector(1)).X_SP}));
    EXPECT_TRUE(same(drawer.part(false, drawer.vector(1e6))));
    const ShapePart<D> once = centredPart(drawer.part(true, drawer.vector(1)));
    EXPECT_TRUE(same(once)) << "it is moved again";
  }
}
TEST(FarFrames, NothingElseChanges) { nothingElseChanges<2>(), nothingElseChanges<3>(); }

// Shapes given to a world, alone and in a compound.
template <int D>
void worldsCentre() {
  std::vector<Vec<D>> corners;
  for (int i = 0; i < 1 << D; ++i) {
    Vec<D> p;
    for (int k = 0; k < D; ++k) p[k] = (i >> k & 1 ? Real(0.5) : Real(-0.5)) + (k == 0 ? 1024 : 0);
    corners.push_back(p);
  }
  const Shape<D> cube = Shape<D>::polytope(std::span<const Vec<D>>(corners));
  const Pose<D> back{Vec<D>(Vec<D>::Unit(0) * -1024), {}};
  const ShapePart<D> part{cube, back};
  World<D> world;
  for (const Shape<D>& shape : {cube, Shape<D>::compound(std::span<const ShapePart<D>>(&part, 1))}) {
    BodyDef<D> body;
    body.shapes.push_back({.shape = shape, .X_BS = shape.convex() ? back : Pose<D>{}});
    world.add(body);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    forParts(world.shapes()[i].shape, world.shapes()[i].X_CS, [&](const ShapeView<D>& view, const Pose<D>& X_CP) {
      EXPECT_EQ(view.half, Vec<D>(Vec<D>::Constant(Real(0.5))));
      EXPECT_EQ(X_CP.p, Vec<D>(Vec<D>::Zero()));
    });
    EXPECT_EQ(world.bodies().pose[i].p, Vec<D>(Vec<D>::Zero()));
    EXPECT_EQ(world.bodies().mass[i], 1);
  }
}
TEST(FarFrames, WorldsCentreGivenShapes) { worldsCentre<2>(), worldsCentre<3>(); }

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::far_frames_test
