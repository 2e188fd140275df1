// SPDX-License-Identifier: Zlib
// Shapes that are drawn with the cursor: what two points, or the corners of a polygon, come to.
#pragma once

#include <optional>
#include <span>

#include "framework/problem/body.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What a drag from one point to another draws, or clicks one by one.
enum class DrawnKind { circle, box, capsule, polygon };

/// The frame of the window's plane: x to the right, y up; in 3D z towards the viewer.
template <int D>
struct DrawingPlane {
  Vec<D> origin;
  Rot<D> q{};
};

/// In metres on the plane. Nothing while the points make no shape: too near to each other, all on a line. In 3D boxes
/// and polygons are as deep as their smaller side is wide, polygons prisms.
template <int D>
std::optional<BodyDef<D>> drawnShape(DrawnKind kind, std::span<const Vec<2>> points, const DrawingPlane<D>& plane);

}}  // namespace lpc::LPC_PRECISION
