// SPDX-License-Identifier: Zlib
#include "framework/problem/contact_order.h"

namespace lpc { inline namespace LPC_PRECISION {

void ContactOrder::add(const decltype(Manifold<2>{}.key()) & key) {
  const auto from = static_cast<std::uint32_t>(m_entries.size());
  m_entries.push_back({std::apply([](auto... part) { return Key{static_cast<std::uint32_t>(part)...}; }, key), from});
  if (from > 0 && m_entries[from].key < m_entries[from - 1].key) m_sorted = false;
}

// Radix sort by 16-bit digits, least significant first. Digits that are equal in all keys are skipped, which leaves
// four in a world of fewer than 65,536 convex shapes.
void ContactOrder::sortEntries() {
  Key differs{}, bits{};
  for (const Entry& e : m_entries) {
    for (std::size_t k = 0; k < differs.size(); ++k) {
      differs[k] |= e.key[k] ^ m_entries[0].key[k];
      bits[k] |= e.key[k];
    }
  }
  m_scratch.resize(m_entries.size());
  for (std::size_t k = differs.size(); k-- > 0;) {
    for (int shift = 0; shift < 32; shift += 16) {
      if (((differs[k] >> shift) & 0xffff) == 0) continue;
      const auto digit = [&](const Entry& e) { return (e.key[k] >> shift) & 0xffff; };
      m_begin.assign(((bits[k] >> shift) & 0xffff) + 2, 0);  // the largest digit is at most the union of all bits
      for (const Entry& e : m_entries) ++m_begin[digit(e) + 1];
      for (std::size_t d = 1; d < m_begin.size(); ++d) m_begin[d] += m_begin[d - 1];
      for (const Entry& e : m_entries) m_scratch[m_begin[digit(e)]++] = e;
      std::swap(m_entries, m_scratch);
    }
  }
}

}}  // namespace lpc::LPC_PRECISION
