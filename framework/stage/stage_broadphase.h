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

using ProxyId = std::int32_t;  // a dense slot; the lowest free slot is reused first

struct ProxyPair {
  ProxyId a, b;  // a < b
  auto operator<=>(const ProxyPair&) const = default;
};

/// One proxy per shape, as a structure of arrays by slot. A free slot has an empty box (lo = +inf, hi = -inf), is not
/// active and overlaps no proxy. The arrays of bounds are padded with free slots to a multiple of kPad, for SIMD. A
/// used slot has an empty box when its shape is a plane or its body has become NaN; all other boxes are finite.
template <int D>
struct Proxies {
  static constexpr int kPad = 16;

  IndexedArray<IndexedVector<Real>, D> lo, hi;
  IndexedVector<std::uint8_t> active;  // awake and not static: a pair needs at least one
  IndexedVector<std::uint32_t> category, mask;
  IndexedVector<std::int32_t> body;  // -1 in a free slot
  int count = 0;                     // number of slots, with free slots, without padding

  int size() const { return count; }
  /// Makes room for `slots` slots; new slots are free.
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
  /// True when two proxies may collide if their boxes overlap: one is active, the bodies differ, the filters pass.
  bool mayCollide(ProxyId a, ProxyId b) const {
    return (active[a] | active[b]) && body[a] != body[b] && (category[a] & mask[b]) && (category[b] & mask[a]);
  }
};

/// Changes of the proxies since the last update. A slot that was freed and reused is in both `removed` and `added`. A
/// slot that was added and then removed is in neither. `moved` may contain added slots and slots with unchanged boxes.
struct ProxyChanges {
  std::span<const ProxyId> added, removed, moved;
};

/// A cell of a broadphase's structure: a node of a tree, a grid cell, a slab between two endpoints of an axis.
template <int D>
struct StructureBox {
  Aabb<D> box;  // infinite where the cell is unbounded
  int level;    // depth below the root; 0 without a tree
  bool holds;   // it stores proxies: a leaf, a grid cell, a region with boxes that cross the borders of its children
};

template <int D>
struct RayHit {
  ProxyId proxy;
  Real t;  // where the ray enters the box
};

/// Finds overlapping pairs of boxes. Reports a pair if and only if the tight closed boxes overlap and
/// Proxies::mayCollide is true. Reports all pairs of the step, not only new ones, each once with a < b, in any order.
template <int D>
class Broadphase : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::broadphase;
  static constexpr int kDimension = D;

  /// Reports changes of the proxies. Called at least once between a change and the next findPairs() or query. A method
  /// that keeps no state ignores it.
  virtual void update(const Proxies<D>&, const ProxyChanges&) {}
  /// Appends the pairs to `out`, which is empty at the call.
  virtual void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) = 0;

  /// Debug drawing: appends the nodes in preorder, each within its parent. Each node with `holds` touches a proxy's
  /// box, and together these nodes cover all boxes. The structure is that of the last update(), or of the last
  /// findPairs() when that builds it. It may be empty for fewer than two boxes. Costs a step neither time nor memory
  /// when unused.
  virtual void structure(std::vector<StructureBox<D>>&) const {}

  // Queries on boxes, not on shapes. The defaults scan linearly. Filters and activity have no effect.
  virtual void overlap(const Proxies<D>& proxies, const Aabb<D>& box, std::vector<ProxyId>& out) const;
  virtual void at(const Proxies<D>& proxies, const Vec<D>& point, std::vector<ProxyId>& out) const;
  /// Boxes hit by the ray p + t * direction, 0 <= t <= maxT; `firstOnly` keeps only the smallest t.
  virtual void ray(const Proxies<D>& proxies, const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly,
                   std::vector<RayHit<D>>& out) const;
  /// Boxes hit by `box` while it moves by `displacement`.
  virtual void sweep(const Proxies<D>& proxies, const Aabb<D>& box, const Vec<D>& displacement,
                     std::vector<RayHit<D>>& out) const;
};

}}  // namespace lpc::LPC_PRECISION
