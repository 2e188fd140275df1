// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "framework/problem/joint.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Pairs of jointed bodies that do not collide with each other.
class NonCollidingPairs {
 public:
  /// Replaces the pairs by the pairs that these joints exclude.
  template <int D>
  void read(std::span<const JointRecord<D>> joints) {
    m_pairs.clear();
    for (const JointRecord<D>& j : joints) {
      if (j.active() && j.bodyA >= 0 && !j.collide) m_pairs.emplace_back(std::minmax(j.bodyA, j.bodyB));
    }
    std::sort(m_pairs.begin(), m_pairs.end());
  }
  bool contains(std::int32_t a, std::int32_t b) const {  // a < b
    return std::binary_search(m_pairs.begin(), m_pairs.end(), std::pair(a, b));
  }

 private:
  std::vector<std::pair<std::int32_t, std::int32_t>> m_pairs;  // sorted
};

}}  // namespace lpc::LPC_PRECISION
