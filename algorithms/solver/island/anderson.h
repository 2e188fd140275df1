// SPDX-License-Identifier: Zlib
// Anderson acceleration of s = f(s) (Walker and Ni 2011): the next guess is the point at which a least-squares line
// through the last guesses predicts no change. For linear f it is the solution once there are as many guesses as
// dimensions.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

class Anderson {
 public:
  std::uint64_t multiplyAdds = 0;  // so far

  void begin() { m_count = 0, m_fresh = true; }

  /// Replaces s by the next guess; `to` is f(s).
  void next(std::vector<double>& s, const std::vector<double>& to) {
    const std::size_t n = s.size();
    m_change.resize(n);
    for (std::size_t i = 0; i < n; ++i) m_change[i] = to[i] - s[i];
    if (!m_fresh) {
      Column& c = m_columns[m_count % kDepth];
      c.change.resize(n), c.to.resize(n);
      for (std::size_t i = 0; i < n; ++i) c.change[i] = m_change[i] - m_lastChange[i], c.to[i] = to[i] - m_lastTo[i];
      ++m_count;
    }
    m_fresh = false;
    m_lastChange = m_change, m_lastTo = to;
    s = to;
    // Newest first; a change that adds little information is omitted.
    std::size_t used = 0;
    for (std::size_t k = 0; k < std::min(m_count, kDepth); ++k) {
      Column& q = m_basis[used];
      q = m_columns[(m_count - 1 - k) % kDepth];
      const double whole = dot(q.change, q.change);
      multiplyAdds += (3 * used + 7) * n;
      for (std::size_t j = 0; j < used; ++j) subtract(q, m_basis[j], dot(q.change, m_basis[j].change));
      const double left = dot(q.change, q.change);
      if (!(left > kNew * whole && left > kFar * dot(m_change, m_change))) continue;
      const double inverse = 1 / std::sqrt(left);
      for (std::size_t i = 0; i < n; ++i) q.change[i] *= inverse, q.to[i] *= inverse;
      const double share = dot(q.change, m_change);
      for (std::size_t i = 0; i < n; ++i) m_change[i] -= share * q.change[i], s[i] -= share * q.to[i];
      ++used;
    }
  }

 private:
  static constexpr std::size_t kDepth = 8;
  static constexpr double kNew = 1e-12;  // of a change's square; below it is rounding
  static constexpr double kFar = 1e-6;   // the same for the change to be undone; below it the step would be a leap
  struct Column {
    std::vector<double> change, to;
  };
  static double dot(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  }
  static void subtract(Column& from, const Column& what, double times) {
    for (std::size_t i = 0; i < from.to.size(); ++i) {
      from.change[i] -= times * what.change[i], from.to[i] -= times * what.to[i];
    }
  }

  std::size_t m_count = 0;
  bool m_fresh = true;
  std::vector<double> m_change, m_lastChange, m_lastTo;
  std::array<Column, kDepth> m_columns, m_basis;
};

}}}  // namespace lpc::LPC_PRECISION::solver
