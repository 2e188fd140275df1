// SPDX-License-Identifier: Zlib
// The referee on two shapes under way: no method of finding times of impact is asked, only signed distances that are
// proved, and how fast a gap can close.
#pragma once

#include <string>

#include "framework/stage/stage_time_of_impact.h"
#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What counts as contact, against the size s of the error measure.
inline constexpr double kImpactBand = sizeof(Real) == 8 ? 1e-9 : 1e-4;

/// The first contact of two moving shapes, from both sides (s).
struct ImpactBracket {
  bool decided = false;  // false: the referee was not, or they glide along each other for too long
  double free = 0;  // apart at every time before: proved; the first time at which they are no farther than the band
  double met;       // deeper than the band at this time; infinite when they never are, as far as was looked
};
template <int D>
ImpactBracket impactBracket(const MovingPair<D>& pair, Real duration);

/// What is wrong with an answer; empty when nothing is. `bracket` is the pair's, decided.
template <int D>
std::string impactFault(const MovingPair<D>& pair, Real duration, const TimeOfImpactAnswer<D>& answer,
                        const ImpactBracket& bracket);

}}  // namespace lpc::LPC_PRECISION
