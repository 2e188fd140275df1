// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/shape_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "framework/shape/support_map.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr Real kFullTurn = 2 * std::numbers::pi_v<Real>;
// rad: slightly beside a direction in which two corners of a core tie, by more than rounding.
constexpr Real kAside = std::max(Real(1e-6), 64 * std::numeric_limits<Real>::epsilon());

template <int D>
typename ShapeMesh<D>::Point point(const Vec<D>& p) {
  return p.template cast<float>();
}

// Evenly spaced directions around a ball, adapted to a stretched core: its flat sides would otherwise get few corners.
template <int D>
Vec<D> evenly(const ShapeView<D>& shape, const Vec<D>& d) {
  return shape.core() == CoreClass::curved ? Vec<D>(d.cwiseQuotient(shape.half).normalized()) : d;
}

// The k-th of `round` angles (rad) that divide a full turn.
Real shareOfTurn(int k, int round) { return kFullTurn * Real(k) / Real(round); }

std::uint32_t count(const auto& list) { return static_cast<std::uint32_t>(list.size()); }

// --- in the plane ----------------------------------------------------------------------------------------------------

// The corners of a core with straight sides, counter-clockwise.
void straightCore(const ShapeView<2>& shape, std::vector<Vec<2>>& out) {
  const Real x = shape.half[0], y = shape.half[1];
  out.clear();
  switch (shape.core()) {
    case CoreClass::segment:
      out = {{-x, 0}, {x, 0}};
      break;
    case CoreClass::box:
      out = {{-x, -y}, {x, -y}, {x, y}, {-x, y}};
      break;
    case CoreClass::hull:
      out = shape.hull->vertices;
      break;
    case CoreClass::point:
    case CoreClass::curved:
    case CoreClass::plane:
      break;
  }
}

void outline(const ShapeView<2>& shape, int round, ShapeMesh<2>& mesh) {
  thread_local std::vector<Vec<2>> core;
  straightCore(shape, core);
  if (core.empty()) {
    for (int i = 0; i < round; ++i) {
      const Vec<2> d = evenly<2>(shape, {std::cos(shareOfTurn(i, round)), std::sin(shareOfTurn(i, round))});
      mesh.corners.push_back(point<2>(coreSupport(shape, d) + shape.radius * d));
    }
    return;
  }
  for (std::size_t i = 0, n = core.size(); i < n; ++i) {
    if (!(shape.radius > 0)) {
      mesh.corners.push_back(point<2>(core[i]));
      continue;
    }
    // An arc from the normal of the incoming side to that of the outgoing side.
    const Vec<2> in = core[i] - core[(i + n - 1) % n], out = core[(i + 1) % n] - core[i];
    const Real begin = std::atan2(-in[0], in[1]);
    Real turn = std::atan2(-out[0], out[1]) - begin;
    if (turn < 0) turn += kFullTurn;
    const int steps = std::max(1, static_cast<int>(std::ceil(turn / kFullTurn * Real(round) - kAside)));
    for (int k = 0; k <= steps; ++k) {
      const Real angle = begin + turn * Real(k) / Real(steps);
      mesh.corners.push_back(point<2>(core[i] + shape.radius * Vec<2>(std::cos(angle), std::sin(angle))));
    }
  }
}

// --- in space --------------------------------------------------------------------------------------------------------

// Skips triangles lower than `least` (m).
void addTriangle(ShapeMesh<3>& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, float least = 0) {
  const auto &p = mesh.corners[a], &q = mesh.corners[b], &r = mesh.corners[c];
  const float longest = std::max({(q - p).norm(), (r - q).norm(), (p - r).norm()});
  if ((q - p).cross(r - p).norm() <= least * longest) return;
  mesh.triangles.insert(mesh.triangles.end(), {a, b, c});
}

void addFan(ShapeMesh<3>& mesh, std::uint32_t begin, std::uint32_t corners, float least = 0) {
  for (std::uint32_t k = 2; k < corners; ++k) addTriangle(mesh, begin, begin + k - 1, begin + k, least);
}

void addBox(const Vec<3>& half, ShapeMesh<3>& mesh) {
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const int side : {-1, 1}) {
      const auto begin = count(mesh.corners);
      for (const auto& [x, y] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
        Vec<3> p;
        p[axis] = Real(side) * half[axis], p[u] = Real(side * x) * half[u], p[v] = Real(y) * half[v];
        mesh.corners.push_back(point<3>(p));
        mesh.normals.push_back(float(side) * ShapeMesh<3>::Point::Unit(axis));
      }
      addFan(mesh, begin, 4);
      // four edges lie along each axis, so there are twelve
      for (const int other : {-1, 1}) {
        Vec<3> p;
        p[axis] = Real(side) * half[axis], p[u] = Real(other) * half[u], p[v] = -half[v];
        mesh.ends.push_back(point<3>(p));
        p[v] = half[v];
        mesh.ends.push_back(point<3>(p));
      }
    }
  }
}

