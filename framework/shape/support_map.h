// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/math/check.h"
#include "framework/shape/curved_core.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Support point of the shape's core (without its rounding) along `d`, in the shape's frame. `d` may have any length;
/// for d = 0 returns any point of the core. Not for a plane. For a polytope, `hint` receives the vertex's index unless
/// it is null.
template <int D>
inline Vec<D> coreSupport(const ShapeView<D>& shape, const Vec<D>& d, int* hint = nullptr) {
  switch (shape.core()) {
    case CoreClass::point:
      return Vec<D>::Zero();
    case CoreClass::segment: {
      Vec<D> p = Vec<D>::Zero();
      p[0] = d[0] >= 0 ? shape.half[0] : -shape.half[0];
      return p;
    }
    case CoreClass::box: {
      Vec<D> p;
      for (int k = 0; k < D; ++k) p[k] = d[k] >= 0 ? shape.half[k] : -shape.half[k];
      return p;
    }
    case CoreClass::hull: {
      const auto& vertices = shape.hull->vertices;
      std::size_t best = 0;
      Real bestDot = vertices[0].dot(d);
      for (std::size_t i = 1; i < vertices.size(); ++i) {
        const Real dot = vertices[i].dot(d);
        if (dot > bestDot) best = i, bestDot = dot;
      }
      if (hint) *hint = static_cast<int>(best);
      return vertices[best];
    }
    case CoreClass::curved:
      return shape.curved->support(d);
    case CoreClass::plane:
      LPC_ASSERT(false);  // unbounded: there is no support point
      break;
  }
  return Vec<D>::Zero();
}

/// Support value: h(d) = max of p . d over the whole shape, in its frame; d need not be unit.
template <int D>
inline Real supportValue(const ShapeView<D>& shape, const Vec<D>& d) {
  return coreSupport(shape, d).dot(d) + shape.radius * d.norm();
}

}}  // namespace lpc::LPC_PRECISION
