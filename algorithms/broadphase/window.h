// SPDX-License-Identifier: Zlib
// Coordinates as small integers. The map x -> q is non-decreasing despite rounding (subtract, multiply, clamp and
// truncate each are), so closed intervals that overlap still overlap after it. It adds false hits, which an exact test
// of the real boxes removes. In return an overlap test works on integers, of which many fit in a register.
#pragma once

#include <algorithm>
#include <limits>

#include "framework/math/indexed.h"
#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace broadphase {

/// The region of the boxes. Coordinates outside are clamped to its border, so that one lost body at 1e7 m does not cost
/// the others their resolution.
template <int D>
struct Window {
  IndexedArray<Real, D> lo, hi;  // lo <= hi, m
};

/// The tight bounds of all boxes, limited on each axis to three times the span of the middle 90 % of a sample.
/// Precondition: `slots` is not empty. `sample` is scratch.
template <int D>
Window<D> findWindow(const Proxies<D>& proxies, std::span<const ProxyId> slots, std::vector<Real>& sample) {
  constexpr std::size_t kSamples = 64;
  const std::size_t stride = std::max<std::size_t>(1, slots.size() / kSamples);
  Window<D> window;
  for (std::size_t d = 0; d < D; ++d) {
    const IndexedVector<Real>&lo = proxies.lo[d], &hi = proxies.hi[d];
    // Four independent chains each hide the latency of the comparisons; free slots and padding are empty boxes and drop
    // out.
    std::array<Real, 4> least, most;
    least.fill(std::numeric_limits<Real>::infinity()), most.fill(-std::numeric_limits<Real>::infinity());
    for (std::size_t i = 0; i + 4 <= lo.size(); i += 4) {
      for (std::size_t k = 0; k < 4; ++k) {
        least[k] = lo[i + k] < least[k] ? lo[i + k] : least[k];
        most[k] = hi[i + k] > most[k] ? hi[i + k] : most[k];
      }
    }
    const Real min = *std::min_element(least.begin(), least.end());
    const Real max = *std::max_element(most.begin(), most.end());
    sample.clear();
    for (std::size_t i = 0; i < slots.size(); i += stride) sample.push_back(lo[slots[i]]);
    const auto at = [&](std::size_t k) {
      std::nth_element(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(k), sample.end());
      return sample[k];
    };
    const std::size_t twentieth = sample.size() / 20;
    const Real early = at(twentieth), late = at(sample.size() - 1 - twentieth);
    const Real span = late - early;
    const bool cut = span > 0;
    window.lo[d] = cut ? std::max(min, early - span) : min;
    window.hi[d] = cut ? std::min(max, late + span) : max;
  }
  return window;
}

/// The longest edge (m) of each of about `samples` boxes, at most twice as many, spread evenly over the slots: of awake
/// ones, or of all if none is awake. Precondition: `slots` is not empty.
template <int D>
void sampleSizes(const Proxies<D>& proxies, std::span<const ProxyId> slots, std::size_t samples,
                 std::vector<Real>& sizes) {
  const std::size_t stride = std::max<std::size_t>(1, slots.size() / samples);
  for (const bool onlyActive : {true, false}) {
    sizes.clear();
    for (std::size_t k = 0; k < slots.size(); k += stride) {
      const auto i = slots[k];
      if (onlyActive && !proxies.active[i]) continue;
      Real size = 0;
      for (std::size_t d = 0; d < D; ++d) size = std::max(size, proxies.hi[d][i] - proxies.lo[d][i]);
      sizes.push_back(size);
    }
    if (!sizes.empty()) return;
  }
}

/// Widened around its middle to a square or cube: a tree that halves all axes at once needs regions as wide as high.
template <int D>
Window<D> widened(Window<D> window) {
  Real span = 0;
  for (std::size_t d = 0; d < D; ++d) span = std::max(span, window.hi[d] - window.lo[d]);
  for (std::size_t d = 0; d < D; ++d) {
    const Real more = (span - (window.hi[d] - window.lo[d])) / 2;
    if (more < std::numeric_limits<Real>::infinity()) window.lo[d] -= more, window.hi[d] += more;
  }
  return window;
}

/// x -> 0 .. limit, the whole window over the range.
struct Scale {
  Real origin, factor, limit;

  Scale() = default;
  Scale(Real lo, Real hi, Real limit_) : origin(lo), limit(limit_) {
    // Neither 0 nor infinite: 0 * inf would be NaN, and a NaN is not monotone.
    const Real most = sizeof(Real) == 8 ? Real(1e100) : Real(1e15);
    factor = hi > lo ? std::clamp(limit / (hi - lo), std::numeric_limits<Real>::min(), most) : Real(1);
  }
  Real operator()(Real x) const {
    const Real t = (x - origin) * factor;
    return std::min(std::max(t, Real(0)), limit);
  }
};

}}}  // namespace lpc::LPC_PRECISION::broadphase
