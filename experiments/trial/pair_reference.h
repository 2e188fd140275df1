// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/shape.h"

namespace lpc::inline LPC_PRECISION {

/// The signed distance of two shapes (X_AB: B's pose in A), in double whatever the build's precision, by brute force
/// and without any algorithm of the registry.
///
/// For every unit n the gap g(n) = -h_A(n) - h_B(-n) is a proved lower bound of the signed distance, and the distance
/// is the largest g: over directions between the closest features when the shapes are apart, over face normals and
/// edge-edge normals when they overlap. All such directions are tried, so the result is the distance but for rounding
/// (about 1e-15 of the shapes' size), and never above it by more.
template <int D>
double bruteForceDistance(const ShapeView<D>& a, const ShapeView<D>& b, const Pose<D>& X_AB);

}  // namespace lpc::inline LPC_PRECISION
