// SPDX-License-Identifier: Zlib
// Cores defined by support functions: the support point, the support face, the mass, and queries with points, boxes and
// rays. Each is compared with the implicit formula of its surface, which none of them uses.
#include "framework/shape/curved_core.h"

#include <gtest/gtest.h>

#include "framework/math/random.h"
#include "framework/shape/support_map.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace curved_core_test { namespace {

constexpr Real kEps = std::numeric_limits<Real>::epsilon();
constexpr int kDraws = 300;

template <int D>
Vec<D> anyVector(Random& random) {
  Vec<D> v;
  for (int k = 0; k < D; ++k) v[k] = static_cast<Real>(random.uniform(-1, 1));
  return v;
}
template <int D>
Shape<D> draw(ShapeKind kind, Random& random, Real rounding = 0) {
  std::vector<Real> sizes;
  for (std::size_t i = 0; i < curvedKind<D>(kind).sizes.size(); ++i) {
    sizes.push_back(static_cast<Real>(random.uniform(0.2, 1)));
  }
  return Shape<D>::curved(kind, sizes, rounding);
}

// Less than 1 inside, 1 on the surface.
template <int D>
Real level(const ShapeView<D>& s, const Vec<D>& p) {
  if (s.kind == ShapeKind::ellipsoid) return p.cwiseQuotient(s.half).squaredNorm();
  const Real across = p.tail(D - 1).norm() / s.half[1];
  if (s.kind == ShapeKind::cone) return std::max(-p[0] / s.half[0], 2 * across + p[0] / s.half[0]);
  return std::max(std::abs(p[0]) / s.half[0], across);
}
template <int D>
Vec<D> onSurface(const ShapeView<D>& s, Random& random) {
  const Vec<D> d = anyVector<D>(random);
  return s.kind == ShapeKind::ellipsoid ? Vec<D>(d / std::sqrt(level(s, d))) : Vec<D>(d / level(s, d));
}

// Calls f(kind) for each curved kind of this dimension. A new kind is tested once it is registered and `level` supports
// it.
template <int D, class F>
void forKinds(F&& f) {
  for (const auto& [kind, unused] : curvedKinds<D>()) {
    SCOPED_TRACE(std::string(shapeKindName(kind)) + ' ' + std::to_string(D) + 'D');
    f(kind);
  }
}

// Number of draws in which a support function is wrong: its point is not on the core, or another point lies farther.
template <int D, class Support>
int wrongSupports(ShapeKind kind, const Support& support) {
  Random random(11);
  int wrong = 0;
  for (int i = 0; i < kDraws; ++i) {
    const Shape<D> shape = draw<D>(kind, random);
    const ShapeView<D>& s = shape.view();
    const Vec<D> d = anyVector<D>(random), p = support(s, d);
    bool right = level(s, p) <= 1 + 8 * kEps;
    for (int k = 0; k < 50; ++k) right = right && onSurface(s, random).dot(d) <= p.dot(d) + 8 * kEps;
    wrong += !right;
  }
  return wrong;
}
template <int D>
void supports() {
  forKinds<D>([](ShapeKind kind) {
    const auto ours = [](const ShapeView<D>& s, const Vec<D>& d) { return coreSupport(s, d); };
    EXPECT_EQ(wrongSupports<D>(kind, ours), 0);
    const auto towards = [](const ShapeView<D>& s, const Vec<D>& d) { return Vec<D>(d / level(s, d)); };
    EXPECT_GT(wrongSupports<D>(kind, towards), 0) << "planted: the point that the direction meets";
    const auto beside = [](const ShapeView<D>& s, const Vec<D>& d) { return Vec<D>(1.01 * coreSupport(s, d)); };
    EXPECT_GT(wrongSupports<D>(kind, beside), 0) << "planted: off the surface";
  });
}
TEST(CurvedCore, SupportIsExtreme) { supports<2>(), supports<3>(); }

