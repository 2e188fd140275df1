// SPDX-License-Identifier: Zlib
// Signed distance by trying everything: all face normals and all products of edges, all pairs of features. Shares no
// code with the algorithms, and is far too slow for them.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "framework/shape.h"

namespace lpc::inline LPC_PRECISION::test {

/// A core as bare features, posed.
template <int D>
struct BruteCore {
  std::vector<Vec<D>> v;
  std::vector<std::array<int, 2>> edges;  // a point is an edge from itself to itself
  std::vector<std::vector<int>> faces;    // 3D: vertices in order; 2D: as edges
  std::vector<Vec<D>> normals;            // of the faces, unit, outward
  bool solid = false;

  Real support(const Vec<D>& d) const {
    Real h = -std::numeric_limits<Real>::infinity();
    for (const Vec<D>& p : v) h = std::max(h, d.dot(p));
    return h;
  }
};

inline BruteCore<2> bruteCore(const ShapeView<2>& s, const Pose<2>& X) {
  BruteCore<2> c;
  if (s.kind == ShapeKind::polytope) {
    c.v = s.hull->vertices;
  } else if (s.kind == ShapeKind::box) {
    const Real x = s.half[0], y = s.half[1];
    c.v = {{-x, -y}, {x, -y}, {x, y}, {-x, y}};
  } else if (s.kind == ShapeKind::sphere) {
    c.v = {{0, 0}};
  } else {
    c.v = {{-s.half[0], 0}, {s.half[0], 0}};
  }
  for (Vec<2>& p : c.v) p = X * p;
  const int n = static_cast<int>(c.v.size());
  c.solid = n > 2;
  for (int i = 0; i < n; ++i) {
    const int k = (i + 1) % n;
    c.edges.push_back({i, k});
    const Vec<2> e = c.v[static_cast<std::size_t>(k)] - c.v[static_cast<std::size_t>(i)];
    if (e.norm() > 0) c.normals.push_back(Vec<2>(e[1], -e[0]).normalized());
  }
  return c;
}

inline BruteCore<3> bruteCore(const ShapeView<3>& s, const Pose<3>& X) {
  BruteCore<3> c;
  if (s.kind == ShapeKind::polytope) {
    c.v = s.hull->vertices;
    for (const auto& f : s.hull->faces) {
      c.faces.emplace_back(s.hull->loop.begin() + f.begin, s.hull->loop.begin() + f.end);
      c.normals.push_back(X.q * f.normal);
    }
    for (const auto& e : s.hull->edges) c.edges.push_back({e.v0, e.v1});
  } else if (s.kind == ShapeKind::box) {
    for (int i = 0; i < 8; ++i) {
      c.v.push_back(Vec<3>(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1).cwiseProduct(s.half));
      for (int bit : {1, 2, 4}) {
        if (!(i & bit)) c.edges.push_back({i, i | bit});
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int bit = 1 << axis, p = 1 << (axis + 1) % 3, q = 1 << (axis + 2) % 3;
      for (int side : {0, bit}) {
        c.faces.push_back({side, side | p, side | p | q, side | q});
        c.normals.push_back(X.q * Vec<3>((side ? 1 : -1) * Vec<3>::Unit(axis)));
      }
    }
  } else if (s.kind == ShapeKind::sphere) {
    c.v = {Vec<3>::Zero()};
    c.edges = {{0, 0}};
  } else {
    c.v = {-s.half[0] * Vec<3>::Unit(0), s.half[0] * Vec<3>::Unit(0)};
    c.edges = {{0, 1}};
  }
  c.solid = !c.faces.empty();
  for (Vec<3>& p : c.v) p = X * p;
  return c;
}

/// -h_A(n) - h_B(-n): the separation along n, unit. Never more than the signed distance.
template <int D>
Real separationAlong(const BruteCore<D>& a, const BruteCore<D>& b, const Vec<D>& n) {
  return -a.support(n) - b.support(-n);
}

template <int D>
Real segmentDistance(const Vec<D>& a0, const Vec<D>& a1, const Vec<D>& b0, const Vec<D>& b1) {
  const auto toSegment = [](const Vec<D>& p, const Vec<D>& q0, const Vec<D>& q1) {
    const Vec<D> d = q1 - q0;
    const Real t = d.squaredNorm() > 0 ? std::clamp((p - q0).dot(d) / d.squaredNorm(), Real(0), Real(1)) : Real(0);
    return (p - q0 - t * d).norm();
  };
  Real best = std::min({toSegment(a0, b0, b1), toSegment(a1, b0, b1), toSegment(b0, a0, a1), toSegment(b1, a0, a1)});
  const Vec<D> u = a1 - a0, w = b1 - b0, r = a0 - b0;
  if constexpr (D == 2) {
    const auto side = [](const Vec<2>& p, const Vec<2>& q, const Vec<2>& v) {
      return (q[0] - p[0]) * (v[1] - p[1]) - (q[1] - p[1]) * (v[0] - p[0]);
    };
    const bool crossing = side(a0, a1, b0) * side(a0, a1, b1) < 0 && side(b0, b1, a0) * side(b0, b1, a1) < 0;
    return crossing ? Real(0) : best;
  } else {
    const Real det = u.squaredNorm() * w.squaredNorm() - u.dot(w) * u.dot(w);
    if (!(det > 0)) return best;
    // The feet of the lines, when both are inside. Projected once more each: of nearly parallel lines the determinant
    // has few digits, the distance at a foot has all.
    const auto inside = [](Real x) { return std::clamp(x, Real(0), Real(1)); };
    Real s = inside((u.dot(w) * w.dot(r) - w.squaredNorm() * u.dot(r)) / det);
    const Real t = inside(w.dot(r + s * u) / w.squaredNorm());
    s = inside(u.dot(t * w - r) / u.squaredNorm());
    return std::min(best, (r + s * u - t * w).norm());
  }
}

/// Distance of the cores' boundaries where no core is inside the other.
template <int D>
Real featureDistance(const BruteCore<D>& a, const BruteCore<D>& b) {
  const auto at = [](const BruteCore<D>& c, int i) -> const Vec<D>& { return c.v[static_cast<std::size_t>(i)]; };
  Real best = std::numeric_limits<Real>::infinity();
  for (const auto& e : a.edges) {
    for (const auto& f : b.edges) {
      best = std::min(best, segmentDistance<D>(at(a, e[0]), at(a, e[1]), at(b, f[0]), at(b, f[1])));
    }
  }
  if constexpr (D == 3) {
    const auto facesAgainstVertices = [&](const BruteCore<3>& c, const BruteCore<3>& other) {
      for (std::size_t f = 0; f < c.faces.size(); ++f) {
        for (const Vec<3>& p : other.v) {
          const Real height = c.normals[f].dot(p - at(c, c.faces[f][0]));
          bool left = true, right = true;
          for (std::size_t k = 0; k < c.faces[f].size(); ++k) {
            const Vec<3>&q0 = at(c, c.faces[f][k]), &q1 = at(c, c.faces[f][(k + 1) % c.faces[f].size()]);
            const Real side = (q1 - q0).cross(c.normals[f]).dot(p - q0);
            left = left && side <= 0, right = right && side >= 0;
          }
          if (left || right) best = std::min(best, std::abs(height));
        }
      }
    };
    facesAgainstVertices(a, b), facesAgainstVertices(b, a);
  }
  return best;
}

/// Signed distance of the cores (m).
template <int D>
Real bruteCoreDistance(const BruteCore<D>& a, const BruteCore<D>& b) {
  Real best = -std::numeric_limits<Real>::infinity();
  const auto offer = [&](const Vec<D>& n) { best = std::max(best, separationAlong<D>(a, b, n)); };
  for (const Vec<D>& n : a.normals) offer(n);
  for (const Vec<D>& n : b.normals) offer(-n);
  if (!a.solid && !b.solid) {
    // Crossing segments have a depth in 2D: their Minkowski difference is a parallelogram.
    const Real apart = featureDistance(a, b);
    Real noise = 0;
    for (const BruteCore<D>* c : {&a, &b}) {
      for (const Vec<D>& p : c->v) noise = std::max(noise, 256 * std::numeric_limits<Real>::epsilon() * p.norm());
    }
    return D == 3 || apart > noise || a.normals.empty() || b.normals.empty() ? apart : std::min(best, apart);
  }
  if constexpr (D == 3) {
    for (const auto& e : a.edges) {
      for (const auto& f : b.edges) {
        const Vec<3> u = (a.v[static_cast<std::size_t>(e[1])] - a.v[static_cast<std::size_t>(e[0])]).normalized();
        const Vec<3> w = (b.v[static_cast<std::size_t>(f[1])] - b.v[static_cast<std::size_t>(f[0])]).normalized();
        const Vec<3> n = u.cross(w);
        if (!(n.norm() > 0)) continue;
        offer(n.normalized()), offer(-n.normalized());
      }
    }
  }
  return best > 0 ? featureDistance(a, b) : best;
}

/// Signed distance of the shapes (m).
template <int D>
Real bruteDistance(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB) {
  // In A's frame: digits would be lost far from the origin.
  const Pose<D> X_AB{X_WA.q.inverse() * Vec<D>(X_WB.p - X_WA.p), X_WA.q.inverse() * X_WB.q};
  return bruteCoreDistance<D>(bruteCore(a, Pose<D>{}), bruteCore(b, X_AB)) - a.radius - b.radius;
}

}  // namespace lpc::inline LPC_PRECISION::test
