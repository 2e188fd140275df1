// SPDX-License-Identifier: Zlib
// Projected Gauss-Seidel over the rows of a whole problem, joints and contacts: each row in turn gets the impulse that
// satisfies it alone, within its limits. Friction is solved as in contact_rows.h; the equality rows of a joint are one
// block.
#pragma once

#include <vector>

#include "algorithms/solver/rows/block_inverse.h"
#include "framework/math/indexed.h"
#include "framework/problem/contact_problem.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

template <int D>
class RowSweep {
 public:
  void prepare(const ContactProblem<D>& p) {
    m_friction.resize(p.rows().size());
    m_blocks.clear(), m_blockOf.assign(m_friction.size(), -1);
    for (int i = 0; i < p.size(); ++i) {
      if (p.row(i).holds() && (i == 0 || !p.row(i - 1).holds() || p.row(i - 1).owner != p.row(i).owner)) {
        m_blockOf[i] = static_cast<std::int32_t>(m_blocks.size());
        m_blocks.push_back(blockOf(p, i));
      }
      if (p.row(i).law == ProblemLaw::normal) m_friction[i] = frictionFactors(p, i);
    }
  }

  /// Updates each row of `which` once. The problem's motion belongs to x before and after; `freeVelocity` is u at x =
  /// 0.
  void sweep(ContactProblem<D>& p, std::span<const std::int32_t> which, IndexedSpan<const double> freeVelocity,
             IndexedSpan<double> x) const {
    for (const std::int32_t i : which) {
      const ProblemRow<D>& r = p.row(i);
      if (r.holds()) hold(p, i, freeVelocity, x);
      if (r.law == ProblemLaw::tangent || r.holds()) continue;
      double& own = x[i];
      const double old = own, u = p.pushed(i) + r.compliance * old + freeVelocity[i];
      own = std::clamp(old - r.mass * u, r.lo, r.hi);
      p.push(i, own - old);
      if (r.law == ProblemLaw::normal) solveFriction(p, i, freeVelocity, x);
    }
  }

  /// Sweeps this often over an island that no other method solved, from x.
  void descend(ContactProblem<D>& p, std::span<const std::int32_t> which, IndexedSpan<const double> freeVelocity,
               IndexedSpan<double> x, int sweeps, WorkDone& work) const {
    p.clearMotion();
    for (const std::int32_t i : which) p.push(i, x[i]);
    for (int n = 0; n < sweeps; ++n) sweep(p, which, freeVelocity, x);
    work[WorkCount::fallbacks] += which.size();
    countRows<D>(work, which.size() * static_cast<std::uint64_t>(sweeps));
  }

 private:
  struct FrictionFactors {
    std::array<std::array<double, 2>, 2> stick{};  // impulse that stops sliding, per velocity
    double slide = 0;                              // 1 / the largest eigenvalue of the tangents' response
  };

  struct Block {
    int count = 0;
    BlockInverse<D> inverse;
  };

  static Block blockOf(const ContactProblem<D>& p, int first) {
    Block block;
    while (block.count < BlockInverse<D>::kRows && first + block.count < p.size() &&
           p.row(first + block.count).holds() && p.row(first + block.count).owner == p.row(first).owner) {
      ++block.count;
    }
    const auto k = [&](int i, int j) { return static_cast<Real>(p.response(p.row(first + i), p.row(first + j))); };
    block.inverse.set(block.count, k, p.row(first).movable);
    return block;
  }
  void hold(ContactProblem<D>& p, int first, IndexedSpan<const double> freeVelocity, IndexedSpan<double> x) const {
    if (m_blockOf[first] < 0) return;  // solved with the rows before it
    const Block& block = m_blocks[m_blockOf[first]];
    IndexedArray<Real, BlockInverse<D>::kRows> u, impulse;
    for (int i = 0; i < block.count; ++i) {
      const double v = p.pushed(first + i) + freeVelocity[first + i];
      u[i] = static_cast<Real>(v);
    }
    block.inverse.multiply(block.count, -1, u.data(), impulse.data());
    for (int i = 0; i < block.count; ++i) {
      const double by = double(impulse[i]);
      x[first + i] += by;
      p.push(first + i, by);
    }
  }

  static FrictionFactors frictionFactors(const ContactProblem<D>& p, int i) {
    FrictionFactors factors;
    const double ss = 1 / p.row(i + 1).mass;
    factors.stick[0][0] = factors.slide = 1 / ss;
    if constexpr (D == 3) {
      const double tt = 1 / p.row(i + 2).mass, st = p.response(p.row(i + 1), p.row(i + 2));
      const double mean = (ss + tt) / 2, half = (ss - tt) / 2, determinant = ss * tt - st * st;
      factors.slide = 1 / (mean + std::sqrt(half * half + st * st));
      constexpr double kFlat = 1e-6;  // pinned bodies: the point may have only one direction in which it can move
      const bool flat = !(determinant > mean * mean * kFlat);
      factors.stick[0] = {flat ? factors.slide : tt / determinant, flat ? 0 : -st / determinant};
      factors.stick[1] = {factors.stick[0][1], flat ? factors.slide : ss / determinant};
    }
    return factors;
  }

  void solveFriction(ContactProblem<D>& p, int i, IndexedSpan<const double> freeVelocity, IndexedSpan<double> x) const {
    const FrictionFactors& r = m_friction[i];
    const double limit = p.row(i).friction * x[i];
    IndexedArray<double, D - 1> old, u, now;
    for (std::size_t k = 0; k < D - 1; ++k) {
      const int row = i + 1 + static_cast<int>(k);
      old[k] = x[row];
      u[k] = p.pushed(row) + freeVelocity[row];
    }
    double squared = 0;
    for (std::size_t k = 0; k < D - 1; ++k) {
      now[k] = old[k];
      for (std::size_t m = 0; m < D - 1; ++m) now[k] -= r.stick[k][m] * u[m];
      squared += now[k] * now[k];
    }
    if (squared > limit * limit) {
      squared = 0;
      for (std::size_t k = 0; k < D - 1; ++k) now[k] = old[k] - r.slide * u[k], squared += now[k] * now[k];
      const double share = squared > limit * limit ? limit / std::sqrt(squared) : 1;
      for (double& t : now) t *= share;
    }
    for (std::size_t k = 0; k < D - 1; ++k) {
      const int row = i + 1 + static_cast<int>(k);
      x[row] = now[k];
      p.push(row, now[k] - old[k]);
    }
  }

  IndexedVector<FrictionFactors> m_friction;  // by row, of normals
  IndexedVector<std::int32_t> m_blockOf;      // by row, of the first row of a block
  IndexedVector<Block> m_blocks;
};

}}}  // namespace lpc::LPC_PRECISION::solver
