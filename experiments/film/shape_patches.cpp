// SPDX-License-Identifier: Zlib
#include "experiments/film/shape_patches.h"

#include <algorithm>
#include <cmath>

#include "framework/shape/support_map.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kPi = 3.14159265358979323846;

void drawFaces(const ShapeView<2>& shape, const Pose<2>& X_WS, const Camera<2>& camera, const DrawColour&,
               const DrawColour& edge, std::vector<Patch>& out) {
  if (shape.core() != CoreClass::point) return;
  out.push_back({{camera.pixel(X_WS.p), camera.pixel(X_WS * Vec<2>(shape.radius, 0))},
                 edge,
                 edge});  // a radius that shows the rotation
}

// The flat faces towards the viewer, brighter the more they face up.
void drawFaces(const ShapeView<3>& shape, const Pose<3>& X_WS, const Camera<3>& camera, const DrawColour& fill,
               const DrawColour& edge, std::vector<Patch>& out) {
  const auto face = [&](const Vec<3>& normal_S, const std::vector<Vec<3>>& corners_S) {
    const Vec<3> normal_W = X_WS.q * normal_S;
    if (normal_W.dot(camera.towards) <= 1e-9) return;
    Patch patch{{}, fill * (0.8 + 0.2 * normal_W[1] + 0.08 * normal_W[0]), edge};
    for (const Vec<3>& p : corners_S) patch.corners.push_back(camera.pixel(X_WS * (p + shape.radius * normal_S)));
    out.push_back(std::move(patch));
  };
  if (shape.core() == CoreClass::hull) {
    for (const auto& f : shape.hull->faces) {
      std::vector<Vec<3>> corners;
      for (int i = f.begin; i < f.end; ++i) {
        const int vertex = shape.hull->loop[static_cast<std::size_t>(i)];
        corners.push_back(shape.hull->vertices[static_cast<std::size_t>(vertex)]);
      }
      face(f.normal, corners);
    }
  } else if (shape.core() == CoreClass::box) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        std::vector<Vec<3>> corners;
        for (const auto& [u, v] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
          Vec<3> p = side * shape.half;
          p[(axis + 1) % 3] = u * shape.half[(axis + 1) % 3], p[(axis + 2) % 3] = v * shape.half[(axis + 2) % 3];
          corners.push_back(p);
        }
        face(side * Vec<3>(Vec<3>::Unit(axis)), corners);
      }
    }
  }
}

// Arcs are accurate to a twentieth of a pixel: films of many small balls would otherwise be large. Shapes with corners
// would lose some of them.
template <int D>
int directionsOf(const ShapeView<D>& shape, const Camera<D>& camera) {
  constexpr int kMost = 48;
  if (shape.core() != CoreClass::point && shape.core() != CoreClass::segment) return kMost;
  const double wanted = kPi * std::sqrt(shape.radius * camera.scale / (2 * 0.05));
  return std::clamp(4 * static_cast<int>(std::ceil(std::min<double>(wanted, kMost) / 4)), 12, kMost);
}

}  // namespace

template <int D>
std::vector<Vec<2>> outlineOf(const ShapeView<D>& shape, const Pose<D>& X_WS, const Camera<D>& camera) {
  const int directions = directionsOf(shape, camera);
  std::vector<Vec<2>> corners;
  for (int i = 0; i < directions; ++i) {
    const double angle = 2 * kPi * (i + 0.37) / directions;  // not along an axis, where two corners of a box tie
    const Vec<D> d_W = std::cos(angle) * camera.right + std::sin(angle) * camera.up;
    const Vec<2> at = camera.pixel(X_WS * coreSupport(shape, X_WS.q.inverse() * d_W) + shape.radius * d_W);
    if (corners.empty() || (corners.back() - at).norm() > 0.01) corners.push_back(at);
  }
  return corners;
}

template <int D>
std::vector<Vec<2>> planePatch(const Pose<D>& X_WS, const Camera<D>& camera) {
  const double reach = 2 * (camera.width + camera.height) / camera.scale;
  const Vec<D> middle_W = camera.middle[0] * camera.right + camera.middle[1] * camera.up;
  Vec<D> origin = X_WS.inverse() * middle_W;
  origin[1] = 0;
  std::vector<Vec<2>> corners;
  for (const auto& [x, other] : {std::pair(-1, 0), std::pair(1, 0), std::pair(1, 1), std::pair(-1, 1)}) {
    Vec<D> p = origin;
    p[0] += x * reach;
    if constexpr (D == 2) {
      p[1] -= other * reach;
    } else {
      p[2] += (other ? -1 : 1) * reach;
    }
    corners.push_back(camera.pixel(X_WS * p));
  }
  return corners;
}

template <int D>
std::vector<Patch> patchesOf(const ShapeView<D>& shape, const Pose<D>& X_WS, const Camera<D>& camera,
                             const DrawColour& fill, const DrawColour& edge) {
  std::vector<Patch> out;
  const bool flatFaced = shape.core() == CoreClass::box || shape.core() == CoreClass::hull;
  if (D == 2 || !flatFaced || shape.radius > 0) out.push_back({outlineOf(shape, X_WS, camera), fill, edge});
  drawFaces(shape, X_WS, camera, fill, edge, out);
  return out;
}

template std::vector<Vec<2>> outlineOf(const ShapeView<2>&, const Pose<2>&, const Camera<2>&);
template std::vector<Vec<2>> outlineOf(const ShapeView<3>&, const Pose<3>&, const Camera<3>&);
template std::vector<Vec<2>> planePatch(const Pose<2>&, const Camera<2>&);
template std::vector<Vec<2>> planePatch(const Pose<3>&, const Camera<3>&);
template std::vector<Patch> patchesOf(const ShapeView<2>&, const Pose<2>&, const Camera<2>&, const DrawColour&,
                                      const DrawColour&);
template std::vector<Patch> patchesOf(const ShapeView<3>&, const Pose<3>&, const Camera<3>&, const DrawColour&,
                                      const DrawColour&);

}}  // namespace lpc::LPC_PRECISION
