// SPDX-License-Identifier: Zlib
#pragma once

#include <array>
#include <vector>

#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A point with coordinates of any number type.
template <class N, int D>
using Point = std::array<N, static_cast<std::size_t>(D)>;

/// The rotation matrix of space.h from the stored components: for a quaternion that is unit only within rounding, a
/// rotation only within rounding. The number type sets the precision.
template <class N>
std::array<Point<N, 2>, 2> rotationOf(const Rot<2>& q) {
  const N c(static_cast<double>(q.c)), s(static_cast<double>(q.s));
  return {{{c, N(0.0) - s}, {s, c}}};
}
template <class N>
std::array<Point<N, 3>, 3> rotationOf(const Rot<3>& q) {
  const N w(static_cast<double>(q.w)), x(static_cast<double>(q.x)), y(static_cast<double>(q.y)),
      z(static_cast<double>(q.z));
  const N one(1.0), two(2.0);
  return {{{one - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y)},
           {two * (x * y + w * z), one - two * (x * x + z * z), two * (y * z - w * x)},
           {two * (x * z - w * y), two * (y * z + w * x), one - two * (x * x + y * y)}}};
}

/// True when the core is the convex hull of finitely many points.
template <int D>
bool hasVertices(const ShapeView<D>& shape) {
  return shape.core() != CoreClass::curved && shape.core() != CoreClass::plane;
}

/// Vertices of the shape's core (without its rounding) in its own frame; empty for a core without vertices.
template <int D>
void coreVertices(const ShapeView<D>& shape, std::vector<Vec<D>>& out) {
  out.clear();
  switch (shape.core()) {
    case CoreClass::point:
      out.push_back(Vec<D>::Zero());
      return;
    case CoreClass::segment:
      out.push_back(Vec<D>::Unit(0) * -shape.half[0]);
      out.push_back(Vec<D>::Unit(0) * shape.half[0]);
      return;
    case CoreClass::box:
      for (int corner = 0; corner < (1 << D); ++corner) {
        Vec<D> p;
        for (int d = 0; d < D; ++d) p[d] = (corner >> d) & 1 ? shape.half[d] : -shape.half[d];
        out.push_back(p);
      }
      return;
    case CoreClass::hull:
      out.assign(shape.hull->vertices.begin(), shape.hull->vertices.end());
      return;
    case CoreClass::curved:
    case CoreClass::plane:
      return;
  }
}

/// These vertices in the world: X_WS applied with the arithmetic of N.
template <class N, int D>
void poseVertices(const std::vector<Vec<D>>& vertices, const Pose<D>& X_WS, std::vector<Point<N, D>>& out) {
  const auto r = rotationOf<N>(X_WS.q);
  out.resize(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (int k = 0; k < D; ++k) {
      const auto row = static_cast<std::size_t>(k);
      N sum(static_cast<double>(X_WS.p[k]));
      for (int j = 0; j < D; ++j) {
        sum = sum + r[row][static_cast<std::size_t>(j)] * N(static_cast<double>(vertices[i][j]));
      }
      out[i][row] = sum;
    }
  }
}

}}  // namespace lpc::LPC_PRECISION
