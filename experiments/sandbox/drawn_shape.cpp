// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/drawn_shape.h"

#include <algorithm>
#include <cmath>

#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr Real kLeast = Real(0.01);  // m: smaller shapes are slips of the mouse

Rot<2> turned(const Rot<2>& q, Real angle) { return q * Rot<2>::angle(angle); }
Rot<3> turned(const Rot<3>& q, Real angle) { return q * Rot<3>::vector({0, 0, angle}); }

template <int D>
Vec<D> lifted(const Vec<2>& p, Real z) {
  if constexpr (D == 2) {
    return p;
  } else {
    return {p[0], p[1], z};
  }
}

template <int D>
Shape<D> boxOf(const Vec<2>& half) {
  if constexpr (D == 2) {
    return Shape<2>::box(half);
  } else {
    return Shape<3>::box({half[0], half[1], half.minCoeff()});
  }
}

template <int D>
std::optional<Shape<D>> polygonOf(std::span<const Vec<2>> points, const Vec<2>& middle) {
  if (points.size() < 3) return std::nullopt;
  Vec<2> lo = points[0], hi = points[0];
  for (const Vec<2>& p : points) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
  std::vector<Vec<D>> corners;
  for (const Vec<2>& p : points) {
    if constexpr (D == 2) {
      corners.push_back(p - middle);
    } else {
      const Real depth = (hi - lo).minCoeff() / 2;
      for (const Real z : {-depth, depth}) corners.push_back(lifted<D>(p - middle, z));
    }
  }
  try {
    return Shape<D>::polytope(corners);
  } catch (const UserError&) {  // collinear points
    return std::nullopt;
  }
}

}  // namespace

template <int D>
std::optional<BodyDef<D>> drawnShape(DrawnKind kind, std::span<const Vec<2>> points, const DrawingPlane<D>& plane) {
  if (points.size() < 2) return std::nullopt;
  const Vec<2> from = points.front(), to = points.back(), way = to - from;
  Vec<2> middle = (from + to) / 2;
  Rot<D> q = plane.q;
  std::optional<Shape<D>> shape;
  switch (kind) {
    case DrawnKind::circle:
      middle = from;
      if (way.norm() >= kLeast) shape = Shape<D>::sphere(way.norm());
      break;
    case DrawnKind::box:
      if (way.cwiseAbs().minCoeff() >= kLeast) shape = boxOf<D>(way.cwiseAbs() / 2);
      break;
    case DrawnKind::capsule:
      if (way.norm() >= kLeast) shape = Shape<D>::capsule(way.norm() / 2, way.norm() / 6);
      q = turned(q, std::atan2(way[1], way[0]));
      break;
    case DrawnKind::polygon:
      middle = Vec<2>::Zero();
      for (const Vec<2>& p : points) middle += p / static_cast<Real>(points.size());
      shape = polygonOf<D>(points, middle);
      break;
  }
  if (!shape) return std::nullopt;
  BodyDef<D> def;
  def.X_WB = {plane.origin + plane.q * lifted<D>(middle, 0), q};
  def.shapes.push_back({.shape = *shape});
  return def;
}

template std::optional<BodyDef<2>> drawnShape(DrawnKind, std::span<const Vec<2>>, const DrawingPlane<2>&);
template std::optional<BodyDef<3>> drawnShape(DrawnKind, std::span<const Vec<2>>, const DrawingPlane<3>&);

}}  // namespace lpc::LPC_PRECISION
