// SPDX-License-Identifier: Zlib
#pragma once

#include "oracles/referee/minkowski.h"

namespace lpc { inline namespace LPC_PRECISION {

/// As in simplex2.h.
template <class N>
NearestFace<N, 3> nearestFace(const Simplex<N, 3>& s) {
  NearestFace<N, 3> face;
  const int last = s.count - 1;
  const Point<N, 3>& z = s.at(last);
  // True when no vertex outside `mask` is nearer along d than those in it.
  const auto supports = [&](const Point<N, 3>& d, unsigned mask) {
    const N level = dot(d, z);
    for (int i = 0; i < last; ++i) {
      if (!(mask >> i & 1) && dot(d, s.at(i)) < level) return false;
    }
    return true;
  };
  const auto found = [&](unsigned mask, const Point<N, 3>& direction, bool origin) {
    face.mask = mask, face.direction = direction, face.origin = origin;
    return face;
  };
  if (isZero(z) || supports(z, 0)) return found(1u << last, z, isZero(z));
  for (int i = 0; i < last; ++i) {
    const Point<N, 3> e = minus(z, s.at(i));
    const N along = dot(e, z);
    if (!(sign(dot(e, s.at(i))) < 0 && sign(along) > 0)) continue;
    // The nearest point of the line, times e . e.
    const N square = dot(e, e);
    Point<N, 3> v;
    for (std::size_t k = 0; k < 3; ++k) v[k] = z[k] * square - e[k] * along;
    const unsigned mask = 1u << i | 1u << last;
    const bool origin = isZero(v);
    if (origin || supports(v, mask)) return found(mask, v, origin);
  }
  for (int i = 0; i < last; ++i) {
    for (int j = i + 1; j < last; ++j) {
      Point<N, 3> n = crossProduct(minus(s.at(i), z), minus(s.at(j), z));
      if (!(sign(dot(n, crossProduct(s.at(i), s.at(j)))) > 0 && sign(dot(n, crossProduct(s.at(j), z))) > 0 &&
            sign(dot(n, crossProduct(z, s.at(i)))) > 0)) {
        continue;
      }
      const int side = sign(dot(n, z));
      if (side < 0) n = negative(n);
      const unsigned mask = 1u << i | 1u << j | 1u << last;
      if (side == 0 || supports(n, mask)) return found(mask, n, side == 0);
    }
  }
  if (s.count == 4) {
    // The origin is inside when it is on the same side of all four faces as their opposite vertices.
    bool inside = true;
    for (int i = 0; i < 4; ++i) {
      const Point<N, 3>&p = s.at((i + 1) % 4), &q = s.at((i + 2) % 4), &r = s.at((i + 3) % 4);
      const Point<N, 3> n = crossProduct(minus(q, p), minus(r, p));
      const int own = sign(dot(n, minus(s.at(i), p)));
      inside = inside && own != 0 && -sign(dot(n, p)) * own > 0;
    }
    if (inside) face.mask = 15, face.origin = true;
  }
  return face;
}

}}  // namespace lpc::LPC_PRECISION
