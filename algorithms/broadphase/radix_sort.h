// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace lpc {

template <class Key>
struct KeyedIndex {
  Key key;
  std::int32_t index;
};

/// Sorts by the lowest `bits` bits of the key, the only ones that may be set; equal keys keep the order of their index.
/// Two memory passes per eleven bits and no comparison: branch predictors fail on the order of random boxes.
/// Precondition: sorted by index. `scratch` is only memory.
template <class Key>
void radixSort(std::vector<KeyedIndex<Key>>& items, std::vector<KeyedIndex<Key>>& scratch, int bits) {
  constexpr int kDigit = 11;
  // The counters alone cost as much as comparing this many items.
  if (items.size() < static_cast<std::size_t>(64 * ((bits + kDigit - 1) / kDigit))) {
    std::sort(items.begin(), items.end(),
              [](const auto& a, const auto& b) { return a.key != b.key ? a.key < b.key : a.index < b.index; });
    return;
  }
  scratch.resize(items.size());
  for (int shift = 0; shift < bits; shift += kDigit) {
    std::array<std::uint32_t, std::size_t{1} << kDigit> start{};
    const auto digit = [shift](Key key) { return static_cast<std::size_t>(key >> shift) & ((1u << kDigit) - 1); };
    for (const auto& item : items) ++start[digit(item.key)];
    std::uint32_t sum = 0;
    for (std::uint32_t& s : start) {
      const std::uint32_t count = s;
      s = sum;
      sum += count;
    }
    for (const auto& item : items) scratch[start[digit(item.key)]++] = item;
    items.swap(scratch);
  }
}

}  // namespace lpc
