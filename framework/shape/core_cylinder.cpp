// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <numbers>

#include "framework/shape/curved_core.h"
#include "framework/shape/curved_ray.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

// A solid cylinder along x, as the capsule; flat ends at x = -half_length and x = half_length.
template <int D>
class Cylinder final : public CurvedBase<D, Cylinder<D>>, public ExactRays<D> {
 public:
  explicit Cylinder(std::span<const Real> sizes) : m_sizes{sizes[0], sizes[1]} {}

  std::span<const Real> sizes() const override { return m_sizes; }
  Vec<3> half() const override { return {m_sizes[0], m_sizes[1], m_sizes[1]}; }

  template <class N>
  std::array<N, 3> extreme(const std::array<N, 3>& d) const {
    const N h = m_sizes[0], r = m_sizes[1];
    const N largest = std::max(std::abs(d[1]), std::abs(d[2]));
    std::array<N, 3> p = {d[0] >= 0 ? h : -h, 0, 0};
    if (!(largest > 0)) return p;  // d is along the axis: the centre of the end is as far as its rim
    const N y = d[1] / largest, z = d[2] / largest, length = std::sqrt(y * y + z * z);
    p[1] = r * (y / length), p[2] = r * (z / length);
    return p;
  }

  void supportFace(const Vec<3>& d, std::vector<Vec<3>>& corners) const override {
    corners.clear();
    const Real h = m_sizes[0], r = m_sizes[1], across = d.tail<2>().norm();
    if (std::abs(d[0]) < across) {  // a line of the side
      const Real y = r * (d[1] / across), z = r * (d[2] / across);
      corners.assign({{h, y, z}, {-h, y, z}});
      return;
    }
    // An octagon in the end circle. Its corners are fixed in the cylinder, so that contacts keep their numbers.
    const Real x = d[0] < 0 ? -h : h, turn = d[0] < 0 ? Real(-1) : Real(1);
    const Real s = r * Real(std::numbers::sqrt2 / 2);
    const Real y[8] = {r, s, 0, -s, -r, -s, 0, s}, z[8] = {0, s, r, s, 0, -s, -r, -s};
    for (int i = 0; i < 8; ++i) corners.push_back({x, y[i], turn * z[i]});
  }

  MassProperties<3> massProperties(Real density) const override {
    const double h = m_sizes[0], r = m_sizes[1], mass = density * std::numbers::pi * r * r * 2 * h;
    const double along = mass * r * r / 2, side = mass * (3 * r * r + 4 * h * h) / 12;
    MassProperties<3> m;
    m.mass = static_cast<Real>(mass);
    m.inertia.diagonal() << static_cast<Real>(along), static_cast<Real>(side), static_cast<Real>(side);
    return m;
  }

  // Inside of both: the space between the planes of the ends, and the endless cylinder.
  RayEntry<3> ray(const Vec<3>& p, const Vec<3>& d) const override {
    const Real h = m_sizes[0], r = m_sizes[1], way = d[0] < 0 ? Real(-1) : Real(1);
    RaySpan<3> span;
    if (d[0] != 0) {
      span.from((-way * h - p[0]) / d[0], Vec<3>(-way, 0, 0));
      span.until((way * h - p[0]) / d[0]);
    } else if (std::abs(p[0]) > h) {
      span.never();
    }
    // The chord is measured from the ray's point nearest to the axis, so that far rays lose no digits.
    const Vec<2> m = p.tail<2>(), u = d.tail<2>();
    const Real uu = u.squaredNorm();
    const Real middle = uu > 0 ? -m.dot(u) / uu : Real(0);
    const Vec<2> closest = m + middle * u;
    const Real aside = closest.norm();
    if (!(aside <= r)) {
      span.never();
    } else if (uu > 0) {
      const Real half = std::sqrt((r - aside) * (r + aside) / uu);
      const Vec<2> n = (closest - half * u).normalized();
      span.from(middle - half, Vec<3>(0, n[0], n[1]));
      span.until(middle + half);
    }
    return span.entry();
  }
  Vec<3> outwards(const Vec<3>& p) const override {
    const Real across = p.tail<2>().norm(), beyond = std::max(Real(0), std::abs(p[0]) - m_sizes[0]);
    const Real share = across > m_sizes[1] ? (across - m_sizes[1]) / across : Real(0);
    return Vec<3>(p[0] < 0 ? -beyond : beyond, share * p[1], share * p[2]).normalized();
  }

 private:
  std::array<Real, 2> m_sizes;
};

const CurvedRegistrar<Cylinder, 3> cylinderRegistrar{ShapeKind::cylinder, {{"half_length", "radius"}}};

}  // namespace
}}  // namespace lpc::LPC_PRECISION
