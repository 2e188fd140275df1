// SPDX-License-Identifier: Zlib
// Shared grounds of triangles (3D) or segments (2D): as a surface, or as a compound of the same parts, which has no
// information on inner edges.
#pragma once

#include <functional>

#include "framework/shape/surface.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

enum class GroundOf { surface, loosePart };

/// The parts of a surface as separate shapes.
template <int D>
Shape<D> looseParts(const Shape<D>& shape) {
  std::vector<ShapePart<D>> parts;
  for (const PlacedView<D>& part : shape.surfaceParts()) {
    const ShapeView<D>& view = part.view;
    parts.push_back(
        {view.hull ? Shape<D>::ofCorners(view.kind, view.hull->vertices) : Shape<D>::segment(view.half[0]), part.X_SP});
  }
  return Shape<D>::compound(parts);
}

/// From x = -2 to 14 m, 8 m wide in 3D, with irregular parts. The height is a function of x (m).
template <int D>
Shape<D> roughGround(std::uint64_t seed, GroundOf of, const std::function<double(double)>& height) {
  Random random(seed);
  Shape<D> out = Shape<D>::sphere(1);
  if constexpr (D == 2) {
    std::vector<Vec<2>> points;
    for (double x = 14; x > -2; x -= random.uniform(0.1, 1.3)) points.push_back(at<2>(x, height(x)));
    points.push_back(at<2>(-2, height(-2)));
    out = Shape<2>::chain(points, false);
  } else {
    constexpr int kAlong = 24, kAcross = 12;
    std::vector<Vec<3>> points;
    for (int i = 0; i <= kAlong; ++i) {
      for (int k = 0; k <= kAcross; ++k) {
        const bool rim = i == 0 || k == 0 || i == kAlong || k == kAcross;
        const double aside = random.uniform(-0.3, 0.3), ahead = random.uniform(-0.3, 0.3);
        const double x = -2 + 16 * (i + (rim ? 0 : ahead)) / kAlong, z = -4 + 8 * (k + (rim ? 0 : aside)) / kAcross;
        points.push_back(at<3>(x, height(x), z));
      }
    }
    std::vector<std::array<int, 3>> triangles;
    for (int i = 0; i < kAlong; ++i) {
      for (int k = 0; k < kAcross; ++k) {
        const int a = i * (kAcross + 1) + k, b = a + kAcross + 1;  // b lies ahead of a, a + 1 beside it
        if (random.below(2)) {
          triangles.insert(triangles.end(), {{a, a + 1, b + 1}, {a, b + 1, b}});
        } else {
          triangles.insert(triangles.end(), {{a, a + 1, b}, {a + 1, b + 1, b}});
        }
      }
    }
    out = Shape<3>::mesh(points, triangles);
  }
  return of == GroundOf::surface ? out : looseParts<D>(out);
}

inline double level(double) { return 0; }

}}}  // namespace lpc::LPC_PRECISION::test
