// SPDX-License-Identifier: Zlib
// All tolerances of the pair queries that are not parameters, each with unit, meaning and danger. Most are multiples of
// the rounding unit and fractions of the pair's scale (core_pair.h): "x scale" is a length in m, relative to the size
// of the shapes. None can make an answer claim more than is true (core_pair.h): too small a value misses the best
// direction and gives a distance that is too low, too large a value costs time or blurs closest points.
#pragma once

#include <cmath>
#include <limits>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// The unit of all tolerances below: the rounding of one number (1). Larger or smaller values are impossible.
inline constexpr Real kEpsilon = std::numeric_limits<Real>::epsilon();

// --- bounds ---------------------------------------------------------------------------------------------------------

/// Squares of lengths between this and its reciprocal (m^2) lose no digit to overflow or underflow. Larger: time.
/// Smaller: directions of very short or long vectors are wrong.
inline constexpr Real kSafeSquare = sizeof(Real) == 8 ? Real(1e-200) : Real(1e-20);

/// Error that rounding may cause in a bound L(n) (x scale): bounds and lengths that differ by less are equal, and a
/// bound above its negative may belong to cores that are apart. Also GJK's default tolerance. Larger: a search ends, or
/// skips the nearest corners, before the last digits are right. Smaller: right answers are refined in vain, and GJK
/// reaches its limit of iterations.
inline constexpr Real kBoundRounding = 8 * kEpsilon;

/// Added to an attained distance, so that it bounds the true one from above also when rounded (x scale). Larger: more
/// vertices and edges are tried. Smaller: the nearest feature may be left out.
inline constexpr Real kAttainedRounding = 64 * kEpsilon;

// --- climbs on hulls (hull_climb.h) ---------------------------------------------------------------------------------

/// Hulls with fewer vertices are searched by brute force (count). Larger: brute force where climbs are faster. Smaller:
/// climbs where brute force is faster.
inline constexpr std::size_t kClimbVertices = 96;

/// A climb gives up after finding this many vertices as high as its highest (count). Larger: time, but not on round
/// hulls. Smaller: brute force along the normal of each face with more corners.
inline constexpr std::size_t kMostLevel = 8;

// --- features -------------------------------------------------------------------------------------------------------

/// Vertices within this distance of the support vertex belong to the supporting feature (x scale). Larger: closest
/// points leave their shapes by as much, and neighbours of a face count as the face. Smaller: a face tilted by a
/// rounded normal is taken for one of its corners, and the closest point jumps from corner to corner.
inline constexpr Real kFeatureBand = 64 * kEpsilon;

/// Features tie if their distance exceeds the least by no more than this fraction of it (1) and of the scale (x scale):
/// all their directions are tried. Larger: more directions only. Smaller: rounding decides which direction is tried.
inline constexpr Real kTiePart = Real(1e-6);
inline constexpr Real kTieRounding = 64 * kEpsilon;

/// Edges with a common normal shorter than this (sine) have only noise as normal. Larger: the axis of crossing edges
/// is missed, and the depth is too large by sine x length. Smaller: axes of noise are tested, which costs only time.
inline constexpr Real kParallelSine = 4 * kEpsilon;

/// A face normal within this of an edge's plane (sine) may be on either side of it: their Gauss arcs may cross. Larger:
/// more edge pairs are projected. Smaller: an arc with a rounded end is missed, but the tested face normal is then as
/// good.
inline constexpr Real kArcSine = 64 * kEpsilon;

/// How far a face's vertices may be below its plane, and the rounding of heights above it (x scale). Larger: edges are
/// measured by their own ends more often, which costs only time. Smaller: an edge is skipped though one of its normals
/// proves more by as much.
inline constexpr Real kFaceRounding = 1024 * kEpsilon;

/// Number of vertices tested first to reject a face (count): those that rejected the faces before. Larger: more are
/// tested in vain. Smaller: all vertices are tested.
inline constexpr std::size_t kLowVertices = 4;

/// How often the vector between two features of separated cores is shortened by neighbouring features (count). Larger:
/// nothing, it stops when the vector is shortest. Smaller: all near features are tried, which costs only time.
inline constexpr int kMostTurns = 32;

// --- cores with a margin --------------------------------------------------------------------------------------------

