// SPDX-License-Identifier: Zlib
// Three numbers in registers, for the inner loops of 3D searches. Eigen reads a vector of doubles as a pair and a
// single number. After the three were written one by one, as by a cross product, that read waits for the store (no
// store forwarding), which took half of the time of a polytope's face. The bits are the same as Eigen's.
#pragma once

#include "algorithms/pair_query/core/core_pair.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

struct Triple {
  Real x = 0, y = 0, z = 0;

  Triple() = default;
  Triple(Real first, Real second, Real third) : x(first), y(second), z(third) {}
  explicit Triple(const Vec<3>& v) : x(v[0]), y(v[1]), z(v[2]) {}
  Vec<3> vector() const { return {x, y, z}; }
  Real operator[](int k) const { return k == 0 ? x : k == 1 ? y : z; }
  /// One by one, as they are.
  void store(Vec<3>& v) const { v[0] = x, v[1] = y, v[2] = z; }
};

inline Triple operator+(const Triple& a, const Triple& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Triple operator-(const Triple& a, const Triple& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Triple operator-(const Triple& a) { return {-a.x, -a.y, -a.z}; }
inline Triple operator*(Real s, const Triple& a) { return {s * a.x, s * a.y, s * a.z}; }

inline Real dot(const Triple& a, const Triple& b) {
  const Real x = a.x * b.x, y = a.y * b.y, z = a.z * b.z;
  return sizeof(Real) == 8 ? (x + y) + z : x + (y + z);
}
using lpc::cross;  // of Eigen's vectors: not hidden by this one
inline Triple cross(const Triple& a, const Triple& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Real norm(const Triple& a) { return std::sqrt(dot(a, a)); }
/// |x| + |y| + |z|.
inline Real sumOfSizes(const Triple& a) {
  const Real x = std::abs(a.x), y = std::abs(a.y), z = std::abs(a.z);
  return sizeof(Real) == 8 ? (x + y) + z : x + (y + z);
}
inline Triple operator*(const Rot<3>& q, const Triple& v) {
  const Triple u(q.x, q.y, q.z), t = Real(2) * cross(u, v);
  return v + q.w * t + cross(u, t);
}

/// Like the function for Vec.
inline void removeAlong(Triple& n, const Triple& e) {
  n = n - dot(n, e) * e;
  n = n - dot(n, e) * e;
}
/// a . b of vectors that may just have been written.
template <int D>
Real along(const Vec<D>& a, const Vec<D>& b) {
  if constexpr (D == 3) {
    return dot(Triple(a), Triple(b));
  } else {
    return a.dot(b);
  }
}

/// Like the function for Vec.
inline bool makeUnit(Triple& v) {
  Real square = dot(v, v);
  if (!(square > kSafeSquare && square < 1 / kSafeSquare)) [[unlikely]] {
    Vec<3> far = v.vector();
    if (!makeUnit<3>(far)) return false;
    v = Triple(far);
    return true;
  }
  const Real length = std::sqrt(square);
  v = {v.x / length, v.y / length, v.z / length};
  return true;
}

}}}  // namespace lpc::LPC_PRECISION::pair_query
