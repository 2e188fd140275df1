// SPDX-License-Identifier: Zlib
// All tolerances of the contact generators that are not parameters, each with unit, meaning and danger. The two lengths
// that a kernel compares with, `rounding` and `tolerance`, belong to a pair and are made of these in contact_patch.h.
#pragma once

#include <limits>

#include "framework/math/tolerances.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

/// The unit of those that rounding dictates: the rounding of one number (1). Larger or smaller it cannot be.
inline constexpr Real kEpsilon = std::numeric_limits<Real>::epsilon();

// --- lengths of a pair ----------------------------------------------------------------------------------------------

/// Lengths below this part (1) of the reaches of both cores and their distance are noise. Larger: shallow contacts get
/// the direction of an axis instead of the one between their witnesses. Smaller: normals made of rounding.
inline constexpr Real kNoise = 64 * kEpsilon;

/// Default of the parameter `bias`: depths that differ by less than this (m) are alike. Larger: a reference face, or an
/// edge pair's normal, that is wrong by as much. Smaller: equals take turns from step to step, and impulses are lost.
inline constexpr Real kBias = kLinearSlop / 10;

/// The bias is cut to this part of the thinner core (1). Larger: the two faces of a thin plate, or the ends of a short
/// edge, are alike. Smaller: thin bodies have no bias and flicker.
inline constexpr Real kThinPart = Real(0.01);

// --- directions -----------------------------------------------------------------------------------------------------

/// Edges more parallel than this (sine) span no axis: their cross product is mostly rounding. Their true axis is then
/// within this angle of one that the faces, or edges at their ends, already give. Smaller: noise. Larger: wrong depth,
/// by the sine times the edge's length.
inline constexpr Real kParallelSine = sizeof(Real) == 8 ? Real(1e-6) : Real(1e-3);

/// Segments more parallel than this (sine) span no plane: their cross product is nothing but rounding. Larger: segments
/// that do cross get a direction across one of them only, wrong by the sine times the other's length. Smaller: a
/// direction made of rounding.
inline constexpr Real kParallelCross = 16 * kEpsilon;

/// Below this part of the product of squared lengths (1) the determinant of two directions is rounding, and segments
/// are parallel: every place is as near as another. Larger: the nearest points of segments that do cross are missed,
/// until the clamps at the ends find them. Smaller: a place made of rounding.
inline constexpr Real kParallelDeterminant = 16 * kEpsilon;

/// Below this angle (sine; 3 degrees, a visible one) two logs lie on each other in two points, above it they cross in
/// one. Larger: two points with gaps below them, that hold up what should tip. Smaller: logs that roll on one point.
/// The direction across two edges is also cleaned of its rounding below it.
inline constexpr Real kNearlyParallel = Real(0.05);

/// Faces steeper than this (cosine to the normal) meet the normal almost edge-on: what lies on them is far from the
/// contact. Larger: faces that do touch give no patch but one witness. Smaller: heights divided by almost nothing.
inline constexpr Real kSteep = Real(0.1);

/// Shape 2's face is the reference only when it faces the normal better by this (cosine). Which one is hardly matters,
/// the points are the same. Larger: a tilted reference. Smaller: ties take turns, and features change their numbers.
inline constexpr Real kClearlyBetter = Real(1e-3);

// --- the choice of four points --------------------------------------------------------------------------------------

/// A kept point is left for another only for a gain above this factor (1), of squared length or of area. Larger: kept
/// points span less of the patch. Smaller: of alike points now one is kept and now another.
inline constexpr Real kClearGain = Real(1.02);

/// How often the two ends are looked for from each other (count); they rest when neither moves. Larger: nothing but
/// time. Smaller: the kept points may span less than half of the area.
inline constexpr int kMostSpreads = 6;

/// Of `extremes`: the first of the four directions lies along the x axis of shape 1, unless the normal leans on it by
/// more than this (cosine), no angle that shapes like to have; then along y. Larger,
/// near 1, and smaller, near 0: normals along an axis take turns, and the directions with them.
inline constexpr Real kLeansOnX = Real(0.8);

// --- points kept from step to step ----------------------------------------------------------------------------------

/// `breaking` is cut to this part of the smaller shape's radius (1). Larger: the corners of small things are one place.
/// Smaller: small things drop points that have hardly slid.
inline constexpr Real kBreakingPart = Real(0.05);

}}}  // namespace lpc::LPC_PRECISION::contacts
