// SPDX-License-Identifier: Zlib
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/math/work.h"
#include "framework/problem/contact.h"
#include "framework/problem/joint.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Graph of contacts and joints. Bodies are nodes; joints, and manifolds without veto, are edges. The world and static
/// or kinematic bodies connect no islands, because contacts do not change their motion; their contacts may have any
/// colour. Each answer is computed at the first call and kept until reset(). It depends on the arrays only, not on
/// earlier calls. Takes time linear in bodies, manifolds and joints (WorkCount::graphVisits).
template <int D>
class ContactGraph {
 public:
  /// Drops all answers. Later calls compute from these arrays, which must not change until the next reset().
  void reset(const Bodies<D>& bodies, std::span<const Manifold<D>> manifolds, std::span<const JointRecord<D>> joints,
             WorkDone& work);

  /// Indices of the manifolds and slots of the joints of a body, ascending. A joint to the world is listed at its
  /// single body; a broken joint is not listed.
  IndexedSpan<const std::int32_t> manifoldsOf(std::int32_t body) const;
  IndexedSpan<const std::int32_t> jointsOf(std::int32_t body) const;

  /// Island number by body slot. An island is a set of dynamic bodies connected by contacts or joints; a single dynamic
  /// body is an island too. -1 for bodies in no island. Islands are numbered by their lowest slot.
  IndexedSpan<const std::int32_t> islands() const;
  /// As islands(), connected by joints only.
  IndexedSpan<const std::int32_t> jointedGroups() const;

  /// The least number of contacts from a dynamic body to a static or kinematic one: 1 for bodies that touch the ground,
  /// 2 for bodies on these. 0 for static and kinematic bodies, -1 for bodies in the air. Shock propagation goes upwards
  /// through these levels. Guendelman, Bridson and Fedkiw (2003) order the bodies by trial steps under gravity; Erleben
  /// (2007) orders them by this number.
  IndexedSpan<const std::int32_t> supportLevels() const;

  /// Orders `contacts` (indices of manifolds, vetoed or not) by colour. Contacts of one colour share no dynamic body,
  /// and keep the given order. Colour c has order[offsets[c]] up to, but not including, order[offsets[c + 1]]. Greedy:
  /// each contact takes the lowest colour that is free at both bodies. When the first kGreedyColours are taken, the
  /// contact gets a new colour of its own, so that a body with many contacts costs no more than others.
  void colour(std::span<const int> contacts, std::vector<int>& order, std::vector<int>& offsets) const;
  static constexpr int kGreedyColours = 64;

 private:
  /// Edges by body: the edges of body i are ids[start[i]] to ids[start[i + 1] - 1].
  struct Incidence {
    bool built = false;
    IndexedVector<std::int32_t> start, next, ids;
    std::span<const std::int32_t> of(std::int32_t body) const;
  };
  template <class Edge>
  void build(Incidence& out, std::size_t edges, const Edge& edge) const;
  const Incidence& touching() const;
  const Incidence& jointed() const;
  bool isNode(std::int32_t body) const;
  void group(IndexedVector<std::int32_t>& out, bool alsoTouching) const;

  const Bodies<D>* m_bodies = nullptr;
  IndexedSpan<const Manifold<D>> m_manifolds;
  IndexedSpan<const JointRecord<D>> m_joints;
  WorkDone* m_work = nullptr;

  // Answers and scratch.
  mutable Incidence m_touching, m_jointed;
  mutable bool m_hasIslands = false, m_hasGroups = false, m_hasLevels = false;
  mutable IndexedVector<std::int32_t> m_islands, m_groups, m_levels, m_queue, m_colour;
  mutable IndexedVector<std::uint64_t> m_taken;  // bit set of colours, by body
};

}}  // namespace lpc::LPC_PRECISION
