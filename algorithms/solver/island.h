// SPDX-License-Identifier: Zlib
// One island of a problem as a dense matrix, each row in units of its own mass: the diagonal is about 1, and with one
// unit for all directions of a contact its cone stays a cone.
#pragma once

#include <vector>

#include "framework/contact_problem.h"

namespace lpc::inline LPC_PRECISION::solver {

template <int D>
struct Island {
  const ContactProblem<D>* problem = nullptr;
  std::span<const std::int32_t> rows;
  std::vector<double> root;  // impulse per scaled impulse; a velocity per scaled velocity is 1 / root
  std::vector<double> w;     // scaled, size() x size()
  std::vector<double> u;     // velocities at no impulse, less what is wanted, scaled
  std::vector<double> x;     // impulses, scaled

  std::size_t size() const { return rows.size(); }
  const ProblemRow<D>& row(std::size_t i) const { return problem->row(rows[i]); }

  void set(const ContactProblem<D>& p, std::span<const std::int32_t> which, std::span<const double> freeVelocity,
           std::span<const double> impulse) {
    problem = &p, rows = which;
    const std::size_t n = size();
    root.resize(n), u.resize(n), x.resize(n);
    for (std::size_t i = 0; i < n; ++i) root[i] = std::sqrt(row(i).unit);
    p.assemble(rows, w);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) w[i * n + j] *= root[i] * root[j];
      u[i] = freeVelocity[static_cast<std::size_t>(rows[i])] * root[i];
      x[i] = impulse[static_cast<std::size_t>(rows[i])] / root[i];
    }
  }
  /// u + W x
  void velocities(std::vector<double>& out) const {
    out = u;
    for (std::size_t i = 0; i < size(); ++i) {
      for (std::size_t j = 0; j < size(); ++j) out[i] += w[i * size() + j] * x[j];
    }
  }
  void store(std::span<double> impulse) const {
    for (std::size_t i = 0; i < size(); ++i) impulse[static_cast<std::size_t>(rows[i])] = x[i] * root[i];
  }
};

}  // namespace lpc::inline LPC_PRECISION::solver
