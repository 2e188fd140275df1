// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "framework/space.h"

namespace lpc::inline LPC_PRECISION {

/// Gives out the slots of a table, the lowest free one first: the same calls give the same slots, and a table stays as
/// short as it can. Free slots are a heap; `visits` is raised by the number of them that were looked at.
class SlotTable {
  struct Higher {
    std::uint64_t& visits;
    bool operator()(std::size_t a, std::size_t b) const { return ++visits, a > b; }
  };

 public:
  /// The lowest free slot; size() grows by one when there is none.
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
  /// For a table that was read from elsewhere.
  template <class Table, class IsFree>
  void read(const Table& table, const IsFree& isFree) {
    m_size = table.size();
    m_free.clear();
    for (std::size_t i = 0; i < m_size; ++i) {
      if (isFree(table[i])) m_free.push_back(i);  // in ascending order, which is a heap
    }
  }

 private:
  std::vector<std::size_t> m_free;
  std::size_t m_size = 0;
};

}  // namespace lpc::inline LPC_PRECISION
