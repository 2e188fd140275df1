// SPDX-License-Identifier: Zlib
// A hull far from its own frame's origin costs every query digits, even when its pose moves it back to the others.
#include "framework/shape/shape.h"
#include "framework/shape/shape_tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
ShapePart<D> centredPart(const ShapePart<D>& part) {
  if (!part.shape.convex() || part.shape.view().core() != CoreClass::hull) return part;
  const ShapeView<D>& view = part.shape.view();
  const Aabb<D> box = boundingBox(view, Pose<D>{});
  const Real size = (box.hi - box.lo).maxCoeff();
  Vec<D> middle = box.lo / 2 + box.hi / 2;
  if (!(middle.cwiseAbs().maxCoeff() > kFarHull * size)) return part;
  // Do not move it along axes where it is no farther off than its size. Then no difference below is rounded: both
  // numbers are within a factor of two of each other.
  for (Real& x : middle) x = std::abs(x) > size ? x : Real(0);
  std::vector<Vec<D>> points;
  for (const Vec<D>& v : view.hull->vertices) points.push_back(v - middle);
  try {
    // A new hull: the old one had faces merged because its coordinates were rounded more.
    return {Shape<D>::ofCorners(view.kind, points, view.radius), part.X_SP * Pose<D>{middle, {}}};
  } catch (const UserError&) {  // no closed hull of these coordinates, which are rounded less
    return part;
  }
}

template ShapePart<2> centredPart(const ShapePart<2>&);
template ShapePart<3> centredPart(const ShapePart<3>&);

}}  // namespace lpc::LPC_PRECISION
