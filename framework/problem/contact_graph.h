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

/// Who touches and who is jointed to whom: bodies are nodes, manifolds that no listener vetoed and joints are edges.
/// The world, and a static or kinematic body, whose motion no contact changes, connects nobody and may have any colour.
/// Each question is answered when it is asked first and kept until reset(); the answer depends on the arrays alone, not
/// on what was asked before. All of it takes time linear in bodies, manifolds and joints (WorkCount::graphVisits).
template <int D>
class ContactGraph {
 public:
  /// Forgets all answers; later ones are about these arrays, which must stay as they are until the next reset().
  void reset(const Bodies<D>& bodies, std::span<const Manifold<D>> manifolds, std::span<const JointRecord<D>> joints,
             WorkDone& work);

  /// Indices of the manifolds and slots of the joints of a body, rising. A joint to the world is
  /// one of its body; a broken one holds nobody.
  IndexedSpan<const std::int32_t> manifoldsOf(std::int32_t body) const;
  IndexedSpan<const std::int32_t> jointsOf(std::int32_t body) const;

  /// Groups of dynamic bodies that touch or are jointed: number by body slot, -1 for bodies that are in none. Numbers
  /// follow the lowest slot. A dynamic body alone is a group of its own.
  IndexedSpan<const std::int32_t> islands() const;
  /// The same by joints alone.
  IndexedSpan<const std::int32_t> jointedGroups() const;

  /// How many contacts, at the least, a dynamic body is away from one that is not: 1 for what touches the ground, 2 for
  /// what touches that; 0 for static and kinematic bodies, -1 for what hangs in the air. The layers in which shock
  /// propagation goes upwards (Guendelman, Bridson and Fedkiw 2003, who order by trial steps under gravity; by this
  /// distance: Erleben 2007).
  IndexedSpan<const std::int32_t> supportLevels() const;

  /// Puts `contacts` (indices of manifolds, vetoed or not) into an order in which those of one colour stand together
  /// and share no dynamic body, each colour in the order given: order[offsets[c]] to order[offsets[c + 1]] have colour
  /// c. Greedy: each contact in turn takes the lowest colour that is free at both bodies. One that finds the first
  /// kGreedyColours taken gets a colour of its own, so that a body with many contacts costs no more than others.
  void colour(std::span<const int> contacts, std::vector<int>& order, std::vector<int>& offsets) const;
  static constexpr int kGreedyColours = 64;

 private:
  /// Edges by body: those of body i are ids[start[i]] .. ids[start[i + 1]].
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
  mutable IndexedVector<std::uint64_t> m_taken;  // colours, by body
};

}}  // namespace lpc::LPC_PRECISION
