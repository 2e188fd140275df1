// SPDX-License-Identifier: Zlib
// The neighbours of a hull's vertices, and when they prove that a vertex is the farthest (Polytope<3>::slack).
//
// A convex polytope has no local maximum but the farthest vertices, so that a climb along its edges finds them. What
// Qhull leaves is convex within rounding: its faces merge triangles that are not quite in one plane. Let Q be the
// convex hull of the vertices, S the surface made of the faces, c a point with a ball of radius r inside all planes, R
// how far the vertices are from c, and s how far corners of a face may lie below its plane, which nothing lies above
// (the offset of a face is that of its foremost vertex). Seen from c, a point of S and the point of Q's surface behind
// it are p and c + l (p - c) with 1 <= l <= 1 + s / (r - s): p is made of corners and so within Q, and the plane of
// p's face ends Q. So the two surfaces differ by no more than t = R s / (r - s) in height along any unit direction n.
//
// Let T be vertices that are connected by edges, all their other neighbours more than `slack` below the highest of
// them, v. If a vertex w besides T were not below v: what of Q's surface lies no lower than v - t is connected, and so
// there is a path on it, from above v to above w, that is never lower. Its shadow on S leaves the corners that T cuts
// off its faces, somewhere between two neighbours of T, which are lower than v - slack: on Q's surface it is lower
// there than v - slack + t. So `slack` is 2 t, and what rounding takes from heights; with `slack + band` T has all that
// lie no lower than v - band. The shadow needs an S that is seen once in each direction from c, with faces that are
// convex from there: that is tested, corner by corner.
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
      if (last > f.begin && i > f.begin && !turnsLeft(f.begin, last, i)) return kNone;  // it goes round but once
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
  // Counted, then filled in the order of the edges.
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
