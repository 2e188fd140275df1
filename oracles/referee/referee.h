// SPDX-License-Identifier: Zlib
// The referee: the signed distance of two posed shapes as an interval that is proved to contain it. Witnesses (FCL,
// libccd, Bullet) are recorded; this decides.
//
// The input is what the numbers say, exactly: each core vertex v becomes p + R v with R the matrix formula of
// framework/math/space.h evaluated without rounding, so a quaternion that is unit only within rounding gives a shape
// that is congruent only within rounding. A polytope is the convex hull of its vertices (its stored faces are not
// read). The answer is
//     phi = max over unit d of min over a in A, b in B of d . (b - a)  -  (radius of A + radius of B)
// with A and B the cores: positive = gap, negative = minus the depth.
#pragma once

#include <string_view>

#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Directions and points of the referee are double whatever Real is.
template <int D>
using Vecd = Eigen::Matrix<double, D, 1>;

struct Interval {
  double lo = 0, hi = 0;

  double width() const { return hi - lo; }
  double middle() const { return lo + (hi - lo) / 2; }
  /// How far `x` is from the interval; 0 inside.
  double distanceTo(double x) const { return x < lo ? lo - x : x > hi ? x - hi : 0; }
};

/// d's own separation, (min of B along d - max of A along d) / |d| - radii: a proved lower bound of phi for every
/// nonzero d (world frame, any length), and phi itself for the right one.
template <int D>
Interval separationAlong(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB,
                         const Vecd<D>& d);

/// s of the error measure |phi - phi_ref| / s: largest extent of either shape + distance between them + largest
/// coordinate (m), whether of a vertex in its own frame, of a position, or of what both make in the world.
template <int D>
double errorScale(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB, double phi);

/// What of it does not depend on where frames are: largest extent of either shape + distance between them (m).
template <int D>
double posedScale(const ShapeView<D>& a, const ShapeView<D>& b, double phi);

template <int D>
struct RefereeAnswer {
  bool decided = false;  // false when a number of the input is not finite, no method applies, or the bounds of a curved
                         // core are too far apart
  double lo = 0, hi = 0;  // phi lies in the closed interval [lo, hi] (m). Of cores with vertices the sign is decided,
                          // too: lo > 0, hi < 0 or lo = hi = 0
  Vecd<D> normal = Vecd<D>::Zero();  // n_AB in the world, unit within rounding; at a tie one of the right ones
  std::string_view method = "undecidable";

  Interval interval() const { return {lo, hi}; }
};

/// Of cores with vertices the quick way first, `refereeExactly` where it proves too little; otherwise one of the last
/// two.
template <int D>
RefereeAnswer<D> referee(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB);

/// In exact integers, of cores with vertices: always decided for finite input. The interval is phi rounded outwards.
template <int D>
RefereeAnswer<D> refereeExactly(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB);

/// In long double with running error bounds: decided when the interval is narrower than 1e-16 s and does not contain 0.
template <int D>
RefereeAnswer<D> refereeByCertificate(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b,
                                      const Pose<D>& X_WB);

/// One of the cores is curved, both are bounded; in long double with error bounds. Decided when the interval is at most
/// 1e-13 s wide (apart) or 1e-6 s (overlapping): what is judged by it must be content with ten times its width.
template <int D>
RefereeAnswer<D> refereeOfCurved(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b,
                                 const Pose<D>& X_WB);

/// One of the cores is a plane; the other's support function at the plane's normal is the answer.
template <int D>
RefereeAnswer<D> refereeOfPlane(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB);

}}  // namespace lpc::LPC_PRECISION
