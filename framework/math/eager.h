// SPDX-License-Identifier: Zlib
// Eager arithmetic of small matrices. In Eigen each sum and product returns an expression with a type of its own. Each
// file compiles these nested expressions again, which takes a sixth to a fifth of a kernel's compile time. Inside
// namespace lpc the compiler prefers these operators to Eigen's for plain matrices of fixed sizes, unless a nearer
// namespace declares operators. They compute the same values as Eigen's.
//
// A scalar factor is applied where it is written; Eigen computes s * (A * B) as (s * A) * B.
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <type_traits>

namespace lpc { inline namespace LPC_PRECISION {

template <class M>
using PlainMatrix = Eigen::Matrix<typename M::Scalar, M::RowsAtCompileTime, M::ColsAtCompileTime, M::Options>;
template <class M>
concept SmallMatrix = (M::SizeAtCompileTime > 0) && std::same_as<M, PlainMatrix<M>>;

template <class S, class M>
concept ScalarOf = std::same_as<S, typename M::Scalar> || std::integral<S>;

template <SmallMatrix M>
M operator+(const M& a, const M& b) {
  return a.operator+(b);
}

template <SmallMatrix M>
M operator-(const M& a, const M& b) {
  return a.operator-(b);
}

template <SmallMatrix M>
M operator-(const M& a) {
  return a.operator-();
}

template <SmallMatrix M, ScalarOf<M> S>
M operator*(const M& a, S s) {
  return a.operator*(static_cast<typename M::Scalar>(s));
}

template <SmallMatrix M, ScalarOf<M> S>
M operator*(S s, const M& a) {
  return a * s;
}

template <SmallMatrix M, ScalarOf<M> S>
M operator/(const M& a, S s) {
  return a.operator/(static_cast<typename M::Scalar>(s));
}

/// A plain R x C matrix with A's scalar type, aligned or not as A is.
template <class A, int R, int C>
using ProductOf = Eigen::Matrix<typename A::Scalar, R, C,
                                (int{A::Options} & int{Eigen::DontAlign}) |
                                    (R == 1 && C > 1 ? int{Eigen::RowMajor} : int{Eigen::ColMajor})>;

template <SmallMatrix A, SmallMatrix B>
ProductOf<A, A::RowsAtCompileTime, B::ColsAtCompileTime> operator*(const A& a, const B& b) {
  return a.operator*(b);
}

template <class A, SmallMatrix B>
requires SmallMatrix<std::remove_const_t<A>> ProductOf<A, A::ColsAtCompileTime, B::ColsAtCompileTime>
operator*(const Eigen::Transpose<A>& a, const B& b) { return a.nestedExpression().transpose().operator*(b); }

template <SmallMatrix A, class B>
requires SmallMatrix<std::remove_const_t<B>> ProductOf<A, A::RowsAtCompileTime, B::RowsAtCompileTime>
operator*(const A& a, const Eigen::Transpose<B>& b) { return a.operator*(b.nestedExpression().transpose()); }

}}  // namespace lpc::LPC_PRECISION