/// Default margin of core_margin (1, fraction of a box's smallest half extent, or of the ball around a hull's middle).
/// Larger: depths at edges and corners are farther from the least. Smaller: more overlaps exceed it and need EPA.
inline constexpr Real kCoreMargin = Real(0.1);

// --- expanding polytope ---------------------------------------------------------------------------------------------

/// A first simplex with an extent of no more than this (x scale) is flat, and so is the difference: only the normals of
/// the existing part are tested. Larger: a thin core is answered by the normals of one plane. Smaller: faces are made
/// of rounding.
inline constexpr Real kFlat = 32 * kEpsilon;

/// In 2D, GJK's points that are no farther apart than this (kFlat x scale) are no base for a triangle: the four extreme
/// points are queried, too. Larger: up to four more supports. Smaller: a base with a direction of rounding.
inline constexpr Real kShortBase = 1024;

/// In 3D, GJK's tetrahedron is used if its determinant is above this fraction of the cube of its longest edge (1).
/// Larger: a new one is made with up to twelve supports. Smaller: needles, which faces inherit.
inline constexpr Real kThinSeed = Real(1e-3);

/// A face within this distance of a new point (x scale) is neither visible nor hidden: the entry edge decides. Larger:
/// near-coplanar faces are removed and depth is lost. Smaller: rounding tears the horizon, and the status is
/// `degenerate`.
inline constexpr Real kVisible = 4 * kEpsilon;

/// A settled face is refined by its neighbourhood if the error of its normal may shift its offset by more than this
/// (tolerances of the search). 16 are faces lower than a hundredth of the scale; nearly all are higher. Larger: needles
/// keep too small a depth. Smaller: common faces are refined, which costs only time.
inline constexpr Real kLeaning = 16;

/// Overlaps less deep than this (x scale) are refined by the edges at contact. Larger: more pairs pay for it. Smaller:
/// a needle facet of a shallow overlap stays lost.
inline const Real kShallow = std::sqrt(kEpsilon);

// --- vertices near contact (local_features.h) -----------------------------------------------------------------------

/// Vertices within this multiple of the remaining gap (1) are near contact. Larger: more directions, and more often too
/// many vertices to try. Smaller: a relevant vertex is omitted.
inline constexpr Real kGapBand = 8;

/// With more vertices near contact than this (count, of one core) no refinement is tried: the number of directions is
/// quadratic. Larger: slow on round hulls. Smaller: two faces with many corners keep a short bound.
inline constexpr std::size_t kMostLocalVertices = 8;

/// How often the edges at contact are gathered anew around a better direction (count). Larger: nothing, it stops when
/// nothing improves. Smaller: a direction that needs two rounds stays half-way.
inline constexpr int kMostEdgeRounds = 4;

// --- curved cores ---------------------------------------------------------------------------------------------------

/// Factor of the search's tolerance for curved cores (1): facets only approach a curved surface. Larger: distance and
/// depth are short, and Newton's steps must correct them. Smaller: facets so flat that their normals are rounding.
inline constexpr Real kCurvedTolerance = sizeof(Real) == 8 ? 64 : 4;

/// The rotation (rad) over which curvature is measured: its square is a rounding of the result, and it is far above the
/// rounding of a difference of gradients. Larger: the curvature of another place. Smaller: noise.
inline const Real kTurn = std::sqrt(std::sqrt(kEpsilon)) / 16;

/// The smallest curvature that a step divides by, relative to the largest (1): on a ring of maxima it is zero. Larger:
/// short steps where the core is much flatter in one direction. Smaller: arbitrarily long steps along the ring.
inline const Real kLeastCurvature = 64 * kEpsilon / kTurn;

/// Newton's steps for the bound (count); they stop when it no longer improves. Larger: only time. Smaller: pairs beside
/// a ridge keep a short bound.
inline constexpr int kMostPolishSteps = 16;

/// A ridge is looked for where the support point jumps over the smallest rotations by more than this (1, fraction of
/// the smaller core). Larger: the ridges of short edges are missed. Smaller: time on smooth cores.
inline constexpr Real kJump = sizeof(Real) == 8 ? Real(1e-3) : Real(0.1);

/// Trials on the way to a ridge that a step has crossed (count). Larger: only time. Smaller: the ridge is missed, and
/// with it the square root of the search's tolerance.
inline constexpr int kMostRidgeSteps = 8;

