// SPDX-License-Identifier: Zlib
// All tolerances of the pair queries that are not parameters, each with unit, meaning and danger. Most are multiples of
// the rounding unit and parts of the pair's scale (core_pair.h): "x scale" is a length in m, whatever the size of the
// shapes. None of them can make an answer claim more than is true (core_pair.h): too small a value misses the best
// direction and gives a distance that is too low, too large a value costs time or blurs witnesses.
#pragma once

#include <cmath>
#include <limits>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// The unit of all below: the rounding of one number (1). Larger or smaller it cannot be.
inline constexpr Real kEpsilon = std::numeric_limits<Real>::epsilon();

// --- bounds ---------------------------------------------------------------------------------------------------------

/// Squares of lengths between this and its reciprocal (m^2) lose no digit to overflow or underflow. Larger: time.
/// Smaller: directions of very short or long vectors are wrong.
inline constexpr Real kSafeSquare = sizeof(Real) == 8 ? Real(1e-200) : Real(1e-20);

/// What rounding may take from a bound L(n) (x scale): bounds and lengths that differ by less are equal, and one above
/// its negative may belong to cores that are apart. Also GJK's default tolerance. Larger: a search ends, or leaves out
/// the nearest corners, before the last digits are right. Smaller: right answers are taken for short ones and worked
/// over in vain, and GJK's iterations run into their limit.
inline constexpr Real kBoundRounding = 8 * kEpsilon;

/// Added to an attained distance, so that it bounds the true one from above also when rounded (x scale). Larger: more
/// vertices and edges are tried. Smaller: the nearest feature may be left out.
inline constexpr Real kAttainedRounding = 64 * kEpsilon;

// --- climbs on hulls (hull_climb.h) ---------------------------------------------------------------------------------

/// On a hull with fewer vertices all are looked at (count). Larger: climbs that would be faster are not made. Smaller:
/// climbs that are slower than a look at all.
inline constexpr std::size_t kClimbVertices = 96;

/// A climb that has found so many vertices as high as its highest gives up (count). Larger: time, and no more where the
/// hull is round. Smaller: along the normal of a face with more corners all vertices are looked at.
inline constexpr std::size_t kMostLevel = 8;

// --- features -------------------------------------------------------------------------------------------------------

/// Vertices that lie no farther behind the foremost one belong to the supporting feature (x scale). Larger: witnesses
/// leave their shapes by as much, and a face's neighbours count as the face. Smaller: a face that a rounded normal
/// tilts is taken for one of its corners, and the witness jumps from corner to corner.
inline constexpr Real kFeatureBand = 64 * kEpsilon;

/// Features whose distance is larger than the least by no more than this part of it (1) and of the scale (x scale) tie:
/// all their directions are tried. Larger: more directions, nothing else. Smaller: rounding decides which one is tried,
/// and not the bound that it proves.
inline constexpr Real kTiePart = Real(1e-6);
inline constexpr Real kTieRounding = 64 * kEpsilon;

/// Edges whose common normal is shorter than this (sine) have none but noise. Larger: the axis of edges that do cross
/// is missed, the depth comes out too large by sine x length. Smaller: axes of noise are tested, which costs time only.
inline constexpr Real kParallelSine = 4 * kEpsilon;

/// A face normal within this of an edge's plane (sine) may be on either side of it: their Gauss arcs may cross. Larger:
/// more edge pairs are projected. Smaller: an arc whose end is rounded is missed, though a face normal, which is
/// tested, is then as good.
inline constexpr Real kArcSine = 64 * kEpsilon;

/// What a face's vertices may lie below its plane by, and the rounding of heights above it (x scale). Larger: edges are
/// measured by their own ends more often, which costs time only. Smaller: an edge is left out though one of its normals
/// proves more by as much.
inline constexpr Real kFaceRounding = 1024 * kEpsilon;

/// Vertices that are asked first how little a face proves (count): those that told it of the faces before. Larger: more
/// are asked in vain. Smaller: all are.
inline constexpr std::size_t kLowVertices = 4;

/// How often the way between two features of cores that are apart is made shorter by features around it (count).
/// Larger: nothing, it ends when it is the shortest. Smaller: all features near by are tried, which costs time only.
inline constexpr int kMostTurns = 32;

// --- cores with a margin --------------------------------------------------------------------------------------------

/// What core_margin takes off a shape unless told (1, part of a box's smallest half extent, of the ball around a hull's
/// middle). Larger: edges and corners that are nearest give depths farther from the least. Smaller: shapes are deeper
/// in each other than it, and need EPA.
inline constexpr Real kCoreMargin = Real(0.1);

// --- expanding polytope ---------------------------------------------------------------------------------------------

/// A first simplex with an extent of no more than this (x scale) is flat, and the difference with it: only the normals
/// of what there is are tested. Larger: a core thinner than it is answered by the normals of one plane. Smaller:
/// faces are made of rounding.
inline constexpr Real kFlat = 32 * kEpsilon;

/// In 2D, GJK's points that are no farther apart than this (kFlat x scale) are no base for a triangle: the four extreme
/// points are asked for, too. Larger: up to four supports more. Smaller: a base whose direction is rounding.
inline constexpr Real kShortBase = 1024;

/// In 3D, GJK's tetrahedron is taken when its determinant is above this part of the cube of its longest edge (1).
/// Larger: a new one is made with up to twelve supports. Smaller: needles, which faces inherit.
inline constexpr Real kThinSeed = Real(1e-3);

