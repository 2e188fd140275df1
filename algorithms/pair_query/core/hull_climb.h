// SPDX-License-Identifier: Zlib
// Hill climbing along the edges of a hull to its support vertex: from a near start it visits a few vertices, whatever
// their number.
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

/// Finds all vertices within `band` (m times the length of d) of the support vertex along d, of any length, and perhaps
/// others; vertices[0] is the highest, of several the first. A climb from `start` ends at a vertex whose neighbours,
/// and the neighbours of all vertices as high within the band and the hull's slack, are lower by more than that
/// (framework/shape/hull_links.cpp has the proof). Returns false if too many vertices are as high: a face with many
/// corners, or a hull too thin for the proof.
inline bool climbToPeak(const Polytope<3>& hull, const Vec<3>& d, int start, Real band, HullPeak& peak) {
  const Real level = band + hull.slack * d.cwiseAbs().sum();  // the sum is no less than the length
  if (!(level < std::numeric_limits<Real>::infinity())) return false;
  const auto height = [&](int v) { return hull.vertices[v].dot(d); };
  auto& [top, count] = peak;
  top[0] = start, count = 1;
  Real most = height(start);
  std::size_t seen = 0;  // number of vertices with all neighbours known
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

/// The support vertex along d, the same as by brute force; -1 if it is not known.
inline int climbToFarthest(const Polytope<3>& hull, const Vec<3>& d, int start) {
  HullPeak peak;
  return climbToPeak(hull, d, start, 0, peak) ? peak.vertices[0] : -1;
}

}}}  // namespace lpc::LPC_PRECISION::pair_query
