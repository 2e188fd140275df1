// SPDX-License-Identifier: Zlib
// Velocity problems of scenes for tests: as a whole, and as a matrix alone.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "framework/problem/contact_problem.h"
#include "tests/conformance/impact_scene.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace contact_problem_test {

inline constexpr bool kDouble = sizeof(Real) == 8;
inline constexpr double kRounding = kDouble ? 1e-12 : 1e-5;  // of rotated inertias

struct Nothing2 final : PositionResolver<2> {};
struct Nothing3 final : PositionResolver<3> {};
template <int D>
const PositionResolver<D>& nothing() {
  static const std::conditional_t<D == 2, Nothing2, Nothing3> none;
  return none;
}
template <int D>
VelocityInput<D> inputOf(ImpactScene<D>& s) {
  return {s.dt,   s.lastDt,  s.bodies, s.manifolds, s.active, s.joints, nothing<D>(), s.model, kRestitutionThreshold,
          s.work, s.profiler};
}

template <int D>
struct Whole {
  ContactProblem<D> problem;
  std::vector<double> freeVelocity;
  explicit Whole(ImpactScene<D>& s) {
    problem.set(inputOf(s));
    problem.freeVelocities(inputOf(s), freeVelocity);
  }
  /// Residual of the problem of `before` at the impulses of `after`.
  static ProblemResidual left(ImpactScene<D> before, ImpactScene<D>& after, bool corrected = true) {
    Whole whole(before);
    std::vector<double> x;
    after.lastDt = 0;
    whole.problem.lastImpulses(inputOf(after), 1, x);
    return whole.problem.naturalMap(x, whole.freeVelocity, corrected);
  }
};

/// The matrix of a scene of contacts and pivots, without the scene.
template <int D>
struct Given {
  Whole<D> whole;
  GivenProblem matrix;
  std::vector<std::int32_t> number;  // of the scene's rows: contacts come first, each with all directions

  explicit Given(ImpactScene<D>& s) : whole(s), number(static_cast<std::size_t>(whole.problem.size())) {
    const ContactProblem<D>& p = whole.problem;
    std::int32_t rows = 0;
    for (const bool joints : {false, true}) {
      for (int i = 0; i < p.size(); ++i) {
        const ProblemRow<D>& r = p.row(i);
        if (r.ofJoint != joints) continue;
        const bool normal = !joints && r.law != ProblemLaw::tangent;
        if (normal) rows = D * static_cast<std::int32_t>(matrix.friction.size()), matrix.friction.push_back(r.friction);
        number[static_cast<std::size_t>(i)] = rows++;
      }
      if (!joints) rows = D * static_cast<std::int32_t>(matrix.friction.size());
    }
    matrix.velocity.assign(static_cast<std::size_t>(rows), 0), matrix.impulse = matrix.velocity;
    Eigen::MatrixXd w = Eigen::MatrixXd::Zero(rows, rows);
    for (int i = 0; i < p.size(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      matrix.velocity[static_cast<std::size_t>(number[at])] = whole.freeVelocity[at];
      for (int j = 0; j < p.size(); ++j)
        w(number[at], number[static_cast<std::size_t>(j)]) = p.response(p.row(i), p.row(j));
    }
    for (std::int32_t j = 0; j < rows; ++j) {
      for (std::int32_t i = 0; i < rows; ++i) {
        if (w(i, j) != 0) matrix.row.push_back(i), matrix.value.push_back((w(i, j) + w(j, i)) / 2);
      }
      matrix.start.push_back(static_cast<std::int32_t>(matrix.row.size()));
    }
  }
  static void solve(const Spec& spec, GivenProblem& given) {
    ImpactScene<D> none;
    VelocityInput<D> in = inputOf(none);
    in.given = &given;
    createStage<VelocityResolver<D>>(spec)->solve(in);
  }
  /// Residual of the scene at the solution of the matrix, m/s: by its impulses, and by the velocities that it returns.
  double left(const Spec& spec, GivenProblem given) {
    solve(spec, given);
    std::vector<double> x(number.size()), u;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = given.impulse[static_cast<std::size_t>(number[i])];
    double out = whole.problem.naturalMap(x, whole.freeVelocity).natural;
    whole.problem.multiply(x, u);
    for (std::size_t i = 0; i < x.size(); ++i) u[i] += whole.freeVelocity[i];
    for (std::size_t i = 0; i < x.size(); ++i)
      out = worse(out, std::abs(u[i] - given.velocity[static_cast<std::size_t>(number[i])]));
    return out;
  }
};

}}}}  // namespace lpc::LPC_PRECISION::test::contact_problem_test
