// SPDX-License-Identifier: Zlib
// Scripts of boxes that are added, moved and removed, as input of a broadphase: drawn from a seed, or read from a file
// of cases.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Change of one slot in a step.
template <int D>
struct BoxChange {
  enum class What { added, removed, moved } what = What::added;
  ProxyId slot = 0;
  Aabb<D> box = {};  // for added and moved boxes
  // For added boxes.
  std::int32_t body = 0;
  bool active = false;
  std::uint32_t category = 1, mask = ~0u;
};

template <int D>
struct BoxScript {
  std::string family;
  int slots = 0;
  // In a step a slot is removed, added and moved at most once each, in this order, as in ProxyChanges.
  std::vector<std::vector<BoxChange<D>>> steps;
};

/// The boxes after the steps so far, and the changes of the last step.
template <int D>
class BoxSet {
 public:
  explicit BoxSet(int slots) { m_proxies.resize(slots); }

  void apply(const std::vector<BoxChange<D>>& step) {
    m_added.clear(), m_removed.clear(), m_moved.clear();
    for (const BoxChange<D>& c : step) apply(c);
  }
  const Proxies<D>& proxies() const { return m_proxies; }
  ProxyChanges changes() const { return {m_added, m_removed, m_moved}; }

  /// The overlapping pairs by definition, without any algorithm; sorted.
  std::vector<ProxyPair> pairs() const {
    std::vector<ProxyPair> out;
    for (ProxyId a = 0; a < m_proxies.size(); ++a) {
      for (ProxyId b = a + 1; b < m_proxies.size(); ++b) {
        if (m_proxies.boxesOverlap(a, b) && m_proxies.mayCollide(a, b)) out.push_back({a, b});
      }
    }
    return out;
  }

 private:
  using What = typename BoxChange<D>::What;

  void apply(const BoxChange<D>& c) {
    const auto k = static_cast<std::size_t>(c.slot);
    m_proxies.setBox(c.slot, c.what == What::removed ? Aabb<D>{} : c.box);
    if (c.what == What::added) {
      m_proxies.body[k] = c.body, m_proxies.active[k] = c.active;
      m_proxies.category[k] = c.category, m_proxies.mask[k] = c.mask;
    } else if (c.what == What::removed) {
      m_proxies.body[k] = -1, m_proxies.active[k] = 0;
    }
    (c.what == What::added ? m_added : c.what == What::removed ? m_removed : m_moved).push_back(c.slot);
  }

  Proxies<D> m_proxies;
  std::vector<ProxyId> m_added, m_removed, m_moved;
};

/// The script as fields of a line of a file of cases: `"slots": n, "steps": [...]`.
template <int D>
std::string scriptText(const BoxScript<D>& script);

}}  // namespace lpc::LPC_PRECISION
