// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/shape/shape_tolerances.h"
#include "framework/shape/surface.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Returns a box in frame S that contains `box_W`.
template <int D>
Aabb<D> turnedBox(const Aabb<D>& box_W, const Pose<D>& X_WS) {
  const Vec<D> half = Real(0.5) * (box_W.hi - box_W.lo);
  if (!half.allFinite()) return {-Vec<D>::Constant(std::numeric_limits<Real>::infinity()), Aabb<D>{}.lo};
  const Rot<D> back = X_WS.q.inverse();
  const Vec<D> middle_W = box_W.lo + half, middle = back * Vec<D>(middle_W - X_WS.p);
  const Vec<D> extent = back.matrix().cwiseAbs() * half;
  const Real size = middle_W.cwiseAbs().maxCoeff() + X_WS.p.cwiseAbs().maxCoeff() + half.maxCoeff();
  return Aabb<D>{middle - extent, middle + extent}.grown(kTurnedBox * size);
}

/// Calls f(number, view, X_AP) for each convex part of a shape posed by X_AS, in the order of their numbers. A surface
/// passes only the parts with boxes that may touch `box_W`, with frame A at X_WA; any other shape passes all parts.
template <int D, class F>
void forPartsNear(const Shape<D>& shape, const Pose<D>& X_AS, const Pose<D>& X_WA, const Aabb<D>& box_W,
                  std::vector<std::int32_t>& scratch, WorkDone& work, const F& f) {
  std::int32_t number = 0;
  const Surface<D>* surface = shape.surface();
  if (!surface) {
    return forParts(shape, X_AS, [&](const ShapeView<D>& part, const Pose<D>& X_AP) { f(number++, part, X_AP); });
  }
  const Aabb<D> box = turnedBox(box_W, X_WA * X_AS);
  surface->tree().find([&](const Aabb<D>& b) { return b.overlaps(box); }, scratch, work);
  for (const std::int32_t i : scratch) {
    const PlacedView<D>& part = surface->parts()[static_cast<std::size_t>(i)];
    f(i, part.view, X_AS * part.X_SP);
  }
}

}}  // namespace lpc::LPC_PRECISION
