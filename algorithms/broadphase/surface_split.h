// SPDX-License-Identifier: Zlib
// One step of a top-down build: boxes are divided where the surface area heuristic is least (Wald 2007).
#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include "framework/math/indexed.h"
#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace broadphase {

template <int D>
struct SplitItem {
  Aabb<D> box;
  ProxyId proxy;

  /// Half of the centre on an axis: differences of two do not overflow.
  Real middle(int axis) const { return box.lo[axis] / 4 + box.hi[axis] / 4; }
};

/// Half of the surface (3D) or of the perimeter (2D). Bounded, so that differences do not overflow to NaN.
template <int D>
inline Real halfSurface(const Aabb<D>& box) {
  const Vec<D> size = box.hi - box.lo;
  Real half = size[0] + size[1];
  if constexpr (D == 3) half = size[0] * size[1] + half * size[2];
  return std::min(half, std::numeric_limits<Real>::max() / 4);
}

/// Moves one half of the items before the others, along the axis.
template <int D>
inline std::size_t splitInHalves(std::span<SplitItem<D>> items, int axis) {
  const auto middle = items.begin() + static_cast<std::ptrdiff_t>(items.size() / 2);
  std::nth_element(items.begin(), middle, items.end(), [axis](const SplitItem<D>& a, const SplitItem<D>& b) {
    const Real x = a.middle(axis), y = b.middle(axis);
    return x != y ? x < y : a.proxy < b.proxy;
  });
  return items.size() / 2;
}

/// Reorders two or more items; returns the number on the left side, neither none nor all. The border is the best of
/// those between eight slices of the axis on which the centres spread most. With `bySurface` false, or if no border is
/// found, each side gets half of the items. The sides do not depend on the order of the items.
template <int D>
inline std::size_t split(std::span<SplitItem<D>> items, bool bySurface) {
  constexpr int kBins = 8;
  constexpr std::size_t kFew = 4;  // items that are halved: bins cost more than they gain
  Vec<D> lo = items[0].box.lo / 4 + items[0].box.hi / 4, hi = lo;
  for (const SplitItem<D>& item : items) {
    const Vec<D> middle = item.box.lo / 4 + item.box.hi / 4;
    lo = lo.cwiseMin(middle), hi = hi.cwiseMax(middle);
  }
  int axis = 0;
  (hi - lo).maxCoeff(&axis);
  const Real from = lo[axis], factor = static_cast<Real>(kBins) / (hi[axis] - from);
  if (!bySurface || items.size() <= kFew || !(factor < std::numeric_limits<Real>::max())) {
    return splitInHalves(items, axis);
  }
  struct Bin {
    Aabb<D> box;
    std::int32_t count = 0;

    void add(const Bin& other) { box = box.merged(other.box), count += other.count; }
    Real cost() const { return halfSurface(box) * static_cast<Real>(count); }
  };
  IndexedArray<Bin, kBins> bins;
  const auto binOf = [&](const SplitItem<D>& item) {
    return std::min(static_cast<std::int32_t>((item.middle(axis) - from) * factor), kBins - 1);
  };
  for (const SplitItem<D>& item : items) bins[binOf(item)].add({item.box, 1});
  // The first and the last bin hold an item, so no cost is that of an empty box.
  IndexedArray<Real, kBins> right;
  Bin sum;
  for (int b = kBins; b-- > 1;) {
    sum.add(bins[b]);
    right[b] = sum.cost();
  }
  sum = Bin{};
  Real least = std::numeric_limits<Real>::infinity();
  int border = 0;
  for (int b = 1; b < kBins; ++b) {
    sum.add(bins[b - 1]);
    if (const Real cost = sum.cost() + right[b]; cost < least) least = cost, border = b;
  }
  if (border == 0) return splitInHalves(items, axis);  // the costs are beyond the range of numbers
  const auto end = std::partition(items.begin(), items.end(), [&](const auto& item) { return binOf(item) < border; });
  return static_cast<std::size_t>(end - items.begin());
}

}}}  // namespace lpc::LPC_PRECISION::broadphase
