// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace lpc {

/// A real number known as v +- e, where e is never too small: a running error bound (Higham, Accuracy and Stability,
/// 3.3) on 64-bit significands. Cheaper than switching rounding modes. Valid because no operation here can underflow:
/// products of a few doubles stay far above the smallest long double.
struct Bounded {
  static_assert(std::numeric_limits<long double>::digits >= 64, "the bounds assume long double beyond double");

  long double v = 0, e = 0;

  Bounded() = default;
  Bounded(double x) : v(x) {}
  static Bounded make(long double value, long double error) {
    Bounded r;
    // kUlp covers the rounding of `value`, the factor that of the error's own computation.
    r.v = value, r.e = (error + kUlp * std::abs(value)) * (1 + 16 * kUlp);
    return r;
  }

  long double lo() const { return v - e - kUlp * std::abs(v); }
  long double hi() const { return v + e + kUlp * std::abs(v); }

  static constexpr long double kUlp = std::numeric_limits<long double>::epsilon();
};

inline Bounded operator-(const Bounded& a) {
  Bounded r = a;
  r.v = -a.v;
  return r;
}
inline Bounded operator+(const Bounded& a, const Bounded& b) { return Bounded::make(a.v + b.v, a.e + b.e); }
inline Bounded operator-(const Bounded& a, const Bounded& b) { return Bounded::make(a.v - b.v, a.e + b.e); }
inline Bounded operator*(const Bounded& a, const Bounded& b) {
  return Bounded::make(a.v * b.v, std::abs(a.v) * b.e + std::abs(b.v) * a.e + a.e * b.e);
}
/// Infinite error when the divisor may be zero.
inline Bounded operator/(const Bounded& a, const Bounded& b) {
  const long double divisor = std::abs(b.v) - b.e, q = a.v / b.v;
  if (!(divisor > 0)) return Bounded::make(0, std::numeric_limits<long double>::infinity());
  return Bounded::make(q, (a.e + std::abs(q) * b.e) / divisor);
}
/// Precondition: the number is not negative (its bounds may reach below zero).
inline Bounded sqrt(const Bounded& a) {
  const long double top = std::sqrt(std::max(a.hi(), 0.0L)), bottom = std::sqrt(std::max(a.lo(), 0.0L));
  return Bounded::make((top + bottom) / 2, (top - bottom) / 2 + 2 * Bounded::kUlp * top);
}
inline Bounded lesser(const Bounded& a, const Bounded& b) {
  const long double lo = std::min(a.lo(), b.lo()), hi = std::min(a.hi(), b.hi());
  return Bounded::make((lo + hi) / 2, (hi - lo) / 2 + Bounded::kUlp * std::abs(lo));
}

/// The nearest double that is not above x.
inline double roundDown(long double x) {
  const double d = static_cast<double>(x);
  return static_cast<long double>(d) <= x ? d : std::nextafter(d, -std::numeric_limits<double>::infinity());
}
inline double roundUp(long double x) { return -roundDown(-x); }

}  // namespace lpc