void addFaces(const Polytope<3>& hull, Real radius, ShapeMesh<3>& mesh) {
  for (const auto& face : hull.faces) {
    const auto begin = count(mesh.corners), corners = static_cast<std::uint32_t>(face.end - face.begin);
    for (int i = face.begin; i < face.end; ++i) {
      const int vertex = hull.loop[static_cast<std::size_t>(i)];
      mesh.corners.push_back(point<3>(hull.vertices[static_cast<std::size_t>(vertex)] + radius * face.normal));
      mesh.normals.push_back(point<3>(face.normal));
    }
    addFan(mesh, begin, corners);
  }
}

void addEdge(ShapeMesh<3>& mesh, const Vec<3>& a, const Vec<3>& b) {
  mesh.ends.push_back(point<3>(a));
  mesh.ends.push_back(point<3>(b));
}

// The part of a cylinder along an edge between the normals of its faces, and a line on both sides.
void addRoundedEdge(const Polytope<3>& hull, const Polytope<3>::Edge& edge, Real radius, int round,
                    ShapeMesh<3>& mesh) {
  const Vec<3>&p = hull.vertices[static_cast<std::size_t>(edge.v0)],
        &q = hull.vertices[static_cast<std::size_t>(edge.v1)];
  const Vec<3>&nA = hull.faces[static_cast<std::size_t>(edge.faceA)].normal,
        &nB = hull.faces[static_cast<std::size_t>(edge.faceB)].normal;
  const Real turn = std::acos(std::clamp<Real>(nA.dot(nB), -1, 1));
  const int steps = std::max(1, static_cast<int>(std::ceil(turn / kFullTurn * Real(round))));
  const auto begin = count(mesh.corners);
  for (int k = 0; k <= steps; ++k) {
    const Real share = turn / Real(steps);
    const Vec<3> n = (std::sin(Real(steps - k) * share) * nA + std::sin(Real(k) * share) * nB).normalized();
    for (const Vec<3>* end : {&p, &q}) {
      mesh.corners.push_back(point<3>(*end + radius * n));
      mesh.normals.push_back(point<3>(n));
    }
  }
  for (std::uint32_t k = 0, at = begin; k < static_cast<std::uint32_t>(steps); ++k, at += 2) {
    // faceA is to the left of the edge from v0 to v1, seen from outside
    addTriangle(mesh, at, at + 2, at + 1);
    addTriangle(mesh, at + 1, at + 2, at + 3);
  }
  for (const Vec<3>* n : {&nA, &nB}) addEdge(mesh, p + radius * *n, q + radius * *n);
}

// `round` angles in a full turn, slightly beside those along an axis; where corners of the core tie, on both sides of
// the axis.
std::vector<Real> angles(int round, bool ties) {
  std::vector<Real> out;
  for (int k = 0; k < round; ++k) {
    const Real angle = shareOfTurn(k, round);
    if (ties && 4 * k % round == 0) out.push_back(angle - kAside);
    out.push_back(angle + kAside);
  }
  return out;
}

// Support points in a grid of directions, along meridians from x to -x. Where two corners of the core tie there is a
// row or a column for each, so that the side or face between them gets its triangles.
void addRoundSurface(const ShapeView<3>& shape, const Vec<3>& middle, int round, ShapeMesh<3>& mesh) {
  std::vector<Real> rows;
  for (int k = 0; 2 * k <= round; ++k) {
    const Real angle = shareOfTurn(k, round);
    if (4 * k != round) {
      rows.push_back(k == 0 ? kAside : 2 * k == round ? angle - kAside : angle);
    } else {
      rows.insert(rows.end(), {angle - kAside, angle + kAside});
    }
  }
  const std::vector<Real> columns = angles(round, shape.core() == CoreClass::box);
  const auto begin = count(mesh.corners), wide = count(columns), tall = count(rows);
  for (const Real row : rows) {
    for (const Real column : columns) {
      const Vec<3> d =
          evenly<3>(shape, {std::cos(row), std::sin(row) * std::cos(column), std::sin(row) * std::sin(column)});
      const Vec<3> core = shape.core() == CoreClass::hull ? middle : coreSupport(shape, d);
      mesh.corners.push_back(point<3>(core + shape.radius * d));
      mesh.normals.push_back(point<3>(d));
    }
  }
  // Without ties, the triangles between two such rows have no area.
  const float least = static_cast<float>(10 * kAside * (shape.radius + shape.half.norm()));
  for (std::uint32_t i = 0; i + 1 < tall; ++i) {
    for (std::uint32_t k = 0; k < wide; ++k) {
      const std::uint32_t a = begin + i * wide + k, b = begin + i * wide + (k + 1) % wide;
      addTriangle(mesh, a, a + wide, b + wide, least);
      addTriangle(mesh, a, b + wide, b, least);
    }
  }
  addFan(mesh, begin, wide, least);
  for (std::uint32_t k = 2, last = begin + (tall - 1) * wide; k < wide; ++k)
    addTriangle(mesh, last, last + k, last + k - 1, least);
}

