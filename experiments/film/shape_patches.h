// SPDX-License-Identifier: Zlib
// A shape as patches for a camera. The caller decides colours and the order of shapes.
#pragma once

#include <vector>

#include "experiments/film/camera.h"
#include "experiments/film/picture.h"
#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The outline (px) of a bounded shape: its support points in the directions of the image plane.
template <int D>
std::vector<Vec<2>> outlineOf(const ShapeView<D>& shape, const Pose<D>& X_WS, const Camera<D>& camera);

/// The part of a plane near the middle of the view (px).
template <int D>
std::vector<Vec<2>> planePatch(const Pose<D>& X_WS, const Camera<D>& camera);

/// A bounded shape, with its patches from back to front.
template <int D>
std::vector<Patch> patchesOf(const ShapeView<D>& shape, const Pose<D>& X_WS, const Camera<D>& camera,
                             const DrawColour& fill, const DrawColour& edge);

}}  // namespace lpc::LPC_PRECISION
