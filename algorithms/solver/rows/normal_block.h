// SPDX-License-Identifier: Zlib
// Solves the normal impulses of one manifold at once. The points of a face are coupled, so that one by one they need
// many sweeps for one small problem.
#pragma once

#include <bit>

#include "algorithms/solver/rows/contact_rows.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// Regularisation: the part (1) of its own response by which each point keeps its impulse. The four corners of a face
/// are statically indeterminate, and two close points nearly so: nothing decides which of them bears the weight. With
/// this term the solution is the one nearest to the previous impulses, and the next sweep removes the remaining
/// velocity. Larger: more sweeps. Smaller: rounding decides impulses. The field drops a point instead.
inline constexpr Real kBlockHold = Real(1e-3);

template <int D>
class NormalBlock {
 public:
  static constexpr int kRows = kManifoldPoints<D>;
  using Impulses = IndexedArray<Real, kRows>;

  /// Returns false if nothing can move a point.
  bool set(const ManifoldRows<D>& m, const PointRows<D>* points, WorkDone& work) {
    m_count = m.count;
    const auto n = static_cast<std::uint64_t>(m_count);
    work[WorkCount::multiplyAdds] += n * n * D * (D - 1);
    for (int i = 0; i < m.count; ++i) {
      const Row<D>& row = points[i].normal;
      if (!(row.mass > 0)) return false;
      for (int j = 0; j < m.count; ++j) {
        const Row<D>& other = points[j].normal;
        m_k(i, j) = m.invMassA + m.invMassB + row.armA.dot(other.turnA) + row.armB.dot(other.turnB);
      }
      m_k(i, i) *= 1 + kBlockHold;
    }
    return true;
  }

  /// Finds x >= 0 with w = K (x - old) + v >= 0 and no impulse where w > 0. `v` is by how much (m/s) the points
  /// separate faster than wanted. Takes the first set of pressing points that fits, from all to none (Catto 2008); if
  /// rounding lets none fit, the set with the smallest error.
  Impulses solve(const Impulses& old, const Impulses& v, WorkDone& work) const {
    const auto n = static_cast<std::size_t>(m_count);
    std::uint64_t& multiplyAdds = work[WorkCount::multiplyAdds];
    multiplyAdds += n * n;
    Impulses q{}, best{};
    for (std::size_t i = 0; i < n; ++i) {
      q[i] = v[i];
      for (std::size_t j = 0; j < n; ++j) q[i] -= m_k(static_cast<int>(i), static_cast<int>(j)) * old[j];
    }
    Real least = std::numeric_limits<Real>::infinity();
    for (unsigned pushing = 1u << n; pushing-- > 0;) {
      Impulses x{};
      const Real wrong = tried(pushing, q, x);
      const auto size = static_cast<std::uint64_t>(std::popcount(pushing));  // factor, two substitutions, check
      multiplyAdds += size * (size + 1) * (size + 2) / 6 + size * (size + 1) + (n - size) * n;
      if (wrong < least) least = wrong, best = x;
      if (!(wrong > 0)) break;
    }
    for (Real& x : best) x = std::max(x, Real(0));
    return best;
  }

 private:
  // Computes x such that the points of the set do not move; returns the largest velocity (m/s) that violates the
  // conditions.
  Real tried(unsigned pushing, const Impulses& q, Impulses& x) const {
    IndexedArray<int, kRows> in{};
    int size = 0;
    for (int i = 0; i < m_count; ++i) {
      if (pushing & (1u << i)) in[size++] = i;
    }
    // K = L d L^T: positive definite.
    RealMatrix<kRows, kRows> l = RealMatrix<kRows, kRows>::Zero();
    Impulses d{}, y{};
    for (int r = 0; r < size; ++r) {
      const int i = in[r];
      y[r] = -q[i], d[r] = m_k(i, i);
      for (int c = 0; c < r; ++c) {
        Real sum = m_k(i, in[c]);
        for (int k = 0; k < c; ++k) sum -= l(r, k) * l(c, k) * d[k];
        l(r, c) = sum / d[c];
        d[r] -= l(r, c) * sum;
        y[r] -= l(r, c) * y[c];
      }
    }
    Real wrong = 0;
    for (int r = size; r-- > 0;) {
      Real sum = y[r] / d[r];
      for (int c = r + 1; c < size; ++c) sum -= l(c, r) * x[in[c]];
      const int i = in[r];
      x[i] = sum;
      wrong = std::max(wrong, -sum * m_k(i, i));
    }
    for (int i = 0; i < m_count; ++i) {
      if (pushing & (1u << i)) continue;
      Real w = q[i];
      for (int j = 0; j < m_count; ++j) w += m_k(i, j) * x[j];
      wrong = std::max(wrong, -w);
    }
    return wrong;
  }

  int m_count = 0;
  RealMatrix<kRows, kRows> m_k;  // velocity of point i, m/s, per impulse at j
};

}}}  // namespace lpc::LPC_PRECISION::solver