template <int D>
void lengths() {
  forKinds<D>([](ShapeKind kind) {
    Random random(12);
    const Shape<D> shape = draw<D>(kind, random);
    const Real tiny = sizeof(Real) == 8 ? Real(1e-150) : Real(1e-30);
    for (int i = 0; i < kDraws; ++i) {
      const Vec<D> d = anyVector<D>(random), p = coreSupport(shape.view(), d);
      for (const Real length : {tiny, Real(1e-3), 1 / tiny}) {
        EXPECT_LE((coreSupport(shape.view(), Vec<D>(length * d)) - p).norm(), 16 * kEps);
      }
      std::array<long double, static_cast<std::size_t>(D)> along;
      for (int k = 0; k < D; ++k) along[static_cast<std::size_t>(k)] = d[k];
      const auto q = shape.view().curved->support(along);
      for (int k = 0; k < D; ++k)
        EXPECT_NEAR(static_cast<double>(q[static_cast<std::size_t>(k)]), double(p[k]), 16 * kEps);
    }
    EXPECT_LE(level(shape.view(), coreSupport(shape.view(), Vec<D>(Vec<D>::Zero()))), 1 + 8 * kEps);
  });
}
TEST(CurvedCore, LengthOfTheDirectionDoesNotMatter) { lengths<2>(), lengths<3>(); }

TEST(CurvedCore, SupportFaces) {
  const Real sizes[2] = {1, Real(0.5)};
  const auto cylinder = Shape<3>::curved(ShapeKind::cylinder, sizes);
  std::vector<Vec<3>> face;
  cylinder.view().curved->supportFace({5, 1, Real(-0.5)}, face);  // standing: the end
  ASSERT_GE(face.size(), 3u);
  const Vec<3> normal = (face[1] - face[0]).cross(face[2] - face[0]);
  EXPECT_GT(normal[0], 0);
  for (const Vec<3>& v : face) EXPECT_EQ(v[0], 1);
  for (const Vec<3>& v : face) EXPECT_NEAR(v.tail<2>().norm(), 0.5, 4 * kEps);
  cylinder.view().curved->supportFace({-3, 0, 0}, face);
  EXPECT_LT((face[1] - face[0]).cross(face[2] - face[0])[0], 0);
  cylinder.view().curved->supportFace({Real(0.1), 0, -1}, face);  // lying: a line
  ASSERT_EQ(face.size(), 2u);
  for (const Vec<3>& v : face) EXPECT_NEAR(v[2], -0.5, 4 * kEps);
  EXPECT_NEAR((face[0] - face[1]).norm(), 2, 8 * kEps);
  const Real half[3] = {1, 2, 3};
  const auto ellipsoid = Shape<3>::curved(ShapeKind::ellipsoid, half);
  ellipsoid.view().curved->supportFace({0, 0, 1}, face);
  ASSERT_EQ(face.size(), 1u);
  EXPECT_NEAR(face[0][2], 3, 8 * kEps);
}

TEST(CurvedCore, MassByFormulas) {
  const double pi = 3.14159265358979323846;
  const Real ball[3] = {2, 2, 2};
  const auto m = massProperties(Shape<3>::curved(ShapeKind::ellipsoid, ball).view(), Real(3));
  const auto same = massProperties(Shape<3>::sphere(2).view(), Real(3));
  EXPECT_NEAR(m.mass, same.mass, 8 * kEps * same.mass);
  EXPECT_LE((m.inertia - same.inertia).cwiseAbs().maxCoeff(), 8 * kEps * same.inertia(0, 0));
  const Real disc[2] = {2, 2};
  const auto flat = massProperties(Shape<2>::curved(ShapeKind::ellipsoid, disc).view(), Real(3));
  EXPECT_NEAR(flat.inertia(0, 0), 3 * pi * 4 * 2, 1e-4);  // m r^2 / 2
  const Real rod[2] = {3, Real(0.001)};
  const auto thin = massProperties(Shape<3>::curved(ShapeKind::cylinder, rod).view(), Real(1));
  EXPECT_NEAR(thin.inertia(1, 1) / thin.mass, 9.0 / 3, 1e-5);  // m l^2 / 12 of a thin rod
  EXPECT_NEAR(thin.inertia(0, 0) / thin.mass, 1e-6 / 2, 1e-12);
}

