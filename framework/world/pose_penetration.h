// SPDX-License-Identifier: Zlib
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "framework/stage/stage_narrowphase.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Measures how deep shapes penetrate at the current poses. It uses the same query for every simulation, and ignores
/// the contacts that the simulation reports. Measures the pairs that may collide: of two bodies, one of them dynamic,
/// allowed by category and mask, and not excluded by a joint.
template <int D>
class PosePenetration {
 public:
  PosePenetration();

  struct Depths {
    double max = 0, mean = 0;  // m; the mean is over the pairs of convex parts that penetrate
    int pairs = 0;             // of convex parts that penetrate
  };
  /// Precondition: all poses are finite.
  Depths of(const Simulation<D>& simulation);

 private:
  struct Part {
    Aabb<D> box;
    ShapeView<D> view;
    Pose<D> X_WP;
    std::int32_t shape;
  };
  void collectPairs(const Simulation<D>& simulation);

  std::unique_ptr<PairQuery<D>> m_query;
  // Scratch.
  std::vector<Part> m_parts;
  std::vector<std::pair<std::int32_t, std::int32_t>> m_nonColliding;      // jointed bodies, sorted
  std::vector<std::vector<std::pair<const Part*, const Part*>>> m_pairs;  // by pair of kinds
  std::vector<PairView<D>> m_views;
  std::vector<PairAnswer<D>> m_answers;
};

}}  // namespace lpc::LPC_PRECISION
