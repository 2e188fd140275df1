// SPDX-License-Identifier: Zlib
#include "experiments/trial/measure/problems_metrics.h"

#include "experiments/trial/measure/metric.h"

namespace lpc { inline namespace LPC_PRECISION {

double ProblemsSeen::iterationsTo(double residual) const {
  std::size_t first = answers.size();
  while (first > 0 && answers[first - 1].residual <= residual) --first;
  return counts && first < answers.size() ? static_cast<double>(first) : kNan;
}

double ProblemsSeen::multiplyAddsTo(double residual) const {
  if (!counts) return last().residual <= residual ? last().multiplyAdds : kNan;
  const double first = iterationsTo(residual);
  return std::isnan(first) ? kNan : answers[static_cast<std::size_t>(first)].multiplyAdds;
}

double ProblemsSeen::rate() const {
  if (!counts || answers.size() < 8) return kNan;
  // Excludes residuals that are only rounding, and the first steps, which remove fast components.
  const double floor = 1e3 * std::numeric_limits<Real>::epsilon();
  std::size_t end = answers.size() - 1;
  while (end > 0 && !(answers[end].residual > floor)) --end;
  const std::size_t begin = end / 2;
  if (end < begin + 3 || answers[end].residual == answers[begin].residual) return kNan;  // it has converged
  return std::pow(answers[end].residual / answers[begin].residual, 1.0 / static_cast<double>(end - begin));
}

namespace {

using SeenProblems = const ProblemsSeen&;
const Measure<ProblemsSeen> kProblemsMetrics[] = {
    {{"multiply_adds", "multiply-adds", "1", "of rows, factorisations, solves and residuals", MetricRole::cost,
      "cheaper"},
     [](SeenProblems s) { return s.last().multiplyAdds; }},
    {{"ns_per_solve", "time per solve", "ns", "processor time of one solve with all iterations, median",
      MetricRole::cost, "cheaper", TrialNeed::timing},
     [](SeenProblems s) { return s.last().nanoseconds; }},
    {{"problem_residual", "natural map", "1",
      "largest error of a row by Coulomb's law with De Saxce's correction, over g dt (m/s without gravity)",
      MetricRole::error, "nearer to the solution"},
     [](SeenProblems s) { return s.last().residual; }},
    {{"own_residual", "natural map of its own law", "1",
      "the same by the method's own law of friction; undefined for k facets in 3D, which only it knows",
      MetricRole::error, "nearer to its own solution"},
     [](SeenProblems s) { return s.last().own; }},
    {{"velocity_error", "error of velocity", "1",
      "largest error of a row's velocity before the converged answer, over g dt", MetricRole::error,
      "velocities nearer to the solution"},
     [](SeenProblems s) { return s.last().velocity; }},
    {{"cone_error", "beyond the cone", "1", "impulse beyond friction's cone or a limit, as velocity over g dt",
      MetricRole::detail, "impulses obey their limits"},
     [](SeenProblems s) { return s.last().cone; }},
    {{"unexplained_velocity", "velocity without an impulse", "1",
      "largest velocity of a body that the impulses have not made, over g dt: momentum from nowhere",
      MetricRole::detail, "momentum is conserved"},
     [](SeenProblems s) { return s.last().unexplained; }},
    {{"iterations_to_thousandth", "iterations to a thousandth", "1",
      "from which on the natural map stays below 0.001 g dt", MetricRole::detail, "faster"},
     [](SeenProblems s) { return s.iterationsTo(1e-3); }},
    {{"multiply_adds_to_thousandth", "multiply-adds to a thousandth", "1",
      "until the natural map stays below 0.001 g dt", MetricRole::detail, "faster"},
     [](SeenProblems s) { return s.multiplyAddsTo(1e-3); }},
    {{"rate", "rate of convergence", "1", "factor of the natural map per iteration, in the tail of the curve",
      MetricRole::detail, "faster"},
     [](SeenProblems s) { return s.rate(); }},
    {{"predicted_rate", "predicted rate", "1",
      "spectral radius of the Gauss-Seidel iteration on the rows that push, whatever the method; without friction and "
      "joints",
      MetricRole::detail, "faster"},
     [](SeenProblems s) { return s.predicted; }},
    {{"fallbacks", "rows left to sweeps", "1", "by a direct method, of islands that are larger than it takes",
      MetricRole::detail, ""},
     [](SeenProblems s) { return s.last().fallbacks; }},
    {{"rows", "rows", "1", "of contacts and joints", MetricRole::detail, ""}, [](SeenProblems s) { return s.rows; }},
    {{"rank", "rank", "1", "of the matrix of those rows; fewer than rows: impulses are not unique", MetricRole::detail,
      ""},
     [](SeenProblems s) { return s.rank; }},
};

using A = const ProblemAnswer&;
const Measure<ProblemAnswer> kSeries[] = {
    {{"problem_residual", "natural map", "1", "by the number of iterations, from 0", MetricRole::error,
      "nearer to the solution"},
     [](A a) { return a.residual; }},
    {{"own_residual", "natural map of its own law", "1", "by the number of iterations, from 0", MetricRole::error,
      "nearer to its own solution"},
     [](A a) { return a.own; }},
    {{"velocity_error", "error of velocity", "1", "by the number of iterations, from 0", MetricRole::error,
      "velocities nearer to the solution"},
     [](A a) { return a.velocity; }},
    {{"multiply_adds", "multiply-adds", "1", "by the number of iterations, from 0", MetricRole::cost, "cheaper"},
     [](A a) { return a.multiplyAdds; }},
    {{"ns_per_solve", "time per solve", "ns", "by the number of iterations, from 0", MetricRole::cost, "cheaper",
      TrialNeed::timing},
     [](A a) { return a.nanoseconds; }},
};

}  // namespace

std::span<const Measure<ProblemsSeen>> problemsMetrics() { return kProblemsMetrics; }
std::span<const Measure<ProblemAnswer>> problemsSeries() { return kSeries; }

void describeProblemsMetrics(std::vector<DescribedMetric>& out) {
  for (const auto& entry : kProblemsMetrics) out.push_back({"metric", "problems", entry.info});
  for (const auto& entry : kSeries) out.push_back({"series", "problems", entry.info});
}

}}  // namespace lpc::LPC_PRECISION
