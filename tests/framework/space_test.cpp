// SPDX-License-Identifier: Zlib
#include "framework/math/space.h"

#include <gtest/gtest.h>

#include "tests/check_property.h"
#include "tests/expect_caught.h"
#include "tests/generators.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace space_test { namespace {

using SinCos = void (*)(double, double&, double&);

// Worst error against the library's sine, which is correct to half an ulp.
double worstError(SinCos f, double extent) {
  PlainDraw draw(1);
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    const double x = extent * (2.0 * draw.below(1 << 30) / (1 << 30) - 1);
    double s, c;
    f(x, s, c);
    worst = std::max({worst, std::abs(s - std::sin(x)), std::abs(c - std::cos(x))});
  }
  return worst;
}

TEST(SinCos, ErrorBelow1e15) {
  for (const double extent : {0.8, 3.2, 100.0, 1e5}) EXPECT_LT(worstError(sinCos, extent), 1e-15) << extent;
  double s, c;
  sinCos(0, s, c);
  EXPECT_EQ(s, 0);
  EXPECT_EQ(c, 1);
}

TEST(SinCos, PlantedBugIsCaught) {
  // Planted bugs: a series with one term less, and a range reduction with an unsplit pi.
  const SinCos shortSeries = [](double x, double& s, double& c) {
    sinCos(x, s, c);
    s += std::pow(std::remainder(x, 1.5707963267948966), 15) / 1.3e12;
  };
  EXPECT_GT(worstError(shortSeries, 0.8), 1e-15);
  const SinCos coarse = [](double x, double& s, double& c) {
    sinCos(x - std::floor(x / 6.283185307179586 + 0.5) * 6.283185307179586, s, c);
  };
  EXPECT_GT(worstError(coarse, 1e5), 1e-15);
}

Real lengthOf(const Rot<2>& q) { return std::sqrt(q.c * q.c + q.s * q.s); }
Real lengthOf(const Rot<3>& q) { return std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z); }
Rot<2> plainProduct(const Rot<2>& q, const Ang<2>& v) { return Rot<2>::angle(v[0]) * q; }
Rot<3> plainProduct(const Rot<3>& q, const Ang<3>& v) { return Rot<3>::vector(v) * q; }

// M1: unit length and an orthonormal matrix after any number of steps.
template <int D, class Step>
void staysRotation(Step step) {
  RapidCheckDraw draw;
  const int steps = draw.pick({1, 100, 3000, 100000});
  Rot<D> q = drawRotation<D>(draw);
  Ang<D> v;
  for (int k = 0; k < kAngDim<D>; ++k) v[k] = draw.signedUnit();
  for (int i = 0; i < steps; ++i) q = step(q, v);
  RC_ASSERT(std::abs(lengthOf(q) - 1) <= 8 * kEps);
  const Mat<D> r = q.matrix();
  RC_ASSERT((r.transpose() * r - Mat<D>::Identity()).cwiseAbs().maxCoeff() <= 8 * kEps);
}
using Angle = double (*)(double, double);
double worstAngle(Angle f) {
  double worst = 0;
  Random random(5);
  for (int i = 0; i < 200000; ++i) {
    const double size = i % 3 == 0 ? 1e-9 : 1, s = size * random.uniform(-1, 1), c = random.uniform(-1, 1);
    worst = std::max(worst, std::abs(f(s, c) - std::atan2(s, c)));
    worst = std::max(worst, std::abs(f(c, s) - std::atan2(c, s)));
  }
  return worst;
}
TEST(Angle, OfErrorBelow1e15) {
  EXPECT_LT(worstAngle(angleOf), 1e-15);
  expectCaught("an angle in the wrong half",
               worstAngle([](double s, double c) { return angleOf(s, std::abs(c)); }) < 1e-15);
  EXPECT_EQ(angleOf(0, 0), 0);
  EXPECT_TRUE(std::isnan(angleOf(std::nan(""), 0)));
}

template <int D>
void turnIsUndone() {
  RapidCheckDraw draw;
  Ang<D> turn;
  for (int i = 0; i < kAngDim<D>; ++i) turn[i] = Real(1.7) * draw.signedUnit();  // less than half a turn
  const Ang<D> back = turnOf(integrateRotation(Rot<D>{}, turn));
  RC_ASSERT((back - turn).norm() <= 16 * kEps);
}
TEST(Rotation, TurnIsUndone) { check("2D", turnIsUndone<2>), check("3D", turnIsUndone<3>); }

template <int D>
void staysOne() {
  check(
      "M1", [] { staysRotation<D>([](auto& q, auto& v) { return integrateRotation(q, v); }); }, 40);
  expectFalsified(
      "M1 without normalising", [] { staysRotation<D>([](auto& q, auto& v) { return plainProduct(q, v); }); }, 40);
}
TEST(Rotation, StaysARotation) { staysOne<2>(), staysOne<3>(); }

