// SPDX-License-Identifier: Zlib
// Shared by resolvers that solve a velocity problem as a whole.
#pragma once

#include <span>
#include <vector>

#include "algorithms/solver/rows/row_sweep.h"
#include "framework/math/indexed.h"
#include "framework/problem/contact_problem.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

template <int D>
class WholeProblem {
 protected:
  /// `warm`: the share of the last step's impulses for warm starting.
  void prepare(const VelocityInput<D>& in, double warm) {
    m_problem.set(in);
    countMadeRows<D>(in.work, m_problem.rows().size());
    m_sweep.prepare(m_problem);
    m_problem.freeVelocities(in, m_free);
    m_problem.lastImpulses(in, warm, m_impulse);
  }

  /// Calls `solve(rows)` for each island, which leaves its solution in m_impulse or returns false. Then projected
  /// Gauss-Seidel sweeps over the island, from the warm start.
  template <class Solve>
  void eachIsland(WorkDone& work, int sweeps, const Solve& solve) {
    const std::span<const std::int32_t> all = m_problem.grouped();
    const IndexedSpan<const std::int32_t> islands = m_problem.islands();
    for (std::size_t k = 0; k + 1 < islands.size(); ++k) {
      const std::span<const std::int32_t> rows(all.data() + islands[k], all.data() + islands[k + 1]);
      if (!solve(rows)) m_sweep.descend(m_problem, rows, m_free, m_impulse, sweeps, work);
    }
  }

  ContactProblem<D> m_problem;
  RowSweep<D> m_sweep;
  IndexedVector<double> m_free, m_impulse;  // by row
};

}}}  // namespace lpc::LPC_PRECISION::solver
