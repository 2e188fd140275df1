// SPDX-License-Identifier: Zlib
// Convex hulls. All arithmetic is double in both precisions. The tolerance is the rounding of the coordinates, so that
// eight corners of a rotated box give six faces and not twelve.
extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include <algorithm>
#include <limits>
#include <map>
#include <string>

#include "framework/math/check.h"
#include "framework/shape/shape.h"
#include "framework/shape/shape_tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
using Point = Eigen::Matrix<double, D, 1>;

// The points, and how far rounding may have moved the given coordinates. Only differences of points are used: they are
// exact even far from the origin.
template <int D>
struct Cloud {
  IndexedVector<Point<D>> p;
  double tolerance = 0;
};

template <int D>
Cloud<D> readPoints(std::span<const Vec<D>> points) {
  if (points.size() < static_cast<std::size_t>(D) + 1) {
    throw UserError("convex hull: " + std::to_string(points.size()) + " points given; valid: at least " +
                    std::to_string(D + 1));
  }
  Cloud<D> cloud;
  double largest = 0, extent = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) throw UserError("convex hull: point " + std::to_string(i) + " is not finite");
    const Point<D> q = points[i].template cast<double>();
    cloud.p.push_back(q);
    largest = std::max(largest, q.cwiseAbs().maxCoeff());
    extent = std::max(extent, (q - cloud.p[0]).cwiseAbs().maxCoeff());
  }
  cloud.tolerance = kHullRounding * largest;
  if (extent > kLargestExtent || extent < 1 / kLargestExtent) {
    throw UserError("convex hull: the points span " + std::to_string(extent) +
                    " m; valid: " + std::to_string(1 / kLargestExtent) + " to " + std::to_string(kLargestExtent));
  }
  return cloud;
}

template <int D>
std::size_t farthestFrom(const IndexedVector<Point<D>>& p, const auto& distance) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < p.size(); ++i) {
    if (distance(p[i]) > distance(p[best])) best = i;
  }
  return best;
}

[[noreturn]] void flat(const char* what) {
  throw UserError(std::string("convex hull: all points lie ") + what + " within rounding");
}

// Throws when the cloud is thinner than its rounding in some direction.
template <int D>
void requireVolume(const Cloud<D>& cloud) {
  const auto& p = cloud.p;
  const Point<D> a = p[farthestFrom<D>(p, [&](const Point<D>& q) { return (q - p[0]).norm(); })];
  const Point<D> b = p[farthestFrom<D>(p, [&](const Point<D>& q) { return (q - a).norm(); })];
  if (!((b - a).norm() > cloud.tolerance)) flat("on one point");
  Eigen::Matrix<double, D, D> axes = Eigen::Matrix<double, D, D>::Zero();  // orthonormal, one column per dimension
                                                                           // found
  axes.col(0) = (b - a).normalized();
  for (int k = 1; k < D; ++k) {
    const auto residual = [&](const Point<D>& q) {
      Point<D> r = q - a;
      for (int j = 0; j < k; ++j) r -= axes.col(j) * axes.col(j).dot(r);
      return r;
    };
    const Point<D> c = residual(p[farthestFrom<D>(p, [&](const Point<D>& q) { return residual(q).norm(); })]);
    if (!(c.norm() > (D == 3 ? kThinnestHull : 1) * cloud.tolerance)) flat(k == 1 ? "on one line" : "in one plane");
    axes.col(k) = c.normalized();
  }
}

double area2(const Point<2>& a, const Point<2>& b, const Point<2>& c) {
  return (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0];
}

// Andrew's monotone chain; returns indices, counter-clockwise.
std::vector<std::size_t> monotoneChain(const IndexedVector<Point<2>>& p) {
  std::vector<std::size_t> order(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) order[i] = i;
  const auto less = [&](std::size_t i, std::size_t j) {
    return std::pair(p[i][0], p[i][1]) < std::pair(p[j][0], p[j][1]);
  };
  std::stable_sort(order.begin(), order.end(), less);
  order.erase(std::unique(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return p[i] == p[j]; }),
              order.end());
  std::vector<std::size_t> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t start = hull.size();
    for (const std::size_t i : order) {
      while (hull.size() >= start + 2 && area2(p[hull[hull.size() - 2]], p[hull.back()], p[i]) <= 0) hull.pop_back();
      hull.push_back(i);
    }
    hull.pop_back();  // it is the first point of the other half
    std::reverse(order.begin(), order.end());
  }
  return hull;
}

