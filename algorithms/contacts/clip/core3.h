// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/patch/point_box.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

/// A core in frame 1: a polytope, a segment (two vertices, one edge, no faces), or a point.
struct Core3 {
  const Vec<3>* v = nullptr;
  const Vec<3>* n = nullptr;              // of the faces, unit, outward
  const Polytope<3>* topology = nullptr;  // faces, loops and edges; null for a point. Its coordinates are not used.
  int vertexCount = 0;

  int faceCount() const { return topology ? static_cast<int>(topology->faces.size()) : 0; }
  int edgeCount() const { return topology ? static_cast<int>(topology->edges.size()) : 0; }
  const Polytope<3>::Face& face(int f) const { return topology->faces[f]; }
  const Polytope<3>::Edge& edge(int e) const { return topology->edges[e]; }
  int loop(int i) const { return topology->loop[i]; }
  const Vec<3>& faceVertex(int f, int k) const { return v[loop(face(f).begin + k)]; }
  int faceSize(int f) const { return face(f).end - face(f).begin; }
  /// False for a side of a flat triangle: it cannot clip, it is an edge.
  bool hasArea(int f) const { return faceSize(f) > 2; }
};

/// Bits of a box's vertex number: 1 = +x, 2 = +y, 4 = +z. Faces: -x, +x, -y, +y, -z, +z.
inline const Polytope<3>& boxTopology() {
  static const Polytope<3> box = [] {
    Polytope<3> t;
    t.vertices.resize(8, Vec<3>::Zero());
    t.loop = {0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6};
    for (int f = 0; f < 6; ++f) {
      Vec<3> n = Vec<3>::Zero();
      n[f / 2] = f % 2 ? Real(1) : Real(-1);
      t.faces.push_back({n, 0, 4 * f, 4 * f + 4});
    }
    // The two faces of an edge: one has v0 -> v1 in its loop, the other v1 -> v0.
    const auto faceWith = [&](int v0, int v1) {
      for (int i = 0; i < 24; ++i) {
        const int next = i % 4 == 3 ? i - 3 : i + 1;
        if (t.loop[i] == v0 && t.loop[next] == v1) return i / 4;
      }
      return -1;
    };
    for (int bit : {1, 2, 4}) {
      for (int v = 0; v < 8; ++v) {
        if (!(v & bit)) t.edges.push_back({v, v | bit, faceWith(v, v | bit), faceWith(v | bit, v)});
      }
    }
    return t;
  }();
  return box;
}

inline const Polytope<3>& segmentTopology() {
  static const Polytope<3> segment = [] {
    Polytope<3> t;
    t.vertices.resize(2, Vec<3>::Zero());
    t.edges.push_back({0, 1, -1, -1});
    return t;
  }();
  return segment;
}

struct Storage3 {
  std::vector<Vec<3>> v = std::vector<Vec<3>>(8), n = std::vector<Vec<3>>(6);
};

/// Written number by number (triple.h): most cores are boxes, and making them took as long as finding their axes.
inline Core3 makeBox3(const Vec<3>& half, const Pose<3>* X_12, Storage3& storage) {
  if (storage.v.size() < 8) storage.v.resize(8);
  Vec<3>* v = storage.v.data();
  Vec<3>* n = storage.n.data();
  if (X_12) {
    const Mat<3> R = X_12->q.matrix();
    const Triple p(X_12->p), e[3] = {Triple(R(0, 0), R(1, 0), R(2, 0)), Triple(R(0, 1), R(1, 1), R(2, 1)),
                                     Triple(R(0, 2), R(1, 2), R(2, 2))};
    const Triple x = half[0] * e[0], y = half[1] * e[1], z = half[2] * e[2];
    const Triple beside[4] = {p - y - z, p + y - z, p - y + z, p + y + z};
    for (int k = 0; k < 4; ++k) (beside[k] - x).store(v[2 * k]), (beside[k] + x).store(v[2 * k + 1]);
    for (int k = 0; k < 3; ++k) (-e[k]).store(n[2 * k]), e[k].store(n[2 * k + 1]);
  } else {
    const Real x = half[0], y = half[1], z = half[2], zero = 0;  // 0 - 0 is no -0
    Triple(zero - x, zero - y, zero - z).store(v[0]), Triple(x, zero - y, zero - z).store(v[1]);
    Triple(zero - x, y, zero - z).store(v[2]), Triple(x, y, zero - z).store(v[3]);
    Triple(zero - x, zero - y, z).store(v[4]), Triple(x, zero - y, z).store(v[5]);
    Triple(zero - x, y, z).store(v[6]), Triple(x, y, z).store(v[7]);
    const Triple ex(1, 0, 0), ey(0, 1, 0), ez(0, 0, 1);
    (-ex).store(n[0]), ex.store(n[1]), (-ey).store(n[2]), ey.store(n[3]), (-ez).store(n[4]), ez.store(n[5]);
  }
  return {v, n, &boxTopology(), 8};
}

