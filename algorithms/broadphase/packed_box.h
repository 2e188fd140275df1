// SPDX-License-Identifier: Zlib
// A whole box in two machine words: D integer coordinates side by side, a guard bit above each. One subtraction then
// compares all axes at once: the guard survives where the field of the minuend is not smaller.
//
//     bit 63 ..            3D: guard z20 guard y20 guard x20            .. 0        (2D: 31 bits each)
#pragma once

#include "algorithms/broadphase/window.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace broadphase {

struct PackedBox {
  std::uint64_t lo, hi;
};

template <int D>
class Packing {
 public:
  static constexpr int kBits = D == 2 ? 31 : 20;
  static constexpr std::uint64_t kField = (std::uint64_t{1} << kBits) - 1;
  static constexpr std::uint64_t kGuards = [] {
    std::uint64_t guards = 0;
    for (int d = 0; d < D; ++d) guards |= std::uint64_t{1} << (d * (kBits + 1) + kBits);
    return guards;
  }();
  // In float, 2^31 - 1 would round up and out of the field: only the high bits are used.
  static constexpr int kUsed = std::min(kBits, std::numeric_limits<Real>::digits);
  static constexpr int kShift = kBits - kUsed;
  static constexpr double kUnit = std::uint64_t{1} << kShift;  // between two coordinates

  Packing() = default;
  explicit Packing(const Window<D>& window) {
    constexpr auto limit = static_cast<Real>((std::uint64_t{1} << kUsed) - 1);
    for (std::size_t d = 0; d < D; ++d) m_scale[d] = Scale(window.lo[d], window.hi[d], limit);
  }
  PackedBox pack(const IndexedArray<Real, D>& lo, const IndexedArray<Real, D>& hi) const {
    PackedBox box{0, 0};
    for (std::size_t d = 0; d < D; ++d) {
      const int at = static_cast<int>(d) * (kBits + 1) + kShift;
      box.lo |= static_cast<std::uint64_t>(static_cast<std::int64_t>(m_scale[d](lo[d]))) << at;
      box.hi |= static_cast<std::uint64_t>(static_cast<std::int64_t>(m_scale[d](hi[d]))) << at;
    }
    return box;
  }
  static std::uint64_t field(std::uint64_t corner, int d) { return (corner >> (d * (kBits + 1))) & kField; }

  /// False only if the real boxes do not overlap.
  static bool overlap(const PackedBox& a, const PackedBox& b) {
    return ((((a.hi | kGuards) - b.lo) & ((b.hi | kGuards) - a.lo)) & kGuards) == kGuards;
  }
  static PackedBox merged(const PackedBox& a, const PackedBox& b) {
    PackedBox box{0, 0};
    for (int d = 0; d < D; ++d) {
      const int at = d * (kBits + 1);
      box.lo |= std::min(field(a.lo, d), field(b.lo, d)) << at;
      box.hi |= std::max(field(a.hi, d), field(b.hi, d)) << at;
    }
    return box;
  }

  /// The box of real coordinates that pack to lo <= field < hi on each axis. The first and the last field are
  /// unbounded: coordinates beyond are clamped to them.
  Aabb<D> region(const IndexedArray<double, D>& lo, const IndexedArray<double, D>& hi) const {
    Aabb<D> box;
    for (std::size_t d = 0; d < D; ++d) {
      box.lo[static_cast<int>(d)] = begins(lo[d], d), box.hi[static_cast<int>(d)] = begins(hi[d], d);
    }
    return box;
  }

 private:
  Real begins(double field, std::size_t d) const {
    const Scale& scale = m_scale[d];
    const double whole = field / kUnit;
    if (whole <= 0) return -std::numeric_limits<Real>::infinity();
    if (whole > static_cast<double>(scale.limit)) return std::numeric_limits<Real>::infinity();
    return static_cast<Real>(static_cast<double>(scale.origin) + whole / static_cast<double>(scale.factor));
  }

  IndexedArray<Scale, D> m_scale{};
};

/// Boxes after the last one that listOverlaps may read, and extra room in `hits` that it may write.
inline constexpr std::int32_t kListAhead = 4;

/// Writes the index of each of boxes[begin .. end) that overlaps `a` to `hits`, which has room for all of them; returns
/// the end of the output. It does not branch on the result, since a quarter of the tests near a box hit. It works in
/// groups of four, since the number of neighbours in a cell is as hard to predict.
template <int D>
inline std::int32_t* listOverlaps(const PackedBox* boxes, const PackedBox& a, std::int32_t begin, std::int32_t end,
                                  std::int32_t* hits) {
  do {
    for (std::int32_t k = begin; k < begin + kListAhead; ++k) {
      *hits = k;
      hits += static_cast<int>(Packing<D>::overlap(boxes[k], a)) & static_cast<int>(k < end);
    }
    begin += kListAhead;
  } while (begin < end);
  return hits;
}

}}}  // namespace lpc::LPC_PRECISION::broadphase
