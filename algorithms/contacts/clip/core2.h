// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/patch/point_box.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

/// A convex polygon in frame 1, counter-clockwise. A capsule's core is a box of zero height: its two end "edges" have
/// no length, but their normals are needed to find cores on one line apart.
struct Core2 {
  const Vec<2>* v;  // read as Xy
  const Vec<2>* n;  // unit, outward, of the edge from vertex i to i + 1
  int count;
};

struct Edge2 {
  Xy a, b;
  int ia, ib;
};

inline Edge2 edgeOf(const Core2& c, int i) {
  const int j = i + 1 < c.count ? i + 1 : 0;
  return {c.v[i], c.v[j], i, j};
}

/// Memory for one polygon, reused from pair to pair.
struct Storage2 {
  std::vector<Vec<2>> v = std::vector<Vec<2>>(4), n = std::vector<Vec<2>>(4);
};

/// X_12 brings shape 2 into frame 1; it is null for shape 1, and a hull is then not copied. Not for planes and curved
/// cores.
inline Core2 makeCore2(const ShapeView<2>& s, const Pose<2>* X_12, Storage2& storage) {
  switch (s.core()) {
    case CoreClass::hull: {
      const auto& hull = *s.hull;
      const int count = static_cast<int>(hull.vertices.size());
      if (!X_12) return {hull.vertices.data(), hull.normals.data(), count};
      storage.v.resize(std::max<std::size_t>(hull.vertices.size(), storage.v.size()));
      storage.n.resize(storage.v.size());
      for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
        placed(*X_12, hull.vertices[i]).to(storage.v[i]);
        turned(X_12->q, hull.normals[i]).to(storage.n[i]);
      }
      return {storage.v.data(), storage.n.data(), count};
    }
    case CoreClass::curved:
    case CoreClass::plane:
      LPC_ASSERT(false);  // has no list of edges
      return {};
    case CoreClass::point:
    case CoreClass::segment:
    case CoreClass::box:
      break;
  }
  const Pose<2> X = X_12 ? *X_12 : Pose<2>{};
  storage.v.resize(std::max<std::size_t>(storage.v.size(), 4));
  const Xy half = coreHalf(s), p = X.p;
  const Xy x = turned(X.q, {1, 0}), y = x.left();
  const Xy hx = half.x() * x, hy = half.y() * y;
  (p - hx - hy).to(storage.v[0]), (p + hx - hy).to(storage.v[1]);
  (p + hx + hy).to(storage.v[2]), (p - hx + hy).to(storage.v[3]);
  (-y).to(storage.n[0]), x.to(storage.n[1]), y.to(storage.n[2]), (-x).to(storage.n[3]);
  return {storage.v.data(), storage.n.data(), 4};
}

/// Like `makeCore2`, for a shape that faces the other one along d (frame 1, any length): of a curved core its support
/// face there, one edge, or one vertex, which has no edge to clip.
inline Core2 makeFacing2(const ShapeView<2>& s, const Pose<2>* X_12, const Vec<2>& d, Storage2& storage,
                         WorkDone& work) {
  if (s.core() != CoreClass::curved) return makeCore2(s, X_12, storage);
  const Pose<2> X = X_12 ? *X_12 : Pose<2>{};
  ++work[WorkCount::supportCalls];
  s.curved->supportFace(X.q.inverse() * d, storage.v);
  if (storage.n.size() < storage.v.size()) storage.n.resize(storage.v.size());
  for (std::size_t i = 0; i < storage.v.size(); ++i) storage.v[i] = X * storage.v[i], storage.n[i] = d.normalized();
  return {storage.v.data(), storage.n.data(), static_cast<int>(storage.v.size())};
}

/// The edge of `c` with the normal most along `d`.
inline int edgeAlong(const Core2& c, const Xy& d) {
  int best = 0;
  Real most = dot(c.n[0], d);
  for (int i = 1; i < c.count; ++i) {
    const Real along = dot(c.n[i], d);
    if (along > most) best = i, most = along;
  }
  return best;
}

}}}  // namespace lpc::LPC_PRECISION::contacts
