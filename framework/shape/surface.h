// SPDX-License-Identifier: Zlib
// The data of Shape::mesh and Shape::chain: triangles in 3D, segments in 2D. Each is a convex part, as in a compound.
// The surface also knows the neighbour across each edge, which distinguishes contacts at internal edges from others
// (internal_edges.h).
#pragma once

#include <array>

#include "framework/math/indexed.h"
#include "framework/shape/mesh_tree.h"
#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
class Surface {
 public:
  /// An edge of a triangle, from corner `number` to the next corner, or an end of a segment, where number 0 is the
  /// first end.
  struct Border {
    Vec<D> outward;               // unit, in the part's plane, pointing away from it
    Vec<D> at;                    // a point of the edge
    std::int32_t neighbour = -1;  // the part across the edge; -1: the surface ends here
  };
  static constexpr int kBorders = D;

  /// Builds a surface. Throws UserError, starting with `subject`, for data that Shape::mesh and Shape::chain reject.
  Surface(IndexedSpan<const Vec<D>> points, std::span<const std::array<int, D>> parts, std::string_view subject);

  /// As given by the user.
  const std::vector<Vec<D>>& points() const { return m_points; }
  const std::vector<std::array<int, D>>& corners() const { return m_corners; }

  std::span<const PlacedView<D>> parts() const { return m_parts; }
  const MeshTree<D>& tree() const { return m_tree; }
  // In the surface's frame.
  const Aabb<D>& box() const { return m_box; }
  const Vec<D>& normal(std::int32_t part) const { return m_normals[part]; }
  Border border(std::int32_t part, int number) const;
  /// Radius of a sphere around the frame's origin that contains the surface (m).
  Real reach() const { return m_reach; }

 private:
  static std::vector<Aabb<D>> boxesOf(std::span<const PlacedView<D>> parts);
  void findNeighbours(std::string_view subject);

  std::vector<Vec<D>> m_points;
  std::vector<std::array<int, D>> m_corners;
  std::vector<std::shared_ptr<const Polytope<D>>> m_hulls;  // of triangles
  IndexedVector<PlacedView<D>> m_parts;                     // views point into m_hulls
  IndexedVector<Vec<D>> m_normals;                          // pointing outside
  IndexedVector<IndexedArray<std::int32_t, D>> m_neighbours;
  Aabb<D> m_box;
  Real m_reach = 0;
  MeshTree<D> m_tree;
};

}}  // namespace lpc::LPC_PRECISION
