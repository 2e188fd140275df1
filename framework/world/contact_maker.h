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
#include "framework/world/simulation.h"
#include "framework/world/unpaired_bodies.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Two shapes that may meet within the step, body of the first < body of the second.
struct PairAhead {
  ShapePair shapes;
  Real margin;  // m: contacts are made for separations up to this
};

/// What makes contacts: the stages, and what they work on.
template <int D>
struct MakerInput {
  ContactCache<D>& cache;
  ContactGenerator<D>& generator;
  const BodyTable<D>& table;
  const WorldSettings<D>& settings;
  std::span<const PairAhead> ahead;  // sorted by their slots
  Profiler& profiler;
};

/// From pairs of boxes to manifolds: orientation and order of the pairs, convex parts, which contacts a cache keeps,
/// what was remembered of a pair, and the inner edges of surfaces.
template <int D>
class ContactMaker {
 public:
  // --- state: what a save holds --------------------------------------------------------------------------------------
  IndexedVector<Manifold<D>> manifolds;
  std::vector<PairRecord> records;  // sorted by key; none where no stage remembers

  // --- a step --------------------------------------------------------------------------------------------------------
  /// Pairs of shapes whose boxes overlap and that may have contact, body of the first < body of the second.
  void findPairs(const BodyTable<D>& table, const UnpairedBodies& unpaired, WorkDone& work);
  /// Adds those ahead, and brings all into the order of their bodies and shapes.
  void sortPairs(std::span<const ShapeRecord<D>> shapes, std::span<const PairAhead> ahead);
  /// The manifolds of these pairs; those of the last call are before() then.
  void make(const MakerInput<D>& in);
  /// Indices of the manifolds that a solver takes: those of a body that moves and that no listener vetoed.
  IndexedVector<int>& collectActive(const Bodies<D>& bodies);

  std::span<const ShapePair> pairs() const { return m_pairs; }
  std::span<const Manifold<D>> before() const { return m_old; }

  // --- between steps -------------------------------------------------------------------------------------------------
  /// Ends the contacts and records of which gone(pair) tells the body that leaves them; below 0: they stay. Of each
  /// pair of shapes told(manifold, body) hears once.
  template <class Gone, class Told>
  void end(const Gone& gone, const Told& told);
  /// The centre of mass of the body has moved within it.
  void moveCenter(std::size_t body, const Vec<D>& by, std::uint64_t& visits);
  void forgetPairs() { m_pairs.clear(); }

 private:
  void generate(const MakerInput<D>& in, std::span<const ShapePair> pairs, Real margin);
  std::span<PairMemory> recall(const MakerInput<D>& in, std::span<const ConvexPair<D>> children);
  void remember(const MakerInput<D>& in);
  void mixKept(const MakerInput<D>& in);

  // Scratch.
  std::vector<ProxyPair> m_proxyPairs;
  std::vector<ShapePair> m_pairs, m_regenerate;
  IndexedVector<Manifold<D>> m_old;
  std::vector<PairRecord> m_oldRecords, m_asked;  // asked: pairs of children that the generator was asked for
  std::vector<PairMemory> m_memory;
  ChildPairs<D> m_children;
  ContactOrder m_order;
  IndexedVector<int> m_active;
};

template <int D>
template <class Gone, class Told>
void ContactMaker<D>::end(const Gone& gone, const Told& told) {
  std::optional<decltype(Manifold<D>{}.shapeKey())> last;  // once for each pair of shapes
  std::erase_if(manifolds, [&](const Manifold<D>& m) {
    const std::int32_t body = gone(m);
    if (body < 0) return false;
    if (std::exchange(last, m.shapeKey()) != m.shapeKey()) told(m, body);
    return true;
  });
  std::erase_if(records, [&](const PairRecord& r) { return gone(r) >= 0; });
}

}}  // namespace lpc::LPC_PRECISION
