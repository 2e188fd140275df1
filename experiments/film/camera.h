// SPDX-License-Identifier: Zlib
// A fixed camera: the plane itself in 2D; in 3D an orthographic view from the right and above.
#pragma once

#include <cmath>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct Camera {
  Vec<D> right, up, towards;  // unit, in the world; `towards` the viewer (zero in 2D)
  Vec<2> middle = Vec<2>::Zero();
  double scale = 1;  // pixels per metre
  double width = 0, height = 0;
  static constexpr double kBand = 36;  // px at the top, for two lines of text

  Camera();
  /// In metres, on the image plane.
  Vec<2> flat(const Vec<D>& p) const { return {p.dot(right), p.dot(up)}; }
  /// Far positions are clamped to a range in which numbers can still be written, and counted in whole pixels.
  Vec<2> pixel(const Vec<D>& p) const {
    constexpr double kFar = 1e8;  // px
    const Vec<2> at = (scale * (flat(p) - middle)).cwiseMin(kFar).cwiseMax(-kFar);
    return {width / 2 + at[0], (height + kBand) / 2 - at[1]};
  }
  /// The point of the image plane at this pixel.
  Vec<2> flatOf(const Vec<2>& pixel) const {
    return middle + Vec<2>(pixel[0] - width / 2, (height + kBand) / 2 - pixel[1]) / scale;
  }
};

template <>
inline Camera<2>::Camera() : right(Vec<2>::UnitX()), up(Vec<2>::UnitY()), towards(Vec<2>::Zero()) {}

template <>
inline Camera<3>::Camera() {
  const double azimuth = 0.5, elevation = 0.35;  // rad
  towards = {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
  right = {std::cos(azimuth), 0, -std::sin(azimuth)};
  up = towards.cross(right);
}

}}  // namespace lpc::LPC_PRECISION