// Mass, centre and inertia by counting about 100,000 random points inside.
template <int D>
void massByCounting() {
  forKinds<D>([](ShapeKind kind) {
    Random random(13);
    const Shape<D> shape = draw<D>(kind, random);
    const ShapeView<D>& s = shape.view();
    const int n = 200000;
    double inside = 0, volume = 1;
    Vec<D> square = Vec<D>::Zero(), sum = Vec<D>::Zero();
    for (int k = 0; k < D; ++k) volume *= 2 * double(s.half[k]);
    for (int i = 0; i < n; ++i) {
      const Vec<D> p = s.half.cwiseProduct(anyVector<D>(random));
      if (!(level(s, p) <= 1)) continue;
      ++inside, sum += p, square += p.cwiseAbs2();
    }
    const auto m = massProperties(s, Real(2));
    const double mass = 2 * volume * inside / n;
    EXPECT_NEAR(double(m.mass), mass, 0.02 * mass);
    const Vec<D> center = sum / static_cast<Real>(inside);
    square -= sum.cwiseProduct(center);  // about the centre of mass
    EXPECT_LE((m.center - center).norm(), Real(0.02) * s.half.norm());
    for (int k = 0; k < kAngDim<D>; ++k) {
      const double own = D == 2 ? 0 : double(square[k]), inertia = mass * (double(square.sum()) - own) / inside;
      EXPECT_NEAR(double(m.inertia(k, k)), inertia, 0.02 * inertia);
    }
  });
}
TEST(CurvedCore, MassByCounting) { massByCounting<2>(), massByCounting<3>(); }

template <int D>
void questions() {
  forKinds<D>([](ShapeKind kind) {
    Random random(14);
    for (int i = 0; i < kDraws; ++i) {
      const Shape<D> shape = draw<D>(kind, random);
      const ShapeView<D>& s = shape.view();
      const Pose<D> X{};
      const Vec<D> p = onSurface(s, random);
      EXPECT_TRUE(containsPoint(s, X, Vec<D>(Real(0.9999) * p)));
      EXPECT_FALSE(containsPoint(s, X, Vec<D>(Real(1.0001) * p)));
      // A ray from outside to the centre enters at the surface.
      const Vec<D> from = 3 * p;
      EXPECT_NEAR(double(rayEntry(s, X, from, Vec<D>(-from), Real(1)).t), 2.0 / 3, 1e-4);
      EXPECT_LT(rayEntry(s, X, from, from, Real(100)).t, 0);
      EXPECT_LT(rayEntry(s, X, from, Vec<D>(-from), Real(0.6)).t, 0);
      const Vec<D> edge = Vec<D>::Constant(Real(0.1));
      EXPECT_TRUE(overlapsBox(s, X, Aabb<D>{p - edge, p + edge}));
      const Vec<D> beyond = coreSupport(s, p);  // this box touches the support plane only with a corner
      const Vec<D> n = p / p.norm();
      const Vec<D> lo = beyond + Real(0.001) * n;
      Aabb<D> box{lo, lo};
      for (int k = 0; k < D; ++k) (n[k] < 0 ? box.lo : box.hi)[k] += n[k];
      EXPECT_FALSE(overlapsBox(s, X, box));
    }
  });
}
TEST(CurvedCore, PointsRaysAndBoxes) { questions<2>(), questions<3>(); }

TEST(CurvedCore, RoundingIsAroundTheCore) {
  const Real half[2] = {2, 1};
  const auto shape = Shape<2>::curved(ShapeKind::ellipsoid, half, Real(0.5));
  EXPECT_TRUE(containsPoint(shape.view(), Pose<2>{}, Vec<2>(Real(2.4999), 0)));
  EXPECT_FALSE(containsPoint(shape.view(), Pose<2>{}, Vec<2>(Real(2.5001), 0)));
  EXPECT_NEAR(boundingBox(shape.view(), Pose<2>{}).hi[1], 1.5, 1e-6);
  EXPECT_NEAR(rayEntry(shape.view(), Pose<2>{}, Vec<2>(0, 3), Vec<2>(0, -3), Real(1)).t, 0.5, 1e-6);
}

TEST(CurvedCore, WrongSizesAreRefused) {
  const auto message = [](auto&& make) -> std::string {
    try {
      make();
    } catch (const UserError& e) {
      return e.what();
    }
    return "";
  };
  const Real bad[2] = {1, -1}, good[2] = {1, 1};
  EXPECT_NE(message([&] { Shape<3>::curved(ShapeKind::cylinder, bad); }).find("cylinder: radius is -1"),
            std::string::npos);
  EXPECT_NE(message([&] { Shape<3>::curved(ShapeKind::ellipsoid, good); }).find("2 sizes given; valid: 3"),
            std::string::npos);
  EXPECT_NE(message([&] {
              Shape<2>::curved(ShapeKind::cylinder, good);
            }).find("is not a curved shape kind in 2D; valid: ellipsoid"),
            std::string::npos);
  EXPECT_NE(message([&] { Shape<3>::curved(ShapeKind::box, good); }).find("is not a curved shape kind"),
            std::string::npos);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::curved_core_test
