// SPDX-License-Identifier: Zlib
#include "framework/manifold_sort.h"

namespace lpc::inline LPC_PRECISION {

template <int D>
bool ManifoldSort<D>::readKeys(std::span<const Manifold<D>> manifolds) {
  m_entries.resize(manifolds.size());
  bool sorted = true;
  for (std::size_t i = 0; i < manifolds.size(); ++i) {
    Entry& e = m_entries[i];
    e.key = std::apply([](auto... part) { return Key{static_cast<std::uint32_t>(part)...}; }, manifolds[i].key());
    e.from = static_cast<std::uint32_t>(i);
    if (i > 0 && e.key < m_entries[i - 1].key) sorted = false;
  }
  return !sorted;
}

// Least significant byte first; bytes that are the same in all keys (most are) cost nothing.
template <int D>
void ManifoldSort<D>::sortEntries() {
  Key differs{};
  for (const Entry& e : m_entries) {
    for (std::size_t k = 0; k < differs.size(); ++k) differs[k] |= e.key[k] ^ m_entries[0].key[k];
  }
  m_scratch.resize(m_entries.size());
  for (std::size_t k = differs.size(); k-- > 0;) {
    for (int shift = 0; shift < 32; shift += 8) {
      if (((differs[k] >> shift) & 0xff) == 0) continue;
      const auto digit = [&](const Entry& e) { return (e.key[k] >> shift) & 0xff; };
      std::array<std::uint32_t, 257> begin{};
      for (const Entry& e : m_entries) ++begin[digit(e) + 1];
      for (std::size_t d = 1; d < begin.size(); ++d) begin[d] += begin[d - 1];
      for (const Entry& e : m_entries) m_scratch[begin[digit(e)]++] = e;
      std::swap(m_entries, m_scratch);
    }
  }
}

template <int D>
void ManifoldSort<D>::operator()(std::span<Manifold<D>> manifolds) {
  if (!readKeys(manifolds)) return;
  sortEntries();
  // Each moves once, in place: place `i` takes the one from `from`, whose place takes the next, until a cycle closes.
  for (std::uint32_t i = 0; i < m_entries.size(); ++i) {
    if (m_entries[i].from == i) continue;
    const Manifold<D> first = manifolds[i];
    std::uint32_t to = i;
    for (std::uint32_t from = m_entries[to].from; from != i; from = m_entries[to].from) {
      manifolds[to] = manifolds[from];
      m_entries[to].from = to, to = from;
    }
    manifolds[to] = first;
    m_entries[to].from = to;
  }
}

template class ManifoldSort<2>;
template class ManifoldSort<3>;

}  // namespace lpc::inline LPC_PRECISION
