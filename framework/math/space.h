// SPDX-License-Identifier: Zlib
// Everything in the project that differs only by dimension.
//
// In 2D an angular quantity (angular velocity, torque, rotation vector) is one number, in 3D a vector of three. Both
// are `Ang<D>`, a column of D(D-1)/2 components, so that one line of solver code serves both dimensions:
//
//        2D: Ang<2> = (w)             w turns x towards y         y |  ) w
//        3D: Ang<3> = (wx, wy, wz)    the usual vector            __|_____ x
//
// Frames use monogram notation: X_AB is the pose of B in A, p_AB = X_AB * p_B maps a point from B to A.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#if !defined(LPC_PRECISION) || !defined(LPC_REAL)
#error "link one of the targets lpc::lpc (double) or lpc::lpc_f32 (float): they define LPC_PRECISION and LPC_REAL"
#endif

#include "framework/math/eager.h"

namespace lpc { inline namespace LPC_PRECISION {

using Real = LPC_REAL;  // double (f64) or float (f32), fixed when the library is built

// DontAlign: the same layout for all -m flags of user code, and plain bytes for saving.
template <int Rows, int Cols>
using RealMatrix = Eigen::Matrix<Real, Rows, Cols, Eigen::DontAlign>;

template <int D>
using Vec = RealMatrix<D, 1>;
template <int D>
inline constexpr int kAngDim = D*(D - 1) / 2;
template <int D>
using Ang = RealMatrix<kAngDim<D>, 1>;
template <int D>
using Mat = RealMatrix<D, D>;
template <int D>
using Inertia = RealMatrix<kAngDim<D>, kAngDim<D>>;

/// Sine and cosine of `x` radians, computed with +, -, * only: libm takes another code path, with other last bits, on
/// another CPU. Error below 1e-15 for |x| < 1e5.
inline void sinCos(double x, double& s, double& c) {
  const double k = std::floor(x * 0.63661977236758134308 + 0.5);  // number of quarter turns
  const double r = ((x - k * 1.57079632673412561417) - k * 6.07710050630396597660e-11) - k * 2.02226624879595063154e-21;
  const double r2 = r * r;
  double sr = 1, cr = 1;
  for (int n = 16; n >= 2; n -= 2) {  // Taylor by Horner: |r| <= pi/4, so r^17/17! is less than one rounding error
    sr = 1 - sr * r2 / (n * (n + 1));
    cr = 1 - cr * r2 / (n * (n - 1));
  }
  sr *= r;
  // A k too large for an integer counts as whole turns.
  switch (std::abs(k) < 1e18 ? static_cast<long long>(k) & 3 : 0) {
    case 0:
      s = sr, c = cr;
      break;
    case 1:
      s = cr, c = -sr;
      break;
    case 2:
      s = -sr, c = -cr;
      break;
    default:
      s = -cr, c = sr;
      break;
  }
}

/// atan2 without libm: the angle (rad, -pi to pi) with sine s / n and cosine c / n, where n = |(s, c)|. Error below
/// 1e-15. Returns 0 for a zero vector.
inline double angleOf(double s, double c) {
  const double x = std::abs(c), y = std::abs(s);
  if (!(x > 0) && !(y > 0)) return s + c;  // 0, or NaN
  // Reduce to the first octant; in its upper half measure from the diagonal, so that |t| <= tan(pi/8).
  double near = 0, t = y <= x ? y / x : x / y;
  if (t > 0.41421356237309503) near = 0.78539816339744830962, t = (t - 1) / (t + 1);
  const double t2 = t * t;
  double sum = 0;
  for (int n = 43; n >= 1; n -= 2) sum = 1.0 / n - t2 * sum;  // arctangent series: t^45 / 45 < 1e-18
  double angle = near + t * sum;
  if (y > x) angle = 1.57079632679489661923 - angle;
  if (c < 0) angle = 3.14159265358979323846 - angle;
  return s < 0 ? -angle : angle;
}

/// Cross product. For an arm a = r and a force b = f: the torque r x f, an Ang<D>. For an angular velocity a = w and an
/// arm b = r: the velocity w x r of the point at r, a Vec<D>.
template <class A, class B>
auto cross(const Eigen::MatrixBase<A>& left, const Eigen::MatrixBase<B>& right) {
  const typename A::PlainObject a = left;
  const typename B::PlainObject b = right;
  if constexpr (A::RowsAtCompileTime == 3) {
    return Vec<3>(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
  } else if constexpr (A::RowsAtCompileTime == 2) {
    return Ang<2>(a[0] * b[1] - a[1] * b[0]);
  } else {
    return Vec<2>(-a[0] * b[1], a[0] * b[0]);
  }
}

template <int D>
struct Rot;  // R_AB: turns directions of B into directions of A

template <>
struct Rot<2> {
  Real c = 1, s = 0;  // cosine and sine of the angle, kept at unit length

  static Rot angle(double radians) {
    double s = 0, c = 1;
    sinCos(radians, s, c);
    return {static_cast<Real>(c), static_cast<Real>(s)};
  }
  Real radians() const { return std::atan2(s, c); }  // for output only, never inside a step
  Vec<2> operator*(const Vec<2>& v) const { return {c * v[0] - s * v[1], s * v[0] + c * v[1]}; }
  Rot operator*(const Rot& q) const { return {c * q.c - s * q.s, s * q.c + c * q.s}; }
  Rot inverse() const { return {c, -s}; }
  Mat<2> matrix() const {
    Mat<2> m;
    m << c, -s, s, c;
    return m;
  }
  Rot normalized() const {
    const Real n = std::sqrt(c * c + s * s);
    return {c / n, s / n};
  }
};

template <>
struct Rot<3> {
  Real w = 1, x = 0, y = 0, z = 0;  // unit quaternion

  /// Rotation by |v| radians about v.
  static Rot vector(const Vec<3>& v) {
    const double n = std::sqrt(double(v[0]) * v[0] + double(v[1]) * v[1] + double(v[2]) * v[2]);
    double s = 0, c = 1;
    sinCos(n / 2, s, c);
    const double k = n > 0 ? s / n : 0.5;
    return Rot{Real(c), Real(k * v[0]), Real(k * v[1]), Real(k * v[2])}.normalized();
  }
  Vec<3> imag() const { return {x, y, z}; }
  Vec<3> operator*(const Vec<3>& v) const {
    const Vec<3> u = imag();
    const Vec<3> t = 2 * cross(u, v);
    return v + w * t + cross(u, t);
  }
  Rot operator*(const Rot& q) const {
    return {w * q.w - x * q.x - y * q.y - z * q.z, w * q.x + x * q.w + y * q.z - z * q.y,
            w * q.y - x * q.z + y * q.w + z * q.x, w * q.z + x * q.y - y * q.x + z * q.w};
  }
  Rot inverse() const { return {w, -x, -y, -z}; }
  Mat<3> matrix() const {
    Mat<3> m;
    m << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),   //
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
    return m;
  }
  Rot normalized() const {
    const Real n = std::sqrt(w * w + x * x + y * y + z * z);
    return {w / n, x / n, y / n, z / n};
  }
};

/// X_AB: position of B's origin in A (m) and rotation of B relative to A.
template <int D>
struct Pose {
  Vec<D> p = Vec<D>::Zero();
  Rot<D> q{};

