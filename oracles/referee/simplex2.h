// SPDX-License-Identifier: Zlib
#pragma once

#include "oracles/referee/minkowski.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Nearest face among those that contain the newest vertex. Decided by signs of polynomials only (Johnson's conditions:
/// all barycentric coordinates are positive, and no other vertex is nearer along the face's direction).
template <class N>
NearestFace<N, 2> nearestFace(const Simplex<N, 2>& s) {
  NearestFace<N, 2> face;
  const int last = s.count - 1;
  // True when no vertex outside `mask` is nearer along d than those in it.
  const auto supports = [&](const Point<N, 2>& d, unsigned mask) {
    const N level = dot(d, s.at(last));
    for (int i = 0; i < last; ++i) {
      if (!(mask >> i & 1) && dot(d, s.at(i)) < level) return false;
    }
    return true;
  };
  if (isZero(s.at(last)) || supports(s.at(last), 0)) {
    face.mask = 1u << last, face.direction = s.at(last), face.origin = isZero(s.at(last));
    return face;
  }
  for (int i = 0; i < last; ++i) {
    const Point<N, 2> e = minus(s.at(last), s.at(i));
    if (!(sign(dot(e, s.at(i))) < 0 && sign(dot(e, s.at(last))) > 0)) continue;
    Point<N, 2> n = outward(e);
    const int side = sign(dot(n, s.at(i)));
    if (side < 0) n = negative(n);
    const unsigned mask = 1u << i | 1u << last;
    if (side == 0 || supports(n, mask)) {
      face.mask = mask, face.direction = n, face.origin = side == 0;
      return face;
    }
  }
  if (s.count == 3) {
    const int turn = sign(crossProduct(minus(s.at(1), s.at(0)), minus(s.at(2), s.at(0))));
    bool inside = turn != 0;
    for (int i = 0; i < 3; ++i) inside = inside && sign(crossProduct(s.at(i), s.at((i + 1) % 3))) * turn > 0;
    if (inside) face.mask = 7, face.origin = true;
  }
  return face;
}

}}  // namespace lpc::LPC_PRECISION
