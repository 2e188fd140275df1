// SPDX-License-Identifier: Zlib
// Finds the body under the cursor.
#pragma once

#include <vector>

#include "experiments/sandbox/view_camera.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct Picked {
  std::int32_t slot = -1;  // of the body; -1: none
  Vec<D> point;  // on the body, in the world; without a body, the cursor's point at the depth of the camera's target
};

/// The shape that contains the point, in 3D the first on the cursor's ray. Moving bodies precede fixed ones, also
/// behind them. Planes are ignored.
template <int D>
Picked<D> pick(const Simulation<D>& world, const ViewCamera<D>& camera, const Vec<2>& pixel);

/// The cursor's point on the plane through a point, parallel to the window.
template <int D>
Vec<D> onPlane(const ViewCamera<D>& camera, const Vec<2>& pixel, const Vec<D>& through);

/// The position for a new body: on a moving body, or else at the depth of the camera's target. In a room the first wall
/// is ignored.
template <int D>
Vec<D> freePoint(const Simulation<D>& world, const ViewCamera<D>& camera, const Vec<2>& pixel);

/// Bodies with a part, other than planes, that a rectangle of the window (px) overlaps, by slot. In 3D all of the part
/// must be in front of the viewer.
template <int D>
std::vector<std::int32_t> within(const Simulation<D>& world, const ViewCamera<D>& camera, const Vec<2>& corner,
                                 const Vec<2>& other);

}}  // namespace lpc::LPC_PRECISION
