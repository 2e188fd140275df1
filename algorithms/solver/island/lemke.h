// SPDX-License-Identifier: Zlib
// Lemke's method for w = M z + q, w >= 0, z >= 0, w z = 0. Stewart and Trinkle's contact problems with friction are
// copositive, so the method ends with a solution unless rounding or the limit of pivots stops it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

class Lemke {
 public:
  enum class End { solved, noSolution, outOfPivots };

  std::uint64_t pivots = 0, multiplyAdds = 0;  // of the last solve

  /// `m` is n x n, row by row. A second right-hand side breaks ties, a lexicographic rule of one column: degenerate
  /// contacts would otherwise make the method cycle.
  End solve(std::size_t n, const std::vector<double>& m, const std::vector<double>& q, std::uint64_t limit,
            std::vector<double>& z) {
    pivots = multiplyAdds = 0;
    z.assign(n, 0);
    double scale = 0, least = 0;
    for (std::size_t i = 0; i < n; ++i) scale = std::max(scale, std::abs(q[i])), least = std::min(least, q[i]);
    if (!(least < 0)) return End::solved;
    // basic_i = sum_j a_ij nonbasic_j + (q_i, tie_i): columns 0 .. n-1 are z, n is the artificial variable.
    m_n = n, m_width = n + 3;
    m_a.resize(n * m_width), m_basic.resize(n), m_nonbasic.resize(n + 1);
    std::uint64_t state = 1;
    std::size_t worst = n;
    for (std::size_t i = 0; i < n; ++i) {
      double* const to = row(i);
      for (std::size_t j = 0; j < n; ++j) to[j] = m[i * n + j];
      state = state * 6364136223846793005ull + 1442695040888963407ull;
      to[n] = 1, to[n + 1] = q[i], to[n + 2] = 1 + static_cast<double>(state >> 40) / (1 << 24);
      m_basic[i] = n + 1 + i, m_nonbasic[i] = i;  // variable n + 1 + i is w_i
      if (!(q[i] > least) && (worst == n || to[n + 2] < row(worst)[n + 2])) worst = i;
    }
    m_nonbasic[n] = n;
    pivot(worst, n);
    std::size_t entering = m_nonbasic[n] - n - 1;  // the complement of the w that left the basis: its z
    while (pivots < limit) {
      std::size_t column = 0;
      while (m_nonbasic[column] != entering) ++column;
      std::size_t leaving = n;
      double best = 0, tie = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const double a = row(i)[column];
        if (!(a < -kFlat)) continue;
        const double ratio = row(i)[n + 1] / -a, second = row(i)[n + 2] / -a;
        const bool equal = std::abs(ratio - best) <= kTie * (std::abs(ratio) + std::abs(best) + scale);
        const bool artificial = leaving < n && m_basic[i] == n && equal;
        if (leaving == n || artificial || (equal ? second < tie && m_basic[leaving] != n : ratio < best)) {
          leaving = i, best = ratio, tie = second;
        }
      }
      if (leaving == n) return End::noSolution;
      const std::size_t left = m_basic[leaving];
      pivot(leaving, column);
      if (left == n) {
        for (std::size_t i = 0; i < n; ++i) {
          if (m_basic[i] < n) z[m_basic[i]] = std::max(row(i)[n + 1], 0.0);
        }
        return End::solved;
      }
      entering = left > n ? left - n - 1 : left + n + 1;
    }
    return End::outOfPivots;
  }

 private:
  static constexpr double kFlat = 1e-12;  // smaller entries are rounding, in units in which the diagonal is 1
  static constexpr double kTie = 1e-13;   // relative

  double* row(std::size_t i) { return m_a.data() + i * m_width; }

  // Exchanges basic variable r and nonbasic variable c.
  void pivot(std::size_t r, std::size_t c) {
    ++pivots;
    double* const from = row(r);
    const double inverse = 1 / from[c];
    for (std::size_t j = 0; j < m_width; ++j) from[j] *= -inverse;
    from[c] = inverse;
    for (std::size_t i = 0; i < m_n; ++i) {
      double* const to = row(i);
      const double share = to[c];
      if (i == r || !(share != 0)) continue;
      to[c] = 0;
      for (std::size_t j = 0; j < m_width; ++j) to[j] += share * from[j];
      multiplyAdds += m_width;
    }
    std::swap(m_basic[r], m_nonbasic[c]);
  }

  std::size_t m_n = 0, m_width = 0;
  std::vector<double> m_a;
  std::vector<std::size_t> m_basic, m_nonbasic;
};

}}}  // namespace lpc::LPC_PRECISION::solver
