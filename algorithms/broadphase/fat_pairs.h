// SPDX-License-Identifier: Zlib
// Pairs of overlapping fat boxes, kept from step to step. Pairs of boxes that have changed are dropped and found anew.
#pragma once

#include <algorithm>

#include "framework/math/indexed.h"
#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace broadphase {

/// The loops have no branches and test many pairs in a row: most conditions are unpredictable, and the loads of one
/// pair need not wait for those of another.
template <int D>
class FatPairs {
 public:
  void resize(std::size_t slots) { m_isChanged.resize(slots, 0), m_changed.reserve(slots); }
  void note(ProxyId i) {
    if (!m_isChanged[i]) m_changed.push_back(i);
    m_isChanged[i] = 1;
  }
  const std::vector<ProxyId>& changed() const { return m_changed; }
  bool isChanged(ProxyId i) const { return m_isChanged[i]; }
  std::size_t size() const { return m_pairs.size(); }

  /// Drops the pairs of changed boxes. Of the others, emits those with overlapping tight boxes.
  void keep(const IndexedVector<Aabb<D>>& tight, std::vector<ProxyPair>& out) {
    std::size_t kept = 0, met = out.size();
    out.resize(met + m_pairs.size());
    for (const ProxyPair pair : m_pairs) {
      const bool stays = !(m_isChanged[pair.a] | m_isChanged[pair.b]);
      m_pairs[kept] = out[met] = pair;
      kept += stays;
      met += stays & near(tight[pair.a], tight[pair.b]);
    }
    m_pairs.resize(kept), out.resize(met);
  }
  /// Lists a pair of overlapping fat boxes of which one has changed; listed pairs are added by addListed().
  void list(ProxyId i, ProxyId j) { m_listed.push_back({std::min(i, j), std::max(i, j)}); }
  bool listIsLong() const { return m_listed.size() >= 1024; }
  void addListed(const Proxies<D>& proxies, const IndexedVector<Aabb<D>>& tight, std::vector<ProxyPair>& out) {
    std::size_t kept = m_pairs.size(), met = out.size();
    m_pairs.resize(kept + m_listed.size()), out.resize(met + m_listed.size());
    for (const ProxyPair pair : m_listed) {
      m_pairs[kept] = out[met] = pair;
      const bool may = mayCollide(proxies, pair);
      kept += may;
      met += may & near(tight[pair.a], tight[pair.b]);
    }
    m_pairs.resize(kept), out.resize(met);
    m_listed.clear();
  }
  /// Boxes count as unchanged from here on.
  void settle() {
    for (const ProxyId i : m_changed) m_isChanged[i] = 0;
    m_changed.clear();
  }

  /// The same as Aabb::overlaps.
  static bool near(const Aabb<D>& a, const Aabb<D>& b) {
    bool yes = true;
    for (int d = 0; d < D; ++d) yes = yes & (a.lo[d] <= b.hi[d]) & (b.lo[d] <= a.hi[d]);
    return yes;
  }

 private:
  // The same as Proxies::mayCollide.
  static bool mayCollide(const Proxies<D>& proxies, const ProxyPair& pair) {
    const auto [a, b] = pair;
    return ((proxies.active[a] | proxies.active[b]) != 0) & (proxies.body[a] != proxies.body[b]) &
           ((proxies.category[a] & proxies.mask[b]) != 0) & ((proxies.category[b] & proxies.mask[a]) != 0);
  }

  IndexedVector<std::uint8_t> m_isChanged;  // by slot
  std::vector<ProxyId> m_changed;           // since the last settle()
  std::vector<ProxyPair> m_pairs;           // of boxes that may collide
  std::vector<ProxyPair> m_listed;          // not filtered yet
};

}}}  // namespace lpc::LPC_PRECISION::broadphase
