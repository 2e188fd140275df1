// SPDX-License-Identifier: Zlib
#pragma once

#include <functional>
#include <vector>

#include "experiments/trial/entry.h"
#include "framework/math/random.h"
#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct DrawnPair {
  Shape<D> a, b;
  Pose<D> X_AB;
};

/// The input of every way of drawing.
template <int D>
struct PairRequest {
  ShapeKind kindA, kindB;
  int index;                                                // index of the pair in the trial
  std::function<double(const DrawnPair<D>&)> trueDistance;  // the referee's, m; negative when they overlap
  int vertices = 0;  // of hulls, all on an ellipsoid; 0: hulls of twelve points anywhere in a cube
};

/// A way of drawing pairs of two kinds for a pair query alone; the same seed gives the same pairs.
struct PairDrawing {
  EntryInfo info;
  std::function<DrawnPair<2>(const Spec&, const PairRequest<2>&, Random&)> draw2;
  std::function<DrawnPair<3>(const Spec&, const PairRequest<3>&, Random&)> draw3;
};
const std::vector<PairDrawing>& pairDrawings();

/// Throws UserError for an unknown name.
template <int D>
DrawnPair<D> drawPair(const Spec& drawing, const PairRequest<D>& request, Random& random) {
  const PairDrawing& entry = findEntry(pairDrawings(), "drawing", drawing.name);
  if constexpr (D == 2) {
    return entry.draw2(drawing, request, random);
  } else {
    return entry.draw3(drawing, request, random);
  }
}

}}  // namespace lpc::LPC_PRECISION
