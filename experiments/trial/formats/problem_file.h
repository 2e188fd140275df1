// SPDX-License-Identifier: Zlib
// Velocity problems as a file, JSON: docs/problems.md describes it.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "framework/problem/frozen_problem.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
struct StoredProblem {
  std::string scene;
  long step = 0;
  FrozenProblem<D> problem;
};

template <int D>
void writeProblems(std::ostream& out, const std::vector<StoredProblem<D>>& problems);

/// The content of a file, in its dimension.
struct ProblemFile {
  int dimension = 2;
  std::vector<StoredProblem<2>> in2;
  std::vector<StoredProblem<3>> in3;

  template <int D>
  const std::vector<StoredProblem<D>>& of() const {
    if constexpr (D == 2) {
      return in2;
    } else {
      return in3;
    }
  }
  bool isMatrix(std::size_t i) const {
    return dimension == 2 ? in2.at(i).problem.given.has_value() : in3.at(i).problem.given.has_value();
  }
  std::size_t size() const { return dimension == 2 ? in2.size() : in3.size(); }
  /// Both throw UserError that says what is wrong where, and what is valid.
  static ProblemFile load(const std::string& path);
  static ProblemFile parse(const std::string& bytes, const std::string& path);
};

}}  // namespace lpc::LPC_PRECISION
