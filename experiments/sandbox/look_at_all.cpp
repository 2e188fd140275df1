// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/look_at_all.h"

#include <algorithm>

#include "framework/math/aabb.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Extends down to the lowest top of a fixed body beneath them, on which they will fall, but no farther than their own
// size.
template <int D>
Real floorBelow(const Simulation<D>& world, const Aabb<D>& moving) {
  Real floor = moving.lo[1];
  for (const ShapeRecord<D>& record : world.shapes()) {
    if (record.body < 0) continue;
    const auto body = static_cast<std::size_t>(record.body);
    if (world.bodies().type[body] != BodyType::fixed) continue;
    const Pose<D> X_WS = world.bodies().pose[body] * record.X_CS;
    Real top = X_WS.p[1];
    if (!record.shape.isPlane()) {
      const Aabb<D> box = boundingBox(record.shape, X_WS);
      bool beneath = true;
      for (int d = 0; d < D; ++d) beneath &= d == 1 || (box.lo[d] < moving.hi[d] && box.hi[d] > moving.lo[d]);
      if (!beneath) continue;
      top = box.hi[1];
    }
    if (top < floor) floor = top;
  }
  return std::max(floor, moving.lo[1] - (moving.hi - moving.lo).maxCoeff());
}

}  // namespace

template <int D>
void lookAtAll(ViewCamera<D>& camera, const Simulation<D>& world) {
  Aabb<D> moving, bounded;
  for (const ShapeRecord<D>& record : world.shapes()) {
    if (record.body < 0 || record.shape.isPlane()) continue;
    const auto body = static_cast<std::size_t>(record.body);
    const Aabb<D> box = boundingBox(record.shape, world.bodies().pose[body] * record.X_CS);
    bounded = bounded.merged(box);
    if (world.bodies().type[body] != BodyType::fixed) moving = moving.merged(box);
  }
  const auto any = [](const Aabb<D>& box) { return (box.lo.array() <= box.hi.array()).all(); };
  if (any(moving)) moving.lo[1] = floorBelow(world, moving);
  if (any(bounded)) camera.look(any(moving) ? moving.lo : bounded.lo, any(moving) ? moving.hi : bounded.hi);
}

template void lookAtAll(ViewCamera<2>&, const Simulation<2>&);
template void lookAtAll(ViewCamera<3>&, const Simulation<3>&);

}}  // namespace lpc::LPC_PRECISION
