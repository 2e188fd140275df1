// SPDX-License-Identifier: Zlib
// One island of a problem, each row scaled by its own effective mass. The diagonal of W is then about 1, and because
// all directions of a contact have one unit, its cone stays a cone. W is J J^T over the bodies, or a dense matrix if
// there are no bodies or a method asks for it.
#pragma once

#include <vector>

#include "algorithms/solver/island/body_rows.h"
#include "algorithms/solver/island/dense.h"
#include "framework/math/indexed.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

template <int D>
struct Island {
  const ContactProblem<D>* problem = nullptr;
  std::span<const std::int32_t> rows;
  std::vector<double> root;  // impulse per scaled impulse; velocity per scaled velocity is 1 / root
  std::vector<double> soft;  // compliance of springs, scaled; part of W
  std::vector<double> u;     // velocities at zero impulse, less the wanted ones, scaled
  std::vector<double> x;     // impulses, scaled
  BodyRows<D> bodies;
  bool dense = false;              // whether it has w and uses it
  std::vector<double> w;           // scaled, size() x size()
  std::uint64_t multiplyAdds = 0;  // so far

  std::size_t size() const { return rows.size(); }
  const ProblemRow<D>& row(std::size_t i) const { return problem->row(rows[i]); }

  /// Returns false if the island has too many bodies, or, as a dense matrix, too many rows.
  bool set(const VelocityInput<D>& in, const ContactProblem<D>& p, std::span<const std::int32_t> which,
           IndexedSpan<const double> freeVelocity, IndexedSpan<const double> impulse, int maxBodies, int maxRows) {
    problem = &p, rows = which, dense = false;
    const std::size_t n = size();
    if (in.given ? n > static_cast<std::size_t>(maxRows) : !bodies.set(in, p, which, maxBodies)) return false;
    root.resize(n), soft.resize(n), u.resize(n), x.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      root[i] = std::sqrt(row(i).unit), soft[i] = row(i).compliance * row(i).unit;
      u[i] = freeVelocity[rows[i]] * root[i];
      x[i] = impulse[rows[i]] / root[i];
      if (!in.given) bodies.scale(i, root[i]);
    }
    if (in.given) assemble();
    return true;
  }
  void assemble() {
    const std::size_t n = size();
    problem->assemble(rows, w);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) w[i * n + j] *= root[i] * root[j];
    }
    dense = true;
    multiplyAdds += n * n * (D + kAngDim<D>);
  }
  /// Multiplies W by v.
  void multiply(const std::vector<double>& v, std::vector<double>& out) {
    const std::size_t n = size();
    out.resize(n);
    if (dense) {
      for (std::size_t i = 0; i < n; ++i) {
        out[i] = 0;
        for (std::size_t j = 0; j < n; ++j) out[i] += w[i * n + j] * v[j];
      }
      multiplyAdds += n * n;
      return;
    }
    m_z.assign(bodies.bodies() * BodyRows<D>::kSize, 0);
    for (std::size_t i = 0; i < n; ++i) bodies.push(i, v[i], m_z);
    for (std::size_t i = 0; i < n; ++i) out[i] = bodies.along(i, m_z) + soft[i] * v[i];
    multiplyAdds += 2 * bodies.multiplyAddsOfProduct() + n;
  }
  /// Returns u + W x.
  void velocities(std::vector<double>& out) {
    multiply(x, out);
    for (std::size_t i = 0; i < size(); ++i) out[i] += u[i];
  }
  void store(IndexedSpan<double> impulse) const {
    for (std::size_t i = 0; i < size(); ++i) impulse[rows[i]] = x[i] * root[i];
  }

 private:
  std::vector<double> m_z;
};

/// (W + diagonal)^-1 for a diagonal above 0. Over bodies W is J J^T, and with d = diagonal + soft
///
/// x = (b - J z) / d,   (1 + J^T J / d) z = J^T b / d
///
/// so a factorisation is linear for a tower. Each solve reduces the residual to rounding over the smallest d. Solve for
/// changes of x, with the residual of the previous solve as b.
template <int D>
class IslandFactor {
 public:
  /// Call once per island. Returns the square root of the sum of squares of W.
  double set(Island<D>& island) {
    double sum = 0;
    if (island.dense) {
      for (const double w : island.w) sum += w * w;
      island.multiplyAdds += island.w.size();
      return std::sqrt(sum);
    }
    island.bodies.analyse(m_matrix);
    m_matrix.set(0);
    typename BodyRows<D>::Square one{};
    for (std::size_t k = 0; k < D; ++k) one[k * D + k] = 1;
    for (const auto& g : island.bodies.groups) {
      island.bodies.add(g, one, m_matrix);
      island.multiplyAdds += island.bodies.multiplyAddsOf(g, true);
    }
    for (std::size_t i = 0; i < island.size(); ++i) {
      const double all = island.row(i).unit / island.row(i).mass;
      sum += all * all - (all - island.soft[i]) * (all - island.soft[i]);
    }
    island.multiplyAdds += m_matrix.entries();
    return std::sqrt(sum + m_matrix.squares());  // J J^T and J^T J have the same sum
  }
  void factor(Island<D>& island, const std::vector<double>& diagonal) {
    const std::size_t n = island.size();
    if (island.dense) {
      m_sum = island.w;
      for (std::size_t i = 0; i < n; ++i) m_sum[i * n + i] += diagonal[i];
      m_dense.factor(n, m_sum);
      island.multiplyAdds += m_dense.multiplyAdds;
      return;
    }
    m_inverse.resize(n);
    for (std::size_t i = 0; i < n; ++i) m_inverse[i] = 1 / (diagonal[i] + island.soft[i]);
    m_matrix.set(1);
    for (const auto& g : island.bodies.groups) {
      typename BodyRows<D>::Square s{};
      for (std::size_t k = 0; k < g.count; ++k) s[k * D + k] = m_inverse[g.first + k];
      island.bodies.add(g, s, m_matrix);
      island.multiplyAdds += island.bodies.multiplyAddsOf(g, true);
    }
    m_matrix.factor();
    island.multiplyAdds += m_matrix.multiplyAdds;
  }
  /// Replaces b by x.
  void solve(Island<D>& island, std::vector<double>& b) {
    if (island.dense) {
      m_dense.solve(b.data());
      island.multiplyAdds += m_dense.multiplyAddsOfSolve();
      return;
    }
    m_z.assign(island.bodies.bodies() * BodyRows<D>::kSize, 0);
    for (std::size_t i = 0; i < b.size(); ++i) island.bodies.push(i, b[i] * m_inverse[i], m_z);
    m_matrix.solve(m_z);
    for (std::size_t i = 0; i < b.size(); ++i) b[i] = (b[i] - island.bodies.along(i, m_z)) * m_inverse[i];
    island.multiplyAdds += m_matrix.multiplyAddsOfSolve() + 2 * island.bodies.multiplyAddsOfProduct() + 2 * b.size();
  }

 private:
  SymmetricFactor m_dense;
  BlockCholesky<BodyRows<D>::kSize> m_matrix;
  std::vector<double> m_sum, m_inverse, m_z;
};

}}}  // namespace lpc::LPC_PRECISION::solver
