// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <vector>

#include "framework/problem/contact.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Contacts with parts of surfaces, in the manifolds from `first` on, as the whole surface would have them; all others
/// stay as they are. A pair of convex parts sees a triangle alone: it has normals across edges where the surface goes
/// on, over which bodies stumble that slide. Here each normal is held against the cone of the surface's own normals at
/// the corner or edge where it touches: between the two triangles' across a convex edge, the triangle's own alone where
/// the neighbour lies level or rises, any up to its plane where the surface ends. What is outside becomes the nearest
/// that is allowed, and the separations are measured along it anew; points farther than the margin (m), or that stand
/// on a neighbour, go, and so does what would push into the solid side. A normal within the cone is not touched.
template <int D>
void correctSurfaceContacts(std::span<const ShapeRecord<D>> shapes, std::span<const Pose<D>> pose, Real margin,
                            std::size_t first, std::vector<Manifold<D>>& manifolds);

}}  // namespace lpc::LPC_PRECISION