// Drops vertices that are collinear with the kept vertices before and after them. Each dropped vertex is measured
// against the final edge: comparing neighbours only would consume a finely sampled circle.
std::vector<std::size_t> withoutCollinear(const Cloud<2>& cloud, std::vector<std::size_t> hull) {
  const auto& p = cloud.p;
  const auto onLine = [&](std::size_t a, std::size_t b, std::size_t q) {
    return std::abs(area2(p[a], p[b], p[q])) <= cloud.tolerance * (p[b] - p[a]).norm();
  };
  // Start at a true corner: an end of the hull's diameter.
  const auto& first = p[hull[0]];
  std::size_t start = 0;
  for (std::size_t i = 1; i < hull.size(); ++i) {
    if ((p[hull[i]] - first).norm() > (p[hull[start]] - first).norm()) start = i;
  }
  std::rotate(hull.begin(), hull.begin() + static_cast<std::ptrdiff_t>(start), hull.end());
  std::vector<std::size_t> kept{hull[0]};
  std::size_t from = 0;
  for (std::size_t i = 1; i <= hull.size(); ++i) {
    const std::size_t next = i == hull.size() ? hull[0] : hull[i];
    bool straight = true;
    for (std::size_t j = from + 1; j < i; ++j) straight = straight && onLine(hull[from], next, hull[j]);
    if (straight) continue;
    kept.push_back(hull[i - 1]);
    from = i - 1;
  }
  return kept;
}

// A face of the hull: indices of the given points, counter-clockwise from outside, and Qhull's normal.
struct Loop {
  std::vector<int> v;
  Point<3> normal;
  bool operator<(const Loop& other) const { return v < other.v; }
};

class QhullRun {
 public:
  QhullRun() : m_errors(std::fopen("/dev/null", "w")) { qh_zero(&m_qh, m_errors); }
  ~QhullRun() {
    qh_freeqhull(&m_qh, !qh_ALL);
    int longs = 0, bytes = 0;
    qh_memfreeshort(&m_qh, &longs, &bytes);
    if (m_errors) std::fclose(m_errors);
  }
  QhullRun(const QhullRun&) = delete;
  QhullRun& operator=(const QhullRun&) = delete;

  // Qhull is robust because it merges facets that are not clearly convex. E tells it the precision of the coordinates,
  // so that it merges what rounding has split.
  bool run(std::vector<double>& coordinates, double tolerance, const char* options) {
    char command[128];
    std::snprintf(command, sizeof command, "qhull %s E%.17g", options, tolerance);
    return qh_new_qhull(&m_qh, 3, static_cast<int>(coordinates.size() / 3), coordinates.data(), False, command, nullptr,
                        m_errors) == 0;
  }
  std::vector<Loop> loops() {
    std::vector<Loop> out;
    qhT* qh = &m_qh;  // Qhull's macros use this name
    facetT* facet;
    FORALLfacets {
      setT* ordered = qh_facet3vertex(qh, facet);
      Loop loop{{}, Point<3>(facet->normal[0], facet->normal[1], facet->normal[2])};
      vertexT *vertex, **vertexp;
      FOREACHvertex_(ordered) loop.v.push_back(qh_pointid(qh, vertex->point));
      qh_settempfree(qh, &ordered);
      std::reverse(loop.v.begin(), loop.v.end());  // Qhull's order is clockwise from outside
      out.push_back(std::move(loop));
    }
    return out;
  }

 private:
  qhT m_qh;
  std::FILE* m_errors;
};

// Removes vertices with only two faces: they lie inside an edge.
void dropEdgeVertices(std::vector<Loop>& loops, std::size_t points) {
  for (bool again = true; again;) {
    again = false;
    IndexedVector<int> uses(points);
    for (const Loop& loop : loops) {
      for (const int v : loop.v) ++uses[v];
    }
    for (Loop& loop : loops) {
      again = std::erase_if(loop.v, [&](int v) { return uses[v] < 3; }) > 0 || again;
    }
    again = std::erase_if(loops, [](const Loop& loop) { return loop.v.size() < 3; }) > 0 || again;
  }
}

