// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "framework/problem/contact_graph.h"
#include "framework/stage/profiler.h"
#include "framework/stage/stage_continuous.h"
#include "framework/world/body_table.h"
#include "framework/world/contact_maker.h"
#include "framework/world/fast_parts.h"
#include "framework/world/non_colliding_pairs.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct ContinuousInput {
  Real dt;  // s, of the step
  ContinuousCollision<D>& method;
  BodyTable<D>& table;
  const WorldSettings<D>& settings;
  const NonCollidingPairs& nonColliding;
  Profiler& profiler;

  bool runsIn(CcdPhase when) const { return settings.model.continuous && method.ccdPhase() == when; }
};

/// Continuous collision between the poses of two steps. Depending on the method, it adds contacts before the solver for
/// pairs that would touch, or after it stops bodies that touched.
template <int D>
class ContinuousPass {
 public:
  /// Drops the data of the shape in this slot, after the shape was replaced.
  void forget(std::size_t shape) { m_fast.forget(shape); }
  void forgetAll() { m_fast = FastParts<D>(); }

  /// Call before the solver, with the boxes of the start of the step. Fills speculativePairs(), sorted by slots; a
  /// method that runs after the solver gets none.
  void findSpeculativePairs(const ContinuousInput<D>& in);
  std::span<const SpeculativePair> speculativePairs() const { return m_speculative; }
  /// Keeps the poses at the start of the step, for a method that runs after the solver.
  void begin(const ContinuousInput<D>& in);
  /// Call after the solver. Moves fast bodies back to their time of impact, together with all bodies jointed to them
  /// (`joints`, by slot). Ignores pairs that a listener has vetoed.
  void stopAtImpacts(const ContinuousInput<D>& in, std::span<const Manifold<D>> manifolds,
                     std::span<const JointRecord<D>> joints, const ContactGraph<D>& graph);

 private:
  using Pair = typename FastParts<D>::Pair;
  struct ToiEvent {
    Real t;  // s after the start
    std::size_t pair;
    Real asked;  // earliest stop of the pair's bodies when the event was made; another value now: stale
    // std::push_heap keeps the largest element on top, so the earliest event compares as the largest.
    bool operator<(const ToiEvent& o) const { return std::tie(o.t, o.pair) < std::tie(t, pair); }
  };
  std::span<const Pair> fastPairs(const ContinuousInput<D>& in, const BodySweeps<D>& sweeps);
  Motion<D> sweepOf(const ContinuousInput<D>& in, std::size_t body) const;
  FastPair<D> pairFrom(const ContinuousInput<D>& in, const Pair& p, const BodySweeps<D>& sweeps, Real from) const;

  FastParts<D> m_fast;
  // Scratch of a step.
  std::vector<SpeculativePair> m_speculative;
  std::vector<Pose<D>> m_start;      // poses at the start of the step, X_WC by body slot
  std::vector<Motion<D>> m_motions;  // of the step just solved, by body slot
  std::vector<Real> m_stop;          // s after the start, by body slot
  std::vector<ToiEvent> m_events;
  std::vector<FastPair<D>> m_questions;
  std::vector<Real> m_times;
  std::vector<std::pair<std::int32_t, std::size_t>> m_pairsOf;  // body, pair; sorted
  std::vector<std::int32_t> m_stopped;
};

}}  // namespace lpc::LPC_PRECISION
