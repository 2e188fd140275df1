// SPDX-License-Identifier: Zlib
// The referee in exact integers (GMP). Every coordinate of a posed core is a polynomial in doubles, so an integer times
// a power of two. All decisions are signs of polynomials in them; only the last step, a square root, is rounded, and
// outwards.
#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "oracles/referee/expansion2.h"
#include "oracles/referee/expansion3.h"
#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// A type in this namespace, for argument-dependent lookup: the searches in M call sign() and squareRatio() of their
// number type.
struct Integer {
  mpz_class z;

  Integer() = default;
  explicit Integer(double x) : z(x) {}
  explicit Integer(mpz_class x) : z(std::move(x)) {}
  Integer& operator+=(const Integer& b) {
    z += b.z;
    return *this;
  }
};
Integer operator-(const Integer& a, const Integer& b) { return Integer(mpz_class(a.z - b.z)); }
Integer operator*(const Integer& a, const Integer& b) { return Integer(mpz_class(a.z * b.z)); }
Integer operator-(const Integer& a) { return Integer(mpz_class(-a.z)); }
bool operator<(const Integer& a, const Integer& b) { return a.z < b.z; }
bool operator>(const Integer& a, const Integer& b) { return a.z > b.z; }
int sign(const Integer& a) { return sgn(a.z); }
double squareRatio(const Integer& num, const Integer& den) {
  long n = 0, d = 0;
  const double a = mpz_get_d_2exp(&n, num.z.get_mpz_t()), b = mpz_get_d_2exp(&d, den.z.get_mpz_t());
  const long e = std::clamp(2 * n - d, -4000L, 4000L);
  return std::ldexp(a * a / b, static_cast<int>(e));
}

// m * 2^e.
struct Dyadic {
  mpz_class m;
  long e = 0;

  Dyadic() = default;
  explicit Dyadic(double x) {
    int exponent = 0;
    const double significand = std::frexp(x, &exponent);
    m = std::ldexp(significand, 53);
    e = exponent - 53;
    trim();
  }
  Dyadic(mpz_class mantissa, long exponent) : m(std::move(mantissa)), e(exponent) { trim(); }

  mpz_class scaled(long exponent) const { return m << static_cast<unsigned long>(e - exponent); }  // exponent <= e

 private:
  void trim() {
    if (m == 0) {
      e = 0;
      return;
    }
    const mp_bitcnt_t zeros = mpz_scan1(m.get_mpz_t(), 0);
    m >>= zeros, e += static_cast<long>(zeros);
  }
};
Dyadic operator+(const Dyadic& a, const Dyadic& b) {
  if (a.m == 0) return b;
  if (b.m == 0) return a;
  const long e = std::min(a.e, b.e);
  return {a.scaled(e) + b.scaled(e), e};
}
Dyadic operator-(const Dyadic& a, const Dyadic& b) { return a + Dyadic(-b.m, b.e); }
Dyadic operator*(const Dyadic& a, const Dyadic& b) { return {a.m * b.m, a.e + b.e}; }

// The largest double <= x * 2^e.
double scaledDown(const mpz_class& x, long e) {
  if (x == 0) return 0;
  long exponent = 0;
  const double head = mpz_get_d_2exp(&exponent, x.get_mpz_t());  // truncated towards zero
  const auto bits = static_cast<long>(mpz_sizeinbase(x.get_mpz_t(), 2));
  const bool whole = bits - static_cast<long>(mpz_scan1(x.get_mpz_t(), 0)) <= 53;
  const long place = std::clamp(exponent + e, -5000L, 5000L);
  const double d = std::ldexp(head, static_cast<int>(place));
  const bool kept = std::ldexp(d, static_cast<int>(-place)) == head;  // true unless subnormal or infinite
  if (kept && (whole || head > 0)) return d;
  return std::nextafter(d, -std::numeric_limits<double>::infinity());
}
double scaledUp(const mpz_class& x, long e) { return -scaledDown(mpz_class(-x), e); }

template <int D>
bool isFinite(const ShapeView<D>& shape, const Pose<D>& X_WS, const std::vector<Vec<D>>& core) {
  bool finite = std::isfinite(shape.radius) && X_WS.p.allFinite() && X_WS.q.matrix().allFinite();
  for (const Vec<D>& v : core) finite = finite && v.allFinite();
  return finite;
}

// Position of M relative to the origin: phi of the cores is side * sqrt(level^2 / square) * 2^e.
struct CoreDistance {
  int side;
  mpz_class level, square;
  long e;
};

