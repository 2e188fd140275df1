// SPDX-License-Identifier: Zlib
#pragma once

#include <cstring>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

/// A 2D vector in one register. A Vec<2> goes through memory: writing two numbers and reading them as one packet
/// stalls, and so does copying a struct of two numbers. Sums and products round each number separately, so the bits are
/// those of Vec<2>.
class Xy {
 public:
  Xy() = default;
  Xy(Real x, Real y) : m_v{x, y} {}
  Xy(const Vec<2>& v) : m_v(load(v.data())) {}
  /// Cosine and sine.
  explicit Xy(const Rot<2>& q) : m_v{q.c, q.s} {}

  Real x() const { return m_v[0]; }
  Real y() const { return m_v[1]; }
  /// A quarter turn to the left.
  Xy left() const { return {-m_v[1], m_v[0]}; }
  void to(Vec<2>& v) const { store(m_v, v.data()); }
  void to(Rot<2>& q) const { store(m_v, &q.c); }

  // Friends, which hide no operators of Vec<2>.
  friend Xy operator+(const Xy& a, const Xy& b) { return Xy(a.m_v + b.m_v); }
  friend Xy operator-(const Xy& a, const Xy& b) { return Xy(a.m_v - b.m_v); }
  friend Xy operator-(const Xy& a) { return Xy(-a.m_v); }
  friend Xy operator*(Real s, const Xy& a) { return Xy(Two{s, s} * a.m_v); }
  friend Xy operator/(const Xy& a, Real s) { return Xy(a.m_v / Two{s, s}); }
  /// Component-wise product.
  friend Xy product(const Xy& a, const Xy& b) { return Xy(a.m_v * b.m_v); }
  friend Real dot(const Xy& a, const Xy& b) {
    const Two products = a.m_v * b.m_v;
    return products[0] + products[1];
  }
  /// Rotates by q, and by its inverse.
  friend Xy turned(const Rot<2>& q, const Xy& a) { return Xy(Two{q.c, q.c} * a.m_v + Two{-q.s, q.s} * a.crossed()); }
  friend Xy turnedBack(const Rot<2>& q, const Xy& a) {
    return Xy(Two{q.c, q.c} * a.m_v + Two{q.s, -q.s} * a.crossed());
  }
  friend Xy placed(const Pose<2>& X, const Xy& a) { return Xy(X.p) + turned(X.q, a); }

 private:
  typedef Real Two __attribute__((vector_size(2 * sizeof(Real))));  // of g++ and clang++: two lanes that SSE2 has, too
  explicit Xy(Two v) : m_v(v) {}
  static Two load(const Real* from) {
    Two v;
    std::memcpy(&v, from, sizeof(v));
    return v;
  }
  static void store(Two v, Real* to) { std::memcpy(to, &v, sizeof(v)); }
  Two crossed() const { return Two{m_v[1], m_v[0]}; }

  Two m_v;
};

// Also accepts Vec<2>.
Real dot(const Xy& a, const Xy& b);
Xy turned(const Rot<2>& q, const Xy& a);
Xy turnedBack(const Rot<2>& q, const Xy& a);
Xy placed(const Pose<2>& X, const Xy& a);

}}}  // namespace lpc::LPC_PRECISION::contacts