// How far the points stand out of the face's plane with this normal, at most (m).
double outside(const IndexedVector<Point<3>>& p, const std::vector<int>& hull, const Loop& loop,
               const Point<3>& normal) {
  double inner = std::numeric_limits<double>::infinity(), outer = -inner;
  const Point<3>& base = p[loop.v[0]];
  for (const int v : loop.v) inner = std::min(inner, normal.dot(p[v] - base));
  for (const int v : hull) outer = std::max(outer, normal.dot(p[v] - base));
  return outer - inner;
}

// Normal of the loop's area; the loop's own normal when the area is zero.
Point<3> areaNormal(const IndexedVector<Point<3>>& p, const Loop& loop) {
  const Point<3>& base = p[loop.v[0]];
  Point<3> area = Point<3>::Zero();
  for (std::size_t i = 1; i + 1 < loop.v.size(); ++i) {
    const auto a = loop.v[i], b = loop.v[i + 1];
    area += (p[a] - base).cross(p[b] - base);
  }
  return area.norm() > 0 ? Point<3>(area.normalized()) : loop.normal;
}

// Sine of the loop's turn at b, from a to c; negative when it turns inwards.
double turn(const IndexedVector<Point<3>>& p, const Point<3>& normal, int a, int b, int c) {
  const Point<3> in = p[b] - p[a];
  const Point<3> out = p[c] - p[b];
  return in.cross(out).dot(normal) / (in.norm() * out.norm());
}

// Splits a loop in two at a corner that turns inwards, which merging may leave. Either a narrow triangle of a sliver's
// other side was merged into this face: it becomes a face of its own, across the dent. Or two faces of this side were
// merged: they become separate at an edge from that corner. Returns false when no corner turns inwards, or no split
// helps.
bool mendDent(const IndexedVector<Point<3>>& p, const std::vector<int>& hull, double tolerance, Loop& loop,
              std::vector<Loop>& more) {
  std::vector<int>& v = loop.v;
  for (std::size_t tried = 0; v.size() > 3 && tried < v.size(); ++tried) {
    std::rotate(v.begin(), v.begin() + 1, v.end());
    if (!(turn(p, loop.normal, v[0], v[1], v[2]) < -kDent)) continue;
    const Loop across{{v[0], v[1], v[2]}, loop.normal};
    const Point<3> back = areaNormal(p, across);
    if (outside(p, hull, across, back) <= kDentDepth * tolerance) {
      more.push_back({across.v, back});
      v.erase(v.begin() + 1);
      return true;
    }
    std::size_t to = 0;
    double best = -1;
    for (std::size_t k = 3; k < v.size(); ++k) {
      const double least = std::min(turn(p, loop.normal, v[0], v[1], v[k]), turn(p, loop.normal, v[k], v[1], v[2]));
      if (least > best) best = least, to = k;
    }
    if (to == 0) continue;
    const auto end = v.begin() + static_cast<std::ptrdiff_t>(to);
    more.push_back({{v.begin() + 1, end + 1}, loop.normal});
    v.erase(v.begin() + 2, end);
    return true;
  }
  return false;
}

// The area's normal is better for wide faces, but for a sliver it is made of rounding: Qhull's normal uses the
// neighbourhood. Takes the one that leaves less outside.
Point<3> faceNormal(const IndexedVector<Point<3>>& p, const std::vector<int>& hull, const Loop& loop) {
  const Point<3> area = areaNormal(p, loop);
  return outside(p, hull, loop, area) <= outside(p, hull, loop, loop.normal) ? area : loop.normal;
}