// phi = core distance - radii, rounded outwards. `radii` >= 0.
Interval subtractRadii(const CoreDistance& core, const Dyadic& radii) {
  const auto bits = [](const mpz_class& x) { return static_cast<long>(mpz_sizeinbase(x.get_mpz_t(), 2)); };
  // In units of 2^(e - k) the radii are integers and the root has about 70 bits; more when the radii cancel it.
  long k = std::max(0L, 70 - (bits(core.level) - bits(core.square) / 2));
  if (radii.m != 0) k = std::max(k, core.e - radii.e);
  mpz_class lo, hi;
  bool exact = false;
  for (;; k += 200) {
    const mpz_class target = (core.level * core.level) << static_cast<unsigned long>(2 * k);
    mpz_class quotient, rest, root, rootRest;
    mpz_fdiv_qr(quotient.get_mpz_t(), rest.get_mpz_t(), target.get_mpz_t(), core.square.get_mpz_t());
    mpz_sqrtrem(root.get_mpz_t(), rootRest.get_mpz_t(), quotient.get_mpz_t());
    exact = rest == 0 && rootRest == 0;
    lo = root, hi = exact ? root : mpz_class(root + 1);
    if (core.side < 0) std::swap(lo, hi), lo = -lo, hi = -hi;
    if (radii.m != 0) {
      const mpz_class whole = radii.scaled(core.e - k);
      lo -= whole, hi -= whole;
    }
    // An irrational root differs from the radii, so this ends; if both ends have 60 bits, they also agree on the sign.
    if (exact || (bits(lo) >= 60 && bits(hi) >= 60)) break;
  }
  return {scaledDown(lo, core.e - k), scaledUp(hi, core.e - k)};
}

template <int D>
Vecd<D> unit(const Point<Integer, D>& d) {
  std::array<double, static_cast<std::size_t>(D)> head;
  std::array<long, static_cast<std::size_t>(D)> exponent;
  long top = std::numeric_limits<long>::min();
  for (std::size_t k = 0; k < D; ++k) {
    head[k] = mpz_get_d_2exp(&exponent[k], d[k].z.get_mpz_t());
    if (head[k] != 0) top = std::max(top, exponent[k]);
  }
  Vecd<D> n;
  for (std::size_t k = 0; k < D; ++k) {
    const long shift = head[k] == 0 ? 0 : std::max(exponent[k] - top, -2000L);
    n[static_cast<int>(k)] = std::ldexp(head[k], static_cast<int>(shift));
  }
  return n.normalized();
}

}  // namespace

template <int D>
RefereeAnswer<D> refereeExactly(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b,
                                const Pose<D>& X_WB) {
  RefereeAnswer<D> answer;
  if (!hasVertices(a) || !hasVertices(b)) return answer;
  std::vector<Vec<D>> coreA, coreB;
  coreVertices(a, coreA);
  coreVertices(b, coreB);
  if (!isFinite(a, X_WA, coreA) || !isFinite(b, X_WB, coreB)) return answer;

  std::vector<Point<Dyadic, D>> posedA, posedB;
  poseVertices<Dyadic, D>(coreA, X_WA, posedA);
  poseVertices<Dyadic, D>(coreB, X_WB, posedB);
  long e = std::numeric_limits<long>::max();
  for (const auto* posed : {&posedA, &posedB}) {
    for (const auto& point : *posed) {
      for (const Dyadic& x : point) e = x.m == 0 ? e : std::min(e, x.e);
    }
  }
  Difference<Integer, D> m;
  const auto align = [&](const std::vector<Point<Dyadic, D>>& posed, std::vector<Point<Integer, D>>& out) {
    for (const auto& point : posed) {
      Point<Integer, D> p;
      for (std::size_t k = 0; k < D; ++k) p[k] = Integer(point[k].m == 0 ? mpz_class(0) : point[k].scaled(e));
      out.push_back(std::move(p));
    }
  };
  align(posedA, m.a), align(posedB, m.b);
  if (e == std::numeric_limits<long>::max()) e = 0;  // both cores are the origin

  constexpr int kUnlimited = std::numeric_limits<int>::max();
  Simplex<Integer, D> simplex;
  SearchEnd<Integer, D> end = walkToOrigin(m, simplex, kUnlimited);
  const bool apart = end.kind == end.separated;
  if (end.kind == end.inside) end = completeSimplex(m, simplex);
  if (end.kind == end.inside) {
    InnerPolytope<Integer, D> polytope;
    end = expand(m, simplex, polytope, kUnlimited);
  }
  if (end.kind == end.gaveUp) return answer;

  CoreDistance core{apart ? 1 : -1, dot(end.direction, end.on).z, dot(end.direction, end.direction).z, e};
  const Dyadic radii = Dyadic(static_cast<double>(a.radius)) + Dyadic(static_cast<double>(b.radius));
  const Interval phi = subtractRadii(core, radii);
  answer.decided = true, answer.method = "exact";
  answer.lo = phi.lo, answer.hi = phi.hi;
  answer.normal = (apart ? 1.0 : -1.0) * unit<D>(end.direction);
  return answer;
}

template RefereeAnswer<2> refereeExactly(const ShapeView<2>&, const Pose<2>&, const ShapeView<2>&, const Pose<2>&);
template RefereeAnswer<3> refereeExactly(const ShapeView<3>&, const Pose<3>&, const ShapeView<3>&, const Pose<3>&);

}}  // namespace lpc::LPC_PRECISION
