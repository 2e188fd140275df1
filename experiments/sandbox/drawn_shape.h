// SPDX-License-Identifier: Zlib
// Shapes drawn with the cursor, from two points or the corners of a polygon.
#pragma once

#include <optional>
#include <span>

#include "framework/problem/body.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Shapes drawn by dragging from one point to another, or by several clicks.
enum class DrawnKind { circle, box, capsule, polygon };

/// The frame of the window's plane: x to the right, y up; in 3D z towards the viewer.
template <int D>
struct DrawingPlane {
  Vec<D> origin;
  Rot<D> q{};
};

/// In metres on the plane. Empty while the points do not make a shape: too close to each other, or collinear. In 3D the
/// depth of a box or polygon is its smaller width; polygons become prisms.
template <int D>
std::optional<BodyDef<D>> drawnShape(DrawnKind kind, std::span<const Vec<2>> points, const DrawingPlane<D>& plane);

}}  // namespace lpc::LPC_PRECISION
