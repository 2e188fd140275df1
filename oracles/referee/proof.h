// SPDX-License-Identifier: Zlib
// Shared by the two provers: certificate.cpp for cores with vertices, curved_referee.cpp for cores without. Both search
// in long double, where they may err, and prove the result with running error bounds.
#pragma once

#include <algorithm>
#include <cmath>

#include "oracles/referee/bounded.h"
#include "oracles/referee/expansion2.h"
#include "oracles/referee/expansion3.h"

namespace lpc { inline namespace LPC_PRECISION {

using Real80 = long double;

template <std::size_t D>
Bounded boundedDot(const std::array<Bounded, D>& a, const std::array<Bounded, D>& b) {
  Bounded sum = a[0] * b[0];
  for (std::size_t k = 1; k < D; ++k) sum = sum + a[k] * b[k];
  return sum;
}

/// Numbers without error.
template <int D>
Point<Bounded, D> exactly(const Point<Real80, D>& d) {
  Point<Bounded, D> out;
  for (std::size_t k = 0; k < D; ++k) out[k].v = d[k];
  return out;
}

/// Barycentric coordinates, up to a common positive factor, of the simplex's point nearest to the origin, by Cramer's
/// rule on its Gram matrix. Only their signs matter for the proof; wrong sizes give a weaker proof.
template <int D>
std::array<Real80, 4> weights(const Simplex<Real80, D>& s) {
  std::array<Real80, 4> w{1, 0, 0, 0};
  if (s.count == 2) {
    const auto e = minus(s.at(1), s.at(0));
    w = {dot(e, s.at(1)), -dot(e, s.at(0)), 0, 0};
  } else if (s.count == 3) {
    const auto e = minus(s.at(1), s.at(0)), f = minus(s.at(2), s.at(0));
    const Real80 ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), eo = -dot(e, s.at(0)), fo = -dot(f, s.at(0));
    w[1] = eo * ff - fo * ef, w[2] = fo * ee - eo * ef, w[0] = ee * ff - ef * ef - w[1] - w[2];
  }
  for (Real80& x : w) x = std::max(x, Real80(0));
  return w;
}

inline Point<Bounded, 2> facetNormal(const std::array<Point<Bounded, 2>, 2>& v) { return outward(minus(v[1], v[0])); }
inline Point<Bounded, 3> facetNormal(const std::array<Point<Bounded, 3>, 3>& v) {
  return crossProduct(minus(v[1], v[0]), minus(v[2], v[0]));
}

/// True when the surface is closed: each end of a facet meets exactly one other in the opposite direction.
inline bool isClosed(const InnerPolytope<Real80, 2>& p) {
  std::vector<int> begins, ends;
  for (const auto& f : p.facets) {
    if (f.alive) begins.push_back(f.v[0]), ends.push_back(f.v[1]);
  }
  std::sort(begins.begin(), begins.end());
  std::sort(ends.begin(), ends.end());
  return begins == ends && std::adjacent_find(begins.begin(), begins.end()) == begins.end();
}
inline bool isClosed(const InnerPolytope<Real80, 3>& p) {
  std::vector<std::pair<int, int>> edges, reversed;
  for (const auto& f : p.facets) {
    if (!f.alive) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      edges.emplace_back(f.v[i], f.v[(i + 1) % 3]);
      reversed.emplace_back(f.v[(i + 1) % 3], f.v[i]);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::sort(reversed.begin(), reversed.end());
  return edges == reversed && std::adjacent_find(edges.begin(), edges.end()) == edges.end();
}

}}  // namespace lpc::LPC_PRECISION
