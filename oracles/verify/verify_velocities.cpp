// SPDX-License-Identifier: Zlib
// Velocity resolvers that should converge, on drawn problems. Unlike a distance, an answer cannot be proved: the least
// residual of our converging resolvers is the reference. The residuals of other answers show whether they are wrong or
// another solution. Residuals are computed in long double, from impulses and from velocities alike.
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "framework/problem/contact_problem.h"
#include "framework/stage/profiler.h"
#include "oracles/corpus/drawn_problem.h"
#include "oracles/verify/verify.h"
#include "oracles/witnesses/witness_resolver.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kSolved =
    sizeof(Real) == 8 ? 1e-8 : 1e-3;  // residual of a solution, relative to the largest velocity of a row
constexpr double kAlike =
    sizeof(Real) == 8 ? 1e-6 : 1e-2;  // difference between velocities of two solutions, likewise relative

using Wide = long double;

/// One method's answer to a problem.
template <int D>
struct Answer {
  Tally end = Tally::agree;  // refused, threw: no answer
  std::vector<double> u;     // of the rows, minus the target, m/s
  Wide left = 0;             // residual, m/s
  double nanoseconds = 0;
};

template <int D>
class Judge {
 public:
  explicit Judge(const FrozenProblem<D>& problem) : m_problem(problem) {
    FrozenProblem<D> copy = problem;
    WorkDone work;
    const VelocityInput<D> in = copy.input(work, m_profiler);
    m_rows.set(in), m_rows.freeVelocities(in, m_free);
    for (const double u : m_free) m_scale = std::max(m_scale, std::abs(u));
  }

  double scale() const { return m_scale; }

  Answer<D> ask(const Candidate<VelocityResolver<D>>& method) {
    Answer<D> out;
    FrozenProblem<D> copy = m_problem;
    WorkDone work;
    const VelocityInput<D> in = copy.input(work, m_profiler);
    try {
      const auto resolver = method.create();
      const double before = threadNanoseconds();
      resolver->solve(in);
      const double spent = threadNanoseconds() - before;
      const auto* witness = dynamic_cast<const WitnessResolver<D>*>(resolver.get());  // a witness reports its own time
      out.nanoseconds = witness ? witness->nanoseconds() : spent;
    } catch (const UserError&) {
      out.end = Tally::refused;
    } catch (const std::exception&) {
      out.end = Tally::threw;
    }
    if (out.end != Tally::agree) return out;
    m_rows.impulses(in.manifolds, in.joints, m_impulse);
    m_rows.freeVelocities(in, out.u);
    out.left = unexplained(out.u);
    out.left = std::max(out.left, naturalMap());
    if (!std::isfinite(out.left)) out.end = Tally::notFinite;
    return out;
  }

 private:
  struct Moved {
    Eigen::Matrix<Wide, D, 1> v = Eigen::Matrix<Wide, D, 1>::Zero();
    Eigen::Matrix<Wide, kAngDim<D>, 1> w = Eigen::Matrix<Wide, kAngDim<D>, 1>::Zero();
  };

  Wide impulse(int i) const { return m_impulse[static_cast<std::size_t>(i)]; }

  // Computes u from the impulses; returns how far the answer's velocities differ from it.
  Wide unexplained(const std::vector<double>& velocity) {
    std::vector<Moved> moved(static_cast<std::size_t>(m_problem.bodies.size()) + 1);
    for (int i = 0; i < m_rows.size(); ++i) {
      const ProblemRow<D>& r = m_rows.row(i);
      Moved &a = moved[static_cast<std::size_t>(r.a)], &b = moved[static_cast<std::size_t>(r.b)];
      a.v -= impulse(i) * r.pushA.template cast<Wide>(), a.w -= impulse(i) * r.turnA.template cast<Wide>();
      b.v += impulse(i) * r.pushB.template cast<Wide>(), b.w += impulse(i) * r.turnB.template cast<Wide>();
    }
    Wide worst = 0;
    m_u.clear();
    for (int i = 0; i < m_rows.size(); ++i) {
      const ProblemRow<D>& r = m_rows.row(i);
      const Moved &a = moved[static_cast<std::size_t>(r.a)], &b = moved[static_cast<std::size_t>(r.b)];
      const Wide u = m_free[static_cast<std::size_t>(i)] + r.d.template cast<Wide>().dot(b.v - a.v) +
                     r.armB.template cast<Wide>().dot(b.w) - r.armA.template cast<Wide>().dot(a.w);
      worst = std::max(worst, std::abs(u - velocity[static_cast<std::size_t>(i)]));
      m_u.push_back(u + r.compliance * impulse(i));
    }
    return worst;
  }

