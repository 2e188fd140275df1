// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <vector>

#include "framework/math/check.h"
#include "framework/problem/contact.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Sorts pairs or manifolds by Manifold::key, in time linear in their number. Keys are added one by one and sorted by
/// their bytes, then apply() moves each item once. Equal keys keep their order. A comparison sort would read each
/// manifold about log n times, and manifolds are large.
class ContactOrder {
 public:
  using Key = std::array<std::uint32_t, 6>;

  void add(const decltype(Manifold<2>{}.key()) & key);
  /// Item i belongs to the i-th key. Clears the keys.
  template <class T>
  void apply(std::span<T> items) {
    LPC_ASSERT(items.size() == m_entries.size());
    if (!m_sorted) {
      sortEntries();
      moveItems(items);
    }
    m_entries.clear();
    m_sorted = true;
  }

 private:
  struct Entry {
    Key key;
    std::uint32_t from;
  };
  void sortEntries();

  // In place, by cycles: `to` takes the item at `from`, then `from` takes the next item, until the cycle closes.
  template <class T>
  void moveItems(std::span<T> items) {
    for (std::uint32_t i = 0; i < m_entries.size(); ++i) {
      if (m_entries[i].from == i) continue;
      const T first = items[i];
      std::uint32_t to = i;
      for (std::uint32_t from = m_entries[to].from; from != i; from = m_entries[to].from) {
        items[to] = items[from];
        m_entries[to].from = to, to = from;
      }
      items[to] = first;
      m_entries[to].from = to;
    }
  }

  std::vector<Entry> m_entries, m_scratch;
  std::vector<std::uint32_t> m_begin;
  bool m_sorted = true;
};

}}  // namespace lpc::LPC_PRECISION