/// A face that a new point lies this near to (x scale) is neither seen nor hidden: the edge by which it was reached
/// decides. Larger: near-coplanar faces are dug out and depth is lost. Smaller: rounding tears the horizon apart, and
/// the status is `degenerate`.
inline constexpr Real kVisible = 4 * kEpsilon;

/// A settled face whose normal may lean so that its offset is off by more than this (tolerances of the search) is
/// worked over by its neighbourhood. 16 are faces lower than a hundredth of the scale; nearly all are higher. Larger:
/// needles keep a depth that is too small. Smaller: common faces are worked over, which costs time only.
inline constexpr Real kLeaning = 16;

/// Overlaps less deep than this (x scale) are worked over by the edges at contact. Larger: more pairs pay for it.
/// Smaller: a needle facet of a shallow overlap stays lost.
inline const Real kShallow = std::sqrt(kEpsilon);

// --- vertices near contact (local_features.h) -----------------------------------------------------------------------

/// Vertices within so many times the gap that is left (1) are near contact. Larger: more directions, and more often too
/// many vertices to try. Smaller: one that counts is left out.
inline constexpr Real kGapBand = 8;

/// More vertices near contact than this (count, of one core) are not worked over: the directions grow with the square
/// of it. Larger: slow on round hulls. Smaller: two faces with many corners keep a short bound.
inline constexpr std::size_t kMostLocalVertices = 8;

/// How often the edges at contact are gathered anew around a better direction (count). Larger: nothing, they stop when
/// nothing improves. Smaller: a direction that needs two turns stays half-way.
inline constexpr int kMostEdgeRounds = 4;

// --- curved cores ---------------------------------------------------------------------------------------------------

/// The search's tolerance is so many times as large for curved cores (1): a curved surface is never met by a facet,
/// only approached. Larger: distance and depth are left short, for Newton's steps to mend. Smaller: facets so flat that
/// their normals are made of rounding.
inline constexpr Real kCurvedTolerance = sizeof(Real) == 8 ? 64 : 4;

/// The turn (rad) over which curvature is measured: its square is a rounding of the result, and it is far above the
/// rounding of a difference of gradients. Larger: the curvature of somewhere else. Smaller: of noise.
inline const Real kTurn = std::sqrt(std::sqrt(kEpsilon)) / 16;

/// The least curvature that a step divides by, against the largest (1): on a ring of maxima there is none. Larger:
/// short steps where the core is much flatter one way than the other. Smaller: steps along the ring as long as rounding
/// likes.
inline const Real kLeastCurvature = 64 * kEpsilon / kTurn;

/// Newton's steps for the bound (count); they stop when it gets no better. Larger: nothing but time. Smaller: pairs
/// beside a ridge stay short.
inline constexpr int kMostPolishSteps = 16;

/// Newton's steps for the witnesses (count), which cost the bound no more than roundings. Larger: nothing but time.
/// Smaller: witnesses that are off by the root of a rounding.
inline constexpr int kSettleSteps = 2;

// --- witnesses (touching.h) -----------------------------------------------------------------------------------------

/// How often the features are gathered anew around a better direction (count). Larger: time. Smaller: of cores that are
/// apart, a direction that found the right features and is itself off stays.
inline constexpr int kTouchRounds = 3;

/// The band of features grows by this factor (1), from kFeatureBand or the tolerance of the search to the last one
/// (x scale), until the features of both shapes meet. Larger: witnesses leave their shapes by more. Smaller: features
/// that a leaning normal holds apart never meet, and the witnesses do not lie one above the other.
inline constexpr Real kBandGrowth = 4;
inline constexpr Real kLastBand = 1048576 * kFeatureBand;

/// How often a curved face is asked for one more point of its rim (count), and how far the direction leans towards that
/// (tangent): more than the rounding of n, and less than any visible angle. Larger: a point of another face, which the
/// band then refuses. Smaller: the same point again; fewer, and witnesses of caps that overlap in a lens lie beside it
/// (3: 5e-6 of the size, for two cylinders whose rims all but pass each other).
inline constexpr int kMostRimPoints = 16;
inline constexpr Real kTilt = Real(1e-3);

/// Squares of lengths that differ by less than this (part of them) are alike: the first is the longest extent of an
/// overlap. Larger: an extent that is not the longest. Smaller: of equal diagonals rounding takes one, and the witness
/// still is the middle of both.
inline constexpr Real kSameLength = 64 * kEpsilon;

/// Common normals of two edges shorter than this (sine) are made unit before they are projected on. Larger: time.
/// Smaller: rounding, divided by that length, may choose the wrong axis.
inline constexpr Real kShortNormal = sizeof(Real) == 8 ? Real(1e-2) : Real(0.1);

/// Edges of boxes that are more parallel than this (sine) are left to the general rule for features. Larger: time.
/// Smaller: the place where the lines cross is known to no more than the band of features.
inline constexpr Real kCrossingSine = sizeof(Real) == 8 ? Real(1e-3) : Real(0.1);

/// Projected edges more parallel than this (sine) share a stretch instead of a place. Larger: edges that cross meet
/// off their crossing. Smaller: the place where near-parallel edges cross is rounding, and jumps along them.
inline constexpr Real kSharedStretchSine = 1024 * kEpsilon;

}}}  // namespace lpc::LPC_PRECISION::pair_query
