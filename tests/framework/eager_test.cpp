// SPDX-License-Identifier: Zlib
// Sums and products of small matrices return plain matrices, equal to the last bit to Eigen's own operators. These
// return expressions and are still available as members.
#include "framework/math/eager.h"

#include <gtest/gtest.h>

#include "framework/math/space.h"
#include "tests/check_property.h"
#include "tests/generators.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace eager_test { namespace {

template <int R, int C = 1>
RealMatrix<R, C> drawn(RapidCheckDraw& draw) {
  RealMatrix<R, C> m;
  for (int i = 0; i < R * C; ++i) m.data()[i] = draw.signedUnit() * draw.pick({Real(1e-3), Real(1), Real(1e3)});
  return m;
}

template <class M, class Ours, class Eigens>
void same(const Ours& ours, const Eigens& eigens) {
  static_assert(std::same_as<Ours, M>, "an expression, not a matrix");
  RC_ASSERT((ours.array() == eigens.eval().array()).all());
}

template <int R, int K, int C>
void plain() {
  RapidCheckDraw draw;
  const RealMatrix<R, K> a = drawn<R, K>(draw), b = drawn<R, K>(draw);
  const RealMatrix<K, C> c = drawn<K, C>(draw);
  const RealMatrix<K, R> d = drawn<K, R>(draw);
  const Real s = draw.signedUnit();
  same<RealMatrix<R, K>>(a + b, a.operator+(b));
  same<RealMatrix<R, K>>(a - b, a.operator-(b));
  same<RealMatrix<R, K>>(-a, a.operator-());
  same<RealMatrix<R, K>>(s * a, a.operator*(s));
  same<RealMatrix<R, K>>(a * 3, a.operator*(Real(3)));
  same<RealMatrix<R, K>>(a / (s + 2), a.operator/(s + 2));
  same<RealMatrix<R, C>>(a * c, a.operator*(c));
  same<RealMatrix<R, C>>(d.transpose() * c, d.transpose().operator*(c));
  same<RealMatrix<R, R>>(a * b.transpose(), a.operator*(b.transpose()));
  // Nested expressions, against one expression of Eigen. (Eigen computes s * (A * B) as (s * A) * B, which may differ.)
  same<RealMatrix<R, K>>((a + s * b) / (s + 2) - b, (a.operator+(b.operator*(s))).operator/(s + 2).operator-(b));
  same<RealMatrix<R, C>>(-(a - b) * c, a.operator-(b).operator-().operator*(c));
  same<RealMatrix<R, C>>(a * (s * c), a.operator*(c.operator*(s)));
  same<RealMatrix<R, R>>(a * (s * b).transpose(), a.operator*(b.operator*(s).transpose()));
}
TEST(Eager, PlainMatricesAsEigenSays) {
  check("columns", [] { plain<1, 1, 1>(), plain<2, 2, 1>(), plain<3, 2, 1>(), plain<3, 3, 1>(); });
  check("squares", [] { plain<2, 2, 2>(), plain<3, 3, 3>(), plain<2, 3, 2>(), plain<3, 2, 3>(); });
  expectFalsified("columns added in another order", [] {
    RapidCheckDraw draw;
    const Mat<3> a = drawn<3, 3>(draw);
    const Vec<3> b = drawn<3>(draw);
    const Vec<3> other = (a.col(0) * b[0] + a.col(2) * b[2]) + a.col(1) * b[1];
    same<Vec<3>>(other, a.operator*(b));
  });
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::eager_test
