// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>

#include "oracles/referee/expansion.h"
#include "oracles/referee/simplex3.h"

namespace lpc { inline namespace LPC_PRECISION {

template <class N>
void addFacet(InnerPolytope<N, 3>& p, int i, int j, int k) {
  InnerFacet<N, 3> f;
  f.v = {i, j, k};
  f.normal = crossProduct(minus(p.at(j), p.at(i)), minus(p.at(k), p.at(i)));
  f.measure(p.at(i));
  p.facets.push_back(f);
}

template <class N>
void startPolytope(const Simplex<N, 3>& s, InnerPolytope<N, 3>& p) {
  p.vertices.assign(s.v.begin(), s.v.end());
  p.facets.clear();
  const Point<N, 3> n = crossProduct(minus(s.at(1), s.at(0)), minus(s.at(2), s.at(0)));
  if (sign(dot(n, minus(s.at(3), s.at(0)))) > 0) std::swap(p.vertices[0], p.vertices[1]);
  addFacet(p, 0, 1, 2);
  addFacet(p, 0, 3, 1);
  addFacet(p, 1, 3, 2);
  addFacet(p, 2, 3, 0);
}

/// Replaces every facet that is strictly visible from the new vertex by the cone over their horizon. A facet stays when
/// its plane contains the vertex, so no new facet is flat. Otherwise the vertex would be on the line of a horizon edge,
/// and so in the plane of the visible facet behind that edge. Returns false when rounding has torn the surface.
template <class N>
bool grow(InnerPolytope<N, 3>& p, const typename Difference<N, 3>::Vertex& w, int) {
  std::vector<std::pair<int, int>> edges;
  for (InnerFacet<N, 3>& f : p.facets) {
    if (!f.alive || !(dot(f.normal, w.m) > f.offset)) continue;
    f.alive = false;
    for (std::size_t i = 0; i < 3; ++i) edges.emplace_back(f.v[i], f.v[(i + 1) % 3]);
  }
  const int k = static_cast<int>(p.vertices.size());
  p.vertices.push_back(w);
  for (const auto& [i, j] : edges) {
    if (std::find(edges.begin(), edges.end(), std::pair(j, i)) != edges.end()) continue;
    addFacet(p, i, j, k);
    if (isZero(p.facets.back().normal)) return false;
  }
  return true;
}

}}  // namespace lpc::LPC_PRECISION