// M2: a pose and its inverse cancel.
template <int D, class Inverse>
void thereAndBack(Inverse inverse) {
  const auto X = *poses<D>(10);
  RapidCheckDraw draw;
  const Vec<D> p = 5 * drawVector<D>(draw);
  RC_ASSERT((inverse(X) * (X * p) - p).norm() <= 8 * kEps * (p.norm() + X.p.norm()));
  RC_ASSERT((X * (inverse(X) * p) - p).norm() <= 8 * kEps * (p.norm() + X.p.norm()));
  RC_ASSERT((X.q.matrix() * p - X.q * p).norm() <= 8 * kEps * p.norm());
}
template <int D>
void poseTests() {
  check("M2", [] { thereAndBack<D>([](const Pose<D>& X) { return X.inverse(); }); });
  expectFalsified("M2 with the offset not turned back", [] {
    thereAndBack<D>([](const Pose<D>& X) { return Pose<D>{-X.p, X.q.inverse()}; });
  });
  check("poses compose", [] {
    const auto X_AB = *poses<D>(3), X_BC = *poses<D>(3);
    const Vec<D> p = (*directions<D>());
    RC_ASSERT(((X_AB * X_BC) * p - X_AB * (X_BC * p)).norm() <= 32 * kEps * 10);
  });
}
TEST(Pose, InverseAndProduct) { poseTests<2>(), poseTests<3>(); }

// A rotation by v moves a point at r by cross(v, r) to first order, in world axes: the sign of every formula.
template <int D>
void turnsTheRightWay() {
  RapidCheckDraw draw;
  const Rot<D> q = drawRotation<D>(draw);
  Ang<D> v;
  for (int k = 0; k < kAngDim<D>; ++k) v[k] = draw.signedUnit();
  const Vec<D> r = drawVector<D>(draw);
  const Real h = std::sqrt(kEps);
  const Vec<D> moved = integrateRotation(q, Ang<D>(h * v)) * r - q * r;
  const Vec<D> expected = cross(v, Vec<D>(q * r));
  RC_ASSERT((moved / h - expected).norm() <= 40 * h);
}
TEST(Rotation, TurnsTheRightWay) {
  check("2D", turnsTheRightWay<2>);
  check("3D", turnsTheRightWay<3>);
  EXPECT_NEAR(Rot<2>::angle(0.3).radians(), 0.3, 4 * kEps);
}

template <int D, class Tangents>
void orthonormal(Tangents tangentsOf) {
  const Vec<D> n = *directions<D>();
  Mat<D> basis;
  basis << n, tangentsOf(n);
  RC_ASSERT((basis.transpose() * basis - Mat<D>::Identity()).cwiseAbs().maxCoeff() <= 16 * kEps);
  RC_ASSERT(std::abs(basis.determinant() - 1) <= 16 * kEps);  // right-handed
}
TEST(Tangents, CompleteTheNormal) {
  check("2D", [] { orthonormal<2>([](const Vec<2>& n) { return tangents(n); }); });
  check(
      "3D", [] { orthonormal<3>([](const Vec<3>& n) { return tangents(n); }); }, 1000);
  for (const Real z : {Real(-1), Real(1)}) {
    const Vec<3> n(0, 0, z);
    EXPECT_TRUE(tangents(n).allFinite());
    EXPECT_EQ((tangents(n).transpose() * n).norm(), 0);
  }
  expectFalsified("left-handed", [] { orthonormal<2>([](const Vec<2>& n) { return Vec<2>(n[1], -n[0]); }); });
  expectFalsified(
      "by a fixed axis",
      [] {
        orthonormal<3>([](const Vec<3>& n) {
          RealMatrix<3, 2> t;
          t.col(0) = n.cross(Vec<3>(Vec<3>::Unit(0))).normalized(), t.col(1) = n.cross(Vec<3>(t.col(0)));
          return t;
        });
      },
      1000);
}

// f . (w x r) = w . (r x f): the Jacobian and its transpose agree in every solver.
template <int D>
void crossIdentity() {
  RapidCheckDraw draw;
  const Vec<D> r = drawVector<D>(draw), f = drawVector<D>(draw);
  Ang<D> w;
  for (int k = 0; k < kAngDim<D>; ++k) w[k] = draw.signedUnit();
  RC_ASSERT(std::abs(f.dot(cross(w, r)) - w.dot(cross(r, f))) <= 16 * kEps);
  RC_ASSERT(std::abs(cross(w, r).dot(r)) <= 16 * kEps);
}
TEST(Cross, TripleProduct) { check("2D", crossIdentity<2>), check("3D", crossIdentity<3>); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::space_test
