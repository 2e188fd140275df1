// SPDX-License-Identifier: Zlib
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "experiments/trial/entry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Boxes that fly about in a room and bounce off its walls.
template <int D>
struct MovingBoxes {
  std::vector<Vec<D>> place, velocity;  // m, m/s
  std::vector<Real> half;               // half side of each box (m)
  Real room = 0;                        // half side (m)

  void advance(double dt) {
    for (std::size_t i = 0; i < place.size(); ++i) {
      for (int d = 0; d < D; ++d) {
        place[i][d] += velocity[i][d] * static_cast<Real>(dt);
        if (std::abs(place[i][d]) > room && place[i][d] * velocity[i][d] > 0) velocity[i][d] = -velocity[i][d];
      }
    }
  }
};

/// A layout of n boxes for a broadphase alone; the same seed gives the same boxes.
struct BoxDistribution {
  EntryInfo info;
  std::function<MovingBoxes<2>(const Spec&, int n, std::uint64_t seed)> make2;
  std::function<MovingBoxes<3>(const Spec&, int n, std::uint64_t seed)> make3;
};
const std::vector<BoxDistribution>& boxDistributions();

/// Throws UserError for an unknown name or parameter.
template <int D>
MovingBoxes<D> makeMovingBoxes(const Spec& distribution, int n, std::uint64_t seed) {
  const BoxDistribution& entry = findEntry(boxDistributions(), "distribution", distribution.name);
  if constexpr (D == 2) {
    return entry.make2(distribution, n, seed);
  } else {
    return entry.make3(distribution, n, seed);
  }
}

}}  // namespace lpc::LPC_PRECISION
