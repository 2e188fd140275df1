// SPDX-License-Identifier: Zlib
#pragma once

#include "oracles/referee/minkowski.h"

namespace lpc { inline namespace LPC_PRECISION {

/// How a search in M ended. `direction` . `on` / |direction| is the distance of the origin from the plane (line)
/// through `on`. The caller chooses the signs of phi and of the normal.
template <class N, int D>
struct SearchEnd {
  enum Kind { separated, inside, touching, gaveUp };
  Kind kind = gaveUp;
  Point<N, D> direction;  // separated: towards M; touching and inside: outward normal of M
  Point<N, D> on;         // a point of M on that plane
};

/// A direction perpendicular to the linear span of a simplex that contains the origin and has too few vertices.
template <class N>
Point<N, 2> transversal(const Simplex<N, 2>& s) {
  if (s.count < 2) return {N(1.0), N(0.0)};
  return outward(minus(s.at(1), s.at(0)));
}
template <class N>
Point<N, 3> transversal(const Simplex<N, 3>& s) {
  if (s.count < 2) return {N(1.0), N(0.0), N(0.0)};
  if (s.count == 3) return crossProduct(minus(s.at(1), s.at(0)), minus(s.at(2), s.at(0)));
  const Point<N, 3> e = minus(s.at(1), s.at(0));
  const Point<N, 3> n = {N(0.0), e[2], N(-e[1])};
  return isZero(n) ? Point<N, 3>{N(0.0), N(1.0), N(0.0)} : n;
}

/// GJK (Gilbert, Johnson, Keerthi): finds the point of M nearest to the origin. Ends with `separated`, or with `inside`
/// and a simplex that contains the origin. With exact numbers each new vertex is strictly nearer, hence independent of
/// the face; since M has finitely many faces, the search ends.
template <class N, int D>
SearchEnd<N, D> walkToOrigin(const Difference<N, D>& m, Simplex<N, D>& s, int maxIterations) {
  SearchEnd<N, D> end;
  s.count = 0;
  // Start at a boundary point of M, where all later vertices are too: grow() in 2D relies on it.
  const Point<N, D> first = minus(m.a[0], m.b[0]);
  s.add(m.support(isZero(first) ? transversal(s) : first));
  for (int i = 0; i < maxIterations; ++i) {
    const NearestFace<N, D> face = nearestFace(s);
    if (face.mask == 0) return end;
    s.keep(face.mask);
    if (face.origin) {
      end.kind = end.inside;
      return end;
    }
    const auto w = m.support(negative(face.direction));
    if (!(dot(face.direction, w.m) < dot(face.direction, s.at(0)))) {
      end.kind = end.separated, end.direction = face.direction, end.on = s.at(0);
      return end;
    }
    for (int k = 0; k < s.count; ++k) {
      if (s.v[static_cast<std::size_t>(k)].same(w)) {  // rounding: with exact numbers no vertex comes twice
        end.kind = end.separated, end.direction = face.direction, end.on = s.at(0);
        return end;
      }
    }
    s.add(w);
  }
  return end;
}

/// Completes a simplex that contains the origin to D + 1 vertices. When M does not extend beyond the origin in some
/// direction, the origin is on M's boundary: `touching`, which includes every M without volume.
template <class N, int D>
SearchEnd<N, D> completeSimplex(const Difference<N, D>& m, Simplex<N, D>& s) {
  SearchEnd<N, D> end;
  while (s.count <= D) {
    const Point<N, D> d = transversal(s);
    const auto w = m.support(d);
    if (sign(dot(d, w.m)) <= 0) {
      end.kind = end.touching, end.direction = d, end.on = w.m;
      return end;
    }
    s.add(w);
  }
  end.kind = end.inside;
  return end;
}

/// A facet of an inner polytope of M that contains the origin, with its distance from the origin.
template <class N, int D>
struct InnerFacet {
  std::array<int, static_cast<std::size_t>(D)> v{};  // vertices, counter-clockwise from outside
  Point<N, D> normal;                                // outward, any length
  N offset, square;                                  // normal . v, normal . normal
  double key = 0;                                    // approximate square of the distance
  bool alive = true, settled = false;                // settled: known to be at least as far as the best facet of M

  void measure(const Point<N, D>& vertex) {
    offset = dot(normal, vertex), square = dot(normal, normal), key = squareRatio(offset, square);
  }
};

template <class N, int D>
struct InnerPolytope {
  std::vector<typename Difference<N, D>::Vertex> vertices;
  std::vector<InnerFacet<N, D>> facets;

  const Point<N, D>& at(int i) const { return vertices[static_cast<std::size_t>(i)].m; }
};

/// EPA (van den Bergen): takes the facet nearest to the origin until it is a facet of M. Keys only order the work;
/// decisions compare numbers of type N.
template <class N, int D>
SearchEnd<N, D> expand(const Difference<N, D>& m, const Simplex<N, D>& s, InnerPolytope<N, D>& p, int maxFacets) {
  constexpr double kBand = 1 + 1e-9;  // keys this close may be in the wrong order
  SearchEnd<N, D> end;
  startPolytope(s, p);
  int best = -1;
  while (static_cast<int>(p.facets.size()) < maxFacets) {
    int next = -1;
    for (std::size_t i = 0; i < p.facets.size(); ++i) {
      const InnerFacet<N, D>& f = p.facets[i];
      if (!f.alive || f.settled) continue;
      if (next < 0 || f.key < p.facets[static_cast<std::size_t>(next)].key) next = static_cast<int>(i);
    }
    if (best >= 0 && (next < 0 || !(p.facets[static_cast<std::size_t>(next)].key <=
                                    p.facets[static_cast<std::size_t>(best)].key * kBand))) {
      const InnerFacet<N, D>& f = p.facets[static_cast<std::size_t>(best)];
      end.kind = end.inside, end.direction = f.normal, end.on = p.at(f.v[0]);
      return end;
    }
    if (next < 0) return end;
    InnerFacet<N, D>& f = p.facets[static_cast<std::size_t>(next)];
    f.settled = true;
    if (best >= 0) {
      const InnerFacet<N, D>& b = p.facets[static_cast<std::size_t>(best)];
      if (!(f.offset * f.offset * b.square < b.offset * b.offset * f.square)) continue;
    }
    const auto w = m.support(f.normal);
    if (dot(f.normal, w.m) > f.offset) {
      if (!grow(p, w, next)) return end;
      if (best >= 0 && !p.facets[static_cast<std::size_t>(best)].alive) best = -1;  // only by rounding
    } else {
      best = next;
    }
  }
  return end;
}

}}  // namespace lpc::LPC_PRECISION
