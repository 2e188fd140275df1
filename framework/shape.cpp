// SPDX-License-Identifier: Zlib
#include "framework/shape.h"

#include <algorithm>
#include <array>
#include <string>

#include "framework/check.h"

namespace lpc::inline LPC_PRECISION {
namespace {

constexpr std::array<std::string_view, kShapeKinds> kKindNames = {"sphere", "capsule", "segment", "box", "polytope"};

// One line of what was found and what would do; the comparison is written so that NaN is refused, too.
void requireSize(const char* shape, const char* what, Real value, bool zeroAllowed) {
  const bool large = zeroAllowed ? value >= 0 : value > 0;
  if (large && std::isfinite(value)) return;
  throw UserError(std::string(shape) + ": " + what + " is " + std::to_string(value) + "; valid: finite and " +
                  (zeroAllowed ? "not negative" : "above zero"));
}

}  // namespace

std::string_view shapeKindName(ShapeKind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

ShapeKind shapeKindFromName(std::string_view name) {
  std::string valid;
  for (std::size_t i = 0; i < kKindNames.size(); ++i) {
    if (kKindNames[i] == name) return static_cast<ShapeKind>(i);
    valid += (i ? ", " : "") + std::string(kKindNames[i]);
  }
  throw UserError("there is no shape '" + std::string(name) + "'; valid: " + valid);
}

template <int D>
Shape<D> Shape<D>::sphere(Real radius) {
  requireSize("sphere", "radius", radius, true);
  Shape s;
  s.m_view.kind = ShapeKind::sphere, s.m_view.radius = radius;
  return s;
}

template <int D>
Shape<D> Shape<D>::box(const Vec<D>& halfExtents, Real rounding) {
  for (int k = 0; k < D; ++k) requireSize("box", "a half extent", halfExtents[k], false);
  requireSize("box", "rounding", rounding, true);
  Shape s;
  s.m_view.kind = ShapeKind::box, s.m_view.half = halfExtents, s.m_view.radius = rounding;
  return s;
}

template <int D>
Shape<D> Shape<D>::capsule(Real halfLength, Real radius) {
  requireSize("capsule", "half length", halfLength, true);
  requireSize("capsule", "radius", radius, false);
  Shape s;
  s.m_view.kind = ShapeKind::capsule, s.m_view.half[0] = halfLength, s.m_view.radius = radius;
  return s;
}

template <int D>
Shape<D> Shape<D>::segment(Real halfLength) {
  if (D != 2) throw UserError("segment: exists in 2D only; valid in 3D: sphere, capsule, box, polytope");
  requireSize("segment", "half length", halfLength, false);
  Shape s;
  s.m_view.kind = ShapeKind::segment, s.m_view.half[0] = halfLength;
  return s;
}

template <int D>
Shape<D> Shape<D>::polytope(std::span<const Vec<D>> points, Real rounding) {
  return polytope(convexHull(points), rounding);
}

template <int D>
Shape<D> Shape<D>::polytope(std::shared_ptr<const Polytope<D>> hull, Real rounding) {
  if (!hull) throw UserError("polytope: there is no hull");
  requireSize("polytope", "rounding", rounding, true);
  Shape s;
  s.m_view.kind = ShapeKind::polytope, s.m_view.radius = rounding, s.m_view.hull = hull.get();
  s.m_hull = std::move(hull);
  return s;
}

template <int D>
Aabb<D> boundingBox(const ShapeView<D>& shape, const Pose<D>& X_WS) {
  Aabb<D> box{X_WS.p, X_WS.p};
  if (shape.kind == ShapeKind::polytope) {
    box = Aabb<D>{};
    for (const Vec<D>& v : shape.hull->vertices) {
      const Vec<D> p = X_WS * v;
      box.lo = box.lo.cwiseMin(p), box.hi = box.hi.cwiseMax(p);
    }
  } else if (shape.kind != ShapeKind::sphere) {
    const Vec<D> extent = X_WS.q.matrix().cwiseAbs() * shape.half;  // capsule and segment: half = (h, 0, 0)
    box.lo -= extent, box.hi += extent;
  }
  return box.grown(shape.radius);
}

template <int D>
Real boundingRadius(const ShapeView<D>& shape) {
  if (shape.kind != ShapeKind::polytope) return shape.half.norm() + shape.radius;
  Real r = 0;
  for (const Vec<D>& v : shape.hull->vertices) r = std::max(r, v.norm());
  return r + shape.radius;
}

template class Shape<2>;
template class Shape<3>;
template Aabb<2> boundingBox(const ShapeView<2>&, const Pose<2>&);
template Aabb<3> boundingBox(const ShapeView<3>&, const Pose<3>&);
template Real boundingRadius(const ShapeView<2>&);
template Real boundingRadius(const ShapeView<3>&);

}  // namespace lpc::inline LPC_PRECISION
