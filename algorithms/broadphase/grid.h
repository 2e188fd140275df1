// SPDX-License-Identifier: Zlib
// Cells of one size with integer coordinates from one corner. The grid is unbounded; the outermost coordinates on
// either side stand for everything beyond.
#pragma once

#include <algorithm>
#include <limits>

#include "algorithms/broadphase/gathered_box.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace broadphase {

template <int D>
class Grid {
 public:
  using Cell = IndexedArray<std::int32_t, D>;

  Grid() = default;
  /// Makes cells with edge `cell` (m); if it is 0, all boxes are points and any edge will do.
  Grid(const IndexedArray<Real, D>& origin, Real cell) : m_origin(origin) {
    const Real most = sizeof(Real) == 8 ? Real(1e100) : Real(1e15);  // 0 * inf would be NaN
    m_inverse = cell > 0 ? std::clamp(1 / cell, std::numeric_limits<Real>::min(), most) : Real(1);
  }

  Real inverse() const { return m_inverse; }  // cells per m

  /// Floor, non-decreasing in x, so that touching boxes are in the same or in neighbouring cells; truncation would
  /// merge the two cells beside 0.
  std::int32_t coordinate(Real x, std::size_t d) const {
    const Real limit = Real(kLast);
    const Real t = std::min(std::max((x - m_origin[d]) * m_inverse, -limit), limit);
    const auto whole = static_cast<std::int32_t>(t);
    return whole - (t < static_cast<Real>(whole) ? 1 : 0);
  }

  /// Appends the cells that a box reaches.
  void tellCells(const GatheredBox<D>& box, std::vector<StructureBox<D>>& out) const {
    Cell lo, hi;
    for (std::size_t d = 0; d < D; ++d) lo[d] = coordinate(box.lo[d], d), hi[d] = coordinate(box.hi[d], d);
    for (Cell at = lo; at[D - 1] <= hi[D - 1];) {
      out.push_back({bounds(at), 0, true});
      std::size_t d = 0;
      while (++at[d] > hi[d] && d + 1 < D) at[d] = lo[d], ++d;
    }
  }

 private:
  static constexpr std::int32_t kLast = 1 << 29;  // so that differences of coordinates fit, too

  Aabb<D> bounds(const Cell& at) const {
    Aabb<D> box = Aabb<D>::everywhere();
    for (std::size_t d = 0; d < D; ++d) {
      const int k = static_cast<int>(d);
      if (at[d] > -kLast) box.lo[k] = begins(at[d], d);
      if (at[d] < kLast) box.hi[k] = begins(at[d] + 1, d);
    }
    return box;
  }
  Real begins(std::int32_t coordinate, std::size_t d) const {
    return static_cast<Real>(static_cast<double>(m_origin[d]) + coordinate / static_cast<double>(m_inverse));
  }

  IndexedArray<Real, D> m_origin{};  // m
  Real m_inverse = 1;
};

/// Removes duplicates from `from` on.
template <int D>
inline void tellOnce(std::vector<StructureBox<D>>& out, std::size_t from) {
  const auto before = [](const StructureBox<D>& a, const StructureBox<D>& b) {
    for (int d = D; d-- > 0;) {
      if (a.box.lo[d] != b.box.lo[d]) return a.box.lo[d] < b.box.lo[d];
      if (a.box.hi[d] != b.box.hi[d]) return a.box.hi[d] < b.box.hi[d];
    }
    return false;
  };
  const auto same = [&](const StructureBox<D>& a, const StructureBox<D>& b) { return !before(a, b) && !before(b, a); };
  const auto begin = out.begin() + static_cast<std::ptrdiff_t>(from);
  std::sort(begin, out.end(), before);
  out.erase(std::unique(begin, out.end(), same), out.end());
}

}}}  // namespace lpc::LPC_PRECISION::broadphase
