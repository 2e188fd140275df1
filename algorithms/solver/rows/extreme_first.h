// SPDX-License-Identifier: Zlib
// Solving the worst contact first needs the worst of many, again after each change, and the contacts of the bodies that
// changed. Both searches return the same contact, so that they differ in cost alone.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/problem/body.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

enum class ExtremeSearch { scan, tree };

/// The largest of n values; the first among equals. NaN is never the largest.
class Extreme {
 public:
  explicit Extreme(ExtremeSearch search) : m_search(search) {}

  void reset(std::size_t n) {
    m_values.assign(n, 0);
    if (m_search == ExtremeSearch::scan) return;
    m_leaves = 1;
    while (m_leaves < n) m_leaves *= 2;
    // Tournament tree: node k holds the winner of its two children; leaves start at m_leaves.
    m_winner.resize(2 * m_leaves);
    for (std::size_t i = 0; i < m_leaves; ++i) m_winner[m_leaves + i] = i < n ? static_cast<std::int32_t>(i) : -1;
    for (std::size_t k = m_leaves; --k > 0;) m_winner[k] = better(m_winner[2 * k], m_winner[2 * k + 1]);
  }
  void set(std::size_t i, Real value) {
    m_values[i] = value;
    if (m_search == ExtremeSearch::scan) return;
    for (std::size_t k = (m_leaves + i) / 2; k > 0; k /= 2) m_winner[k] = better(m_winner[2 * k], m_winner[2 * k + 1]);
  }
  /// Requires at least one value.
  std::size_t top() const {
    if (m_search == ExtremeSearch::tree) return static_cast<std::size_t>(m_leaves > 1 ? m_winner[1] : 0);
    std::int32_t best = 0;
    for (std::size_t i = 1; i < m_values.size(); ++i) best = better(best, static_cast<std::int32_t>(i));
    return static_cast<std::size_t>(best);
  }
  Real value(std::size_t i) const { return m_values[i]; }

 private:
  std::int32_t better(std::int32_t a, std::int32_t b) const {
    if (a < 0 || b < 0) return std::max(a, b);  // -1: no candidate
    const Real x = m_values[a], y = m_values[b];
    if (y > x || (!(x >= y) && y == y)) return b;  // the second if x is NaN
    return a;
  }

  ExtremeSearch m_search;
  std::size_t m_leaves = 1;
  IndexedVector<Real> m_values;
  IndexedVector<std::int32_t> m_winner;
};

/// Contacts of each movable body, in one array: those of body i are ids[start[i]] .. ids[start[i + 1]].
class ContactsOfBodies {
 public:
  /// `pair(k)` returns the two bodies of contact k; `moves(body)` whether impulses move it.
  template <class Pair, class Moves>
  void build(std::size_t bodies, std::size_t contacts, const Pair& pair, const Moves& moves) {
    m_start.assign(bodies + 1, 0);
    const auto each = [&](const auto& visit) {
      for (std::size_t k = 0; k < contacts; ++k) {
        const auto [a, b] = pair(k);
        if (moves(a)) visit(a, k);
        if (moves(b)) visit(b, k);
      }
    };
    each([&](int body, std::size_t) { ++m_start[body + 1]; });
    for (std::size_t i = 0; i < bodies; ++i) m_start[i + 1] += m_start[i];
    m_ids.resize(m_start[bodies]);
    m_next.assign(m_start.begin(), m_start.end());
    each([&](int body, std::size_t k) { m_ids[m_next[body]++] = static_cast<std::uint32_t>(k); });
  }
  std::span<const std::uint32_t> of(int body) const {
    return {m_ids.data() + m_start[body], m_start[body + 1] - m_start[body]};
  }

 private:
  IndexedVector<std::size_t> m_start, m_next;
  IndexedVector<std::uint32_t> m_ids;
};

}}}  // namespace lpc::LPC_PRECISION::solver
