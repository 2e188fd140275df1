// SPDX-License-Identifier: Zlib
// Who covers whom, of what a camera of 3D sees.
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

/// How near the surface of a convex shape, not a plane, is at a point of the picture. Exact for flat faces and balls;
/// of a curved core 26 tangent planes stand for it.
std::function<double(const Vec<2>&)> nearnessOf(const ShapeView<3>& shape, const Pose<3>& X_WS,
                                                const Camera<3>& camera);

struct DepthOrder {
  std::vector<std::size_t> backToFront;                      // all parts
  std::vector<std::pair<std::size_t, std::size_t>> covered;  // who is covered, even in part, and by whom
};
/// Two parts are compared where both are seen, in the middle of what their outlines share: the middles of bodies say
/// nothing of a floor or a wall, whose own is far from whoever stands beside it. What covers nobody comes as in `seen`.
/// Parts that cover each other in a ring have no order; it is cut at the first of them.
DepthOrder depthOrder(const std::vector<SeenPart>& seen);

}}  // namespace lpc::LPC_PRECISION
