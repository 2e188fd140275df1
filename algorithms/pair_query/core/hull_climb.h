// SPDX-License-Identifier: Zlib
// The farthest vertex of a hull by a climb along its edges: where it begins near by, it looks at a few vertices,
// however many there are.
#pragma once

#include <algorithm>
#include <array>

#include "algorithms/pair_query/tolerances.h"
#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// Some vertices of a hull.
struct HullPeak {
  std::array<int, kMostLevel> vertices;
  std::size_t count = 0;
};

/// All vertices that lie within `band` (m times the length of d) of the farthest along d, of any length, and perhaps
/// others; the highest, of several the first, is vertices[0]. They are found by a climb from `start`, whose end is one
/// whose neighbours, and those of all that are as high within the band and the hull's slack, are lower by more than
/// that (framework/shape/hull_links.cpp has the proof). False where so many are as high that it gives up: a face with
/// many corners, or a hull so thin that nothing is proved.
inline bool climbToPeak(const Polytope<3>& hull, const Vec<3>& d, int start, Real band, HullPeak& peak) {
  const Real level = band + hull.slack * d.cwiseAbs().sum();  // the sum is no less than the length
  if (!(level < std::numeric_limits<Real>::infinity())) return false;
  const auto height = [&](int v) { return hull.vertices[v].dot(d); };
  auto& [top, count] = peak;
  top[0] = start, count = 1;
  Real most = height(start);
  std::size_t seen = 0;  // of so many all neighbours are known
  while (seen < count) {
    for (const Polytope<3>::Spoke& s : hull.spokesOf(top[seen++])) {
      const Real h = height(s.to);
      if (h > most) {
        most = h, top[0] = s.to, count = 1, seen = 0;
      } else if (seen > 0 && h >= most - level &&
                 std::find(top.begin(), top.begin() + count, s.to) == top.begin() + count) {
        if (count == top.size()) return false;
        top[count++] = s.to;
      }
    }
  }
  for (std::size_t k = 1; k < count; ++k) {
    if (top[k] < top[0] && height(top[k]) == most) std::swap(top[0], top[k]);
  }
  return true;
}

/// The farthest vertex along d, the one that a look at all finds; -1: it is not known.
inline int climbToFarthest(const Polytope<3>& hull, const Vec<3>& d, int start) {
  HullPeak peak;
  return climbToPeak(hull, d, start, 0, peak) ? peak.vertices[0] : -1;
}

}}}  // namespace lpc::LPC_PRECISION::pair_query
