// SPDX-License-Identifier: Zlib
#include "framework/shape/shape.h"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "framework/math/check.h"
#include "framework/math/names.h"
#include "framework/shape/curved_core.h"
#include "framework/shape/surface.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr IndexedArray<std::string_view, kShapeKinds> kKindNames = {
    "sphere", "capsule", "segment", "box", "polytope", "cylinder", "ellipsoid", "plane", "cone", "triangle", "custom"};

// Throws one line with what was found and what is valid; written so that NaN is rejected too.
void requireSize(const char* shape, const char* what, Real value, bool zeroAllowed) {
  const bool large = zeroAllowed ? value >= 0 : value > 0;
  if (large && std::isfinite(value)) return;
  throw UserError(std::string(shape) + ": " + what + " is " + std::to_string(value) + "; valid: finite and " +
                  (zeroAllowed ? "not negative" : "above zero"));
}

}  // namespace

std::string_view shapeKindName(ShapeKind kind) { return kKindNames[kind]; }

ShapeKind shapeKindFromName(std::string_view name) {
  for (std::size_t i = 0; i < kKindNames.size(); ++i) {
    if (kKindNames[i] == name) return static_cast<ShapeKind>(i);
  }
  throw UserError("unknown shape '" + std::string(name) + "'" +
                  validNames({kKindNames.begin(), kKindNames.end()}, name));
}

bool kindExists(ShapeKind kind, int dimension) {
  if (kind == ShapeKind::custom) {
    const auto isIn = [&](const auto& kinds) {  // a core without sizes cannot be drawn, saved or scaled
      const auto found = kinds.find(kind);
      return found != kinds.end() && !found->second.sizes.empty();
    };
    return dimension == 2 ? isIn(curvedKinds<2>()) : isIn(curvedKinds<3>());
  }
  if (kind == ShapeKind::segment) return dimension == 2;
  const bool spatial = kind == ShapeKind::cylinder || kind == ShapeKind::cone || kind == ShapeKind::triangle;
  return dimension == 3 || !spatial;
}

template <int D>
Shape<D> Shape<D>::sphere(Real radius) {
  requireSize("sphere", "radius", radius, true);
  Shape s;
  s.m_view.kind = ShapeKind::sphere, s.m_view.radius = radius;
  return std::move(s).measured();
}

template <int D>
Shape<D> Shape<D>::box(const Vec<D>& halfExtents, Real rounding) {
  for (int k = 0; k < D; ++k) requireSize("box", "a half extent", halfExtents[k], false);
  requireSize("box", "rounding", rounding, true);
  Shape s;
  s.m_view.kind = ShapeKind::box, s.m_view.half = halfExtents, s.m_view.radius = rounding;
  return std::move(s).measured();
}

template <int D>
Shape<D> Shape<D>::capsule(Real halfLength, Real radius) {
  requireSize("capsule", "half length", halfLength, true);
  requireSize("capsule", "radius", radius, false);
  Shape s;
  s.m_view.kind = ShapeKind::capsule, s.m_view.half[0] = halfLength, s.m_view.radius = radius;
  return std::move(s).measured();
}

template <int D>
Shape<D> Shape<D>::segment(Real halfLength) {
  if (D != 2) throw UserError("segment: 2D only; valid in 3D: sphere, capsule, box, polytope");
  requireSize("segment", "half length", halfLength, false);
  Shape s;
  s.m_view.kind = ShapeKind::segment, s.m_view.half[0] = halfLength;
  return std::move(s).measured();
}

template <int D>
Shape<D> Shape<D>::polytope(std::span<const Vec<D>> points, Real rounding) {
  return polytope(convexHull(points), rounding);
}

template <int D>
Shape<D> Shape<D>::polytope(std::shared_ptr<const Polytope<D>> hull, Real rounding) {
  if (!hull) throw UserError("polytope: the hull is null");
  requireSize("polytope", "rounding", rounding, true);
  if constexpr (D == 3) {
    if (hull->firstSpoke.size() != hull->vertices.size() + 1) {  // a hull made by hand
      auto linked = std::make_shared<Polytope<3>>(*hull);
      linkVertices(*linked);
      if (linked->firstSpoke.empty()) throw UserError("polytope: a face or an edge refers to a missing vertex");
      hull = std::move(linked);
    }
  }
  Shape s;
  s.m_view.kind = ShapeKind::polytope, s.m_view.radius = rounding, s.m_view.hull = hull.get();
  for (const Vec<D>& v : hull->vertices) s.m_view.half = s.m_view.half.cwiseMax(v.cwiseAbs()).eval();
  s.m_hull = std::move(hull);
  return std::move(s).measured();
}

template <int D>
Shape<D> Shape<D>::triangle(const Vec<D>& p0, const Vec<D>& p1, const Vec<D>& p2, Real rounding) {
  requireSize("triangle", "rounding", rounding, true);
  if constexpr (D == 2) {
    throw UserError("triangle: 3D only; valid in 2D: polytope");
  } else {
    Shape s;
    s.m_hull = flatTriangle({p0, p1, p2}, "triangle");
    s.m_view.kind = ShapeKind::triangle, s.m_view.radius = rounding, s.m_view.hull = s.m_hull.get();
    for (const Vec<D>& v : s.m_hull->vertices) s.m_view.half = s.m_view.half.cwiseMax(v.cwiseAbs()).eval();
    return std::move(s).measured();
  }
}

template <int D>
Shape<D> Shape<D>::ofCorners(ShapeKind kind, std::span<const Vec<D>> corners, Real rounding) {
  LPC_ASSERT(coreClass(kind) == CoreClass::hull);
  if (kind != ShapeKind::triangle) return polytope(corners, rounding);
  if (corners.size() != 3) {
    throw UserError("triangle: " + std::to_string(corners.size()) + " points given; valid: 3");
  }
  return triangle(corners[0], corners[1], corners[2], rounding);
}

