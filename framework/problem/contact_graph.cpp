// SPDX-License-Identifier: Zlib
#include "framework/problem/contact_graph.h"

#include <algorithm>
#include <bit>

#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
void ContactGraph<D>::reset(const Bodies<D>& bodies, std::span<const Manifold<D>> manifolds,
                            std::span<const JointRecord<D>> joints, WorkDone& work) {
  m_bodies = &bodies, m_manifolds = manifolds, m_joints = joints, m_work = &work;
  m_touching.built = m_jointed.built = m_hasIslands = m_hasGroups = m_hasLevels = false;
}

template <int D>
bool ContactGraph<D>::isNode(std::int32_t body) const {
  return body >= 0 && m_bodies->used[body] && m_bodies->type[body] == BodyType::dynamic;
}

template <int D>
std::span<const std::int32_t> ContactGraph<D>::Incidence::of(std::int32_t body) const {
  return {ids.data() + start[body], ids.data() + start[body + 1]};
}

// Counts the edges, then fills them in order. `edge(k)` returns its two bodies, -1 for the world or for no edge.
template <int D>
template <class Edge>
void ContactGraph<D>::build(Incidence& out, std::size_t edges, const Edge& edge) const {
  const std::size_t bodies = m_bodies->pose.size();
  out.built = true;
  out.start.assign(bodies + 1, 0);
  const auto each = [&](const auto& visit) {
    for (std::size_t k = 0; k < edges; ++k) {
      const auto [a, b] = edge(k);
      if (a >= 0) visit(a, k);
      if (b >= 0) visit(b, k);
    }
  };
  each([&](std::int32_t body, std::size_t) { ++out.start[body + 1]; });
  for (std::size_t i = 0; i < bodies; ++i) out.start[i + 1] += out.start[i];
  out.ids.resize(static_cast<std::size_t>(out.start[bodies]));
  out.next.assign(out.start.begin(), out.start.end());
  each([&](std::int32_t body, std::size_t k) { out.ids[out.next[body]++] = static_cast<std::int32_t>(k); });
  (*m_work)[WorkCount::graphVisits] += bodies + 2 * edges;
}

template <int D>
auto ContactGraph<D>::touching() const -> const Incidence& {
  if (!m_touching.built) {
    build(m_touching, m_manifolds.size(), [&](std::size_t k) {
      const Manifold<D>& m = m_manifolds[k];
      return m.ignored ? std::pair(-1, -1) : std::pair(m.bodyA, m.bodyB);
    });
  }
  return m_touching;
}

template <int D>
auto ContactGraph<D>::jointed() const -> const Incidence& {
  if (!m_jointed.built) {
    build(m_jointed, m_joints.size(), [&](std::size_t k) {
      const JointRecord<D>& j = m_joints[k];
      return j.active() ? std::pair(j.bodyA, j.bodyB) : std::pair(-1, -1);
    });
  }
  return m_jointed;
}

template <int D>
IndexedSpan<const std::int32_t> ContactGraph<D>::manifoldsOf(std::int32_t body) const {
  return touching().of(body);
}

template <int D>
IndexedSpan<const std::int32_t> ContactGraph<D>::jointsOf(std::int32_t body) const {
  return jointed().of(body);
}

// Breadth-first search from the lowest body without a number: linear, unlike union-find.
template <int D>
void ContactGraph<D>::group(IndexedVector<std::int32_t>& out, bool alsoTouching) const {
  out.assign(m_bodies->pose.size(), -1);
  std::int32_t number = 0;
  const auto reach = [&](std::int32_t body) {
    if (isNode(body) && out[body] < 0) out[body] = number, m_queue.push_back(body);
  };
  std::uint64_t visits = out.size();
  for (std::size_t i = 0; i < out.size(); ++i) {
    m_queue.clear();
    reach(static_cast<std::int32_t>(i));
    if (m_queue.empty()) continue;
    for (std::size_t at = 0; at < m_queue.size(); ++at) {
      const std::int32_t body = m_queue[at];
      for (const std::int32_t j : jointed().of(body)) reach(m_joints[j].bodyA), reach(m_joints[j].bodyB);
      visits += jointed().of(body).size();
      if (!alsoTouching) continue;
      for (const std::int32_t m : touching().of(body)) {
        reach(m_manifolds[m].bodyA), reach(m_manifolds[m].bodyB);
      }
      visits += touching().of(body).size();
    }
    ++number;
  }
  (*m_work)[WorkCount::graphVisits] += visits;
}

