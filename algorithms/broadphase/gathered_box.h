// SPDX-License-Identifier: Zlib
// A proxy as the sorting broadphases store it: all data that decide about a pair in one cache line, so that neighbours
// in a sweep, a cell or a tree node are neighbours in memory, too.
#pragma once

#include "framework/math/indexed.h"
#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace broadphase {

template <int D>
struct GatheredBox {
  IndexedArray<Real, D> lo, hi;  // exact, world (m)
  std::uint32_t category, mask;
  std::int32_t body;
  std::uint32_t slotAndActive;  // slot * 2 + active: keeps the 3D double-precision box at 64 bytes

  static GatheredBox of(const Proxies<D>& proxies, ProxyId slot) {
    GatheredBox b;
    for (std::size_t d = 0; d < D; ++d) b.lo[d] = proxies.lo[d][slot], b.hi[d] = proxies.hi[d][slot];
    b.category = proxies.category[slot], b.mask = proxies.mask[slot], b.body = proxies.body[slot];
    b.slotAndActive = static_cast<std::uint32_t>(slot) * 2 + (proxies.active[slot] ? 1 : 0);
    return b;
  }
  ProxyId slot() const { return static_cast<ProxyId>(slotAndActive >> 1); }
  bool active() const { return slotAndActive & 1; }
  Aabb<D> box() const { return {Vec<D>(lo.data()), Vec<D>(hi.data())}; }
};

/// Lists the slots with a box that can overlap another.
template <int D>
inline void listSlots(const Proxies<D>& proxies, std::vector<ProxyId>& slots) {
  slots.clear();
  for (ProxyId i = 0; i < proxies.size(); ++i) {
    if (!proxies.isFree(i) && proxies.lo[0][i] <= proxies.hi[0][i]) slots.push_back(i);
  }
}

/// The same with awake ones first; returns their number. No two of the others need be compared.
template <int D>
inline std::size_t listActiveFirst(const Proxies<D>& proxies, std::vector<ProxyId>& slots) {
  slots.clear();
  std::size_t awake = 0;
  for (const bool active : {true, false}) {
    for (ProxyId i = 0; i < proxies.size(); ++i) {
      if ((proxies.active[i] != 0) == active && !proxies.isFree(i) && proxies.lo[0][i] <= proxies.hi[0][i]) {
        slots.push_back(i);
      }
    }
    if (active) awake = slots.size();
  }
  return awake;
}

/// Appends the pair if the exact closed boxes overlap and the two may collide: Proxies::boxesOverlap and mayCollide.
template <int D>
inline void emitIfPair(const GatheredBox<D>& a, const GatheredBox<D>& b, std::vector<ProxyPair>& out) {
  for (std::size_t d = 0; d < D; ++d) {
    if (a.lo[d] > b.hi[d] || b.lo[d] > a.hi[d]) return;
  }
  if (!((a.slotAndActive | b.slotAndActive) & 1) || a.body == b.body) return;
  if (!(a.category & b.mask) || !(b.category & a.mask)) return;
  const ProxyId i = a.slot(), j = b.slot();
  out.push_back(i < j ? ProxyPair{i, j} : ProxyPair{j, i});
}

}}}  // namespace lpc::LPC_PRECISION::broadphase
