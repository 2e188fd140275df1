// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Assigns the slots of a table, the lowest free slot first: the same calls give the same slots, and the table stays as
/// short as possible. Free slots are a heap; `visits` counts calls of take() and comparisons in the heap.
class SlotTable {
  struct Higher {
    std::uint64_t& visits;
    bool operator()(std::size_t a, std::size_t b) const { return ++visits, a > b; }
  };

 public:
  /// Returns the lowest free slot; size() grows by one when there is none.
  std::size_t take(std::uint64_t& visits) {
    ++visits;
    if (m_free.empty()) return m_size++;
    std::pop_heap(m_free.begin(), m_free.end(), Higher{visits});
    const std::size_t slot = m_free.back();
    m_free.pop_back();
    return slot;
  }
  void give(std::size_t slot, std::uint64_t& visits) {
    m_free.push_back(slot);
    std::push_heap(m_free.begin(), m_free.end(), Higher{visits});
  }
  std::size_t size() const { return m_size; }
  int inUse() const { return static_cast<int>(m_size - m_free.size()); }
  /// Reads the free slots of a table that was loaded.
  template <class Table, class IsFree>
  void read(const Table& table, const IsFree& isFree) {
    m_size = table.size();
    m_free.clear();
    for (std::size_t i = 0; i < m_size; ++i) {
      if (isFree(table[i])) m_free.push_back(i);  // ascending order is a valid heap
    }
  }

 private:
  std::vector<std::size_t> m_free;
  std::size_t m_size = 0;
};

/// Slots owned by each body, ascending, whatever the order of insertion. `visits` counts the slots that are returned,
/// inserted or moved; appending the last slot counts none.
class SlotLists {
 public:
  std::span<const std::int32_t> of(std::size_t owner) const {
    return owner < m_lists.size() ? std::span<const std::int32_t>(m_lists[owner]) : std::span<const std::int32_t>();
  }
  std::span<const std::int32_t> of(std::size_t owner, std::uint64_t& visits) const {
    visits += of(owner).size();
    return of(owner);
  }
  void add(std::size_t owner, std::size_t slot, std::uint64_t& visits) {
    if (owner >= m_lists.size()) m_lists.resize(owner + 1);
    std::vector<std::int32_t>& list = m_lists[owner];
    const auto after = std::upper_bound(list.begin(), list.end(), static_cast<std::int32_t>(slot));
    visits += static_cast<std::uint64_t>(list.end() - after);
    list.insert(after, static_cast<std::int32_t>(slot));
  }
  /// Precondition: `owner` has the slot.
  void remove(std::size_t owner, std::size_t slot, std::uint64_t& visits) {
    std::vector<std::int32_t>& list = m_lists[owner];
    const auto at = std::lower_bound(list.begin(), list.end(), static_cast<std::int32_t>(slot));
    visits += static_cast<std::uint64_t>(list.end() - at);
    list.erase(at);
  }
  void clear() { m_lists.clear(); }

 private:
  std::vector<std::vector<std::int32_t>> m_lists;
};

}}  // namespace lpc::LPC_PRECISION
