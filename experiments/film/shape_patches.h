// SPDX-License-Identifier: Zlib
// What a camera sees of a shape, as patches: whose shape it is, and in what order it is drawn, is told elsewhere.
#pragma once

#include <vector>

#include "experiments/film/camera.h"
#include "experiments/film/picture.h"
#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The outline (px) of a bounded shape: what lies farthest in each direction of the camera's plane.
template <int D>
std::vector<Vec<2>> outlineOf(const ShapeView<D>& shape, const Pose<D>& X_WS, const Camera<D>& camera);

/// What of a plane is near the middle of the view (px).
template <int D>
std::vector<Vec<2>> planePatch(const Pose<D>& X_WS, const Camera<D>& camera);

/// A bounded shape, in the order in which its patches cover each other.
template <int D>
std::vector<Patch> patchesOf(const ShapeView<D>& shape, const Pose<D>& X_WS, const Camera<D>& camera,
                             const DrawColour& fill, const DrawColour& edge);

}}  // namespace lpc::LPC_PRECISION
