// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <vector>

#include "framework/contact.h"

namespace lpc::inline LPC_PRECISION {

/// Sorts manifolds by Manifold::key in time linear in their number. Comparing sorts look at each manifold some log n
/// times in a random order, and manifolds are large: with 30,000 of them that was the most of the stage "cache".
template <int D>
class ManifoldSort {
 public:
  void operator()(std::span<Manifold<D>> manifolds);

 private:
  using Key = std::array<std::uint32_t, std::tuple_size_v<decltype(Manifold<D>{}.key())>>;
  struct Entry {
    Key key;
    std::uint32_t from;
  };
  bool readKeys(std::span<const Manifold<D>> manifolds);  // false: they are in order already
  void sortEntries();
  std::vector<Entry> m_entries, m_scratch;
};

}  // namespace lpc::inline LPC_PRECISION
