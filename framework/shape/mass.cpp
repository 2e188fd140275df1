// SPDX-License-Identifier: Zlib
// Closed forms in double. Capsules are summed from a bar and a ball, polytopes from simplices around their own middle.
#include <Eigen/Cholesky>
#include <numbers>

#include "framework/math/tolerances.h"
#include "framework/shape/curved_core.h"

namespace lpc { inline namespace LPC_PRECISION {

Inertia<3> rotateInertia(const Rot<3>& q, const Inertia<3>& inertia) {
  const Mat<3> r = q.matrix();
  return r * inertia * r.transpose();
}

bool isInertia(const Inertia<2>& inertia) { return inertia(0, 0) >= 0; }

// Tests the second moments, which are half the trace minus the inertia: a solid has none below zero.
bool isInertia(const Inertia<3>& inertia) {
  const Real trace = inertia.trace(), rounding = kUnitTolerance * trace;
  if (!((inertia - inertia.transpose()).cwiseAbs().maxCoeff() <= rounding)) return false;
  if (!(trace > 0)) return (inertia.array() == 0).all();
  const Mat<3> second = (trace / 2 + rounding) * Mat<3>(Mat<3>::Identity()) - inertia;
  return Eigen::LLT<Mat<3>>(second).info() == Eigen::Success;
}

namespace {

constexpr double kPi = std::numbers::pi;

// Inertia of a unit mass at r about the origin: w -> r x (w x r).
template <int D>
Inertia<D> pointInertia(const Vec<D>& r) {
  Inertia<D> inertia;
  for (int k = 0; k < kAngDim<D>; ++k) {
    const Vec<D> v = cross(Ang<D>(Ang<D>::Unit(k)), r);
    inertia.col(k) = cross(r, v);
  }
  return inertia;
}

MassProperties<2> solid(double mass, double inertia) {
  MassProperties<2> m;
  m.mass = static_cast<Real>(mass), m.inertia(0, 0) = static_cast<Real>(inertia);
  return m;
}
MassProperties<3> solid(double mass, double ix, double iy, double iz) {
  MassProperties<3> m;
  m.mass = static_cast<Real>(mass);
  m.inertia.diagonal() << static_cast<Real>(ix), static_cast<Real>(iy), static_cast<Real>(iz);
  return m;
}

MassProperties<2> ofCapsule(const Vec<2>& half, double r, double density) {  // half = 0: a disc
  const double h = half[0], bar = density * 4 * h * r, disc = density * kPi * r * r;
  // A half disc's centroid is 4r/3pi from its flat side, which is h from the middle.
  return solid(bar + disc, bar * (h * h + r * r) / 3 + disc * (r * r / 2 + h * h + 2 * h * 4 * r / (3 * kPi)));
}
MassProperties<3> ofCapsule(const Vec<3>& half, double r, double density) {  // half = 0: a ball
  const double h = half[0], bar = density * kPi * r * r * 2 * h, ball = density * 4 / 3 * kPi * r * r * r;
  const double along = bar * r * r / 2 + ball * 2 / 5 * r * r;
  // A half ball's centroid is 3r/8 from its flat side.
  const double across = bar * (3 * r * r + 4 * h * h) / 12 + ball * (2.0 / 5 * r * r + h * h + 2 * h * 3 * r / 8);
  return solid(bar + ball, along, across, across);
}

MassProperties<2> ofBox(const Vec<2>& half, double density) {
  const double x = half[0], y = half[1], mass = density * 4 * x * y;
  return solid(mass, mass * (x * x + y * y) / 3);
}
MassProperties<3> ofBox(const Vec<3>& half, double density) {
  const double x = half[0], y = half[1], z = half[2], mass = density * 8 * x * y * z;
  return solid(mass, mass * (y * y + z * z) / 3, mass * (x * x + z * z) / 3, mass * (x * x + y * y) / 3);
}

// Volume integrals of 1, p and p p^T over simplices with one corner at a reference point near the middle. About the
// frame's origin, a small shape far away would be a difference of huge numbers, even a negative inertia.
template <int D>
struct Integrals {
  using Point = Eigen::Matrix<double, D, 1>;
  using Square = Eigen::Matrix<double, D, D>;
  double volume = 0;
  Point first = Point::Zero();
  Square second = Square::Zero();

