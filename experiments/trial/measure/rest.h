// SPDX-License-Identifier: Zlib
#pragma once

#include <string>

#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A scene that rests is held when nothing has sunk by more than this share of its smallest body (1). It is the
/// strictest of kRestShares, so that what is held is held by each of them.
inline constexpr double kRestShare = 0.01;
inline constexpr double kRestShares[] = {kRestShare, 0.1, 0.5};

/// m: the smallest side of a dynamic body in its own frame, over those that are there; 0 without one.
template <int D>
double smallestBody(const Simulation<D>& world);

/// How far bodies that should rest have sunk by the end of a run: as shares of the smallest body, beyond the slop that
/// methods keep on purpose (kLinearSlop, of the sag once for each level).
struct Rest {
  double size = 0;              // m, smallestBody
  double levels = 1, fall = 0;  // SceneSpec::Limits
  double sag = 0;               // m: farthest that a body has sunk from where it came
  double depth = 0;             // m: deepest overlap of shapes
  double sinking = 0;           // m/s: the farthest way down in the last second; NaN: not known
  double sagShare() const;      // beyond `fall`
  double depthShare() const;
  double sinkingShare() const;  // in a second
  double share() const;         // the largest of the three; what is not known is not counted
  std::string reason() const;   // which of the three is the largest
};

}}  // namespace lpc::LPC_PRECISION
