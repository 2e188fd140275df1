// SPDX-License-Identifier: Zlib
#include "experiments/trial/pair_reference.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace lpc::inline LPC_PRECISION {
namespace {

template <int D>
using Wide = Eigen::Matrix<double, D, 1>;

/// The core of a shape as bare features in A's frame.
template <int D>
struct CoreFeatures {
  std::vector<Wide<D>> vertices, edges, normals;  // edges as directions
  std::vector<std::pair<Wide<D>, Wide<D>>> segments;

  double support(const Wide<D>& n) const {
    double best = -std::numeric_limits<double>::infinity();
    for (const Wide<D>& v : vertices) best = std::max(best, v.dot(n));
    return best;
  }
};

template <int D>
void addEdge(CoreFeatures<D>& f, const Wide<D>& from, const Wide<D>& to) {
  f.segments.emplace_back(from, to);
  f.edges.push_back(to - from);
}

template <int D>
CoreFeatures<D> localFeatures(const ShapeView<D>& s) {
  CoreFeatures<D> f;
  switch (s.kind) {
    case ShapeKind::sphere:
      f.vertices.push_back(Wide<D>::Zero());
      break;
    case ShapeKind::capsule:
    case ShapeKind::segment: {
      Wide<D> p = Wide<D>::Zero();
      p[0] = s.half[0];
      f.vertices = {-p, p};
      addEdge<D>(f, -p, p);
      break;
    }
    case ShapeKind::box: {
      const Wide<D> half = s.half.template cast<double>();
      for (int corner = 0; corner < (1 << D); ++corner) {
        Wide<D> p;
        for (int d = 0; d < D; ++d) p[d] = (corner >> d & 1) ? half[d] : -half[d];
        f.vertices.push_back(p);
        for (int d = 0; d < D; ++d) {
          if (corner >> d & 1) continue;
          Wide<D> q = p;
          q[d] = half[d];
          addEdge<D>(f, p, q);
        }
      }
      for (int d = 0; d < D; ++d) {
        f.normals.push_back(Wide<D>::Unit(d));
        f.normals.push_back(-Wide<D>::Unit(d));
      }
      break;
    }
    case ShapeKind::polytope: {
      for (const auto& v : s.hull->vertices) f.vertices.push_back(v.template cast<double>());
      if constexpr (D == 2) {
        for (std::size_t i = 0; i < f.vertices.size(); ++i) {
          addEdge<D>(f, f.vertices[i], f.vertices[(i + 1) % f.vertices.size()]);
          f.normals.push_back({f.edges[i][1], -f.edges[i][0]});
        }
      } else {
        for (const auto& e : s.hull->edges) {
          addEdge<D>(f, f.vertices[static_cast<std::size_t>(e.v0)], f.vertices[static_cast<std::size_t>(e.v1)]);
        }
        for (const auto& face : s.hull->faces) f.normals.push_back(face.normal.template cast<double>());
      }
      break;
    }
  }
  return f;
}

Eigen::Matrix2d widened(const Rot<2>& q) {
  const double n = std::sqrt(double(q.c) * q.c + double(q.s) * q.s), c = q.c / n, s = q.s / n;
  Eigen::Matrix2d m;
  m << c, -s, s, c;
  return m;
}
Eigen::Matrix3d widened(const Rot<3>& q) { return Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().matrix(); }

template <int D>
CoreFeatures<D> posed(CoreFeatures<D> f, const Pose<D>& x) {
  const auto r = widened(x.q);
  const Wide<D> p = x.p.template cast<double>();
  for (auto& v : f.vertices) v = r * v + p;
  for (auto& e : f.edges) e = r * e;
  for (auto& n : f.normals) n = r * n;
  for (auto& [from, to] : f.segments) from = r * from + p, to = r * to + p;
  return f;
}

// From a point perpendicular to a segment's line.
template <int D>
Wide<D> toLine(const Wide<D>& p, const std::pair<Wide<D>, Wide<D>>& s) {
  const Wide<D> e = s.second - s.first;
  const double length2 = e.squaredNorm();
  if (length2 == 0) return s.first - p;
  const Wide<D> d = s.first - p;
  return d - e * (d.dot(e) / length2);
}

}  // namespace

template <int D>
double bruteForceDistance(const ShapeView<D>& shapeA, const ShapeView<D>& shapeB, const Pose<D>& X_AB) {
  const CoreFeatures<D> a = localFeatures(shapeA), b = posed(localFeatures(shapeB), X_AB);
  double best = -std::numeric_limits<double>::infinity();
  // `n` from A to B; a direction without a side is tried both ways.
  const auto tryOne = [&](const Wide<D>& direction) {
    const double length = direction.norm();
    if (!(length > 1e-150)) return;
    const Wide<D> n = direction / length;
    best = std::max(best, -a.support(n) - b.support(-n));
  };
  const auto tryBoth = [&](const Wide<D>& direction) { tryOne(direction), tryOne(-direction); };
  for (const auto& n : a.normals) tryOne(n);
  for (const auto& n : b.normals) tryOne(-n);
  for (const auto& v : a.vertices) {
    for (const auto& w : b.vertices) tryOne(w - v);
    for (const auto& s : b.segments) tryBoth(toLine<D>(v, s));
  }
  for (const auto& w : b.vertices) {
    for (const auto& s : a.segments) tryBoth(toLine<D>(w, s));
  }
  if constexpr (D == 3) {
    for (const auto& e : a.edges) {
      for (const auto& f : b.edges) tryBoth(e.cross(f));
    }
    // A bare segment against a bare point or parallel segment has no normal of its own: any direction across it.
    for (const auto* e : {&a.edges, &b.edges}) {
      if (e->size() == 1) tryBoth(e->front().unitOrthogonal());
    }
  } else {
    for (const auto* e : {&a.edges, &b.edges}) {
      if (e->size() == 1) tryBoth(Wide<2>(-e->front()[1], e->front()[0]));
    }
  }
  if (best == -std::numeric_limits<double>::infinity()) best = 0;  // two points in the same place
  return best - double(shapeA.radius) - double(shapeB.radius);
}

template double bruteForceDistance(const ShapeView<2>&, const ShapeView<2>&, const Pose<2>&);
template double bruteForceDistance(const ShapeView<3>&, const ShapeView<3>&, const Pose<3>&);

}  // namespace lpc::inline LPC_PRECISION
