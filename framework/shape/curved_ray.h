// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <limits>

#include "framework/shape/ray_tolerances.h"
#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Where a ray is inside a convex set, from the half-lines or spans in which it is inside of each of several sets.
template <int D>
struct RaySpan {
  RayEntry<D> enter{0};  // the normal is zero as long as the ray starts inside of all
  Real leave = std::numeric_limits<Real>::infinity();

  void from(Real t, const Vec<D>& normal) {
    if (t >= enter.t) enter = {t, normal};
  }
  void until(Real t) { leave = std::min(leave, t); }
  void never() { leave = -1; }
  /// Infinite for a miss.
  RayEntry<D> entry() const { return enter.t <= leave ? enter : RayEntry<D>{std::numeric_limits<Real>::infinity()}; }
};

/// What a curved core may know of itself, so that rays need no search by support points. In the core's own frame.
template <int D>
class ExactRays {
 public:
  virtual ~ExactRays() = default;
  /// Where the ray p + t d, d not zero, enters the core: t >= 0, with the unit normal of the surface there, on an edge
  /// that of one face through which the ray enters; t is infinite for a miss. The normal is zero when p is inside.
  virtual RayEntry<D> ray(const Vec<D>& p, const Vec<D>& d) const = 0;
  /// Unit direction to p, outside, from the point of the core nearest to it.
  virtual Vec<D> outwards(const Vec<D>& p) const = 0;
};

}}  // namespace lpc::LPC_PRECISION
