// SPDX-License-Identifier: Zlib
#include <numbers>

#include "framework/curved_core.h"

namespace lpc::inline LPC_PRECISION {
namespace {

// A solid cone along x: its base at x = -half_height, its tip at x = half_height.
template <int D>
class Cone final : public CurvedBase<D, Cone<D>> {
 public:
  explicit Cone(std::span<const Real> sizes) : m_sizes{sizes[0], sizes[1]} {}

  std::span<const Real> sizes() const override { return m_sizes; }
  Vec<3> half() const override { return {m_sizes[0], m_sizes[1], m_sizes[1]}; }

  template <class N>
  std::array<N, 3> extreme(const std::array<N, 3>& d) const {
    const N h = m_sizes[0], r = m_sizes[1], across = std::sqrt(d[1] * d[1] + d[2] * d[2]);
    if (2 * h * d[0] >= r * across) return {h, 0, 0};
    if (!(across > 0)) return {-h, 0, 0};
    return {-h, r * (d[1] / across), r * (d[2] / across)};
  }

  void supportFace(const Vec<3>& d, std::vector<Vec<3>>& corners) const override {
    const Real h = m_sizes[0], r = m_sizes[1], across = d.tail<2>().norm();
    if (d[0] > 2 * across || !(across > 0 || d[0] < 0)) return corners.assign(1, Vec<3>(h, 0, 0));
    corners.clear();
    if (-d[0] < across) {  // the line of the side
      corners.assign({{h, 0, 0}, {-h, r * (d[1] / across), r * (d[2] / across)}});
      return;
    }
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

const CurvedRegistrar<Cone, 3> registrar{ShapeKind::cone, {{"half_height", "radius"}}};

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
