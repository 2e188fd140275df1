// SPDX-License-Identifier: Zlib
// All tolerances of the shapes' own geometry: hulls (polytope.cpp), also those of saves (saved_state.cpp), triangles
// (triangle.cpp), surfaces (surface.cpp) and their inner edges (internal_edges.cpp), parts of compounds (compound.cpp),
// the walk to a curved core (support_gap.h) and exact questions about one shape (shape_query.cpp). Each with unit,
// meaning and danger.
#pragma once

#include <limits>

#include "framework/math/tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What rounding may have moved the points of a hull by: this part of the largest coordinate (1). Points that stand out
/// by less lie on the face. Larger: true corners are dropped. Smaller: eight corners of a turned box give twelve faces.
inline constexpr double kHullRounding = 8 * double(std::numeric_limits<Real>::epsilon());

/// A hull's extent, and its inverse, may be as large as this (m): products of three coordinates stay in the range of a
/// double, and of a Real for the queries. Larger: lengths and volumes overflow. Smaller: usable sizes are refused.
inline constexpr double kLargestExtent = sizeof(Real) == 8 ? 1e100 : 1e12;

/// A face's normal may be off its unit length by this (1), beyond it the face is not one and the hull is tried again.
/// Larger: a normal that is no direction. Smaller: below the rounding of a float (6e-8) all hulls are refused.
inline constexpr double kFaceNormalError = 1e-5;

/// A hull in space that is no thicker than this many times that rounding is none (1). Larger: usable plates are
/// refused. Smaller: Qhull's merging does not end (four of 60,000 plates of about 12), or finds no whole faces (every
/// tenth).
inline constexpr double kThinnestHull = 20;

/// A face's loop turns inwards at a corner where the sine of the turn is beyond this (1). Larger: dents stay.
/// Smaller: faces of no area where three corners lie on a line.
inline constexpr double kDent = 1e-10;

/// What bridges a dent is a face of the other side when no point stands out of it by more than this many times the
/// rounding (1): up to 4 where it is one, 16 and more where it is none. Larger: a face through the hull. Smaller: a
/// face that is missing.
inline constexpr double kDentDepth = 8;

/// What the rounding is multiplied by from try to try (1), when a near-degenerate cloud gives no closed hull: each one
/// merges more. Larger: hulls that leave points outside. Smaller, or fewer: clouds are refused that have a hull.
inline constexpr double kHullTries[] = {1, 4, 16};

/// What rounding may take from the height of a hull's vertex above or below another one or a face (1, of the farthest
/// coordinate): two sums of three products each. Larger: climbs along a hull's edges stop at more vertices that are as
/// high, and look at all instead. Smaller: one ends at a vertex that is not the farthest.
inline constexpr double kHeightRounding = 4 * double(std::numeric_limits<Real>::epsilon());

/// Three corners of a face, seen from the hull's middle, turn left when their determinant is above this part of the
/// cube of the hull's radius (1). Larger: hulls with narrow faces are never climbed on. Smaller: a turn made of
/// rounding.
inline constexpr double kLeftTurn = 16 * double(std::numeric_limits<Real>::epsilon());

/// A hull whose middle is farther from its frame's origin than this many times its size is moved to its middle (1).
/// Larger: float answers about hulls that are off by more than 1e-5 of their size. Smaller: hulls and saves that were
/// right change by a rounding.
inline constexpr Real kFarHull = 10;

/// An edge whose part across the edges before it is no longer than this (1, of its length) spans no face with them.
/// Larger: narrow faces are passed over, the walk ends too far. Smaller: a foot made of rounding.
inline constexpr Real kFlatFace = 4 * std::numeric_limits<Real>::epsilon();

/// The walk ends when length and bound differ by this part (1) of the coordinates it is made of. Larger: a gap that is
/// too small. Smaller: steps that turn round in rounding, until there is no descent.
inline constexpr Real kGapRounding = 4 * std::numeric_limits<Real>::epsilon();

/// Steps of that walk (count); about 10 are needed for most. Smaller: a gap that is too small, a direction that is off.
/// Larger: nothing but time, it ends where there is no descent.
inline constexpr int kMostGapSteps = 64;

/// A ray has met a curved core when what is ahead is this part (1) of the coordinates it is made of. Larger: hits
/// before the surface. Smaller: a ray that stands on the surface and never arrives.
inline constexpr Real kRayRounding = 4 * std::numeric_limits<Real>::epsilon();

/// Steps of a ray towards a curved core (count), then it grazes and misses. Smaller: rays that hit at a low angle are
/// missed. Larger: time for those that graze.
inline constexpr int kMostRaySteps = 256;

/// A triangle is no flatter than this many times the rounding of its corners (1). Larger: usable slivers are refused.
/// Smaller: a normal made of rounding.
inline constexpr double kFlattestTriangle = 8;

/// Triangles of a mesh, segments of a chain at most (count). Larger: numbers of edges overflow 32 bits, and gigabytes.
/// Smaller: usable meshes are refused.
inline constexpr std::size_t kMostTriangles = std::size_t(1) << 22;

/// A box that is brought into a surface's frame grows by this part (1) of its coordinates there. Larger: more triangles
/// are looked at. Smaller: one that touches the box is missed for rounding.
inline constexpr Real kTurnedBox = 8 * std::numeric_limits<Real>::epsilon();

/// A contact normal that leans over an edge of its triangle by less than this (1, the sine) is the triangle's own.
/// Larger: bodies that slide are slowed by what is left. Smaller: rounding alone corrects every normal.
inline constexpr Real kLeans = 16 * std::numeric_limits<Real>::epsilon();

/// A contact normal may look to the solid side of its triangle by this (1, the sine) before the contact is dropped.
/// Larger: bodies are pushed inwards. Smaller: of what lies on a neighbour at a right angle rounding decides whether
/// the edge carries, too.
inline constexpr Real kAgainstSolid = Real(1e-4);

/// Two triangles that share an edge lie back to back when the cosine of the angle of their normals is below this (1).
/// Larger: sharp wedges count as folded, which changes nothing but what rounding says. Smaller: of a folded sheet
/// rounding says whether its rim is a ridge or a crack.
inline constexpr Real kBackToBack = Real(-0.99999);

/// A corrected contact stays when its foot is off the triangle by no more than this (m). Larger: bodies are carried by
/// neighbours beside them, a box before it has come to a step. Smaller: of a box on a fine mesh rounding drops corners
/// that stand on an edge.
inline constexpr Real kFootOff = kLinearSlop / 5;

/// Parts of a compound may overlap by this share of their sizes (1) though overlap is refused. Larger: mass that is
/// counted twice goes unseen. Smaller: parts that share a face are refused for their rounding, of which a gap keeps the
/// root: in float, where the parts are 20 times as wide as they are thick.
inline constexpr Real kPartOverlap = sizeof(Real) == 8 ? Real(1e-4) : Real(1e-2);

/// A user's support function may be off by this part of the core's extent (1). Larger: a core with a dent of that depth
/// is taken. Smaller: honest rounding is refused.
inline constexpr Real kSupportRounding = 64 * std::numeric_limits<Real>::epsilon();

}}  // namespace lpc::LPC_PRECISION