  // `corners`: the simplex's other corners as columns; `measure`: its signed volume.
  void add(const Square& corners, double measure) {
    const Point sum = corners.rowwise().sum();
    volume += measure;
    first += measure / (D + 1) * sum;
    second += measure / ((D + 1) * (D + 2)) * (sum * sum.transpose() + corners * corners.transpose());
  }
};

Inertia<2> inertiaOf(const Eigen::Matrix2d& second) { return Inertia<2>::Constant(static_cast<Real>(second.trace())); }
Inertia<3> inertiaOf(const Eigen::Matrix3d& second) {
  return (second.trace() * Eigen::Matrix3d::Identity() - second).cast<Real>();
}

template <int D>
Eigen::Matrix<double, D, 1> middle(const Polytope<D>& hull) {
  Eigen::Matrix<double, D, 1> sum = Eigen::Matrix<double, D, 1>::Zero();
  const Eigen::Matrix<double, D, 1> base = hull.vertices[0].template cast<double>();
  for (const Vec<D>& v : hull.vertices) sum += v.template cast<double>() - base;
  return base + sum / static_cast<double>(hull.vertices.size());
}

Integrals<2> integrate(const Polytope<2>& hull, const Eigen::Vector2d& reference) {
  Integrals<2> sum;
  for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
    Eigen::Matrix2d c;
    c.col(0) = hull.vertices[i].cast<double>() - reference;
    c.col(1) = hull.vertices[(i + 1) % hull.vertices.size()].cast<double>() - reference;
    sum.add(c, c.determinant() / 2);
  }
  return sum;
}
Integrals<3> integrate(const Polytope<3>& hull, const Eigen::Vector3d& reference) {
  Integrals<3> sum;
  const auto at = [&](int i) -> Eigen::Vector3d { return hull.vertices[hull.loop[i]].cast<double>() - reference; };
  for (const auto& face : hull.faces) {
    for (int i = face.begin + 1; i + 1 < face.end; ++i) {
      Eigen::Matrix3d c;
      c << at(face.begin), at(i), at(i + 1);
      sum.add(c, c.determinant() / 6);
    }
  }
  return sum;
}

template <int D>
MassProperties<D> ofPolytope(const Polytope<D>& hull, double density) {
  const auto reference = middle<D>(hull);
  const Integrals<D> sum = integrate(hull, reference);
  const typename Integrals<D>::Point shift = sum.first / sum.volume;
  MassProperties<D> m;
  m.mass = static_cast<Real>(density * sum.volume);
  m.center = (reference + shift).template cast<Real>();
  const typename Integrals<D>::Square central = density * (sum.second - sum.volume * shift * shift.transpose());
  m.inertia = inertiaOf(central);
  return m;
}

}  // namespace

template <int D>
MassProperties<D> massProperties(const ShapeView<D>& shape, Real density) {
  switch (shape.core()) {
    case CoreClass::point:
      return ofCapsule(shape.half, shape.radius, density);
    case CoreClass::segment:
      if (shape.radius > 0) return ofCapsule(shape.half, shape.radius, density);
      break;
    case CoreClass::box:
      return ofBox(shape.half, density);
    case CoreClass::hull:
      if (shape.kind == ShapeKind::triangle) {  // no volume, but its middle is needed
        MassProperties<D> none;
        none.center = middle<D>(*shape.hull).template cast<Real>();
        return none;
      }
      return ofPolytope<D>(*shape.hull, density);
    case CoreClass::curved:
      return shape.curved->massProperties(density);
    case CoreClass::plane:  // never moves: its mass is never used
      return {};
  }
  MassProperties<D> m;  // a thin rod: no inertia about its own axis; in 2D the only axis is perpendicular
  m.mass = density * 2 * shape.half[0];
  m.inertia = m.mass / 3 * pointInertia<D>(shape.half);
  return m;
}

template <int D>
MassProperties<D> transformed(const MassProperties<D>& m, const Pose<D>& X_AS) {
  return {m.mass, X_AS * m.center, rotateInertia(X_AS.q, m.inertia)};
}

template <int D>
MassProperties<D> combined(const MassProperties<D>& a, const MassProperties<D>& b) {
  const Real mass = a.mass + b.mass;
  if (mass == 0) return a;  // NaN is passed on, for the caller to detect
  // Use the distance of the two centres, never that to the origin.
  const Vec<D> apart = b.center - a.center;
  const Real share = b.mass / mass;
  return {mass, a.center + share * apart, a.inertia + b.inertia + a.mass * share * pointInertia<D>(apart)};
}

template MassProperties<2> massProperties(const ShapeView<2>&, Real);
template MassProperties<3> massProperties(const ShapeView<3>&, Real);
template MassProperties<2> transformed(const MassProperties<2>&, const Pose<2>&);
template MassProperties<3> transformed(const MassProperties<3>&, const Pose<3>&);
template MassProperties<2> combined(const MassProperties<2>&, const MassProperties<2>&);
template MassProperties<3> combined(const MassProperties<3>&, const MassProperties<3>&);

}}  // namespace lpc::LPC_PRECISION
