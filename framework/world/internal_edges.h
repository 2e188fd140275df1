// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <vector>

#include "framework/problem/contact.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Corrects contacts with parts of surfaces, in the manifolds from `first` on, to those of the whole surface. Other
/// manifolds stay unchanged. The contact generator sees each triangle alone: it gives normals across internal edges, on
/// which sliding bodies stumble. Each normal is compared with the cone of the surface's normals at the touched corner
/// or edge. Across a convex edge the cone spans the normals of the two triangles. It is only the triangle's own normal
/// when the neighbour is level or rises. At a border of the surface it reaches to the triangle's plane. A normal inside
/// the cone stays. A normal outside becomes the nearest one inside, and separations are measured along it. Points
/// farther than the margin (m), or above a neighbour, are removed, as are contacts that push into the solid side.
template <int D>
void correctSurfaceContacts(std::span<const ShapeRecord<D>> shapes, std::span<const Pose<D>> pose, Real margin,
                            std::size_t first, std::vector<Manifold<D>>& manifolds);

}}  // namespace lpc::LPC_PRECISION
