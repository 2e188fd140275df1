// SPDX-License-Identifier: Zlib
// Two features of 3D cores that may face each other: their common normal, and the vector between them.
#pragma once

#include <cstdint>
#include <string>

#include "algorithms/pair_query/sat/sat_core3.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// Numbers of a vertex, edge or face of A and of B. A face faces a vertex.
struct SatFeatures {
  enum class Kind : std::int32_t { none, vertices, vertexEdge, edgeVertex, edges, faceOfA, faceOfB };
  Kind kind = Kind::none;
  std::int32_t a = 0, b = 0;
};

/// In words, for traces.
inline std::string words(const SatFeatures& f) {
  using enum SatFeatures::Kind;
  const auto two = [&](const char* a, const char* b) {
    return a + std::to_string(f.a) + " of A, " + b + std::to_string(f.b) + " of B";
  };
  switch (f.kind) {
    case none:
      break;
    case vertices:
      return two("vertex ", "vertex ");
    case vertexEdge:
      return two("vertex ", "edge ");
    case edgeVertex:
      return two("edge ", "vertex ");
    case edges:
      return two("edge ", "edge ");
    case faceOfA:
      return two("face ", "vertex ");
    case faceOfB:
      return two("vertex ", "face ");
  }
  return "foremost vertices";
}

/// A candidate edge.
struct SatRidge {
  int number;
  Vec<3> v0, v1;
  Vec<3> direction;  // unit, v0 to v1
  Vec<3> n0 = Vec<3>::Zero(), n1 = Vec<3>::Zero();
  bool bare = false;  // has no faces

  SatRidge(const SatCore& core, int i) : number(i) {
    const SatCore::Edge& e = core.edges()[i];
    v0 = core.vertex(e.v0), v1 = core.vertex(e.v1);
    direction = v1 - v0;
    makeUnit<3>(direction);
    bare = e.faceA < 0;
  }
};

/// Vector from q to the edge's nearest point; orthogonal to the edge to the last bit if the point is inside.
inline Vec<3> toEdge(const SatRidge& e, const Vec<3>& q) {
  const Vec<3> from0 = e.v0 - q, from1 = e.v1 - q;
  if (from0.dot(e.direction) >= 0) return from0;
  if (from1.dot(e.direction) <= 0) return from1;
  Vec<3> v = from0.squaredNorm() < from1.squaredNorm() ? from0 : from1;
  removeAlong<3>(v, e.direction);
  return v;
}

/// From a to b; for edges that are parallel within rounding, some vector.
inline Vec<3> betweenEdges(const SatRidge& a, const SatRidge& b) {
  const Vec<3> w = b.v0 - a.v0;
  const Real cosine = a.direction.dot(b.direction), sine2 = a.direction.cross(b.direction).squaredNorm();
  const Real alongA = w.dot(a.direction), alongB = w.dot(b.direction);
  const Real t = sine2 > 0 ? (alongA - cosine * alongB) / sine2 : Real(0);
  const Vec<3> onA = a.v0 + std::clamp(t, Real(0), (a.v1 - a.v0).norm()) * a.direction;
  const Vec<3> toB = toEdge(b, onA);
  return -toEdge(a, onA + toB);
}

/// From q to the face's plane along its normal if q is above the face, else to its rim.
inline Vec<3> toFace(const SatCore& core, int number, const Vec<3>& q) {
  const SatCore::Face& f = core.faces()[number];
  const SatCore::Plane plane = core.plane(f);
  const std::span<const int> loop = core.loop(f);
  bool above = loop.size() > 2;  // the side of a triangle is a line: nothing is above it
  Vec<3> u = core.vertex(loop.back()), nearest = u - q;
  for (const int next : loop) {
    const Vec<3> v = core.vertex(next);
    if (loop.size() == 2 || !((v - u).cross(q - u).dot(plane.n) >= 0)) {
      above = false;
      const Vec<3> e = v - u, from = u - q;
      const Real length2 = e.squaredNorm();
      const Real t = length2 > 0 ? std::clamp(-from.dot(e) / length2, Real(0), Real(1)) : Real(0);
      const Vec<3> toRim = from + t * e;
      if (toRim.squaredNorm() < nearest.squaredNorm()) nearest = toRim;
    }
    u = v;
  }
  return above ? Vec<3>(-(plane.n.dot(q) - plane.offset) * plane.n) : nearest;
}

/// Whether such features exist.
inline bool exist(const SatFeatures& f, const SatCore& a, const SatCore& b) {
  using enum SatFeatures::Kind;
  const auto vertex = [](int i, const SatCore& core) { return i >= 0 && i < core.vertexCount(); };
  const auto edge = [](int i, const SatCore& core) { return i >= 0 && i < static_cast<int>(core.edges().size()); };
  const auto face = [](int i, const SatCore& core) { return i >= 0 && i < static_cast<int>(core.faces().size()); };
  switch (f.kind) {
    case none:
      return false;
    case vertices:
      return vertex(f.a, a) && vertex(f.b, b);
    case vertexEdge:
      return vertex(f.a, a) && edge(f.b, b);
    case edgeVertex:
      return edge(f.a, a) && vertex(f.b, b);
    case edges:
      return edge(f.a, a) && edge(f.b, b);
    case faceOfA:
      return face(f.a, a) && vertex(f.b, b);
    case faceOfB:
      return vertex(f.a, a) && face(f.b, b);
  }
  return false;  // a number from a file
}

/// From A's feature to B's: the shortest vector, or some vector. It is attained by two points of the features, so the
/// cores are no farther apart.
inline Vec<3> wayBetween(const SatFeatures& f, const SatCore& a, const SatCore& b) {
  using enum SatFeatures::Kind;
  switch (f.kind) {
    case none:
      break;
    case vertices:
      return b.vertex(f.b) - a.vertex(f.a);
    case vertexEdge:
      return toEdge(SatRidge(b, f.b), a.vertex(f.a));
    case edgeVertex:
      return -toEdge(SatRidge(a, f.a), b.vertex(f.b));
    case edges:
      return betweenEdges(SatRidge(a, f.a), SatRidge(b, f.b));
    case faceOfA:
      return -toFace(a, f.a, b.vertex(f.b));
    case faceOfB:
      return toFace(b, f.b, a.vertex(f.a));
  }
  return b.vertex(0) - a.vertex(0);
}

/// Their common unit normal from A to B; for two edges of either sign. False if they have none.
inline bool commonNormal(const SatFeatures& f, const SatCore& a, const SatCore& b, const Vec<3>& way, Vec<3>& n) {
  using enum SatFeatures::Kind;
  switch (f.kind) {
    case none:
      return false;
    case faceOfA:
      n = a.plane(a.faces()[f.a]).n;
      return true;
    case faceOfB:
      n = -b.plane(b.faces()[f.b]).n;
      return true;
    case edges: {
      const SatRidge ofA(a, f.a);
      n = ofA.direction.cross(SatRidge(b, f.b).direction);
      if (!makeUnit<3>(n)) return false;
      removeAlong<3>(n, ofA.direction);
      return makeUnit<3>(n);
    }
    case vertices:
    case vertexEdge:
    case edgeVertex:
      n = way;
      return makeUnit<3>(n);
  }
  return false;
}

}}}  // namespace lpc::LPC_PRECISION::pair_query
