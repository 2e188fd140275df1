// SPDX-License-Identifier: Zlib
// Measurements of a trial of a frozen problem. Separate from the trial, which a reader of metrics need not know.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "experiments/trial/measure/metric.h"

namespace lpc { inline namespace LPC_PRECISION {

/// One solution of a method. Errors are in units of g dt, or in m/s without gravity.
struct ProblemAnswer {
  double residual = 0;     // of Coulomb's law, by the natural map with De Saxce's correction
  double own = 0;          // of the method's own law; NaN for a pyramid with corners unknown to us
  double cone = 0;         // beyond the friction cone
  double velocity = 0;     // of the rows, against the converged solution; NaN: there is none
  double unexplained = 0;  // of the bodies' velocities: the part that the impulses do not explain
  double fallbacks = 0;    // rows that a direct method left to sweeps
  double multiplyAdds = 0, nanoseconds = std::numeric_limits<double>::quiet_NaN();
};

/// Methods for the converged solution, the reference for velocity errors, tried in this order.
inline constexpr std::array<const char*, 3> kReferenceResolvers = {
    "direct_lcp{cfm=1e-8,max_rows=400}", "admm{iterations=500,tolerance=0,proximal=1e-9,max_rows=400}",
    "nncg{iterations=500}"};

struct ProblemsSeen {
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<ProblemAnswer> answers;  // after 0, 1, 2, ... iterations; a single one for a method without iterations
  double rows = 0, rank = kNan, predicted = kNan;
  bool counts = false;  // its answers count iterations

  const ProblemAnswer& last() const { return answers.back(); }
  /// The first iteration from which the residual stays below.
  double iterationsTo(double residual) const;
  double multiplyAddsTo(double residual) const;
  /// The factor by which the residual falls per iteration, in its tail.
  double rate() const;
};

std::span<const Measure<ProblemsSeen>> problemsMetrics();
std::span<const Measure<ProblemAnswer>> problemsSeries();

}}  // namespace lpc::LPC_PRECISION
