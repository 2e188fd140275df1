// SPDX-License-Identifier: Zlib
#pragma once

#include <functional>

#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Support function of a convex body: a point farthest along d (world frame, d unit).
template <int D>
using SupportFunction = std::function<Vecd<D>(const Vecd<D>&)>;

struct SweepLimits {
  double width = 1e-6;   // stop when the interval is this narrow (m)
  int maxCells = 20000;  // or after this many cells of directions, with a wider interval
};

/// Bounds phi of two bodies known only by their support functions, by branch and bound over cells of directions. Slow,
/// and independent of the other referees, so that it can check them. The bounds hold up to a few roundings of the
/// support points.
template <int D>
Interval sweepDirections(const SupportFunction<D>& a, const SupportFunction<D>& b, const SweepLimits& limits);

/// The same for our shapes.
template <int D>
Interval sweepDirections(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB,
                         const SweepLimits& limits);

}}  // namespace lpc::LPC_PRECISION