/// X_12 brings shape 2 into frame 1; it is null for shape 1, and a hull is then not copied. Not for planes and curved
/// cores.
inline Core3 makeCore3(const ShapeView<3>& s, const Pose<3>* X_12, Storage3& storage) {
  if (s.core() == CoreClass::box) return makeBox3(s.half, X_12, storage);
  const Mat<3> R = X_12 ? X_12->q.matrix() : Mat<3>::Identity();
  const Vec<3> p = X_12 ? X_12->p : Vec<3>::Zero();
  if (storage.v.size() < 8) storage.v.resize(8);
  Vec<3>* v = storage.v.data();
  Vec<3>* n = storage.n.data();
  switch (s.core()) {
    case CoreClass::point:
      v[0] = p;
      return {v, n, nullptr, 1};
    case CoreClass::segment: {
      const Vec<3> h = s.half[0] * R.col(0);
      v[0] = p - h, v[1] = p + h;
      return {v, n, &segmentTopology(), 2};
    }
    case CoreClass::hull: {
      const Polytope<3>& hull = *s.hull;
      const std::size_t vertices = hull.vertices.size(), faces = hull.faces.size();
      if (storage.n.size() < faces) storage.n.resize(faces);
      if (storage.v.size() < vertices) storage.v.resize(vertices);
      for (std::size_t i = 0; i < faces; ++i)
        storage.n[i] = X_12 ? Vec<3>(R * hull.faces[i].normal) : hull.faces[i].normal;
      if (!X_12) return {hull.vertices.data(), storage.n.data(), &hull, static_cast<int>(vertices)};
      for (std::size_t i = 0; i < vertices; ++i) storage.v[i] = R * hull.vertices[i] + p;
      return {storage.v.data(), storage.n.data(), &hull, static_cast<int>(vertices)};
    }
    case CoreClass::box:
    case CoreClass::curved:
    case CoreClass::plane:
      LPC_ASSERT(false);  // made above, or has no list of faces
      break;
  }
  return {};
}

/// One face with this number of corners, counter-clockwise seen from outside.
inline const Polytope<3>& polygonTopology(std::size_t corners) {
  constexpr std::size_t kMost = 64;
  static const IndexedVector<Polytope<3>> polygons = [] {
    IndexedVector<Polytope<3>> made(kMost + 1);
    for (int count = 3; count <= static_cast<int>(kMost); ++count) {
      Polytope<3>& t = made[count];
      t.faces.push_back({Vec<3>::Zero(), 0, 0, count});
      for (int i = 0; i < count; ++i) {
        t.loop.push_back(i);
        t.edges.push_back({i, (i + 1) % count, 0, -1});
      }
    }
    return made;
  }();
  LPC_ASSERT(corners >= 3 && corners <= kMost);
  return polygons[corners];
}

/// Like `makeCore3`, for a shape that faces the other one along d (frame 1, any length): of a curved core its support
/// face there, a polygon, an edge, or a point.
inline Core3 makeFacing3(const ShapeView<3>& s, const Pose<3>* X_12, const Vec<3>& d, Storage3& storage,
                         WorkDone& work) {
  if (s.core() != CoreClass::curved) return makeCore3(s, X_12, storage);
  const Pose<3> X = X_12 ? *X_12 : Pose<3>{};
  ++work[WorkCount::supportCalls];
  s.curved->supportFace(X.q.inverse() * d, storage.v);
  auto& v = storage.v;
  for (Vec<3>& corner : v) corner = X * corner;
  const int count = static_cast<int>(v.size());
  if (count < 3) return {v.data(), storage.n.data(), count == 2 ? &segmentTopology() : nullptr, count};
  storage.n[0] = (v[1] - v[0]).cross(v[2] - v[0]).normalized();
  return {v.data(), storage.n.data(), &polygonTopology(v.size()), count};
}

/// The face of `c` with the normal most along `d`; with a vertex, only among the faces around it.
inline int faceAlong(const Core3& c, const Vec<3>& d, int vertex = -1) {
  const Triple towards(d);
  int best = -1;
  Real bestDot = -std::numeric_limits<Real>::infinity();
  for (int f = 0; f < c.faceCount(); ++f) {
    const Real along = dot(Triple(c.n[f]), towards);
    if (!(along > bestDot)) continue;
    bool around = vertex < 0;
    for (int k = c.face(f).begin; !around && k < c.face(f).end; ++k) around = c.loop(k) == vertex;
    if (around) best = f, bestDot = along;
  }
  return best;
}

/// The support vertex of `c` along `d`.
inline int vertexAlong(const Core3& c, const Vec<3>& d) {
  const Triple towards(d);
  int best = 0;
  Real bestDot = dot(Triple(c.v[0]), towards);
  for (int i = 1; i < c.vertexCount; ++i) {
    const Real along = dot(Triple(c.v[i]), towards);
    if (along > bestDot) best = i, bestDot = along;
  }
  return best;
}

}}}  // namespace lpc::LPC_PRECISION::contacts
