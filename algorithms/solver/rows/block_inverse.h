// SPDX-License-Identifier: Zlib
#pragma once

#include <array>
#include <limits>

#include "framework/math/indexed.h"
#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// Inverse of the response K of up to 6 rows that are solved together: impulses per change of velocity.
template <int D>
class BlockInverse {
 public:
  static constexpr int kRows = 6;

  /// `k(i, j)` is the velocity of row i per impulse along row j. K is symmetric, and positive definite except for rows
  /// that nothing can move, which get no impulse. With `solvable` false, K may be singular in any direction.
  template <class K>
  void set(int n, const K& k, bool solvable) {
    m_sized = n == D && solvable;
    if (n == D) {
      Mat<D> m;
      for (int i = 0; i < D; ++i) {
        for (int j = 0; j < D; ++j) m(i, j) = k(i, j);
      }
      const Real trace = m.trace();
      for (int i = 0; i < D; ++i) m_sized = m_sized && m(i, i) > trace * std::numeric_limits<Real>::epsilon();
      if (m_sized) {
        m_point = m.inverse();
        return;
      }
      if (!solvable) {
        m_sized = true;
        m_point = trace > 0 ? Mat<D>(Mat<D>::Identity() / trace) : Mat<D>(Mat<D>::Zero());
        return;
      }
    }
    if (solvable) return factor(n, k);
    // Two pinned bodies can only turn: K is singular, and its inverse would give infinite impulses along the immovable
    // direction. A gradient step is slow but safe.
    Real trace = 0;
    for (int i = 0; i < n; ++i) trace += k(i, i);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) at(i, j) = i == j && trace > 0 ? 1 / trace : Real(0);
    }
  }

  /// out = scale * K^-1 v
  void multiply(int n, Real scale, const Real* v, Real* out) const {
    if (m_sized) {
      const Vec<D> x = (scale * m_point) * Vec<D>(Eigen::Map<const Vec<D>>(v));
      for (int i = 0; i < D; ++i) out[i] = x[i];
      return;
    }
    for (int i = 0; i < n; ++i) {
      out[i] = 0;
      for (int j = 0; j < n; ++j) out[i] += m_inverse[kRows * i + j] * v[j];
      out[i] *= scale;
    }
  }

 private:
  Real& at(int i, int j) { return m_inverse[kRows * i + j]; }

  // K = L d L^T without square roots, then each column of the inverse. A row that depends on earlier rows, or that
  // nothing can move, is omitted: the earlier rows satisfy it, or it cannot be satisfied.
  template <class K>
  void factor(int n, const K& k) {
    IndexedArray<IndexedArray<Real, kRows>, kRows> l{};
    IndexedArray<Real, kRows> inverse{};  // of d; 0 for an omitted row
    for (int i = 0; i < n; ++i) {
      auto& row = l[i];
      const Real own = k(i, i);
      Real d = own;
      for (int j = 0; j < i; ++j) {
        const auto& other = l[j];
        Real x = k(i, j);
        for (int m = 0; m < j; ++m) {
          if (inverse[m] > 0) x -= row[m] * other[m] / inverse[m];
        }
        row[j] = x * inverse[j];
        d -= row[j] * x;
      }
      const bool independent = d > own * 64 * std::numeric_limits<Real>::epsilon();
      inverse[i] = independent ? 1 / d : Real(0);
    }
    for (int c = 0; c < n; ++c) {
      IndexedArray<Real, kRows> x{};
      for (int i = 0; i < n; ++i) {  // L y = e_c, over the rows that are kept
        if (!(inverse[i] > 0)) continue;
        x[i] = i == c ? 1 : 0;
        for (int j = 0; j < i; ++j) x[i] -= l[i][j] * x[j];
      }
      for (int i = n; i-- > 0;) {  // L^T z = d^-1 y
        x[i] *= inverse[i];
        if (!(inverse[i] > 0)) continue;
        for (int j = i + 1; j < n; ++j) x[i] -= l[j][i] * x[j];
      }
      for (int i = 0; i < n; ++i) at(i, c) = x[i];
    }
  }

  bool m_sized = false;  // for D rows: m_point, as a matrix of fixed size
  Mat<D> m_point;
  IndexedArray<Real, kRows * kRows> m_inverse;
};

}}}  // namespace lpc::LPC_PRECISION::solver
