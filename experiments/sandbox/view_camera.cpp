// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/view_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr Real kRim = Real(1.1);         // factor by which a fitted box is enlarged
constexpr Real kLeastSize = Real(1e-3);  // m: smaller boxes are not magnified further
constexpr Real kRadiansPerPixel = Real(0.008);
// Limits of pixels per metre, and of metres to the target: beyond, floats of the matrix overflow or vanish.
constexpr Real kNearest = Real(1e-6), kFarthest = Real(1e9);

Real tangentOfHalfView() { return std::tan(std::numbers::pi_v<Real> / 8); }  // 45 degrees from top to bottom

}  // namespace

void ViewFrame::resize(int width, int height, int left, int top) {
  m_width = std::max(width, 1), m_height = std::max(height, 1);
  m_left = left, m_top = top;
}

Vec<2> ViewCamera<2>::toPixel(const Vec<2>& p) const {
  const Vec<2> at = m_scale * (p - m_middle);
  return center() + Vec<2>(at[0], -at[1]);
}

Vec<2> ViewCamera<2>::toWorld(const Vec<2>& pixel) const {
  const Vec<2> at = (pixel - center()) / m_scale;
  return m_middle + Vec<2>(at[0], -at[1]);
}

void ViewCamera<2>::pan(Real dx, Real dy) { m_middle -= Vec<2>(dx, -dy) / m_scale; }

void ViewCamera<2>::zoom(Real factor, const Vec<2>& pixel) {
  const Vec<2> under = toWorld(pixel);
  m_scale = std::clamp(m_scale * factor, kNearest, kFarthest);
  m_middle += under - toWorld(pixel);
}

void ViewCamera<2>::look(const Vec<2>& lo, const Vec<2>& hi) {
  const Vec<2> size = kRim * (hi - lo).cwiseMax(kLeastSize);
  m_middle = (lo + hi) / 2;
  m_scale = std::clamp(std::min(Real(width()) / size[0], Real(height()) / size[1]), kNearest, kFarthest);
}

ViewMatrix ViewCamera<2>::matrix() const {
  ViewMatrix m{};
  m[0] = static_cast<float>(2 * m_scale / Real(width()));
  m[5] = static_cast<float>(2 * m_scale / Real(height()));
  m[10] = m[15] = 1;
  return m;
}

Vec<3> ViewCamera<3>::right() const { return {std::cos(m_azimuth), 0, -std::sin(m_azimuth)}; }
Vec<3> ViewCamera<3>::up() const { return towards().cross(right()); }
Vec<3> ViewCamera<3>::towards() const {
  return {std::cos(m_elevation) * std::sin(m_azimuth), std::sin(m_elevation),
          std::cos(m_elevation) * std::cos(m_azimuth)};
}
Real ViewCamera<3>::focal() const { return Real(height()) / (2 * tangentOfHalfView()); }

Real ViewCamera<3>::scaleAt(const Vec<3>& p) const {
  return focal() / std::max(m_distance - (p - m_target).dot(towards()), nearest());
}

Vec<2> ViewCamera<3>::toPixel(const Vec<3>& p) const {
  const Vec<3> at = p - m_target;
  const Real depth = m_distance - at.dot(towards());
  if (!(depth > 0)) return Vec<2>::Constant(std::numeric_limits<Real>::quiet_NaN());
  return center() + focal() / depth * Vec<2>(at.dot(right()), -at.dot(up()));
}

ViewCamera<3>::Ray ViewCamera<3>::ray(const Vec<2>& pixel) const {
  const Vec<2> at = (pixel - center()) / focal();
  return {eye(), (at[0] * right() - at[1] * up() - towards()).normalized()};
}

void ViewCamera<3>::orbit(Real dx, Real dy) {
  constexpr Real kTurn = 2 * std::numbers::pi_v<Real>;
  m_azimuth = std::remainder(m_azimuth - kRadiansPerPixel * dx, kTurn);
  m_elevation = std::clamp(m_elevation + kRadiansPerPixel * dy, -kTurn / 4, kTurn / 4);
}

void ViewCamera<3>::pan(Real dx, Real dy) { m_target -= (dx * right() - dy * up()) / scale(); }

void ViewCamera<3>::zoom(Real factor, const Vec<2>& pixel) {
  const Vec<2> at = pixel - center();
  const Real before = 1 / scale();
  m_distance = std::clamp(m_distance / factor, kNearest, kFarthest);
  m_target += (before - 1 / scale()) * (at[0] * right() - at[1] * up());
}

void ViewCamera<3>::look(const Vec<3>& lo, const Vec<3>& hi) {
  m_target = (lo + hi) / 2;
  const Vec<3> half = kRim / 2 * (hi - lo).cwiseMax(kLeastSize);
  const Real tall = tangentOfHalfView(), wide = tall * Real(width()) / Real(height());
  Real distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec<3> sides((corner & 1) ? 1 : -1, (corner & 2) ? 1 : -1, (corner & 4) ? 1 : -1);
    const Vec<3> at = half.cwiseProduct(sides);
    distance = std::max(distance,
                        at.dot(towards()) + std::max(std::abs(at.dot(right())) / wide, std::abs(at.dot(up())) / tall));
  }
  m_distance = std::clamp(distance, kNearest, kFarthest);
}

ViewMatrix ViewCamera<3>::matrix() const {
  const Real near = nearest(), far = farthest();
  const Real deep = (far + near) / (far - near), shift = 2 * far * near / (far - near);
  const std::array<Vec<3>, 4> rows = {2 * focal() / Real(width()) * right(), 2 * focal() / Real(height()) * up(),
                                      -deep * towards(), -towards()};
  const std::array<Real, 4> last = {0, 0, deep * m_distance - shift, m_distance};
  ViewMatrix m{};
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      m[4 * column + row] = static_cast<float>(rows[row][static_cast<int>(column)]);
    }
    m[12 + row] = static_cast<float>(last[row]);
  }
  return m;
}

}}  // namespace lpc::LPC_PRECISION
