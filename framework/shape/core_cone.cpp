// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <numbers>

#include "framework/shape/curved_core.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

// A solid cone along x, with its base at x = -half_height and its tip at x = half_height.
template <int D>
class Cone final : public CurvedBase<D, Cone<D>> {
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

 private:
  std::array<Real, 2> m_sizes;
};

const CurvedRegistrar<Cone, 3> coneRegistrar{ShapeKind::cone, {{"half_height", "radius"}}};

}  // namespace
}}  // namespace lpc::LPC_PRECISION
