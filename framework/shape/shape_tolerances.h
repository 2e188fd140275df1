// SPDX-License-Identifier: Zlib
// All tolerances of the shapes' own geometry, each with unit, meaning and danger. Used for hulls in polytope.cpp,
// hull_links.cpp and centred_part.cpp, and in saved worlds in saved_state.cpp. For triangles: triangle.cpp. For
// surfaces: surface.cpp, and internal_edges.cpp for internal edges. For parts of compounds: compound.cpp. For GJK on a
// curved core: support_gap.h. For exact queries of one shape: shape_query.cpp.
#pragma once

#include <limits>

#include "framework/math/tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {

/// How far rounding may have moved the points of a hull, relative to the largest coordinate (1). Points that stand out
/// of a face by less are on the face. Larger: true corners are dropped. Smaller: eight corners of a rotated box give
/// twelve faces.
inline constexpr double kHullRounding = 8 * double(std::numeric_limits<Real>::epsilon());

/// Largest extent of a hull (m). Its inverse is the smallest extent. Products of three coordinates stay in the range of
/// a double, and in queries in the range of a Real. Larger: lengths and volumes overflow. Smaller: usable sizes are
/// rejected.
inline constexpr double kLargestExtent = sizeof(Real) == 8 ? 1e100 : 1e12;

/// Allowed error of a face normal's length (1); beyond it the face is invalid and the hull is computed again. Larger: a
/// normal that has no valid direction is accepted. Smaller: below the rounding of a float (6e-8) all hulls are
/// rejected.
inline constexpr double kFaceNormalError = 1e-5;

/// Smallest thickness of a 3D hull, in multiples of the rounding (1). Larger: usable plates are rejected. Smaller:
/// Qhull's merging does not end (4 of 60,000 plates of thickness about 12), or gives no closed faces (every tenth
/// plate).
inline constexpr double kThinnestHull = 20;

/// A face's loop turns inwards at a corner when the sine of the turn is below minus this (1). Larger: dents stay.
/// Smaller: faces without area where three corners are collinear.
inline constexpr double kDent = 1e-10;

/// The triangle that bridges a dent counts as a face of the other side when no point is outside of it by more than this
/// many times the rounding (1). Measured: up to 4 for true faces, 16 and more for others. Larger: a face cuts through
/// the hull. Smaller: a face is missing.
inline constexpr double kDentDepth = 8;

/// Factors of the rounding from attempt to attempt (1), when a near-degenerate point cloud gives no closed hull: each
/// larger factor merges more faces. Larger: hulls leave points outside. Smaller, or fewer: point clouds with a valid
/// hull are rejected.
inline constexpr double kHullTries[] = {1, 4, 16};

/// Rounding error of the height of a hull's vertex above another vertex or a face, relative to the farthest coordinate
/// (1): two sums of three products each. Larger: hill climbing stops at more vertices of nearly equal height, and
/// searches all vertices instead. Smaller: hill climbing ends at a vertex that is not the support point.
inline constexpr double kHeightRounding = 4 * double(std::numeric_limits<Real>::epsilon());

/// Three corners of a face, seen from the hull's middle, turn left when their determinant is above this fraction of the
/// cube of the hull's radius (1). Larger: hulls with narrow faces never use hill climbing. Smaller: rounding decides.
inline constexpr double kLeftTurn = 16 * double(std::numeric_limits<Real>::epsilon());

/// A hull is moved to its middle when the middle is farther from its frame's origin than this many times its size (1).
/// Larger: float answers about hulls are off by more than 1e-5 of their size. Smaller: correct hulls and saves change
/// by a rounding.
inline constexpr Real kFarHull = 10;

/// GJK skips a face when an edge is nearly parallel to the edges before it: its perpendicular part is at most this
/// fraction of its length (1). Larger: narrow faces are skipped, and GJK ends too far away. Smaller: rounding
/// determines the nearest point.
inline constexpr Real kFlatFace = 4 * std::numeric_limits<Real>::epsilon();

/// GJK ends when length and bound differ by at most this fraction of their coordinates (1). Larger: the gap is too
/// small. Smaller: steps only follow rounding, until there is no descent.
inline constexpr Real kGapRounding = 4 * std::numeric_limits<Real>::epsilon();

/// Largest number of GJK iterations (count); most queries need about 10. Smaller: the gap is too small, and its
/// direction wrong. Larger: only more time, since GJK ends when there is no descent.
inline constexpr int kMostGapSteps = 64;

/// A ray has hit a curved core when its remaining distance is at most this fraction of the coordinates (1). Larger:
/// hits before the surface. Smaller: the ray stops short of the surface and never arrives.
inline constexpr Real kRayRounding = 4 * std::numeric_limits<Real>::epsilon();

/// Largest number of steps (count) of a ray towards a curved core; then the ray counts as a grazing miss. Smaller: rays
/// that hit at a low angle miss. Larger: more time for grazing rays.
inline constexpr int kMostRaySteps = 256;

/// Smallest height of a triangle, in multiples of the rounding of its corners (1). Larger: usable slivers are rejected.
/// Smaller: rounding determines the normal.
inline constexpr double kFlattestTriangle = 8;

/// Largest number of triangles of a mesh or segments of a chain (count). Larger: edge indices overflow 32 bits;
/// gigabytes of memory. Smaller: usable meshes are rejected.
inline constexpr std::size_t kMostTriangles = std::size_t(1) << 22;

/// A box transformed into a surface's frame grows by this fraction of its coordinates there (1). Larger: more triangles
/// are tested. Smaller: rounding loses a triangle that touches the box.
inline constexpr Real kTurnedBox = 8 * std::numeric_limits<Real>::epsilon();

/// A contact normal that leans over an edge of its triangle by less than this (1, the sine) counts as the triangle's
/// own. Larger: the error that remains slows sliding bodies. Smaller: rounding alone corrects every normal.
inline constexpr Real kLeans = 16 * std::numeric_limits<Real>::epsilon();

/// How far a contact normal may point to the solid side of its triangle (1, the sine) before the contact is dropped.
/// Larger: bodies are pushed inwards. Smaller: when a body rests on a neighbour at a right angle, rounding decides
/// whether the shared edge carries the body too.
inline constexpr Real kAgainstSolid = Real(1e-4);

/// Two triangles that share an edge are back to back when the cosine of the angle between their normals is below this
/// (1). Larger: sharp wedges count as folded, which changes nothing but rounding errors. Smaller: rounding decides
/// whether the rim of a folded sheet is a ridge or a crack.
inline constexpr Real kBackToBack = Real(-0.99999);

/// A corrected contact stays when the foot of its normal is at most this far outside the triangle (m). Larger: a
/// neighbour carries a body that is still beside it, such as a box before it has reached a step. Smaller: rounding
/// drops corners of a box that stand on an edge of a fine mesh.
inline constexpr Real kFootOff = kLinearSlop / 5;

/// Allowed overlap of a compound's parts, relative to their sizes (1), when overlap is refused. Larger: mass counted
/// twice goes undetected. Smaller: parts that share a face are rejected because of rounding. GJK finds a gap only to
/// the root of the rounding: in float that matters where parts are 20 times as wide as thick.
inline constexpr Real kPartOverlap = sizeof(Real) == 8 ? Real(1e-4) : Real(1e-2);

/// Allowed error of a user's support function, relative to the core's extent (1). Larger: a core with a dent of that
/// depth is accepted. Smaller: ordinary rounding is rejected.
inline constexpr Real kSupportRounding = 64 * std::numeric_limits<Real>::epsilon();

}}  // namespace lpc::LPC_PRECISION