  // Residual of Coulomb's law with De Saxce's correction, maximum over all rows, m/s; as ContactProblem::naturalMap().
  Wide naturalMap() const {
    Wide worst = 0;
    for (int i = 0; i < m_rows.size(); ++i) {
      const ProblemRow<D>& r = m_rows.row(i);
      const auto at = static_cast<std::size_t>(i);
      const Wide mass = r.unit, x = impulse(i);
      Wide left = 0;
      if (r.law == ProblemLaw::free) left = std::abs(m_u[at]);
      if (r.law == ProblemLaw::interval) {
        left = std::abs(x - std::clamp(x - mass * m_u[at], Wide(r.lo), Wide(r.hi))) / mass;
      }
      if (r.law == ProblemLaw::normal) left = contact(i, r.friction, mass) / mass;
      worst = std::isfinite(left) ? std::max(worst, left) : left;
      if (!std::isfinite(left)) break;
    }
    return worst;
  }
  Wide contact(int i, Wide mu, Wide mass) const {
    const auto at = static_cast<std::size_t>(i);
    Wide slide = 0, t = 0, error = 0;
    std::array<Wide, D> moved{};
    for (std::size_t k = 1; k < D; ++k) slide += m_u[at + k] * m_u[at + k];
    for (std::size_t k = 0; k < D; ++k) {
      moved[k] = Wide(m_impulse[at + k]) - mass * (m_u[at + k] + (k == 0 ? mu * std::sqrt(slide) : 0));
      if (k > 0) t += moved[k] * moved[k];
    }
    t = std::sqrt(t);
    if (t > mu * moved[0]) {
      const Wide onto = std::max((moved[0] + mu * t) / (1 + mu * mu), Wide(0));
      for (std::size_t k = 1; k < D; ++k) moved[k] *= onto > 0 ? mu * onto / t : 0;
      moved[0] = onto;
    }
    for (std::size_t k = 0; k < D; ++k) error += (m_impulse[at + k] - moved[k]) * (m_impulse[at + k] - moved[k]);
    return std::sqrt(error);
  }

  const FrozenProblem<D>& m_problem;
  Profiler m_profiler;
  ContactProblem<D> m_rows;
  std::vector<double> m_free, m_impulse;
  std::vector<Wide> m_u;
  double m_scale = std::numeric_limits<double>::min();
};

// A reference without answer has an infinite residual.
template <int D>
Verdict judged(const Answer<D>& answer, const Answer<D>& best, double scale) {
  if (answer.end != Tally::agree) return withoutAnswer(answer.end);
  Verdict out;
  const bool solved = answer.left <= kSolved * scale;
  if (!(best.left <= kSolved * scale)) {  // a method that solves the problem needs no reference, but cannot agree with
                                          // one
    out.end = solved ? Tally::tie : Tally::undecided;
    return out;
  }
  double differs = 0;
  for (std::size_t i = 0; i < best.u.size(); ++i) differs = std::max(differs, std::abs(answer.u[i] - best.u[i]));
  out.error = differs / scale, out.value = static_cast<double>(answer.left);
  if (differs <= kAlike * scale) return out;
  out.end = solved ? Tally::tie : Tally::wrong;
  if (out.end == Tally::wrong) out.failure = "wrong_velocities";
  return out;
}

}  // namespace

template <int D>
std::vector<Verdict> verifyProblem(const FrozenProblem<D>& problem,
                                   std::span<const Candidate<VelocityResolver<D>>> methods,
                                   std::vector<double>* nanoseconds) {
  Judge<D> judge(problem);
  std::vector<Answer<D>> answers;
  for (const Candidate<VelocityResolver<D>>& m : methods) answers.push_back(judge.ask(m));
  // The reference always uses the same methods, so that no verdict depends on which methods are verified.
  Answer<D> best;
  best.left = std::numeric_limits<Wide>::infinity();
  for (const Spec& spec : convergedResolvers(D)) {
    const auto asked =
        std::find_if(methods.begin(), methods.end(), [&](const auto& m) { return m.name == spec.text(); });
    const Answer<D> answer =
        asked != methods.end()
            ? answers[static_cast<std::size_t>(asked - methods.begin())]
            : judge.ask({spec.text(), {}, [spec] { return createStage<VelocityResolver<D>>(spec); }});
    if (answer.end == Tally::agree && answer.left < best.left) best = answer;
  }
  std::vector<Verdict> out;
  for (const Answer<D>& answer : answers) {
    out.push_back(judged(answer, best, judge.scale()));
    if (nanoseconds) nanoseconds->push_back(answer.nanoseconds);
  }
  return out;
}
template std::vector<Verdict> verifyProblem(const FrozenProblem<2>&, std::span<const Candidate<VelocityResolver<2>>>,
                                            std::vector<double>*);
template std::vector<Verdict> verifyProblem(const FrozenProblem<3>&, std::span<const Candidate<VelocityResolver<3>>>,
                                            std::vector<double>*);

template <int D>
void verifyVelocities(const VerifyRange& range, std::span<const Candidate<VelocityResolver<D>>> methods,
                      Verified& out) {
  for (int index = range.first; index < range.first + range.count; ++index) {
    const DrawnProblem<D> drawn = drawProblem<D>(range.seed, index);
    std::vector<double> spent(range.ended ? methods.size() : 0);
    std::vector<Verdict> verdicts(spent.size(), withoutAnswer(range.ended.value_or(Tally::refused)));
    if (!range.ended) verdicts = verifyProblem<D>(drawn.problem, methods, &spent);
    for (std::size_t i = 0; i < methods.size(); ++i) {
      book(out.ledger, subjectOf(StageKind::velocity, D, methods[i].name), methods[i].info.role,
           {{"family", drawn.family}}, verdicts[i], spent[i], [] { return std::string(); });
    }
  }
}
template void verifyVelocities(const VerifyRange&, std::span<const Candidate<VelocityResolver<2>>>, Verified&);
template void verifyVelocities(const VerifyRange&, std::span<const Candidate<VelocityResolver<3>>>, Verified&);

}}  // namespace lpc::LPC_PRECISION