template <int D>
std::map<ShapeKind, CurvedKind<D>>& curvedKinds() {
  static std::map<ShapeKind, CurvedKind<D>> kinds;
  return kinds;
}

template <int D>
const CurvedKind<D>& curvedKind(ShapeKind kind) {
  const auto found = curvedKinds<D>().find(kind);
  if (found != curvedKinds<D>().end()) return found->second;
  std::string valid;
  for (const auto& [known, unused] : curvedKinds<D>()) {
    valid += (valid.empty() ? "" : ", ") + std::string(shapeKindName(known));
  }
  throw UserError(std::string(shapeKindName(kind)) + ": is not a curved shape kind in " + std::to_string(D) +
                  "D; valid: " + valid);
}

template <int D>
Shape<D> Shape<D>::curved(ShapeKind kind, std::span<const Real> sizes, Real rounding) {
  const CurvedKind<D>& made = curvedKind<D>(kind);
  const std::string name(shapeKindName(kind));
  if (made.claims > 1)
    throw UserError(name + ": " + std::to_string(made.claims) + " plugins define it; valid: one plugin");
  if (sizes.size() != made.sizes.size()) {
    throw UserError(name + ": " + std::to_string(sizes.size()) +
                    " sizes given; valid: " + std::to_string(made.sizes.size()));
  }
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    requireSize(name.c_str(), std::string(made.sizes[i]).c_str(), sizes[i], false);
  }
  requireSize(name.c_str(), "rounding", rounding, true);
  Shape s;
  s.m_curved = made.create(sizes);
  if (kind == ShapeKind::custom) {
    requireConvexCore(*s.m_curved, name);
    const std::span<const Real> kept = s.m_curved->sizes();
    if (sizes.empty() || !std::equal(sizes.begin(), sizes.end(), kept.begin(), kept.end())) {
      throw UserError(name + ": its constructor does not keep its sizes; valid: one or more sizes, all of them kept");
    }
  }
  s.m_view.kind = kind, s.m_view.radius = rounding, s.m_view.half = s.m_curved->half();
  s.m_view.curved = s.m_curved.get();
  return std::move(s).measured();
}

template <int D>
Shape<D> Shape<D>::plane() {
  Shape s;
  s.m_view.kind = ShapeKind::plane;
  return std::move(s).measured();
}

template <int D>
Shape<D> Shape<D>::measured() && {
  if (m_surface) {
    m_flat = true, m_reach = m_surface->reach();
  } else if (convex()) {
    m_flat = m_view.radius == 0 && m_view.core() != CoreClass::curved && m_view.core() != CoreClass::point;
    m_reach = boundingRadius(m_view);
  } else {
    m_flat = true;
    for (const ShapePart<D>& part : *m_compound) {
      m_flat = m_flat && part.shape.flat();
      m_reach = std::max(m_reach, part.X_SP.p.norm() + part.shape.reach());
    }
  }
  return std::move(*this);
}

template <int D>
Aabb<D> boundingBox(const ShapeView<D>& shape, const Pose<D>& X_WS) {
  Aabb<D> box{X_WS.p, X_WS.p};
  const auto extend = [&](const Vec<D>& extent) { box.lo -= extent, box.hi += extent; };
  switch (shape.core()) {
    case CoreClass::point:
      break;
    case CoreClass::segment:
    case CoreClass::box:
      extend(X_WS.q.matrix().cwiseAbs() * shape.half);  // a segment's half is (h, 0, 0)
      break;
    case CoreClass::hull:
      box = Aabb<D>{};
      for (const Vec<D>& v : shape.hull->vertices) {
        const Vec<D> p = X_WS * v;
        box.lo = box.lo.cwiseMin(p), box.hi = box.hi.cwiseMax(p);
      }
      break;
    case CoreClass::curved: {
      const Mat<D> r = X_WS.q.matrix();
      Vec<D> extent;
      for (int k = 0; k < D; ++k) {
        const Vec<D> axis = r.row(k).transpose();
        extent[k] = shape.curved->support(axis).dot(axis);
      }
      extend(extent);
      break;
    }
    case CoreClass::plane:
      extend(Vec<D>::Constant(std::numeric_limits<Real>::infinity()));
      break;
  }
  return box.grown(shape.radius);
}

template <int D>
Real boundingRadius(const ShapeView<D>& shape) {
  switch (shape.core()) {
    case CoreClass::point:
    case CoreClass::segment:
    case CoreClass::box:
    case CoreClass::curved:  // the corner of its box: not the smallest sphere, but valid for every curved core
      return shape.half.norm() + shape.radius;
    case CoreClass::plane:
      return std::numeric_limits<Real>::infinity();
    case CoreClass::hull:
      break;
  }
  Real r = 0;
  for (const Vec<D>& v : shape.hull->vertices) r = std::max(r, v.norm());
  return r + shape.radius;
}

template class Shape<2>;
template class Shape<3>;
template std::map<ShapeKind, CurvedKind<2>>& curvedKinds();
template std::map<ShapeKind, CurvedKind<3>>& curvedKinds();
template const CurvedKind<2>& curvedKind(ShapeKind);
template const CurvedKind<3>& curvedKind(ShapeKind);
template Aabb<2> boundingBox(const ShapeView<2>&, const Pose<2>&);
template Aabb<3> boundingBox(const ShapeView<3>&, const Pose<3>&);
template Real boundingRadius(const ShapeView<2>&);
template Real boundingRadius(const ShapeView<3>&);

}}  // namespace lpc::LPC_PRECISION
