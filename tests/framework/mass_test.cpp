// SPDX-License-Identifier: Zlib
// M9: mass, centre and inertia, compared with sums over a cut and an independent integration, and tested on hard
// inputs.
#include "framework/shape/mass.h"

#include <gtest/gtest.h>

#include "tests/check_property.h"
#include "tests/generators.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace mass_test { namespace {

constexpr Real kPi = Real(3.14159265358979323846);

template <int D>
Real gap(const MassProperties<D>& a, const MassProperties<D>& b, Real length) {
  const Real mass = std::max(a.mass, b.mass);
  return std::max({std::abs(a.mass - b.mass) / mass, (a.center - b.center).norm() / length,
                   (a.inertia - b.inertia).cwiseAbs().maxCoeff() / (mass * length * length)});
}

// Midpoint sums over a grid of cells; shares only the shape with the closed forms. A ray along the first axis cuts
// whole rows of cells, so that the error falls with the square of the cell size.
template <int D>
MassProperties<D> byGrid(const Shape<D>& s, int cells) {
  const Aabb<D> box = boundingBox(s.view(), Pose<D>{});
  const Vec<D> size = box.hi - box.lo;
  double mass = 0;
  Eigen::Matrix<double, D, 1> first = Eigen::Matrix<double, D, 1>::Zero();
  Eigen::Matrix<double, D, D> second = Eigen::Matrix<double, D, D>::Zero();
  const int rows = D == 2 ? cells : cells * cells;
  for (int row = 0; row < rows; ++row) {
    Vec<D> p = box.lo;
    double area = 1;
    for (int k = 1, rest = row; k < D; ++k, rest /= cells) {
      p[k] += size[k] * (Real(rest % cells) + Real(0.5)) / Real(cells);
      area *= double(size[k]) / cells;
    }
    p[0] = box.lo[0] - size[0];
    Vec<D> back = p;
    back[0] = box.hi[0] + size[0];
    const Vec<D> d = 3 * size[0] * Vec<D>::Unit(0);
    const Real in = rayEntry(s.view(), Pose<D>{}, p, d, Real(1)).t,
               out = rayEntry(s.view(), Pose<D>{}, back, Vec<D>(-d), Real(1)).t;
    if (in < 0 || out < 0) continue;
    const double x0 = double(p[0] + in * d[0]), x1 = double(back[0] - out * d[0]), length = x1 - x0;
    Eigen::Matrix<double, D, 1> middle = p.template cast<double>();
    middle[0] = (x0 + x1) / 2;
    mass += length * area, first += length * area * middle;
    second += length * area * middle * middle.transpose();
    second(0, 0) += area * length * length * length / 12;
  }
  MassProperties<D> m;
  const Eigen::Matrix<double, D, 1> center = first / mass;
  second -= mass * center * center.transpose();
  m.mass = static_cast<Real>(mass), m.center = center.template cast<Real>();
  // I = trace(S) 1 - S in 3D, trace(S) in 2D.
  for (int i = 0; i < kAngDim<D>; ++i) {
    for (int j = 0; j < kAngDim<D>; ++j) {
      const double own = kAngDim<D> == 1 ? 0 : second(i, j);
      m.inertia(i, j) = static_cast<Real>((i == j ? second.trace() : 0) - own);
    }
  }
  return m;
}

template <int D, class Mass>
void equalsGrid(Mass massOf) {
  RapidCheckDraw draw;
  const ShapeKind kind = draw.pick({ShapeKind::sphere, ShapeKind::box, ShapeKind::capsule, ShapeKind::polytope});
  Sketch<D> sketch = drawSketch<D>(draw, kind);
  if (kind == ShapeKind::box || kind == ShapeKind::polytope) sketch.radius = 0;  // adds no mass
  const Shape<D> s = sketch.build(drawScale(draw));
  const auto sum = byGrid<D>(s, D == 2 ? 2000 : 60);
  RC_ASSERT(gap(massOf(s), sum, sizeOf(s)) < Real(D == 2 ? 1e-3 : 1e-2));
}
template <int D>
void grid() {
  check(
      "M9: equal to a sum over cells",
      [] { equalsGrid<D>([](const Shape<D>& s) { return massProperties(s.view(), Real(1)); }); }, 60);
  expectFalsified(
      "caps of a capsule placed as if their centroid were on the flat side",
      [] {
        equalsGrid<D>([](const Shape<D>& s) {
          auto m = massProperties(s.view(), Real(1));
          if (s.kind() != ShapeKind::capsule) return m;
          const auto caps = massProperties(Shape<D>::sphere(s.view().radius).view(), Real(1));
          const Real missing = caps.mass * s.view().half[0] * s.view().radius * (D == 2 ? Real(0.848826) : Real(0.75));
          m.inertia(kAngDim<D> - 1, kAngDim<D> - 1) -= missing;
          return m;
        });
      },
      60);
}
TEST(Mass, EqualsSumOverCells2) { grid<2>(); }
TEST(Mass, EqualsSumOverCells3) { grid<3>(); }

