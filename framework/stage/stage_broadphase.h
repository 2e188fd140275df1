// SPDX-License-Identifier: Zlib
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "framework/math/aabb.h"
#include "framework/math/indexed.h"
#include "framework/math/work.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

using ProxyId = std::int32_t;  // a dense slot, the lowest free one reused

struct ProxyPair {
  ProxyId a, b;  // a < b
  auto operator<=>(const ProxyPair&) const = default;
};

/// One proxy per shape, a structure of arrays by slot. A free slot is an empty box (lo = +inf, hi = -inf) that is not
/// active and overlaps nothing. The arrays of bounds are padded with such slots to a multiple of kPad, for SIMD. A slot
/// in use may hold an empty box, too, never any other that is not finite: its body has become NaN and takes no part.
template <int D>
struct Proxies {
  static constexpr int kPad = 16;

  IndexedArray<IndexedVector<Real>, D> lo, hi;
  IndexedVector<std::uint8_t> active;  // awake and not static: a pair needs at least one
  IndexedVector<std::uint32_t> category, mask;
  IndexedVector<std::int32_t> body;  // -1 in a free slot
  int count = 0;                     // slots in use by number, free ones among them, padding not

  int size() const { return count; }
  /// Makes room for `slots` slots; new ones are free.
  void resize(int slots);
  void setBox(ProxyId i, const Aabb<D>& box);
  Aabb<D> box(ProxyId i) const;
  bool isFree(ProxyId i) const { return body[i] < 0; }

  bool boxesOverlap(ProxyId a, ProxyId b) const {
    for (int d = 0; d < D; ++d) {
      if (lo[d][a] > hi[d][b] || lo[d][b] > hi[d][a]) return false;
    }
    return true;
  }
  /// All that decides about a pair but the boxes: one is active, the bodies differ, the filters pass.
  bool mayCollide(ProxyId a, ProxyId b) const {
    return (active[a] | active[b]) && body[a] != body[b] && (category[a] & mask[b]) && (category[b] & mask[a]);
  }
};

/// What happened to the proxies since the last update. A slot that was freed and reused is in `removed` and in `added`;
/// one that came and went in between is in neither. `moved` may name added slots, and slots whose box is as before.
struct ProxyChanges {
  std::span<const ProxyId> added, removed, moved;
};

/// A part of what a broadphase divides space or boxes by: a node of a tree, a cell, a slab between two ends of an axis.
template <int D>
struct StructureBox {
  Aabb<D> box;  // infinite where the part has no end
  int level;    // below the root; 0 where there is no tree
  bool holds;   // boxes of proxies stand here: a leaf, a cell, a region with boxes across the borders of its parts
};

template <int D>
struct RayHit {
  ProxyId proxy;
  Real t;  // of entering the box, along the ray
};

/// Finds the pairs of boxes that overlap. Reports a pair if and only if the tight closed boxes overlap and
/// Proxies::mayCollide; a < b, each pair once, in any order, all pairs of this step and not only new ones.
template <int D>
class Broadphase : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::broadphase;
  static constexpr int kDimension = D;

  /// Called at least once between a change and findPairs or a query. A method without memory ignores it.
  virtual void update(const Proxies<D>&, const ProxyChanges&) {}
  /// Appends to `out`, which arrives empty.
  virtual void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) = 0;

  /// For who looks: appends the parts, each below the last one before it that is a level higher, and within that one.
  /// Those that hold touch a proxy's box each, and cover all of these together. They are as of the last update, or of
  /// the last findPairs where that builds; of fewer than two boxes there may be none. No step pays for it, by memory
  /// neither.
  virtual void structure(std::vector<StructureBox<D>>&) const {}

  // Queries on boxes, not on shapes; each has a linear scan as default. Filters and activity play no part in them.
  virtual void overlap(const Proxies<D>& proxies, const Aabb<D>& box, std::vector<ProxyId>& out) const;
  virtual void at(const Proxies<D>& proxies, const Vec<D>& point, std::vector<ProxyId>& out) const;
  /// Boxes that the ray p + t * direction, 0 <= t <= maxT, meets; `firstOnly` keeps the one with the smallest t.
  virtual void ray(const Proxies<D>& proxies, const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly,
                   std::vector<RayHit<D>>& out) const;
  /// Boxes that `box` meets while it is moved by `displacement`.
  virtual void sweep(const Proxies<D>& proxies, const Aabb<D>& box, const Vec<D>& displacement,
                     std::vector<RayHit<D>>& out) const;
};

}}  // namespace lpc::LPC_PRECISION