template <int D>
IndexedSpan<const std::int32_t> ContactGraph<D>::islands() const {
  if (!m_hasIslands) group(m_islands, true), m_hasIslands = true;
  return m_islands;
}

template <int D>
IndexedSpan<const std::int32_t> ContactGraph<D>::jointedGroups() const {
  if (!m_hasGroups) group(m_groups, false), m_hasGroups = true;
  return m_groups;
}

template <int D>
IndexedSpan<const std::int32_t> ContactGraph<D>::supportLevels() const {
  if (m_hasLevels) return m_levels;
  m_hasLevels = true;
  m_levels.assign(m_bodies->pose.size(), -1);
  m_queue.clear();
  for (std::size_t i = 0; i < m_levels.size(); ++i) {
    const auto body = static_cast<std::int32_t>(i);
    if (m_bodies->used[i] && !isNode(body)) m_levels[i] = 0, m_queue.push_back(body);
  }
  std::uint64_t visits = m_levels.size();
  for (std::size_t at = 0; at < m_queue.size(); ++at) {
    const std::int32_t body = m_queue[at];
    for (const std::int32_t k : touching().of(body)) {
      const Manifold<D>& m = m_manifolds[k];
      const std::int32_t other = m.bodyA == body ? m.bodyB : m.bodyA;
      if (!isNode(other) || m_levels[other] >= 0) continue;
      m_levels[other] = m_levels[body] + 1, m_queue.push_back(other);
    }
    visits += touching().of(body).size();
  }
  (*m_work)[WorkCount::graphVisits] += visits;
  return m_levels;
}

template <int D>
void ContactGraph<D>::colour(std::span<const int> contacts, std::vector<int>& order, std::vector<int>& offsets) const {
  m_taken.assign(m_bodies->pose.size(), 0);
  m_colour.clear();
  int colours = 0, own = kGreedyColours;
  for (const int k : contacts) {
    const Manifold<D>& m = m_manifolds[k];
    const bool a = isNode(m.bodyA), b = isNode(m.bodyB);
    const std::uint64_t taken = (a ? m_taken[m.bodyA] : 0) | (b ? m_taken[m.bodyB] : 0);
    const int lowest = std::countr_one(taken), mine = lowest < kGreedyColours ? lowest : own++;
    if (lowest < kGreedyColours) {
      if (a) m_taken[m.bodyA] |= std::uint64_t{1} << lowest;
      if (b) m_taken[m.bodyB] |= std::uint64_t{1} << lowest;
    }
    m_colour.push_back(mine);
    colours = std::max(colours, mine + 1);
  }
  // Counting sort: each colour keeps the order of the contacts.
  offsets.assign(static_cast<std::size_t>(colours) + 1, 0);
  for (const int c : m_colour) ++offsets[static_cast<std::size_t>(c) + 1];
  for (std::size_t c = 1; c < offsets.size(); ++c) offsets[c] += offsets[c - 1];
  m_queue.assign(offsets.begin(), offsets.end());  // position of the next contact of each colour
  order.resize(contacts.size());
  for (std::size_t k = 0; k < contacts.size(); ++k)
    order[static_cast<std::size_t>(m_queue[m_colour[k]]++)] = contacts[k];
  (*m_work)[WorkCount::graphVisits] += m_taken.size() + 2 * contacts.size() + offsets.size();
}

template class ContactGraph<2>;
template class ContactGraph<3>;

}}  // namespace lpc::LPC_PRECISION
