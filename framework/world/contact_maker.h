// SPDX-License-Identifier: Zlib
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "framework/problem/contact_order.h"
#include "framework/stage/profiler.h"
#include "framework/stage/stage_narrowphase.h"
#include "framework/world/body_table.h"
#include "framework/world/flush_contacts.h"
#include "framework/world/non_colliding_pairs.h"
#include "framework/world/past_pair.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Two shapes that may touch within the step. The body slot of the first is below that of the second.
struct SpeculativePair {
  ShapePair shapes;
  Real margin;  // m: the generator makes contacts up to this separation
};

/// The stages that make contacts, and the data that these stages read.
template <int D>
struct MakerInput {
  ContactCache<D>& cache;
  ContactGenerator<D>& generator;
  const BodyTable<D>& table;
  const WorldSettings<D>& settings;
  std::span<const SpeculativePair> speculative;  // sorted by slots
  Profiler& profiler;
};

/// Turns pairs of boxes into manifolds. Orders and orients the pairs, splits them into convex parts, keeps cached
/// contacts and pair memory, and corrects contacts at internal edges of surfaces and between flush parts.
template <int D>
class ContactMaker {
 public:
  // --- state, which a save holds -------------------------------------------------------------------------------------
  IndexedVector<Manifold<D>> manifolds;
  std::vector<PairRecord> records;  // sorted by key; empty when the generator keeps no memory of pairs

  // --- during a step -------------------------------------------------------------------------------------------------
  /// Finds pairs of shapes that may collide and have overlapping boxes. The body slot of the first shape is below that
  /// of the second.
  void findPairs(const BodyTable<D>& table, const NonCollidingPairs& nonColliding, WorkDone& work);
  /// Adds the pairs of `speculative`, and sorts all pairs by bodies and shapes.
  void sortPairs(std::span<const ShapeRecord<D>> shapes, std::span<const SpeculativePair> speculative);
  /// Makes the manifolds of pairs(), and updates those that the cache keeps.
  void make(const MakerInput<D>& in);
  /// Indices of the manifolds that the solver takes: at least one body is active (Bodies::active), and no listener
  /// vetoed.
  IndexedVector<int>& collectActive(const Bodies<D>& bodies);

  std::span<const ShapePair> pairs() const { return m_pairs; }
  /// The pairs that had contacts before the last call of make(), without resting ones, sorted by key.
  std::span<const PastPair> before() const { return m_before; }
  /// Their manifolds, unless the cache kept them, sorted by key.
  std::span<const Manifold<D>> past() const { return m_past; }

  // --- between steps -------------------------------------------------------------------------------------------------
  /// Removes manifolds and records of pairs that end: endedBy(pair) returns the body that leaves the pair, or a
  /// negative number when the pair stays. Calls onEnd(manifold, body) once for each such pair of shapes.
  template <class EndedBy, class OnEnd>
  void end(const EndedBy& endedBy, const OnEnd& onEnd);
  /// Updates contacts after the centre of mass of the body has moved by `by` within the body.
  void moveCenter(std::size_t body, const Vec<D>& by, std::uint64_t& visits);
  void forgetPairs() { m_pairs.clear(); }

 private:
  void generate(const MakerInput<D>& in, std::span<const ShapePair> pairs, Real margin);
  std::span<PairMemory> recall(const MakerInput<D>& in, std::span<const ConvexPair<D>> convexPairs);
  void findOld(const MakerInput<D>& in);
  void remember(const MakerInput<D>& in);
  void correctFlush(const MakerInput<D>& in);
  void renewKept(const MakerInput<D>& in, const CacheInput<D>& cacheInput);
  void insertFresh();

  /// The manifolds of a pair of shapes with contacts in the last step.
  struct OldPair {
    std::size_t first, count;  // among `manifolds`, before any is removed or inserted
    bool kept;                 // by the cache; otherwise the contacts are made anew, or end
  };

  // Scratch.
  std::vector<ProxyPair> m_proxyPairs;
  std::vector<ShapePair> m_pairs, m_scratchPairs, m_regenerate;
  std::vector<std::int32_t> m_places, m_shapeOrder, m_scratchOrder;  // see sortPairs()
  std::vector<std::uint32_t> m_begin;
  IndexedVector<Manifold<D>> m_fresh, m_gone;
  std::vector<OldPair> m_oldPairs;  // without resting ones
  std::vector<PastPair> m_before;
  std::span<const Manifold<D>> m_past;            // m_fresh or m_gone
  std::vector<PairRecord> m_oldRecords, m_asked;  // m_asked: pairs of convex parts passed to the generator
  std::vector<PairMemory> m_memory;
  PartPairs<D> m_partPairs;
  ContactOrder m_order;
  FlushContacts<D> m_flush;
  std::vector<const Manifold<D>*> m_kept;  // manifolds that the cache keeps
  IndexedVector<int> m_active;
};

template <int D>
template <class EndedBy, class OnEnd>
void ContactMaker<D>::end(const EndedBy& endedBy, const OnEnd& onEnd) {
  std::optional<decltype(Manifold<D>{}.shapeKey())> last;  // once for each pair of shapes
  std::erase_if(manifolds, [&](const Manifold<D>& m) {
    const std::int32_t body = endedBy(m);
    if (body < 0) return false;
    if (std::exchange(last, m.shapeKey()) != m.shapeKey()) onEnd(m, body);
    return true;
  });
  std::erase_if(records, [&](const PairRecord& r) { return endedBy(r) >= 0; });
}

}}  // namespace lpc::LPC_PRECISION
