// SPDX-License-Identifier: Zlib
// Tolerances of the normals that rays find on curved cores, each with unit, meaning and danger.
#pragma once

#include <cmath>
#include <limits>

#include "framework/shape/shape_tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {

/// How far before its entry into a core without rounding, relative to the core's size (1), a ray measures the direction
/// to the core. Larger: the normal of another place. Smaller: a direction of rounding.
inline const Real kBeforeSurface = std::cbrt(std::numeric_limits<Real>::epsilon());

/// Newton's steps for the normal where a ray enters (count). Larger: only time. Smaller: a normal that is off by the
/// cube root of a rounding.
inline constexpr int kSettleNormal = 3;

/// The rotation (rad) over which these steps measure how the support point moves. Larger: the curvature of another
/// place. Smaller: noise.
inline const Real kNormalTurn = std::sqrt(std::sqrt(std::numeric_limits<Real>::epsilon())) / 16;

/// Steps to the point of an ellipsoid nearest to a point (count). Larger: only time. Smaller: normals of very flat
/// ellipsoids are off.
inline constexpr int kMostNearestSteps = 64;

/// A ray within this of a cone's axis, relative to the coordinates (1), enters at the tip, which has many normals.
/// Larger: the tip's normal beside it. Smaller: rounding chooses the normal.
inline constexpr Real kTip = 8 * std::numeric_limits<Real>::epsilon();

}}  // namespace lpc::LPC_PRECISION
