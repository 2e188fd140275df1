// SPDX-License-Identifier: Zlib
#pragma once

#include <string>

#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A scene at rest is held if nothing has sunk by more than this fraction of its smallest body (1). It is the strictest
/// of kRestShares, so a held scene meets each of them.
inline constexpr double kRestShare = 0.01;
inline constexpr double kRestShares[] = {kRestShare, 0.1, 0.5};

/// m: the smallest side of a dynamic body in its own frame, over the present bodies; 0 if there is none.
template <int D>
double smallestBody(const Simulation<D>& world);

/// How far bodies that should rest have sunk by the end of a run: as fractions of the smallest body, beyond the slop
/// that methods keep on purpose (kLinearSlop; for the sag once per level).
struct Rest {
  double size = 0;              // m, smallestBody
  double levels = 1, fall = 0;  // SceneSpec::Limits
  double sag = 0;               // m: largest sinking of a body below its initial position
  double depth = 0;             // m: deepest overlap of shapes
  double sinking = 0;           // m/s: largest descent in the last second; NaN: unknown
  double sagShare() const;      // beyond `fall`
  double depthShare() const;
  double sinkingShare() const;  // in a second
  double share() const;         // the largest of the three; unknown ones are ignored
  std::string reason() const;   // names the largest of the three
};

}}  // namespace lpc::LPC_PRECISION