TEST(Mass, ClosedForms) {
  const auto disc = massProperties(Shape<2>::sphere(2).view(), Real(3));
  EXPECT_NEAR(disc.mass, 12 * kPi, 1e-5);
  EXPECT_NEAR(disc.inertia(0, 0), 24 * kPi, 1e-4);
  const auto ball = massProperties(Shape<3>::sphere(1).view(), Real(3));
  EXPECT_NEAR(ball.mass, 4 * kPi, 1e-5);
  EXPECT_NEAR(ball.inertia(1, 1), Real(8) / 5 * kPi, 1e-5);
  const auto box = massProperties(Shape<3>::box(Vec<3>(1, 2, 3)).view(), Real(1));
  EXPECT_NEAR(box.mass, 48, 1e-4);
  EXPECT_NEAR(box.inertia(0, 0), 48 * 13 / 3.0, 1e-3);
  EXPECT_EQ(massProperties(Shape<3>::box(Vec<3>(1, 2, 3), Real(0.5)).view(), Real(1)).mass, box.mass) << "rounding";
  const auto rod = massProperties(Shape<2>::segment(3).view(), Real(2));
  EXPECT_NEAR(rod.mass, 12, 1e-5);
  EXPECT_NEAR(rod.inertia(0, 0), 12 * 36 / 12.0, 1e-4);
  // A capsule of zero length is a ball; one of zero thickness is nearly a rod.
  EXPECT_LT(gap(massProperties(Shape<3>::capsule(0, 1).view(), Real(3)), ball, Real(1)), 8 * kEps);
  const auto needle = massProperties(Shape<3>::capsule(1, Real(1e-3)).view(), Real(1));
  EXPECT_NEAR(needle.inertia(1, 1) / needle.mass, 1 / 3.0, 1e-3);
}

// --- cutting: the parts of a box add up to the box, wherever the parts' frames are ----------------------------------

template <int D, class Combine>
void cut(Combine combine) {
  RapidCheckDraw draw;
  const Vec<D> half = drawHalf<D>(draw);
  const Real at = Real(0.1) + Real(0.8) * draw.real(0, 1);  // share of the left part
  const Vec<D> offset = draw.pick({Real(0), Real(1), Real(1000)}) * drawVector<D>(draw);
  Vec<D> a = half, b = half, pA = offset, pB = offset;
  a[0] *= at, b[0] *= 1 - at;
  pA[0] -= half[0] - a[0], pB[0] += half[0] - b[0];
  Pose<D> turned;
  turned.q = drawRotation<D>(draw);
  const auto part = [&](const Vec<D>& h, const Vec<D>& p) {
    return transformed(transformed(massProperties(Shape<D>::box(h).view(), Real(2)), Pose<D>{p, {}}), turned);
  };
  const auto whole = part(half, offset);
  const auto sum = combine(part(a, pA), part(b, pB));
  RC_ASSERT(gap(sum, whole, half.norm()) <= 64 * kEps * (1 + offset.norm() / half.minCoeff()));
}
template <int D>
void cuts() {
  check("M9: parts add up", [] { cut<D>([](const auto& a, const auto& b) { return combined(a, b); }); });
  expectFalsified("without the parallel axes", [] {
    cut<D>([](const auto& a, const auto& b) {
      auto m = combined(a, b);
      m.inertia = a.inertia + b.inertia;
      return m;
    });
  });
}
TEST(Mass, PartsAddUp) { cuts<2>(), cuts<3>(); }

TEST(Mass, CombinesWithNothing) {
  const auto box = massProperties(Shape<3>::box(Vec<3>(1, 2, 3)).view(), Real(1));
  const auto sum = combined(MassProperties<3>{}, box);
  EXPECT_EQ(sum.mass, box.mass);
  EXPECT_EQ(sum.inertia, box.inertia);
  EXPECT_EQ(combined(MassProperties<3>{}, MassProperties<3>{}).mass, 0);
}

// --- a moved box as a polytope: only the centre changes -------------------------------------------------------------

