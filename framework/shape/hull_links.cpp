// SPDX-License-Identifier: Zlib
// Neighbours of a hull's vertices, and when they prove that a vertex is a support point (Polytope<3>::slack).
//
// A convex polytope has no local maximum other than its support vertices, so hill climbing along its edges finds them.
// Qhull's result is convex only within rounding: its faces merge triangles that are not exactly coplanar. Let Q be the
// convex hull of the vertices, and S the surface made of the faces. Let c be a point with a ball of radius r inside all
// planes, and R the distance of the vertices from c. Let s be how far corners of a face may lie below its plane;
// nothing lies above it (the offset of a face is that of its highest vertex). Seen from c, a point of S and the point
// of Q's surface behind it are p and c + l (p - c) with 1 <= l <= 1 + s / (r - s). The lower bound: p is a convex
// combination of corners, so it is within Q. The upper bound: the plane of p's face bounds Q. So along any unit
// direction n, the two surfaces differ in height by at most t = R s / (r - s).
//
// Let T be vertices connected by edges, with all their other neighbours more than `slack` below the highest of them, v.
// Suppose that a vertex w outside T is not below v. The part of Q's surface that lies no lower than v - t is connected,
// so it has a path from above v to above w. The projection of this path on S crosses the corners that T cuts off its
// faces, somewhere between two neighbours of T, which are lower than v - slack. There the path on Q's surface is lower
// than v - slack + t. So `slack` is 2 t plus the rounding of heights. With `slack + band`, T contains all vertices no
// lower than v - band. The projection needs an S that is seen once in each direction from c, with faces that are convex
// from there: this is tested, corner by corner.
#include <algorithm>
#include <limits>

#include "framework/shape/shape.h"
#include "framework/shape/shape_tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using Point3 = Eigen::Vector3d;

bool isWhole(const Polytope<3>& hull) {
  const auto exists = [](int i, std::size_t count) { return i >= 0 && static_cast<std::size_t>(i) < count; };
  const std::size_t vertices = hull.vertices.size();
  return std::all_of(hull.loop.begin(), hull.loop.end(), [&](int v) { return exists(v, vertices); }) &&
         std::all_of(hull.edges.begin(), hull.edges.end(),
                     [&](const auto& e) { return exists(e.v0, vertices) && exists(e.v1, vertices) && e.v0 != e.v1; }) &&
         std::all_of(hull.faces.begin(), hull.faces.end(), [&](const auto& f) {
           return f.begin >= 0 && f.begin < f.end && static_cast<std::size_t>(f.end) <= hull.loop.size();
         });
}

double slackOf(const Polytope<3>& hull) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const auto corner = [&](int i) { return Point3(hull.vertices[hull.loop[i]].cast<double>()); };
  Point3 centre = Point3::Zero();
  double largest = 0, radius = 0, inner = kNone, below = 0;
  for (const Vec<3>& v : hull.vertices) {
    centre += v.cast<double>() / static_cast<double>(hull.vertices.size());
    largest = std::max(largest, v.cast<double>().norm());
  }
  for (const Vec<3>& v : hull.vertices) radius = std::max(radius, (v.cast<double>() - centre).norm());
  for (const auto& f : hull.faces) {
    const Point3 n = f.normal.cast<double>();
    inner = std::min(inner, double(f.offset) - n.dot(centre));
    const auto turnsLeft = [&](int i, int j, int k) {
      const Point3 a = corner(i) - centre, b = corner(j) - centre, q = corner(k) - centre;
      return a.cross(b).dot(q) > kLeftTurn * radius * radius * radius;
    };
    for (int i = f.begin; i < f.end; ++i) {
      below = std::max(below, double(f.offset) - n.dot(corner(i)));
      const int next = i + 1 < f.end ? i + 1 : f.begin, last = i > f.begin ? i - 1 : f.end - 1;
      if (!turnsLeft(last, i, next)) return kNone;
      if (last > f.begin && i > f.begin && !turnsLeft(f.begin, last, i)) return kNone;  // the loop goes round only once
    }
  }
  const double rounding = kHeightRounding * largest;
  below += 2 * rounding, inner -= 2 * rounding;
  if (!(below < inner / 2)) return kNone;
  return 2 * radius * below / (inner - below) + 2 * rounding;
}

}  // namespace

void linkVertices(Polytope<3>& hull) {
  hull.spokes.clear(), hull.firstSpoke.clear();
  hull.slack = std::numeric_limits<Real>::infinity();
  if (!isWhole(hull)) return;
  // Count, then fill in the order of the edges.
  hull.firstSpoke.assign(hull.vertices.size() + 1, 0);
  hull.spokes.resize(2 * hull.edges.size());
  const auto first = [&](int v) -> int& { return hull.firstSpoke[v]; };
  for (const auto& e : hull.edges) ++first(e.v0), ++first(e.v1);
  int end = 0;
  for (int& f : hull.firstSpoke) end += f, f = end;
  for (int k = static_cast<int>(hull.edges.size()); k-- > 0;) {
    const auto& e = hull.edges[k];
    hull.spokes[--first(e.v0)] = {e.v1, k};
    hull.spokes[--first(e.v1)] = {e.v0, k};
  }
  hull.slack = static_cast<Real>(slackOf(hull));
}

}}  // namespace lpc::LPC_PRECISION