// Support points in the directions of each coordinate plane, slightly to both sides of it.
void addRims(const ShapeView<3>& shape, int round, ShapeMesh<3>& mesh) {
  const Real least = 10 * kAside * (shape.radius + shape.half.norm());
  std::vector<Vec<3>> rim, other;
  const int first = shape.core() == CoreClass::point ? 1 : 0;  // two rims show the rotation of a ball
  for (int axis = first; axis < 3; ++axis) {
    for (const int side : {1, -1}) {
      std::swap(rim, other);
      rim.clear();
      for (const Real angle : angles(round, true)) {
        Vec<3> d;
        d[axis] = Real(side) * kAside, d[(axis + 1) % 3] = std::cos(angle), d[(axis + 2) % 3] = std::sin(angle);
        d = evenly(shape, d);
        rim.push_back(coreSupport(shape, d) + shape.radius * d);
      }
      const auto apart = [&](std::size_t k) { return (rim[k] - other[k]).norm() > Real(1e-3) * rim[k].norm(); };
      bool seen = side == 1;
      for (std::size_t k = 0; k < rim.size() && !seen; ++k) seen = apart(k);
      for (std::size_t k = 0; k < rim.size() && seen; ++k) {
        const Vec<3>& next = rim[(k + 1) % rim.size()];
        if ((next - rim[k]).norm() > least) addEdge(mesh, rim[k], next);
      }
    }
  }
}

}  // namespace

void meshOf(const ShapeView<2>& shape, int round, ShapeMesh<2>& mesh) {
  LPC_ASSERT(shape.core() != CoreClass::plane);
  mesh.corners.clear(), mesh.triangles.clear(), mesh.ends.clear();
  outline(shape, round, mesh);
  const auto n = count(mesh.corners);
  for (std::uint32_t k = 2; k < n; ++k) mesh.triangles.insert(mesh.triangles.end(), {0, k - 1, k});
  for (std::size_t k = 0; k < n && n > 1; ++k) {
    mesh.ends.insert(mesh.ends.end(), {mesh.corners[k], mesh.corners[(k + 1) % n]});
  }
  if (shape.core() != CoreClass::point) return;
  mesh.ends.insert(mesh.ends.end(), {ShapeMesh<2>::Point::Zero(), mesh.corners[0]});
}

void meshOf(const ShapeView<3>& shape, int round, ShapeMesh<3>& mesh) {
  LPC_ASSERT(shape.core() != CoreClass::plane);
  mesh.corners.clear(), mesh.normals.clear(), mesh.triangles.clear(), mesh.ends.clear();
  if (shape.core() == CoreClass::hull) {
    const Polytope<3>& hull = *shape.hull;
    addFaces(hull, shape.radius, mesh);
    if (shape.radius > 0) {
      for (const auto& edge : hull.edges) addRoundedEdge(hull, edge, shape.radius, round, mesh);
      for (const Vec<3>& vertex : hull.vertices) addRoundSurface(shape, vertex, round, mesh);
    } else {
      for (const auto& edge : hull.edges) {
        addEdge(mesh, hull.vertices[static_cast<std::size_t>(edge.v0)],
                hull.vertices[static_cast<std::size_t>(edge.v1)]);
      }
    }
  } else if (shape.core() == CoreClass::box && !(shape.radius > 0)) {
    addBox(shape.half, mesh);
  } else {
    addRoundSurface(shape, Vec<3>::Zero(), round, mesh);
    addRims(shape, round, mesh);
  }
}

}}  // namespace lpc::LPC_PRECISION