template <int D>
Shape<D> boxAsPolytope(const Vec<D>& half, const Pose<D>& X) {
  std::vector<Vec<D>> points;
  for (int bits = 0; bits < 1 << D; ++bits) {
    Vec<D> p;
    for (int k = 0; k < D; ++k) p[k] = (bits >> k) & 1 ? half[k] : -half[k];
    points.push_back(X * p);
  }
  return Shape<D>::polytope(points);
}

// Planted bug: integrates the simplices from the frame's origin, as textbooks do.
MassProperties<2> fromOrigin(const Polytope<2>& hull) {
  Real mass = 0, inertia = 0;
  Vec<2> first = Vec<2>::Zero();
  for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
    const Vec<2>&a = hull.vertices[i], &b = hull.vertices[(i + 1) % hull.vertices.size()];
    const Real area = cross(a, b)[0] / 2;
    mass += area, first += area / 3 * (a + b), inertia += area / 6 * (a.dot(a) + a.dot(b) + b.dot(b));
  }
  MassProperties<2> m;
  m.mass = mass, m.center = first / mass, m.inertia(0, 0) = inertia - mass * m.center.squaredNorm();
  return m;
}

template <int D, class Mass>
void moved(Mass massOf) {
  RapidCheckDraw draw;
  const Vec<D> half = drawHalf<D>(draw);
  const Real far = draw.pick({Real(1), Real(100), sizeof(Real) == 8 ? Real(1e6) : Real(1e3)});
  const auto X = drawPose<D>(draw, far);
  const auto m = massOf(boxAsPolytope<D>(half, X));
  const auto expected = transformed(massProperties(Shape<D>::box(half).view(), Real(1)), X);
  RC_ASSERT(gap(m, expected, half.norm()) <= 256 * kEps * (1 + X.p.norm() / half.minCoeff()));
}
template <int D>
void moves() {
  check("M9: moving changes the centre only",
        [] { moved<D>([](const Shape<D>& s) { return massProperties(s.view(), Real(1)); }); });
}
TEST(Mass, MovesWithItsFrame) {
  moves<2>(), moves<3>();
  expectFalsified("integrated from the origin",
                  [] { moved<2>([](const Shape<2>& s) { return fromOrigin(*s.view().hull); }); });
}

// box2d #756, #174, #1006: a small triangle far away got a negative inertia.
TEST(Mass, SmallTriangleFarAway) {
  const Real far = sizeof(Real) == 8 ? Real(1e6) : Real(1e2), size = sizeof(Real) == 8 ? Real(0.015625) : Real(0.25);
  const std::vector<Vec<2>> points = {{far, far}, {far + size, far}, {far, far + size}};  // exactly representable
  const auto m = massProperties(Shape<2>::polytope(points).view(), Real(1));
  EXPECT_NEAR(m.mass / (size * size / 2), 1, 8 * double(kEps));
  EXPECT_NEAR(m.inertia(0, 0) / (size * size * size * size / 18), 1, 32 * double(kEps));
  EXPECT_NEAR((m.center[0] - far) / size, 1 / 3.0, double(far / size * 2 * kEps));
}

// --- properties of every inertia ------------------------------------------------------------------------------------

template <class Mass>
void physical(Mass massOf) {
  const Shape<3> s = *shapes<3>();
  const auto X = *poses<3>(3);
  const MassProperties<3> m = transformed(massOf(s), X);
  RC_ASSERT(m.mass > 0);
  const Real scale = m.inertia.norm();
  RC_ASSERT((m.inertia - m.inertia.transpose()).norm() <= 32 * kEps * scale);
  // In any frame the inertia is positive definite, and none of its principal values exceeds the sum of the other two: S
  // = trace/2 - I has no negative eigenvalue.
  const Mat<3> second = m.inertia.trace() / 2 * Mat<3>::Identity() - m.inertia;
  for (int i = 0; i < 30; ++i) {
    const Vec<3> d = *directions<3>();
    RC_ASSERT(d.dot(m.inertia * d) > 0);
    RC_ASSERT(d.dot(second * d) >= -64 * kEps * scale);
  }
}
TEST(Mass, IsPhysical) {
  check("M9: positive, triangle inequality",
        [] { physical([](const Shape<3>& s) { return massProperties(s.view(), Real(2)); }); });
  expectFalsified("two axes swapped with a wrong factor", [] {
    physical([](const Shape<3>& s) {
      auto m = massProperties(s.view(), Real(2));
      m.inertia(0, 0) *= Real(2.5);
      return m;
    });
  });
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::mass_test
