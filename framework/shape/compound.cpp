// SPDX-License-Identifier: Zlib
// Shapes of several convex parts, and properties computed from all parts.
#include <string>

#include "framework/math/user_numbers.h"
#include "framework/shape/shape_tolerances.h"
#include "framework/shape/support_gap.h"
#include "framework/shape/support_map.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
struct Placed {
  const ShapePart<D>& part;
  Vec<D> center;  // centre of mass, in the part's own frame
  Aabb<D> box;

  explicit Placed(const ShapePart<D>& p)
      : part(p), center(massProperties(p.shape.view(), Real(1)).center), box(boundingBox(p.shape, p.X_SP)) {}

  /// Support point along unit d of the part, shrunk about its centre of mass.
  Vec<D> shrunk(const Vec<D>& d) const {
    const ShapeView<D>& view = part.shape.view();
    const Vec<D> local = part.X_SP.q.inverse() * d;
    const Vec<D> farthest = coreSupport(view, local) + view.radius * local;
    return part.X_SP * Vec<D>(center + (1 - kPartOverlap) * (farthest - center));
  }
};

// After shrinking, parts that share a face are apart by more than their rounding.
template <int D>
bool overlap(const Placed<D>& a, const Placed<D>& b) {
  if (!a.box.overlaps(b.box)) return false;
  const auto difference = [&](const Vec<D>& d) { return Vec<D>(b.shrunk(d) - a.shrunk(-d)); };
  const Vec<D> start = b.part.X_SP * b.center - a.part.X_SP * a.center;
  return !(gapToOrigin<D>(difference, start).gap > 0);
}

}  // namespace

template <int D>
Shape<D> Shape<D>::compound(std::span<const ShapePart<D>> parts, PartOverlap allowed) {
  if (parts.empty()) throw UserError("compound: no parts; valid: one or more convex shapes");
  std::vector<Placed<D>> placed;
  auto made = std::make_shared<std::vector<ShapePart<D>>>();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string subject = "compound, part " + std::to_string(i);
    if (parts[i].shape.surface()) throw UserError(subject + ": is a mesh or chain; valid: convex shapes");
    if (!parts[i].shape.convex()) throw UserError(subject + ": is a compound; valid: its convex parts");
    if (parts[i].shape.isPlane()) throw UserError(subject + ": is a plane; valid: bounded shapes");
    checkPose(parts[i].X_SP, subject);
    made->push_back(centredPart(parts[i]));
    if (allowed == PartOverlap::counted) continue;
    placed.emplace_back(parts[i]);
    for (std::size_t j = 0; j < i; ++j) {
      if (!overlap(placed[j], placed[i])) continue;
      throw UserError(subject + ": overlaps part " + std::to_string(j) + "; valid: parts without overlap");
    }
  }
  Shape s;
  s.m_compound = std::move(made);
  return std::move(s).measured();
}

template <int D>
Aabb<D> boundingBox(const Shape<D>& shape, const Pose<D>& X_WS) {
  Aabb<D> box;
  forParts(shape, X_WS, [&](const ShapeView<D>& v, const Pose<D>& X_WP) { box = box.merged(boundingBox(v, X_WP)); });
  return box;
}

template <int D>
MassProperties<D> massProperties(const Shape<D>& shape, Real density) {
  MassProperties<D> sum;
  if (shape.surface()) return sum;  // never moves
  forParts(shape, Pose<D>{}, [&](const ShapeView<D>& v, const Pose<D>& X_SP) {
    sum = combined(sum, transformed(massProperties(v, density), X_SP));
  });
  return sum;
}

template Shape<2> Shape<2>::compound(std::span<const ShapePart<2>>, PartOverlap);
template Shape<3> Shape<3>::compound(std::span<const ShapePart<3>>, PartOverlap);
template Aabb<2> boundingBox(const Shape<2>&, const Pose<2>&);
template Aabb<3> boundingBox(const Shape<3>&, const Pose<3>&);
template MassProperties<2> massProperties(const Shape<2>&, Real);
template MassProperties<3> massProperties(const Shape<3>&, Real);

}}  // namespace lpc::LPC_PRECISION
