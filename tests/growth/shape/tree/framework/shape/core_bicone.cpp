// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <numbers>

#include "framework/shape/curved_core.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

// Two solid cones along x, base to base: tips at x = -half_length and x = half_length.
template <int D>
class Bicone final : public CurvedBase<D, Bicone<D>> {
 public:
  explicit Bicone(std::span<const Real> sizes) : m_sizes{sizes[0], sizes[1]} {}

  std::span<const Real> sizes() const override { return m_sizes; }
  Vec<3> half() const override { return {m_sizes[0], m_sizes[1], m_sizes[1]}; }

  template <class N>
  std::array<N, 3> extreme(const std::array<N, 3>& d) const {
    const N h = m_sizes[0], r = m_sizes[1];
    const N largest = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
    if (!(largest > 0)) return {h, 0, 0};
    const N x = d[0] / largest, y = d[1] / largest, z = d[2] / largest, across = std::sqrt(y * y + z * z);
    if (h * std::abs(x) >= r * across) return {d[0] < 0 ? -h : h, 0, 0};
    return {0, r * (y / across), r * (z / across)};
  }

  void supportFace(const Vec<3>& d, std::vector<Vec<3>>& corners) const override {
    const Real h = m_sizes[0], r = m_sizes[1], across = d.tail<2>().norm(), tip = d[0] < 0 ? -h : h;
    corners.assign(1, Vec<3>(tip, 0, 0));
    if (2 * h * across > r * std::abs(d[0])) {  // on the side line
      corners.push_back({0, r * (d[1] / across), r * (d[2] / across)});
    }
  }

  MassProperties<3> massProperties(Real density) const override {
    const double h = m_sizes[0], r = m_sizes[1], mass = density * std::numbers::pi * r * r * 2 * h / 3;
    const double side = mass * (3.0 / 20 * r * r + h * h / 10);
    MassProperties<3> m;
    m.mass = static_cast<Real>(mass);
    m.inertia.diagonal() << static_cast<Real>(0.3 * mass * r * r), static_cast<Real>(side), static_cast<Real>(side);
    return m;
  }

 private:
  std::array<Real, 2> m_sizes;
};

const CurvedRegistrar<Bicone, 3> registrar{ShapeKind::bicone, {{"half_length", "radius"}}};

}  // namespace
}}  // namespace lpc::LPC_PRECISION
