// SPDX-License-Identifier: Zlib
// A flat triangle as a hull. Computed in double, as all hulls are.
#include <algorithm>
#include <string>

#include "framework/shape/flat_triangle.h"
#include "framework/shape/shape.h"
#include "framework/shape/shape_tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {

namespace {

using Corner = Eigen::Vector3d;

struct TriangleSides {
  explicit TriangleSides(const IndexedArray<Corner, 3>& p) {
    for (std::size_t i = 0; i < 3; ++i) edge[i] = p[(i + 1) % 3] - p[i], longest = std::max(longest, edge[i].norm());
    // The cross product of the two shortest edges has the most digits: use the corner opposite the longest edge.
    std::size_t apex = 0;
    for (std::size_t i = 1; i < 3; ++i) {
      if (edge[(i + 1) % 3].squaredNorm() > edge[(apex + 1) % 3].squaredNorm()) apex = i;
    }
    if (longest > 0) across = edge[(apex + 2) % 3].cross(edge[apex]) / longest;
  }
  bool spanArea(double largest) const { return across.norm() > kFlattestTriangle * kHullRounding * largest; }

  IndexedArray<Corner, 3> edge;
  double longest = 0;              // m
  Corner across = Corner::Zero();  // normal; its length is the height over the longest edge
};

}  // namespace

bool hasArea(const std::array<Vec<3>, 3>& corners) {
  IndexedArray<Corner, 3> p;
  double largest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    p[i] = corners[i].cast<double>();
    largest = std::max(largest, p[i].cwiseAbs().maxCoeff());
  }
  return TriangleSides(p).spanArea(largest);
}

std::shared_ptr<const Polytope<3>> flatTriangle(const std::array<Vec<3>, 3>& corners, std::string_view subject) {
  IndexedArray<Corner, 3> p;
  double largest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!corners[i].allFinite()) {
      throw UserError(std::string(subject) + ": corner " + std::to_string(i) + " is not finite");
    }
    p[i] = corners[i].cast<double>();
    largest = std::max(largest, p[i].cwiseAbs().maxCoeff());
  }
  const TriangleSides sides(p);
  const IndexedArray<Corner, 3>& edge = sides.edge;
  const double longest = sides.longest;
  if (longest > 2 * kLargestExtent || (longest > 0 && longest < 1 / kLargestExtent)) {
    throw UserError(std::string(subject) + ": it is " + std::to_string(longest) + " m long; valid: " +
                    std::to_string(1 / kLargestExtent) + " to " + std::to_string(2 * kLargestExtent));
  }
  if (!sides.spanArea(largest)) {
    throw UserError(std::string(subject) +
                    ": its corners lie on one line within rounding; valid: a triangle with area");
  }
  const Corner n = sides.across.normalized();
  auto out = std::make_shared<Polytope<3>>();
  out->vertices.assign(corners.begin(), corners.end());
  const auto face = [&](const Vec<3>& normal, Real offset, std::initializer_list<int> loop) {
    const int begin = static_cast<int>(out->loop.size());
    out->loop.insert(out->loop.end(), loop);
    out->faces.push_back({normal, offset, begin, static_cast<int>(out->loop.size())});
  };
  const Vec<3> up = n.cast<Real>();
  const Real height = static_cast<Real>(n.dot((p[0] + p[1] + p[2]) / 3));
  face(up, height, {0, 1, 2});
  face(-up, -height, {0, 2, 1});
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const Corner side = edge[i].cross(n).normalized();
    face(side.cast<Real>(), static_cast<Real>(side.dot(p[i])), {j, i});
    out->edges.push_back({i, j, 0, 2 + i});
    out->edges.push_back({j, i, 1, 2 + i});
  }
  linkVertices(*out);
  return out;
}

}}  // namespace lpc::LPC_PRECISION
