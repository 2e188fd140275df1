// SPDX-License-Identifier: Zlib
// The referee: the signed distance of two posed shapes as an interval that is proved to contain it. Answers of
// witnesses (FCL, libccd, Bullet) are recorded; the referee decides.
//
// The input numbers are exact: each core vertex v becomes p + R v, with R the matrix formula of framework/math/space.h
// evaluated without rounding. A quaternion that is unit only within rounding gives a shape that is congruent only
// within rounding. A polytope is the convex hull of its vertices; its stored faces are not read. The answer is
//
//     phi = max over unit d of min over a in A, b in B of d . (b - a)  -  (radius of A + radius of B)
//
// with A and B the cores: positive = gap, negative = minus the depth.
#pragma once

#include <string_view>

#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The referee's directions and points are double, whatever Real is.
template <int D>
using Vecd = Eigen::Matrix<double, D, 1>;

struct Interval {
  double lo = 0, hi = 0;

  double width() const { return hi - lo; }
  double middle() const { return lo + (hi - lo) / 2; }
  /// Distance of `x` from the interval; 0 inside.
  double distanceTo(double x) const { return x < lo ? lo - x : x > hi ? x - hi : 0; }
};

/// Separation along d, (min of B along d - max of A along d) / |d| - radii. A proved lower bound of phi for every
/// nonzero d (world frame, any length); equal to phi for the separating axis.
template <int D>
Interval separationAlong(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB,
                         const Vecd<D>& d);

/// s of the error measure |phi - phi_ref| / s: largest extent of either shape + distance between them + largest
/// coordinate (m). Coordinates are those of vertices, in their own frame and in the world, and of positions.
template <int D>
double errorScale(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB, double phi);

/// The part of s that does not depend on the position of frames: largest extent of either shape + distance between them
/// (m).
template <int D>
double posedScale(const ShapeView<D>& a, const ShapeView<D>& b, double phi);

template <int D>
struct RefereeAnswer {
  bool decided = false;   // false when an input number is not finite, no method applies, or the bounds of a curved core
                          // are too far apart
  double lo = 0, hi = 0;  // phi is in the closed interval [lo, hi] (m). For cores with vertices the sign is decided
                          // too: lo > 0, hi < 0 or lo = hi = 0
  Vecd<D> normal = Vecd<D>::Zero();  // n_AB in the world, unit within rounding; at a tie any correct one
  std::string_view method = "undecidable";

  Interval interval() const { return {lo, hi}; }
};

/// The ground truth of a pair. For cores with vertices `refereeByCertificate` first, then `refereeExactly` when that
/// proves too little; otherwise refereeOfCurved or refereeOfPlane.
template <int D>
RefereeAnswer<D> referee(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB);

/// In exact integers, for cores with vertices: always decided for finite input. The interval is phi rounded outwards.
template <int D>
RefereeAnswer<D> refereeExactly(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB);

/// In long double with running error bounds. Decided when the interval is narrower than 1e-16 s and does not contain 0.
template <int D>
RefereeAnswer<D> refereeByCertificate(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b,
                                      const Pose<D>& X_WB);

/// For a curved core, with both cores bounded; in long double with error bounds. Decided when the interval is at most
/// 1e-13 s wide (separated) or 1e-6 s (overlapping). Comparisons with it must allow ten times its width.
template <int D>
RefereeAnswer<D> refereeOfCurved(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b,
                                 const Pose<D>& X_WB);

/// For a plane; the answer is the other core's support value along the plane's normal.
template <int D>
RefereeAnswer<D> refereeOfPlane(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB);

}}  // namespace lpc::LPC_PRECISION
