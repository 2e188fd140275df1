// SPDX-License-Identifier: Zlib
// A bounded convex shape as triangles and edges, in its own frame.
#pragma once

#include <cstdint>
#include <vector>

#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct ShapeMesh {
  using Point = Eigen::Matrix<float, D, 1>;
  std::vector<Point> corners;            // of triangles
  std::vector<Point> normals;            // per corner, unit; 3D only
  std::vector<std::uint32_t> triangles;  // three corners each, counter-clockwise seen from outside
  std::vector<Point> ends;               // of edges, two each
};

/// Replaces the content of `mesh`. Round parts have `round` corners, a multiple of four, in a full turn. Edges on a
/// round shape show its rotation.
void meshOf(const ShapeView<2>& shape, int round, ShapeMesh<2>& mesh);
void meshOf(const ShapeView<3>& shape, int round, ShapeMesh<3>& mesh);

}}  // namespace lpc::LPC_PRECISION
