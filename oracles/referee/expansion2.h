// SPDX-License-Identifier: Zlib
#pragma once

#include "oracles/referee/expansion.h"
#include "oracles/referee/simplex2.h"

namespace lpc { inline namespace LPC_PRECISION {

template <class N>
void addEdge(InnerPolytope<N, 2>& p, int i, int j) {
  InnerFacet<N, 2> f;
  f.v = {i, j};
  f.normal = outward(minus(p.at(j), p.at(i)));
  f.measure(p.at(i));
  p.facets.push_back(f);
}

template <class N>
void startPolytope(const Simplex<N, 2>& s, InnerPolytope<N, 2>& p) {
  p.vertices.assign(s.v.begin(), s.v.end());
  p.facets.clear();
  if (sign(crossProduct(minus(s.at(1), s.at(0)), minus(s.at(2), s.at(0)))) < 0) std::swap(p.vertices[0], p.vertices[1]);
  for (int i = 0; i < 3; ++i) addEdge(p, i, (i + 1) % 3);
}

/// `seen` is the only edge visible from the new vertex: all vertices are on M's boundary.
template <class N>
bool grow(InnerPolytope<N, 2>& p, const typename Difference<N, 2>::Vertex& w, int seen) {
  const int k = static_cast<int>(p.vertices.size());
  p.vertices.push_back(w);
  p.facets[static_cast<std::size_t>(seen)].alive = false;
  const auto v = p.facets[static_cast<std::size_t>(seen)].v;
  addEdge(p, v[0], k);
  addEdge(p, k, v[1]);
  return true;
}

}}  // namespace lpc::LPC_PRECISION
