// SPDX-License-Identifier: Zlib
// A 3D core as separating axes see it: corners, planes of its faces, edges. Those of a hull are its own; those of other
// shapes are made here.
#pragma once

#include <span>
#include <vector>

#include "algorithms/pair_query/core/core_pair.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

class SatCore {
 public:
  using Face = Polytope<3>::Face;
  using Edge = Polytope<3>::Edge;
  struct Plane {
    Vec<3> n = Vec<3>::Zero();
    Real offset = 0;
  };

  /// A's core; all results are in its frame.
  void start(const ShapeView<3>& shape) { read(shape), m_p.setZero(), m_placed = true; }
  /// B's core.
  void start(const ShapeView<3>& shape, const Vec<3>& p, const Mat<3>& r) {
    read(shape), m_p = p, m_r = r, m_placed = false;
  }

  int vertexCount() const { return static_cast<int>(m_corners.size()); }
  IndexedSpan<const Face> faces() const { return m_faces; }
  IndexedSpan<const Edge> edges() const { return m_edges; }
  std::span<const Polytope<3>::Spoke> spokes(int vertex) const { return m_hull->spokesOf(vertex); }
  std::span<const int> loop(const Face& f) const { return m_loop.part(f.begin, f.end - f.begin); }
  Vec<3> vertex(int i) const {
    const Vec<3>& v = m_corners[i];
    return m_placed ? v : Vec<3>(m_p + m_r * v);
  }
  Vec<3> normal(int face) const {
    const Vec<3>& n = m_faces[face].normal;
    return m_placed ? n : Vec<3>(m_r * n);
  }
  Plane plane(const Face& f) const {
    if (m_placed) return {f.normal, f.offset};
    const Vec<3> n = m_r * f.normal;
    return {n, f.offset + n.dot(m_p)};
  }

  /// The support vertex along n.
  int foremost(const Vec<3>& n) const {
    const Vec<3> d = m_placed ? n : Vec<3>(m_r.transpose() * n);
    std::size_t best = 0;
    Real most = m_corners[0].dot(d);
    for (std::size_t i = 1; i < m_corners.size(); ++i) {
      const Real along = m_corners[i].dot(d);
      if (along > most) best = i, most = along;
    }
    return static_cast<int>(best);
  }

  /// Makes `vertices` and the ball.
  void fill() {
    vertices = m_corners;
    Vec<3> middle = Vec<3>::Zero();
    for (const Vec<3>& v : m_corners) middle += v;
    middle /= static_cast<Real>(m_corners.size());
    inner = m_faces.empty() ? Real(0) : std::numeric_limits<Real>::infinity();
    for (const Face& f : m_faces) inner = std::min(inner, f.offset - f.normal.dot(middle));
    centre = middle;
    if (m_placed) return;
    centre = m_p + m_r * middle;
    m_moved.resize(m_corners.size());
    for (std::size_t i = 0; i < m_moved.size(); ++i) m_moved[i] = m_p + m_r * m_corners[i];
    vertices = m_moved;
  }
  std::span<const Vec<3>> vertices;
  Vec<3> centre = Vec<3>::Zero();  // of a ball within the core
  Real inner = 0;                  // its radius (m)

  /// Makes `heights`, those of the point q above all planes (m), and returns the index of the largest.
  int measure(const Vec<3>& q) {
    const Vec<3> own = m_placed ? q : Vec<3>(m_r.transpose() * (q - m_p));
    heights.resize(m_faces.size());
    for (std::size_t i = 0; i < heights.size(); ++i) heights[i] = m_faces[i].normal.dot(own) - m_faces[i].offset;
    below.assign(m_faces.size(), -1);
    return static_cast<int>(std::max_element(heights.begin(), heights.end()) - heights.begin());
  }
  std::vector<Real> heights;
  std::vector<int> below;  // the vertex of the other core that limits what the face proves; -1: not tested

 private:
  // Cores other than hulls are made once, and then resized.
  void read(const ShapeView<3>& shape) {
    const Vec<3>& h = shape.half;
    switch (shape.core()) {
      case CoreClass::hull:
        return view(*shape.hull);
      case CoreClass::box:
        if (m_box.vertices.empty()) makeBox();
        for (std::size_t bits = 0; bits < 8; ++bits) {
          m_box.vertices[bits] = {(bits & 1) ? h[0] : -h[0], (bits & 2) ? h[1] : -h[1], (bits & 4) ? h[2] : -h[2]};
        }
        for (int k = 0; k < 6; ++k) m_box.faces[k].offset = h[k / 2];
        return view(m_box);
      case CoreClass::segment:
        if (m_segment.vertices.empty()) {
          m_segment.vertices.assign(2, Vec<3>::Zero());
          m_segment.edges.push_back({0, 1, -1, -1});  // an edge without faces
          linkVertices(m_segment);
        }
        m_segment.vertices = {{-h[0], 0, 0}, {h[0], 0, 0}};
        return view(m_segment);
      case CoreClass::point:
        if (m_point.vertices.empty()) {
          m_point.vertices.push_back(Vec<3>::Zero());
          linkVertices(m_point);
        }
        return view(m_point);
      case CoreClass::curved:
      case CoreClass::plane:
        LPC_ASSERT(false);  // has no list of edges
        break;
    }
  }

  void view(const Polytope<3>& hull) {
    LPC_ASSERT(hull.firstSpoke.size() == hull.vertices.size() + 1);
    m_hull = &hull;
    m_corners = hull.vertices, m_faces = hull.faces, m_edges = hull.edges, m_loop = hull.loop;
  }

  // Corner number `bits` has the signs of its bits; face 2 k faces along axis k, 2 k + 1 against it.
  void makeBox() {
    m_box.vertices.assign(8, Vec<3>::Zero());
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      for (const int sign : {1, -1}) {
        const int at = sign > 0 ? 1 << k : 0, begin = static_cast<int>(m_box.loop.size());
        const int first = sign > 0 ? i : j, second = sign > 0 ? j : i;  // counter-clockwise from outside
        for (const int v : {at, at | 1 << first, at | 1 << i | 1 << j, at | 1 << second}) m_box.loop.push_back(v);
        m_box.faces.push_back({Vec<3>(Real(sign) * Vec<3>::Unit(k)), 0, begin, begin + 4});
      }
      for (const int si : {-1, 1}) {
        for (const int sj : {-1, 1}) {
          const int v0 = (si > 0 ? 1 << i : 0) | (sj > 0 ? 1 << j : 0);
          const int fi = 2 * i + (si < 0), fj = 2 * j + (sj < 0);
          // Right-handed: n0 x n1 is the edge's direction, as in a polytope's loops.
          const bool turn = si * sj > 0;
          m_box.edges.push_back({v0, v0 | (1 << k), turn ? fi : fj, turn ? fj : fi});
        }
      }
    }
    linkVertices(m_box);
  }

  const Polytope<3>* m_hull = nullptr;
  IndexedSpan<const Vec<3>> m_corners;  // in its own frame
  IndexedSpan<const Face> m_faces;
  IndexedSpan<const Edge> m_edges;
  IndexedSpan<const int> m_loop;
  Vec<3> m_p = Vec<3>::Zero();
  Mat<3> m_r = Mat<3>::Identity();
  bool m_placed = true;  // its frame is A's
  Polytope<3> m_box, m_segment, m_point;
  std::vector<Vec<3>> m_moved;
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
