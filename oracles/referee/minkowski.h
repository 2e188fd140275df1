// SPDX-License-Identifier: Zlib
// The Minkowski difference M = B - A of two vertex lists, and the referee's queries of it, for any number type. With
// exact integers the answers are exact and every loop provably ends. With long double they are candidates that
// certificate.cpp proves or rejects.
#pragma once

#include <utility>
#include <vector>

#include "oracles/referee/posed_core.h"

namespace lpc { inline namespace LPC_PRECISION {

inline int sign(long double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
/// num^2 / den within 1e-12; infinite or 0 when out of the range of double.
inline double squareRatio(long double num, long double den) { return static_cast<double>(num * num / den); }

template <class N, std::size_t D>
N dot(const std::array<N, D>& a, const std::array<N, D>& b) {
  N sum = a[0] * b[0];
  for (std::size_t k = 1; k < D; ++k) sum += a[k] * b[k];
  return sum;
}
template <class N, std::size_t D>
std::array<N, D> minus(const std::array<N, D>& a, const std::array<N, D>& b) {
  std::array<N, D> c;
  for (std::size_t k = 0; k < D; ++k) c[k] = a[k] - b[k];
  return c;
}
template <class N, std::size_t D>
std::array<N, D> negative(const std::array<N, D>& a) {
  std::array<N, D> c;
  for (std::size_t k = 0; k < D; ++k) c[k] = -a[k];
  return c;
}
template <class N, std::size_t D>
bool isZero(const std::array<N, D>& a) {
  for (const N& x : a) {
    if (sign(x) != 0) return false;
  }
  return true;
}
template <class N>
std::array<N, 3> crossProduct(const std::array<N, 3>& a, const std::array<N, 3>& b) {
  return {N(a[1] * b[2] - a[2] * b[1]), N(a[2] * b[0] - a[0] * b[2]), N(a[0] * b[1] - a[1] * b[0])};
}
template <class N>
N crossProduct(const std::array<N, 2>& a, const std::array<N, 2>& b) {
  return N(a[0] * b[1] - a[1] * b[0]);
}
/// Rotates clockwise by a quarter turn: for a counter-clockwise edge, the outward normal.
template <class N>
std::array<N, 2> outward(const std::array<N, 2>& edge) {
  return {edge[1], N(-edge[0])};
}

template <class N, int D>
struct Difference {
  struct Vertex {
    Point<N, D> m;  // b[ib] - a[ia]
    int ia = 0, ib = 0;
    bool same(const Vertex& v) const { return ia == v.ia && ib == v.ib; }
  };

  std::vector<Point<N, D>> a, b;

  /// Support point: a vertex of M farthest along d.
  Vertex support(const Point<N, D>& d) const {
    Vertex v;
    v.ia = extreme(a, d, -1), v.ib = extreme(b, d, 1);
    v.m = minus(b[static_cast<std::size_t>(v.ib)], a[static_cast<std::size_t>(v.ia)]);
    return v;
  }

 private:
  static int extreme(const std::vector<Point<N, D>>& points, const Point<N, D>& d, int side) {
    std::size_t best = 0;
    N most = dot(points[0], d);
    for (std::size_t i = 1; i < points.size(); ++i) {
      N value = dot(points[i], d);
      if (side > 0 ? value > most : value < most) best = i, std::swap(most, value);
    }
    return static_cast<int>(best);
  }
};

template <class N, int D>
struct Simplex {
  std::array<typename Difference<N, D>::Vertex, static_cast<std::size_t>(D) + 1> v;
  int count = 0;

  const Point<N, D>& at(int i) const { return v[static_cast<std::size_t>(i)].m; }
  void add(const typename Difference<N, D>::Vertex& w) { v[static_cast<std::size_t>(count++)] = w; }
  void keep(unsigned mask) {
    int n = 0;
    for (int i = 0; i < count; ++i) {
      if (mask >> i & 1) std::swap(v[static_cast<std::size_t>(n++)], v[static_cast<std::size_t>(i)]);
    }
    count = n;
  }
};

/// The face of a simplex that contains, in its interior, the simplex's point nearest to the origin.
template <class N, int D>
struct NearestFace {
  unsigned mask = 0;      // 0: none found, which cannot happen with exact numbers
  bool origin = false;    // the face contains the origin
  Point<N, D> direction;  // parallel to the nearest point, any positive length
};

}}  // namespace lpc::LPC_PRECISION
