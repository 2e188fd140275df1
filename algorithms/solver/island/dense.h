// SPDX-License-Identifier: Zlib
// Dense linear systems, row by row. Eigen's factorisations of matrices of any size allocate, and sum in an order that
// depends on the width of the registers. Here every sum has one fixed order, and arrays keep their capacity. Zeros
// beyond the last entry of a row stay zero and are skipped: a contact couples with its neighbours only.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// Writes, for each row, one past its last entry that is not zero.
inline void rowEnds(std::size_t n, const std::vector<double>& a, std::vector<std::size_t>& out) {
  out.assign(n, n);
  for (std::size_t i = 0; i < n; ++i) {
    while (out[i] > 0 && !(a[i * n + out[i] - 1] != 0)) --out[i];
  }
}

/// A = L D L^T of a symmetric matrix that is positive definite except for rounding. A row that depends on earlier rows
/// is omitted: they satisfy it, or it cannot be satisfied.
class SymmetricFactor {
 public:
  std::uint64_t multiplyAdds = 0;  // of the last factorisation

  /// `a` is n x n; entries below its diagonal are not read.
  void factor(std::size_t n, const std::vector<double>& a) {
    m_n = n, m_u = a, m_inverse.assign(n, 0);
    rowEnds(n, m_u, m_end);
    multiplyAdds = n;
    for (std::size_t j = 0; j < n; ++j) {
      const double* const row = m_u.data() + j * n;
      const std::size_t end = m_end[j];
      const double pivot = row[j];
      if (!(pivot > kDependent * a[j * n + j])) continue;
      m_inverse[j] = 1 / pivot;
      for (std::size_t i = j + 1; i < end; ++i) {
        const double share = row[i] / pivot;
        if (!(share != 0)) continue;
        double* const to = m_u.data() + i * n;
        for (std::size_t k = i; k < end; ++k) to[k] -= share * row[k];
        multiplyAdds += end - i + 1;
        m_end[i] = std::max(m_end[i], end);
      }
    }
  }
  std::uint64_t multiplyAddsOfSolve() const {
    std::uint64_t sum = 0;
    for (std::size_t j = 0; j < m_n; ++j) sum += 2 * (m_end[j] - std::min(m_end[j], j));
    return sum;
  }
  /// Replaces x by A^-1 x.
  void solve(double* x) const {
    for (std::size_t j = 0; j < m_n; ++j) {
      const double* const row = m_u.data() + j * m_n;
      x[j] *= m_inverse[j];
      if (!(x[j] != 0)) continue;
      for (std::size_t k = j + 1; k < m_end[j]; ++k) x[k] -= row[k] * x[j];
    }
    for (std::size_t j = m_n; j-- > 0;) {
      if (!(m_inverse[j] > 0)) continue;
      const double* const row = m_u.data() + j * m_n;
      double sum = 0;
      for (std::size_t k = j + 1; k < m_end[j]; ++k) sum += row[k] * x[k];
      x[j] -= m_inverse[j] * sum;
    }
  }

 private:
  static constexpr double kDependent = 64 * std::numeric_limits<double>::epsilon();  // of the row's original value
  std::size_t m_n = 0;
  std::vector<double> m_u, m_inverse;  // D L^T, and 1 / D; 0 for an omitted row
  std::vector<std::size_t> m_end;      // end of each row of m_u
};

/// P A = L U of any matrix.
class GeneralFactor {
 public:
  std::uint64_t multiplyAdds = 0;  // of the last factorisation

  /// Returns false if the matrix is singular.
  bool factor(std::size_t n, const std::vector<double>& a) {
    m_n = n, m_a = a, m_from.resize(n);
    rowEnds(n, m_a, m_end);
    multiplyAdds = 0;
    for (std::size_t j = 0; j < n; ++j) {
      std::size_t best = j;
      for (std::size_t i = j + 1; i < n; ++i) {
        if (std::abs(m_a[i * n + j]) > std::abs(m_a[best * n + j])) best = i;
      }
      m_from[j] = best;
      if (!(std::abs(m_a[best * n + j]) > 0)) return false;
      if (best != j) std::swap_ranges(row(j), row(j) + n, row(best)), std::swap(m_end[j], m_end[best]);
      for (std::size_t i = j + 1; i < n; ++i) {
        const double share = row(i)[j] /= row(j)[j];
        if (!(share != 0)) continue;
        for (std::size_t k = j + 1; k < m_end[j]; ++k) row(i)[k] -= share * row(j)[k];
        multiplyAdds += m_end[j] - j;
        m_end[i] = std::max(m_end[i], m_end[j]);
      }
    }
    return true;
  }
  std::uint64_t multiplyAddsOfSolve() const {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < m_n; ++i) sum += i + m_end[i] - std::min(m_end[i], i);
    return sum;
  }
  /// Replaces x by A^-1 x.
  void solve(double* x) {
    for (std::size_t j = 0; j < m_n; ++j) std::swap(x[j], x[m_from[j]]);
    for (std::size_t i = 0; i < m_n; ++i) {
      for (std::size_t k = 0; k < i; ++k) x[i] -= row(i)[k] * x[k];
    }
    for (std::size_t i = m_n; i-- > 0;) {
      for (std::size_t k = i + 1; k < m_end[i]; ++k) x[i] -= row(i)[k] * x[k];
      x[i] /= row(i)[i];
    }
  }

 private:
  double* row(std::size_t i) { return m_a.data() + i * m_n; }
  std::size_t m_n = 0;
  std::vector<double> m_a;
  std::vector<std::size_t> m_from, m_end;
};

}}}  // namespace lpc::LPC_PRECISION::solver
