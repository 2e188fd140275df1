// SPDX-License-Identifier: Zlib
// M3 to M7: properties of the support function, on which GJK, EPA, MPR and the certificates rely.
#include "framework/shape/support_map.h"

#include <gtest/gtest.h>

#include "tests/check_property.h"
#include "tests/generators.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace support_map_test { namespace {

// Points that span the shape's core.
template <int D>
std::vector<Vec<D>> corners(const ShapeView<D>& s) {
  if (s.hull) return s.hull->vertices;
  std::vector<Vec<D>> out;
  for (int bits = 0; bits < 1 << D; ++bits) {
    Vec<D> p;
    for (int k = 0; k < D; ++k) p[k] = (bits >> k) & 1 ? s.half[k] : -s.half[k];
    out.push_back(p);
  }
  return out;
}

template <int D, class Support>
void extreme(Support support) {  // M3
  const Shape<D> s = *shapes<D>();
  const Vec<D> d = *directions<D>();
  const Vec<D> best = support(s.view(), d);
  bool own = false;
  for (const Vec<D>& p : corners(s.view())) {
    RC_ASSERT(p.dot(d) <= best.dot(d) + 4 * kEps * sizeOf(s));
    own = own || (p - best).norm() <= 4 * kEps * sizeOf(s);
  }
  RC_ASSERT(own);  // and it is a point of the core
}
template <int D>
void m3() {
  check(
      "M3", [] { extreme<D>([](auto& s, auto& d) { return coreSupport(s, d); }); }, 300);
  expectFalsified(
      "M3 of a climber that stops at the first vertex that is no better",
      [] {
        extreme<D>([](const ShapeView<D>& s, const Vec<D>& d) {
          if (!s.hull) return coreSupport(s, d);
          std::size_t i = 0;
          const auto& v = s.hull->vertices;
          while (i + 1 < v.size() && v[i + 1].dot(d) > v[i].dot(d)) ++i;
          return v[i];
        });
      },
      300);
}
TEST(SupportMap, Extreme) { m3<2>(), m3<3>(); }

template <int D>
using Support = Vec<D> (*)(const ShapeView<D>&, const Vec<D>&);
template <int D>
Vec<D> right(const ShapeView<D>& s, const Vec<D>& d) {
  return coreSupport(s, d);
}

template <int D>
void anyLength(Support<D> support) {  // M4
  const Shape<D> s = *shapes<D>();
  const Vec<D> d = *directions<D>();
  const int far = sizeof(Real) == 8 ? 150 : 15;
  for (const Real k : {Real(std::pow(10, -far)), Real(0.5), Real(std::pow(10, far))}) {
    const Vec<D> other = support(s.view(), Vec<D>(k * d));
    RC_ASSERT(std::abs(other.dot(d) - support(s.view(), d).dot(d)) <= 4 * kEps * sizeOf(s));
  }
  const Real h = supportValue(s.view(), d);
  RC_ASSERT(std::abs(supportValue(s.view(), Vec<D>(4 * d)) - 4 * h) <= 16 * kEps * sizeOf(s));
}
template <int D>
void noDirection(Support<D> support) {  // M5
  const Shape<D> s = *shapes<D>();
  RC_ASSERT(support(s.view(), Vec<D>(Vec<D>::Zero())).allFinite());
  RC_ASSERT(supportValue(s.view(), Vec<D>(Vec<D>::Zero())) == 0);
}
template <int D>
void lengths() {
  check("M4", [] { anyLength<D>(right<D>); });
  expectFalsified("M4 of a support that takes short directions for none", [] {
    anyLength<D>([](const ShapeView<D>& s, const Vec<D>& d) {
      return coreSupport(s, d.norm() < Real(1e-9) ? Vec<D>(Vec<D>::Unit(0)) : d);
    });
  });
  check("M5", [] { noDirection<D>(right<D>); });
  expectFalsified("M5 of a support that makes the direction unit", [] {
    noDirection<D>([](const ShapeView<D>& s, const Vec<D>& d) { return Vec<D>(coreSupport(s, d) + 0 * d / d.norm()); });
  });
}
TEST(SupportMap, AnyLength) { lengths<2>(), lengths<3>(); }

// M6: the posed shape's support agrees with its points.
template <int D>
void posed(Vec<D> (*local)(const Pose<D>&, const Vec<D>&)) {
  const Shape<D> s = *shapes<D>();
  const auto X = *poses<D>(3);
  const Vec<D> d = *directions<D>();
  const Real h = X.p.dot(d) + supportValue(s.view(), local(X, d));
  Real best = -std::numeric_limits<Real>::infinity();
  for (const Vec<D>& p : corners(s.view())) best = std::max(best, (X * p).dot(d) + s.view().radius);
  RC_ASSERT(std::abs(h - best) <= 16 * kEps * (sizeOf(s) + X.p.norm()));
}
// M7: supports of a Minkowski sum add up.
template <int D>
void sumOf(Support<D> support) {
  RapidCheckDraw draw;
  const Shape<D> a = Shape<D>::polytope(drawPoints<D>(draw)), b = Shape<D>::polytope(drawPoints<D>(draw));
  const Vec<D> d = *directions<D>();
  Real sum = -std::numeric_limits<Real>::infinity();
  for (const Vec<D>& p : a.view().hull->vertices) {
    for (const Vec<D>& q : b.view().hull->vertices) sum = std::max(sum, (p + q).dot(d));
  }
  const Vec<D> p = coreSupport(a.view(), d) + support(b.view(), d);
  RC_ASSERT(std::abs(sum - p.dot(d)) <= 32 * kEps * 10);
}
template <int D>
void posesAndSums() {
  check("M6", [] { posed<D>([](const Pose<D>& X, const Vec<D>& d) { return Vec<D>(X.q.inverse() * d); }); });
  expectFalsified("M6 with the direction turned the wrong way",
                  [] { posed<D>([](const Pose<D>& X, const Vec<D>& d) { return Vec<D>(X.q * d); }); });
  check("M7", [] { sumOf<D>(right<D>); });
  expectFalsified("M7 of a difference taken for a sum", [] {
    sumOf<D>([](const ShapeView<D>& s, const Vec<D>& d) { return Vec<D>(-coreSupport(s, Vec<D>(-d))); });
  });
}
TEST(SupportMap, PosesAndSums) { posesAndSums<2>(), posesAndSums<3>(); }

TEST(SupportMap, HintIsTheVertex) {
  const std::vector<Vec<2>> points = {{0, 0}, {2, 0}, {0, 1}};
  const auto s = Shape<2>::polytope(points);
  int hint = -1;
  const Vec<2> p = coreSupport(s.view(), Vec<2>(1, 0), &hint);
  EXPECT_EQ(p, s.view().hull->vertices[static_cast<std::size_t>(hint)]);
  EXPECT_EQ(p, Vec<2>(2, 0));
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::support_map_test