/// On a ridge: how far beside it the slope of each side is taken (rad), and over which rotation its curvature is (rad).
/// Larger: values of another place. Smaller: the side is chosen by rounding, and the curvature is noise.
inline const Real kBeside = std::sqrt(kEpsilon);
inline const Real kRidgeTurn = std::sqrt(std::sqrt(kEpsilon)) * 8;

/// How often a step along a ridge that does not rise is tried again at a quarter of its length (count). Larger: time.
/// Smaller: long steps along a ring that is smaller than a great circle end the search.
inline constexpr int kMostShorterSteps = 4;

/// Two jumps of the support point span a face when the sine between them is above this (1). Larger: the normal of a
/// narrow face is not tried. Smaller: the normal of two parallel edges is tried, which is noise.
inline constexpr Real kFaceSine = Real(1e-3);

/// With this many faces (count) EPA of curved cores leaves the last digits to Newton's steps, which start from the
/// faces that are left: a ring of equally deep directions would take millions of faces. Larger: time on rings. Smaller:
/// more pairs have their deepest direction found by steps from few faces.
inline constexpr int kLocalFaces = 256;

/// Newton's steps start from a face when no part of the surface is farther above it than this (1, fraction of its
/// offset), times the fourth power of the number of faces in kLocalFaces. Larger: steps from too far away end
/// elsewhere. Smaller: more faces first.
inline constexpr Real kNearFace = Real(1e-4);

/// No steps start from a face if its normal is closer than this (rad) to a direction where earlier steps have ended.
/// Larger: one of two near depths is missed. Smaller: more starts that end at the same place.
inline constexpr Real kSameDirection = Real(0.05);

/// Starts of Newton's steps that end where others did, without a better bound, after which the search ends (count); and
/// of all starts. Larger: time. Smaller: one of several nearly equal depths is missed.
inline constexpr int kMostIdleStarts = 4;
inline constexpr std::size_t kMostStarts = 16;

/// Newton's steps for the closest points (count), which cost the bound no more than roundings. Larger: only time.
/// Smaller: closest points are off by the square root of a rounding.
inline constexpr int kSettleSteps = 2;

// --- witnesses (touching.h) -----------------------------------------------------------------------------------------

/// How often the features are gathered anew around a better direction (count). Larger: time. Smaller: for separated
/// cores, an inaccurate direction that found the right features is kept.
inline constexpr int kTouchRounds = 3;

/// The band of features grows by this factor (1), from kFeatureBand or the search's tolerance to the largest (x scale),
/// until the features of both shapes meet. Larger: closest points leave their shapes by more. Smaller: features kept
/// apart by an inaccurate normal never meet, and the closest points are not one above the other.
inline constexpr Real kBandGrowth = 4;
inline constexpr Real kLastBand = 1048576 * kFeatureBand;

/// How often a curved face is queried for one more point of its rim (count), and how far the direction leans towards it
/// (tangent): more than the rounding of n, less than any visible angle. Larger: a point of another face, which the band
/// then rejects. Smaller: the same point again; with fewer, closest points of caps that overlap in a lens lie beside it
/// (3: 5e-6 of the size, for two cylinders with rims that almost miss each other).
inline constexpr int kMostRimPoints = 16;
inline constexpr Real kTilt = Real(1e-3);

/// Squared lengths that differ by less than this (1, fraction of them) are equal: the first is the longest extent of an
/// overlap. Larger: an extent that is not the longest. Smaller: rounding chooses among equal diagonals, and the closest
/// point is still the middle of both.
inline constexpr Real kSameLength = 64 * kEpsilon;

/// Common normals of two edges shorter than this (sine) are normalised before projecting. Larger: time. Smaller:
/// rounding, divided by that length, may choose the wrong axis.
inline constexpr Real kShortNormal = sizeof(Real) == 8 ? Real(1e-2) : Real(0.1);

/// Edges of boxes that are more parallel than this (sine) are left to the general rule for features. Larger: time.
/// Smaller: the crossing point of the lines is no more accurate than the band of features.
inline constexpr Real kCrossingSine = sizeof(Real) == 8 ? Real(1e-3) : Real(0.1);

/// Projected edges that are more parallel than this (sine) share an interval instead of a point. Larger: crossing edges
/// meet beside their crossing. Smaller: the crossing of nearly parallel edges is rounding, and jumps along them.
inline constexpr Real kSharedStretchSine = 1024 * kEpsilon;

}}}  // namespace lpc::LPC_PRECISION::pair_query
