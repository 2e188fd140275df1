// SPDX-License-Identifier: Zlib
// What lies under the cursor.
#pragma once

#include <vector>

#include "experiments/sandbox/view_camera.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct Picked {
  std::int32_t slot = -1;  // of the body; -1: none
  Vec<D> point;            // on it, in the world; where there is none, what the cursor points at at the camera's target
};

/// A shape that holds the point, in 3D the first on the cursor's ray. A body that moves is meant rather than one that
/// does not: what hides it is seen through. Planes are never meant.
template <int D>
Picked<D> pick(const Simulation<D>& world, const ViewCamera<D>& camera, const Vec<2>& pixel);

/// Where the cursor is on the plane through a point that faces the viewer.
template <int D>
Vec<D> onPlane(const ViewCamera<D>& camera, const Vec<2>& pixel, const Vec<D>& through);

/// Where a new body comes: on one that moves, else as deep as the camera's target. In a room the first wall is seen
/// through.
template <int D>
Vec<D> freePoint(const Simulation<D>& world, const ViewCamera<D>& camera, const Vec<2>& pixel);

/// Bodies that are no planes and whose centres of mass are within a rectangle of the window (px), by slot.
template <int D>
std::vector<std::int32_t> within(const Simulation<D>& world, const ViewCamera<D>& camera, const Vec<2>& corner,
                                 const Vec<2>& other);

}}  // namespace lpc::LPC_PRECISION
