// SPDX-License-Identifier: Zlib
#pragma once

#include <functional>

#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A point of a convex body farthest along d (world frame, d unit).
template <int D>
using SupportFunction = std::function<Vecd<D>(const Vecd<D>&)>;

struct SweepLimits {
  double width = 1e-6;   // stop when the interval is this narrow (m)
  int maxCells = 20000;  // or after so many cells of directions; the interval is then as wide as it is
};

/// phi of two bodies that are known by their support functions only, from both sides, whatever their shapes. Slow, and
/// written apart from the other referees, so that it can judge them: branch and bound over cells of directions. The
/// bounds hold up to a few roundings of the support points.
template <int D>
Interval sweepDirections(const SupportFunction<D>& a, const SupportFunction<D>& b, const SweepLimits& limits);

/// The same for our shapes.
template <int D>
Interval sweepDirections(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB,
                         const SweepLimits& limits);

}}  // namespace lpc::LPC_PRECISION
