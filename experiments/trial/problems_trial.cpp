// SPDX-License-Identifier: Zlib
// A velocity resolver alone, on a frozen problem: the residual after each number of iterations, and the cost.
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "experiments/trial/formats/problem_file.h"
#include "experiments/trial/measure/metric.h"
#include "experiments/trial/measure/problem_spectrum.h"
#include "experiments/trial/measure/problems_metrics.h"
#include "experiments/trial/trial.h"
#include "framework/math/worse.h"
#include "framework/problem/contact_problem.h"
#include "framework/stage/profiler.h"
#include "oracles/witnesses/witness_resolver.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr int kMostRows = 400;                                  // of a matrix for eigenvalues
constexpr int kSolves = 11;                                     // timed solves; the first warms the caches
constexpr double kConverged = sizeof(Real) == 8 ? 1e-9 : 1e-4;  // of g dt: residual of a reference
constexpr int kReferenceTries = 20;

template <int D>
class ProblemTrial {
 public:
  ProblemTrial(const ProblemRequest& asked, FrozenProblem<D> problem)
      : m_problem(std::move(problem)),
        m_spec(Spec::parse(asked.velocity)),
        m_timed(asked.timed),
        m_iterations(asked.iterations) {
    const Registered& entry = Registry::instance().find(StageKind::velocity, D, m_spec.name);
    m_law = frictionLaw(entry.info, m_spec);
    // A real-valued effort, counted per contact, does not count iterations.
    if (const ParamInfo* p = firstOf(ParamRole::effort, entry.params); p && p->type == "integer") {
      m_seen.counts = true, m_effort = p->name, m_least = static_cast<int>(p->range.value().lo);
    }
    if (asked.cold) forget(m_problem);
    if (!asked.friction) m_problem.model.friction = false;
    WorkDone work;
    if (asked.coloured) {
      ContactGraph<D> graph;
      graph.reset(m_problem.bodies, m_problem.manifolds, m_problem.joints, work);
      const std::vector<int> given = m_problem.order;
      graph.colour(given, m_problem.order, m_problem.colours);
    }
    const VelocityInput<D> in = m_problem.input(work, m_profiler);
    m_rows.set(in), m_rows.freeVelocities(in, m_free), m_rows.lastImpulses(in, 1, m_last);
    const double speed = double(m_problem.gravity.norm()) * double(m_problem.dt);
    m_unit = speed > 0 ? speed : 1;
  }