// Builds a polytope from the loops. Returns null when they are not closed: an edge does not have exactly two faces, or
// Euler's count is wrong.
std::shared_ptr<Polytope<3>> assemble(std::span<const Vec<3>> points, const Cloud<3>& cloud, std::vector<Loop> loops) {
  dropEdgeVertices(loops, points.size());
  IndexedVector<int> number(points.size(), -1);
  for (const Loop& loop : loops) {
    for (const int v : loop.v) number[v] = 0;
  }
  auto hull = std::make_shared<Polytope<3>>();
  std::vector<int> used;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<int>(hull->vertices.size());
    hull->vertices.push_back(points[i]);
    used.push_back(static_cast<int>(i));
  }
  for (std::size_t i = 0; i < loops.size(); ++i) {
    std::vector<Loop> more;
    while (mendDent(cloud.p, used, cloud.tolerance, loops[i], more)) continue;
    loops.insert(loops.end(), more.begin(), more.end());
  }
  // A canonical order, whatever Qhull's was: each loop starts at its lowest vertex, faces are sorted by loops.
  for (Loop& loop : loops) std::rotate(loop.v.begin(), std::min_element(loop.v.begin(), loop.v.end()), loop.v.end());
  std::sort(loops.begin(), loops.end());
  std::map<std::pair<int, int>, std::size_t> open;  // edges with only one face so far
  for (std::size_t f = 0; f < loops.size(); ++f) {
    const std::vector<int>& loop = loops[f].v;
    Polytope<3>::Face face;
    face.normal = faceNormal(cloud.p, used, loops[f]).cast<Real>();
    if (!(std::abs(face.normal.norm() - 1) < kFaceNormalError)) return nullptr;
    face.begin = static_cast<int>(hull->loop.size());
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const int a = number[loop[i]];
      const int b = number[loop[(i + 1) % loop.size()]];
      hull->loop.push_back(a);
      if (const auto twin = open.find({b, a}); twin != open.end()) {
        hull->edges[twin->second].faceB = static_cast<int>(f);
        open.erase(twin);
      } else {
        if (!open.emplace(std::pair(a, b), hull->edges.size()).second) return nullptr;
        hull->edges.push_back({a, b, static_cast<int>(f), -1});
      }
    }
    face.end = static_cast<int>(hull->loop.size());
    // The plane supports the hull: no vertex is outside, whatever the rounding of the normal.
    double offset = -std::numeric_limits<double>::infinity();
    for (const Vec<3>& v : hull->vertices) offset = std::max(offset, face.normal.cast<double>().dot(v.cast<double>()));
    face.offset = static_cast<Real>(offset);
    hull->faces.push_back(face);
  }
  const bool closed = open.empty() && hull->vertices.size() + hull->faces.size() == hull->edges.size() + 2;
  if (!closed) return nullptr;
  linkVertices(*hull);
  return hull;
}

}  // namespace

std::shared_ptr<const Polytope<2>> convexHull(std::span<const Vec<2>> points) {
  const Cloud<2> cloud = readPoints<2>(points);
  requireVolume(cloud);
  std::vector<std::size_t> kept = withoutCollinear(cloud, monotoneChain(cloud.p));
  if (kept.size() < 3) flat("on one line");
  std::rotate(kept.begin(), std::min_element(kept.begin(), kept.end()), kept.end());
  auto hull = std::make_shared<Polytope<2>>();
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const Point<2> edge = cloud.p[kept[(i + 1) % kept.size()]] - cloud.p[kept[i]];
    hull->vertices.push_back(points[kept[i]]);
    hull->normals.push_back(Point<2>(edge[1], -edge[0]).normalized().cast<Real>());
  }
  return hull;
}

std::shared_ptr<const Polytope<3>> convexHull(std::span<const Vec<3>> points) {
  const Cloud<3> cloud = readPoints<3>(points);
  requireVolume(cloud);
  std::vector<double> coordinates;
  for (const Point<3>& q : cloud.p) {
    const Point<3> near = q - cloud.p[0];
    coordinates.insert(coordinates.end(), {near[0], near[1], near[2]});
  }
  for (const double grown : kHullTries) {  // a near-degenerate point cloud can fail at one tolerance, rarely at three
    QhullRun qhull;
    if (!qhull.run(coordinates, grown * cloud.tolerance, "Q12")) continue;
    if (auto hull = assemble(points, cloud, qhull.loops())) return hull;
  }
  throw UserError("convex hull: the points are too close to one plane for a valid hull");
}

}}  // namespace lpc::LPC_PRECISION
