// SPDX-License-Identifier: Zlib
// Which part covers which, as a 3D camera sees them.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "experiments/film/camera.h"
#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A convex part as the camera sees it.
struct SeenPart {
  std::vector<Vec<2>> outline;                    // px, convex, in order
  std::function<double(const Vec<2>&)> nearness;  // m along `towards`, of its surface at a point (px) of the outline
};

/// Nearness of the surface of a convex shape other than a plane, at a point of the picture. Exact for flat faces and
/// balls; 26 tangent planes approximate a curved core.
std::function<double(const Vec<2>&)> nearnessOf(const ShapeView<3>& shape, const Pose<3>& X_WS,
                                                const Camera<3>& camera);

struct DepthOrder {
  std::vector<std::size_t> backToFront;                      // all parts
  std::vector<std::pair<std::size_t, std::size_t>> covered;  // (covered part, covering part), also if covered partly
};
/// Compares two parts where both are visible, in the middle of the overlap of their outlines: the centre of a floor or
/// a wall is far from a body beside it. Parts that cover nothing come in the order of `seen`. Parts that cover each
/// other in a cycle have no order; it is cut at the first of them.
DepthOrder depthOrder(const std::vector<SeenPart>& seen);

}}  // namespace lpc::LPC_PRECISION
