// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/look_at_all.h"

#include "framework/aabb.h"

namespace lpc::inline LPC_PRECISION {

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
  if (any(bounded)) camera.look(any(moving) ? moving.lo : bounded.lo, any(moving) ? moving.hi : bounded.hi);
}

template void lookAtAll(ViewCamera<2>&, const Simulation<2>&);
template void lookAtAll(ViewCamera<3>&, const Simulation<3>&);

}  // namespace lpc::inline LPC_PRECISION
