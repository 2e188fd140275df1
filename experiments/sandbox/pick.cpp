// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/pick.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "framework/shape/support_map.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Calls f(body, view, X_WP) for all convex parts except planes.
template <int D, class F>
void forAllParts(const Simulation<D>& world, const F& f) {
  for (const ShapeRecord<D>& s : world.shapes()) {
    if (s.body < 0 || s.shape.isPlane()) continue;
    const Pose<D> X_WS = world.bodies().pose[static_cast<std::size_t>(s.body)] * s.X_CS;
    forParts(s.shape, X_WS, [&](const ShapeView<D>& view, const Pose<D>& X_WP) { f(s.body, view, X_WP); });
  }
}

bool moves(BodyType type) { return type != BodyType::fixed; }

}  // namespace

template <>
Vec<2> onPlane(const ViewCamera<2>& camera, const Vec<2>& pixel, const Vec<2>&) {
  return camera.toWorld(pixel);
}

template <>
Vec<3> onPlane(const ViewCamera<3>& camera, const Vec<2>& pixel, const Vec<3>& through) {
  const auto ray = camera.ray(pixel);
  const Vec<3> towards = camera.towards();
  return ray.origin + (through - ray.origin).dot(towards) / ray.direction.dot(towards) * ray.direction;
}

template <>
Picked<2> pick(const Simulation<2>& world, const ViewCamera<2>& camera, const Vec<2>& pixel) {
  Picked<2> out{-1, camera.toWorld(pixel)};
  forAllParts<2>(world, [&](std::int32_t body, const ShapeView<2>& view, const Pose<2>& X_WP) {
    const auto i = static_cast<std::size_t>(body);
    const auto& type = world.bodies().type;
    if (out.slot >= 0 && moves(type[static_cast<std::size_t>(out.slot)]) && !moves(type[i])) return;
    if (containsPoint(view, X_WP, out.point)) out.slot = body;
  });
  return out;
}

template <>
Picked<3> pick(const Simulation<3>& world, const ViewCamera<3>& camera, const Vec<2>& pixel) {
  const auto ray = camera.ray(pixel);
  Picked<3> out{-1, onPlane<3>(camera, pixel, camera.origin())};
  constexpr Real kFar = std::numeric_limits<Real>::infinity();
  Real nearest = kFar;
  bool moving = false;
  forAllParts<3>(world, [&](std::int32_t body, const ShapeView<3>& view, const Pose<3>& X_WP) {
    const bool better = moves(world.bodies().type[static_cast<std::size_t>(body)]);
    if (moving && !better) return;
    const Real most = better && !moving ? kFar : nearest;
    const RayEntry<3> hit = rayEntry(view, X_WP, ray.origin, ray.direction, most);
    if (hit.t < 0 || hit.t >= most) return;
    nearest = hit.t, moving = better, out.slot = body, out.point = ray.origin + hit.t * ray.direction;
  });
  return out;
}

template <int D>
Vec<D> freePoint(const Simulation<D>& world, const ViewCamera<D>& camera, const Vec<2>& pixel) {
  const Picked<D> picked = pick(world, camera, pixel);
  if (picked.slot >= 0 && moves(world.bodies().type[static_cast<std::size_t>(picked.slot)])) return picked.point;
  return onPlane<D>(camera, pixel, camera.origin());
}

template Vec<2> freePoint(const Simulation<2>&, const ViewCamera<2>&, const Vec<2>&);
template Vec<3> freePoint(const Simulation<3>&, const ViewCamera<3>&, const Vec<2>&);

namespace {

// Exact.
bool isWithin(const ViewCamera<2>& camera, const ShapeView<2>& view, const Pose<2>& X_WP, const Vec<2>& lo,
              const Vec<2>& hi) {
  const Vec<2> a = camera.toWorld(lo), b = camera.toWorld(hi);
  return overlapsBox(view, X_WP, Aabb<2>{a.cwiseMin(b), a.cwiseMax(b)});
}

// Compares the hull of 64 support points on the screen. A rectangle that overlaps only a flat corner, or in strong
// perspective only the rim, may be missed, by up to about 1/40 of the shape's size.
bool isWithin(const ViewCamera<3>& camera, const ShapeView<3>& view, const Pose<3>& X_WP, const Vec<2>& lo,
              const Vec<2>& hi) {
  constexpr int kDirections = 64;
  std::vector<Vec<2>> outline;
  for (int i = 0; i < kDirections; ++i) {
    const Real angle = Real(2 * 3.141592653589793) * Real(i) / kDirections;
    const Vec<3> d = X_WP.q.inverse() * Vec<3>(std::cos(angle) * camera.right() + std::sin(angle) * camera.up());
    const Vec<2> at = camera.toPixel(X_WP * Vec<3>(coreSupport(view, d) + view.radius * d));
    if (!at.allFinite()) return false;  // behind the viewer
    outline.push_back(at);
  }
  // Separating axes: those of the rectangle and the normals of the outline.
  std::vector<Vec<2>> axes = {Vec<2>::UnitX(), Vec<2>::UnitY()};
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec<2> edge = outline[(i + 1) % outline.size()] - outline[i];
    axes.push_back({-edge[1], edge[0]});
  }
  const Vec<2> middle = (lo + hi) / 2, half = (hi - lo) / 2;
  return std::all_of(axes.begin(), axes.end(), [&](const Vec<2>& axis) {
    Real least = std::numeric_limits<Real>::infinity(), most = -least;
    for (const Vec<2>& p : outline) least = std::min(least, axis.dot(p)), most = std::max(most, axis.dot(p));
    const Real at = axis.dot(middle), reach = axis.cwiseAbs().dot(half);
    return least <= at + reach && most >= at - reach;
  });
}

}  // namespace

template <int D>
std::vector<std::int32_t> within(const Simulation<D>& world, const ViewCamera<D>& camera, const Vec<2>& corner,
                                 const Vec<2>& other) {
  const Vec<2> lo = corner.cwiseMin(other), hi = corner.cwiseMax(other);
  std::vector<bool> in(world.bodies().pose.size(), false);
  forAllParts<D>(world, [&](std::int32_t body, const ShapeView<D>& view, const Pose<D>& X_WP) {
    const auto i = static_cast<std::size_t>(body);
    in[i] = in[i] || isWithin(camera, view, X_WP, lo, hi);
  });
  std::vector<std::int32_t> out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (in[i]) out.push_back(static_cast<std::int32_t>(i));
  }
  return out;
}

template std::vector<std::int32_t> within(const Simulation<2>&, const ViewCamera<2>&, const Vec<2>&, const Vec<2>&);
template std::vector<std::int32_t> within(const Simulation<3>&, const ViewCamera<3>&, const Vec<2>&, const Vec<2>&);

}}  // namespace lpc::LPC_PRECISION
