// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <numbers>

#include "framework/shape/curved_core.h"
#include "framework/shape/curved_ray.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

// A solid cone along x, with its base at x = -half_height and its tip at x = half_height.
template <int D>
class Cone final : public CurvedBase<D, Cone<D>>, public ExactRays<D> {
 public:
  explicit Cone(std::span<const Real> sizes) : m_sizes{sizes[0], sizes[1]} {}

  std::span<const Real> sizes() const override { return m_sizes; }
  Vec<3> half() const override { return {m_sizes[0], m_sizes[1], m_sizes[1]}; }

  template <class N>
  std::array<N, 3> extreme(const std::array<N, 3>& d) const {
    const N h = m_sizes[0], r = m_sizes[1];
    const N largest = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
    if (!(largest > 0)) return {h, 0, 0};
    const N x = d[0] / largest, y = d[1] / largest, z = d[2] / largest, across = std::sqrt(y * y + z * z);
    if (2 * h * x >= r * across) return {h, 0, 0};
    if (!(across > 0)) return {-h, 0, 0};  // the centre of the base is as far as its rim
    return {-h, r * (y / across), r * (z / across)};
  }

  void supportFace(const Vec<3>& d, std::vector<Vec<3>>& corners) const override {
    const Real h = m_sizes[0], r = m_sizes[1], across = d.tail<2>().norm();
    // Which direction is nearest to d: the axis, the normal of the side, or that of the base.
    const Real side = (2 * h * across + r * d[0]) / std::sqrt(4 * h * h + r * r);
    if (d[0] > side) return corners.assign(1, Vec<3>(h, 0, 0));
    corners.clear();
    if (side > -d[0] && across > 0) {  // a line of the side
      corners.assign({{h, 0, 0}, {-h, r * (d[1] / across), r * (d[2] / across)}});
      return;
    }
    // An octagon in the base circle. Its corners are fixed in the cone, so that contacts keep their numbers.
    const Real s = r * Real(std::numbers::sqrt2 / 2);
    const Real y[8] = {r, s, 0, -s, -r, -s, 0, s}, z[8] = {0, -s, -r, -s, 0, s, r, s};
    for (int i = 0; i < 8; ++i) corners.push_back({-h, y[i], z[i]});
  }

  MassProperties<3> massProperties(Real density) const override {
    const double h = 2 * double(m_sizes[0]), r = m_sizes[1], mass = density * std::numbers::pi * r * r * h / 3;
    const double side = mass * (3.0 / 20 * r * r + 3.0 / 80 * h * h);
    MassProperties<3> m;
    m.mass = static_cast<Real>(mass);
    m.center[0] = static_cast<Real>(-h / 4);  // a quarter of the height above the base
    m.inertia.diagonal() << static_cast<Real>(0.3 * mass * r * r), static_cast<Real>(side), static_cast<Real>(side);
    return m;
  }

  // Inside of both: the half-space of the base, and the endless cone from the tip.
  RayEntry<3> ray(const Vec<3>& p, const Vec<3>& d) const override {
    const Real h = m_sizes[0];
    // The ray's point nearest to the cone's middle: from there, far rays lose no digits.
    const Real middle = -p.dot(d) / d.squaredNorm();
    const Vec<3> q = p + middle * d;
    RaySpan<3> span;
    if (d[0] > 0) {
      span.from((-h - p[0]) / d[0], Vec<3>(-1, 0, 0));
    } else if (d[0] < 0) {
      span.until((-h - p[0]) / d[0]);
    } else if (p[0] < -h) {
      span.never();
    }
    sideRay(q, d, middle, span);
    return span.entry();
  }
  Vec<3> outwards(const Vec<3>& p) const override {
    const Real h = m_sizes[0], r = m_sizes[1], across = p.tail<2>().norm();
    const Real x = p[0] + h, y = across - r;  // from the rim, in the plane of p and the axis
    const Real along = 2 * h * x - r * y, above = r * x + 2 * h * y;
    if (along > 4 * h * h + r * r) return Vec<3>(p[0] - h, p[1], p[2]).normalized();
    if (along > 0 && above > 0) return sideNormal(p.tail<2>());
    if (!(y > 0)) return {-1, 0, 0};
    return Vec<3>(x, p[1] * (y / across), p[2] * (y / across)).normalized();
  }

 private:
  Vec<3> sideNormal(const Vec<2>& across) const {
    const Vec<2> u = 2 * m_sizes[0] * across.normalized();
    return Vec<3>(m_sizes[1], u[0], u[1]).normalized();
  }

  // With w the depth below the tip and k the slope, the double cone is y^2 + z^2 <= (k w)^2; the cone has w >= 0. Times
  // count from q and are told `later`.
  void sideRay(const Vec<3>& q, const Vec<3>& d, Real later, RaySpan<3>& span) const {
    const Real h = m_sizes[0], k = m_sizes[1] / (2 * h), kw = k * (h - q[0]), ku = -k * d[0];
    const Vec<2> m = q.tail<2>(), u = d.tail<2>();
    const Real length = u.norm(), a = (length - std::abs(ku)) * (length + std::abs(ku)), b = m.dot(u) - kw * ku;
    const Real c = (m.norm() - kw) * (m.norm() + kw);
    // b b - a c by Lagrange's identity, which cancels less.
    const Real round = std::abs(m[0] * u[1] - m[1] * u[0]), steep = (kw * u - ku * m).norm();
    const Real square = (steep - round) * (steep + round);
    if (a > 0 && square < 0) return span.never();
    const Real root = std::sqrt(std::max(square, Real(0)));
    const Real sum = b < 0 ? root - b : -root - b;  // no cancellation
    const Real other = sum != 0 ? c / sum : Real(0), first = a != 0 ? sum / a : other;
    const Real low = std::min(first, other), high = std::max(first, other);
    const auto enters = [&](Real t) { span.from(later + t, normalAt(q, d, t)); };
    if (a > 0) {  // both roots are on one of the two cones
      if (kw + (low + high) / 2 * ku < 0) return span.never();
      enters(low), span.until(later + high);
    } else if (ku > 0) {
      // A ray along a line of the side, for which the equation says nothing, enters at the tip.
      const bool along = std::abs(sum) <= kTip * ku * (m.norm() + std::abs(kw));
      enters(along ? -kw / ku : a < 0 ? high : other);
    } else if (ku < 0) {
      span.until(later + (a < 0 ? low : other));
    }
  }

  // On the side at q + t d. At the tip, the opposite of d if no part of the cone is farther along it.
  Vec<3> normalAt(const Vec<3>& q, const Vec<3>& d, Real t) const {
    const Real h = m_sizes[0], r = m_sizes[1];
    const Vec<2> across = q.tail<2>() + t * d.tail<2>();
    const Vec<3> side = sideNormal(across);
    if (across.norm() > kTip * (q.norm() + h + r) && side.dot(d) <= 0) return side;
    if (-2 * h * d[0] >= r * d.tail<2>().norm()) return -d.normalized();
    return sideNormal(-d.tail<2>());
  }

  std::array<Real, 2> m_sizes;
};

const CurvedRegistrar<Cone, 3> coneRegistrar{ShapeKind::cone, {{"half_height", "radius"}}};

}  // namespace
}}  // namespace lpc::LPC_PRECISION
