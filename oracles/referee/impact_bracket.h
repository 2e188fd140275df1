// SPDX-License-Identifier: Zlib
// Ground truth for times of impact of two moving shapes. Uses only proved signed distances and upper bounds of the
// closing speed, and no time of impact method.
#pragma once

#include <string>

#include "framework/stage/stage_time_of_impact.h"
#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Separation that counts as contact, relative to s of the error measure.
inline constexpr double kImpactBand = sizeof(Real) == 8 ? 1e-9 : 1e-4;

/// Bounds of the first contact of two moving shapes, from both sides (s).
struct ImpactBracket {
  bool decided = false;  // false: a distance was undecided, or the shapes slide along each other for too long
  double free = 0;  // proved: separated at all earlier times; the first time at which the separation is within the band
  double met;       // deeper than the band at this time; infinite when no such time was found
};
template <int D>
ImpactBracket impactBracket(const MovingPair<D>& pair, Real duration);

/// An interval (s) that is proved to contain the first time at which phi is 0. Its width is about the rounding of poses
/// over the closing speed at the impact. `hi` is infinite when phi is never seen below 0: the shapes may graze at `lo`
/// or later. Both ends are infinite when phi > 0 is proved throughout.
template <int D>
Interval firstTouch(const MovingPair<D>& pair, Real duration);

/// The error of a time of impact: the separation at that time, relative to s; shapes that overlap at time 0 have none.
/// An error in time counts times the closing speed at the impact. NaN when the referee does not know the separation.
template <int D>
double impactError(const MovingPair<D>& pair, Real t);

/// What is wrong with an answer; empty when it is right. `bracket` is that of the pair, and decided.
template <int D>
std::string impactFault(const MovingPair<D>& pair, Real duration, const TimeOfImpactAnswer<D>& answer,
                        const ImpactBracket& bracket);

}}  // namespace lpc::LPC_PRECISION