  Vec<D> operator*(const Vec<D>& point) const { return p + q * point; }
  Pose operator*(const Pose& x) const { return {p + q * x.p, q * x.q}; }
  Pose inverse() const { return {-(q.inverse() * p), q.inverse()}; }
};

template <int D>
struct Motion {
  Vec<D> v = Vec<D>::Zero();  // of the centre of mass, m/s
  Ang<D> w = Ang<D>::Zero();  // rad/s, world frame
};

/// Returns X_AB. Positions are subtracted first: far from the origin X_WA.inverse() * X_WB would lose digits.
template <int D>
Pose<D> poseBetween(const Pose<D>& X_WA, const Pose<D>& X_WB) {
  const Rot<D> back = X_WA.q.inverse();
  return {back * (X_WB.p - X_WA.p).eval(), back * X_WB.q};
}

/// The rotation `q` followed by a rotation by `turn` (rad, world frame). Exact for a constant angular velocity.
inline Rot<2> integrateRotation(const Rot<2>& q, const Ang<2>& turn) {
  return (Rot<2>::angle(turn[0]) * q).normalized();
}
inline Rot<3> integrateRotation(const Rot<3>& q, const Ang<3>& turn) { return (Rot<3>::vector(turn) * q).normalized(); }

/// The shortest rotation vector (rad, world frame) of `q`: the inverse of integrateRotation() on the identity.
inline Ang<2> turnOf(const Rot<2>& q) { return Ang<2>(static_cast<Real>(angleOf(q.s, q.c))); }
inline Ang<3> turnOf(const Rot<3>& q) {
  const double w = q.w, n = std::sqrt(double(q.x) * q.x + double(q.y) * q.y + double(q.z) * q.z);
  const double angle = 2 * (w < 0 ? angleOf(-n, -w) : angleOf(n, w));
  return static_cast<Real>(n > 0 ? angle / n : 0) * q.imag();
}

/// Rotates an inertia of the body frame (or its inverse) to the world: R I R^T. In 2D it is a scalar and does not
/// change.
inline Inertia<2> rotateInertia(const Rot<2>&, const Inertia<2>& inertia) { return inertia; }
Inertia<3> rotateInertia(const Rot<3>& q, const Inertia<3>& inertia);  // mass.cpp

/// Unit vectors that complete `n` to a right-handed basis: one column in 2D, two in 3D. Depends on `n` only.
inline RealMatrix<2, 1> tangents(const Vec<2>& n) { return {-n[1], n[0]}; }
inline RealMatrix<3, 2> tangents(const Vec<3>& n) {
  // The branch keeps the divisor away from zero; Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
  const Real sign = n[2] >= 0 ? Real(1) : Real(-1);
  const Real a = -1 / (sign + n[2]);
  const Real b = n[0] * n[1] * a;
  RealMatrix<3, 2> t;
  t.col(0) << 1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0];
  t.col(1) << b, sign + n[1] * n[1] * a, -n[1];
  return t;
}

}}  // namespace lpc::LPC_PRECISION
