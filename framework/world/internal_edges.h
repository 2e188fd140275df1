// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <vector>

#include "framework/problem/contact.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Corrects contacts with parts of surfaces in the manifolds from index `first` on, so that they are contacts of the
/// whole surface. The contact generator sees each triangle alone. So it makes normals across internal edges, on which
/// sliding bodies stumble. Each normal is compared with the cone of the surface's normals at the touched corner or
/// edge:
///
/// - Across a convex edge the cone spans the normals of the two triangles.
/// - When the neighbour is level or rises, the cone is only the triangle's own normal.
/// - At a border of the surface the cone reaches to the triangle's plane.
///
/// A normal inside the cone stays. Any other normal is replaced by the nearest one in the cone, and separations are
/// measured along it. Points farther than the margin (m), or above a neighbour, are removed. So are contacts that push
/// into the solid side. Manifolds before `first` stay unchanged.
template <int D>
void correctSurfaceContacts(std::span<const ShapeRecord<D>> shapes, std::span<const Pose<D>> pose, Real margin,
                            std::size_t first, std::vector<Manifold<D>>& manifolds);

}}  // namespace lpc::LPC_PRECISION