  TrialResult run() {
    TrialResult out;
    m_seen.rows = m_rows.size();
    findReference();
    for (int n = 0; m_seen.counts && n <= m_iterations; ++n) {
      m_spec.set(m_effort, Spec::parse(std::to_string(std::max(n, m_least))));
      m_seen.answers.push_back(n < m_least ? untouched() : solve());
    }
    if (!m_seen.counts) m_seen.answers.push_back(solve());
    predict();
    const auto applies = [&](TrialNeed need) { return need != TrialNeed::timing || m_timed; };
    measure<ProblemsSeen>(problemsMetrics(), m_seen, applies, out.metrics);
    for (const Measure<ProblemAnswer>& entry : problemsSeries()) {
      if (!applies(entry.info.need)) continue;
      auto& list = out.series[std::string(entry.info.name)];
      for (const ProblemAnswer& a : m_seen.answers) list.push_back(entry.value(a));
    }
    const auto broken = std::find_if(m_seen.answers.begin(), m_seen.answers.end(), [](const ProblemAnswer& a) {
      return !std::isfinite(a.residual) || !std::isfinite(a.unexplained);
    });
    if (broken != m_seen.answers.end()) out.fail("diverged", "nan", broken - m_seen.answers.begin());
    char text[20];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(m_hash));
    out.hash = text;
    return out;
  }

 private:
  static void forget(FrozenProblem<D>& p) {
    for (Manifold<D>& m : p.manifolds) {
      for (ContactPoint<D>& c : m.points) c.impulse.fill(0);
    }
    for (JointRecord<D>& j : p.joints) j.impulse.fill(0);
    if (p.given) std::fill(p.given->impulse.begin(), p.given->impulse.end(), 0.0);
  }

  ProblemAnswer solve() {
    FrozenProblem<D> copy = m_problem;
    WorkDone work;
    createStage<VelocityResolver<D>>(m_spec)->solve(copy.input(work, m_profiler));
    ProblemAnswer out = judged(copy);
    out.multiplyAdds = static_cast<double>(work[WorkCount::multiplyAdds]);
    out.fallbacks = static_cast<double>(work[WorkCount::fallbacks]);
    if (m_timed) out.nanoseconds = time();
    m_hash = XXH64(copy.bodies.motion.data(), copy.bodies.motion.size() * sizeof(Motion<D>), m_hash);
    if (copy.given) {
      m_hash = XXH64(copy.given->velocity.data(), copy.given->velocity.size() * sizeof(double), m_hash);
    }
    return out;
  }

  /// The initial state, for a method that does not start at 0 iterations: the impulses of the last step, unless cold.
  ProblemAnswer untouched() {
    FrozenProblem<D> copy = m_problem;
    WorkDone work;
    const VelocityInput<D> in = copy.input(work, m_profiler);
    m_rows.apply(in, m_last);
    return judged(copy);
  }

  double time() {
    std::vector<double> seconds;
    for (int i = 0; i < kSolves; ++i) {
      FrozenProblem<D> copy = m_problem;
      const auto method = createStage<VelocityResolver<D>>(m_spec);
      const auto* witness = dynamic_cast<const WitnessResolver<D>*>(method.get());  // which reports its own time
      WorkDone work;
      const VelocityInput<D> in = copy.input(work, m_profiler);
      const double before = cpuSeconds();
      method->solve(in);
      const double spent = cpuSeconds() - before;
      if (i > 0) seconds.push_back(witness ? 1e-9 * witness->nanoseconds() : spent);
    }
    return 1e9 * quantile(seconds, 0.5);
  }

  ProblemAnswer judged(FrozenProblem<D>& solved) {
    WorkDone work;
    const VelocityInput<D> after = solved.input(work, m_profiler);
    m_rows.impulses(after, m_impulse);
    ProblemAnswer out;
    const ProblemResidual left = m_rows.naturalMap(m_impulse, m_free);
    out.residual = left.natural / m_unit, out.cone = left.cone / m_unit, out.own = ownResidual(left.natural) / m_unit;
    out.velocity = m_reference.empty() ? ProblemsSeen::kNan : 0;
    m_rows.freeVelocities(after, m_velocity);
    for (std::size_t i = 0; i < m_reference.size(); ++i) {
      out.velocity = worse(out.velocity, std::abs(m_velocity[i] - m_reference[i]) / m_unit);
    }
    FrozenProblem<D> pushed = m_problem;
    m_rows.apply(pushed.input(work, m_profiler), m_impulse);
    for (std::size_t i = 0; i < solved.bodies.motion.size(); ++i) {
      const Motion<D>& now = solved.bodies.motion[i];
      const double off = double((now.v - pushed.bodies.motion[i].v).norm());
      out.unexplained = worse(out.unexplained, now.w.allFinite() ? off / m_unit : ProblemsSeen::kNan);
    }
    for (std::size_t i = 0; solved.given && i < solved.given->velocity.size(); ++i) {
      const double off = std::abs(solved.given->velocity[i] - pushed.given->velocity[i]);
      out.unexplained = worse(out.unexplained, off / m_unit);
    }
    return out;
  }

  double ownResidual(double coulomb) {
    const bool facets = m_law == FrictionLaw::facets;  // in 2D, the two sides of Coulomb's cone
    if (m_law == FrictionLaw::coulomb || (facets && D == 2) || !m_problem.model.friction) return coulomb;
    if (m_law == FrictionLaw::convex) return m_rows.naturalMap(m_impulse, m_free, false).natural;
    const bool byTangents = m_law == FrictionLaw::pyramid || m_law == FrictionLaw::lagged;
    if (!byTangents) return ProblemsSeen::kNan;  // only the method knows the directions of its facets
    // Each row separately: a tangent's limits are those of its contact's normal, now or in the last step.
    double worst = 0, limit = 0, squared = 0;
    m_rows.multiply(m_impulse, m_velocity);
    for (int i = 0; i < m_rows.size(); ++i) {
      const ProblemRow<D>& row = m_rows.row(i);
      const auto at = static_cast<std::size_t>(i);
      double moved = m_impulse[at] - row.unit * (m_velocity[at] + m_free[at]);
      if (row.law == ProblemLaw::normal) {
        moved = std::max(moved, 0.0), limit = row.friction * (m_law == FrictionLaw::lagged ? m_last : m_impulse)[at];
      } else if (row.law == ProblemLaw::tangent) {
        moved = std::clamp(moved, -std::max(limit, 0.0), std::max(limit, 0.0));
      } else {
        m_rows.project(i, &moved);
      }
      const double error = (m_impulse[at] - moved) / row.unit;
      squared = error * error + (row.law == ProblemLaw::tangent ? squared : 0);
      worst = worse(worst, std::sqrt(squared));
    }
    return worst;
  }

  // Row velocities of a converged solution: each method continues from the best of the previous ones. Impulses of
  // redundant contacts are not unique; velocities are, except those of friction.
  void findReference() {
    FrozenProblem<D> best = m_problem;
    best.lastDt = best.dt;
    double least = std::numeric_limits<double>::infinity();
    for (const char* resolver : kReferenceResolvers) {
      const Spec spec = Spec::parse(resolver);
      FrozenProblem<D> warm = best;
      for (int i = 0; i < kReferenceTries && least > kConverged; ++i) {
        FrozenProblem<D> copy = warm;
        WorkDone work;
        const VelocityInput<D> in = copy.input(work, m_profiler);
        createStage<VelocityResolver<D>>(spec)->solve(in);
        m_rows.impulses(in, m_impulse);
        const double left = m_rows.naturalMap(m_impulse, m_free).natural / m_unit;
        const auto& motion = copy.bodies.motion;
        const bool finite = std::all_of(motion.begin(), motion.end(),
                                        [](const Motion<D>& m) { return m.v.allFinite() && m.w.allFinite(); });
        if (!std::isfinite(left) || !finite) break;
        warm.manifolds = copy.manifolds, warm.joints = copy.joints;
        if (warm.given) warm.given->impulse = copy.given->impulse;
        if (left >= least) continue;
        least = left, best = warm;
        m_rows.freeVelocities(in, m_reference);
      }
    }
    if (least > kConverged) m_reference.clear();
  }

  // Without friction and joints a sweep is linear on the pressing rows.
  void predict() {
    std::vector<std::int32_t> active;
    const auto& rows = m_rows.rows();
    if (m_rows.size() == 0 || m_rows.size() > kMostRows || m_reference.empty()) return;
    for (std::int32_t i = 0; i < m_rows.size(); ++i) {
      const ProblemRow<D>& row = rows[static_cast<std::size_t>(i)];
      if (row.ofJoint || row.law != ProblemLaw::interval) return;
      if (m_reference[static_cast<std::size_t>(i)] < 1e-6 * m_unit) active.push_back(i);
    }
    std::vector<double> w;
    m_rows.assemble(active, w);
    const Spectrum spectrum = spectrumOf(w, active.size());
    m_seen.rank = spectrum.rank, m_seen.predicted = spectrum.gaussSeidel;
  }

  FrozenProblem<D> m_problem;
  Spec m_spec;
  bool m_timed;
  int m_iterations, m_least = 0;
  std::string m_effort;
  FrictionLaw m_law = FrictionLaw::unstated;
  Profiler m_profiler;
  ContactProblem<D> m_rows;
  std::vector<double> m_free, m_last, m_impulse, m_velocity, m_reference;
  double m_unit = 1;  // m/s
  std::uint64_t m_hash = 0;
  ProblemsSeen m_seen;
};

template <int D>
TrialResult runProblem(const ProblemRequest& asked, const ProblemFile& file) {
  const auto& list = file.of<D>();
  if (asked.problem >= list.size()) throw UserError("no problem has the number " + std::to_string(asked.problem));
  try {
    return ProblemTrial<D>(asked, list[asked.problem].problem).run();
  } catch (const UserError& e) {  // a witness that does not support such a problem, or is absent
    TrialResult out;
    out.fail("unsupported", e.what(), 0);
    return out;
  }
}

}  // namespace

TrialResult runProblemsTrial(const ProblemRequest& asked, const std::string& problemFile) {
  const ProblemFile file = ProblemFile::load(problemFile);
  return file.dimension == 2 ? runProblem<2>(asked, file) : runProblem<3>(asked, file);
}

}}  // namespace lpc::LPC_PRECISION
