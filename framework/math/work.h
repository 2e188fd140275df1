// SPDX-License-Identifier: Zlib
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "framework/math/indexed.h"

namespace lpc {

/// Work counters: a cost that does not depend on the machine. Each counter has its own chart; counters are never
/// summed.
enum class WorkCount {
  boxTests,       // box-box overlap tests
  nodeVisits,     // nodes of a tree or cells of a grid
  sortMoves,      // elements moved while sorting
  partTests,      // box tests of convex parts, for pairs of shapes of which one has several parts
  pairQueries,    // shape pairs queried
  supportCalls,   // support points computed
  axisTests,      // separating axes projected
  polytopeFaces,  // faces created by EPA
  rowUpdates,     // one constraint row solved once in an iteration; 0 when a method factorises instead
  forceEvals,     // evaluations of all forces
  detections,     // collision detections requested by a solver inside its step
  eventVisits,    // slots, shapes and contacts visited for the user's changes between steps and for waking bodies
  graphVisits,    // bodies, manifolds and joints visited by the contact graph
  impactLimits,   // impact phases, and pairs in impact, that reached their limit of iterations
  fallbacks,      // rows that a direct method left to Gauss-Seidel
  sweptPairs,     // pairs of convex parts, one of them fast, that may touch during a step
  stops,          // bodies stopped by continuous collision
  multiplyAdds,   // of constraint rows, factorisations, solves and residuals: the only cost that ranks all resolvers
  kCount
};

inline constexpr IndexedArray<std::string_view, static_cast<int>(WorkCount::kCount)> kCountNames = {
    "box_tests",    "node_visits",    "sort_moves",  "part_tests",  "pair_queries", "support_calls",
    "axis_tests",   "polytope_faces", "row_updates", "force_evals", "detections",   "event_visits",
    "graph_visits", "impact_limits",  "fallbacks",   "swept_pairs", "stops",        "multiply_adds"};

struct WorkDone {
  IndexedArray<std::uint64_t, static_cast<int>(WorkCount::kCount)> counts{};

  std::uint64_t& operator[](WorkCount c) { return counts[c]; }
  std::uint64_t operator[](WorkCount c) const { return counts[c]; }
};

/// Multiply-adds of one Gauss-Seidel update of a row between two bodies: relative velocity, impulse, and both velocity
/// changes.
template <int D>
inline constexpr std::uint64_t kRowMultiplyAdds = (D + D * (D - 1)) + 1 + (2 * D + D * (D - 1));

/// n rows updated once.
template <int D>
void countRows(WorkDone& work, std::uint64_t n) {
  work[WorkCount::rowUpdates] += n;
  work[WorkCount::multiplyAdds] += n * kRowMultiplyAdds<D>;
}

/// Multiply-adds of building a row: both arms, both changes of angular velocity per impulse, the effective mass.
template <int D>
inline constexpr std::uint64_t kRowMakingMultiplyAdds = 2 * D*(D - 1) + D* D*(D - 1) * (D - 1) / 2 + D*(D - 1) + 1;

/// n rows built, or built again in the same step.
template <int D>
void countMadeRows(WorkDone& work, std::uint64_t n) {
  work[WorkCount::multiplyAdds] += n * kRowMakingMultiplyAdds<D>;
}

}  // namespace lpc
