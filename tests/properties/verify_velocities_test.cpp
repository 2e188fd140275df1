// SPDX-License-Identifier: Zlib
// Velocity resolvers that solve to convergence, and their witness, on drawn problems: the residual shows which one is
// wrong.
#include <gtest/gtest.h>

#include "framework/stage/profiler.h"
#include "oracles/corpus/drawn_problem.h"
#include "oracles/verify/verify.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace verify_velocities_test { namespace {

template <int D>
using Method = Candidate<VelocityResolver<D>>;

/// The first of our converging resolvers, on a changed problem.
template <int D>
class Planted final : public VelocityResolver<D> {
 public:
  using Change = void (*)(Manifold<D>&);
  explicit Planted(Change change) : m_change(change) {}
  void solve(const VelocityInput<D>& in) override {
    for (Manifold<D>& m : in.manifolds) m_change(m);
    createStage<VelocityResolver<D>>(convergedResolvers(D)[0])->solve(in);
  }

 private:
  Change m_change;
};

template <int D>
Method<D> registered(const Spec& spec) {
  return {spec.text(), Registry::instance().find(StageKind::velocity, D, spec.name).info,
          [spec] { return createStage<VelocityResolver<D>>(spec); }};
}

template <int D>
LedgerEntry rowOf(const Verified& v, const std::string& method, const std::string& family = "") {
  LedgerKey key;
  key.stage = "velocity", key.precision = sizeof(Real) == 8 ? "f64" : "f32", key.dimension = D;
  key.axis = family.empty() ? "all" : "family", key.value = family, key.method = method;
  return v.ledger.at(key);
}

template <int D>
Verified asked(const std::vector<Method<D>>& methods, int count) {
  Verified out;
  verifyVelocities<D>({.seed = 1, .first = 0, .count = count}, methods, out);
  return out;
}

constexpr int kProblems = 40;

// Of 40 problems most are solved by all methods with the same velocities, even if the impulses are not unique. Admm and
// Siconos converge on nearly all; unconverged solutions of the others are recorded as wrong.
template <int D>
void agree() {
  std::vector<Method<D>> methods = {registered<D>({"siconos", {}})};
  for (const Spec& spec : convergedResolvers(D)) methods.push_back(registered<D>(spec));
  if (rowOf<D>(asked<D>({methods[0]}, 1), "siconos")[Tally::refused] > 0)
    GTEST_SKIP() << "Siconos is not in this build";
  const Verified v = asked<D>(methods, kProblems);
  for (const Method<D>& m : methods) {
    const LedgerEntry row = rowOf<D>(v, m.name);
    std::printf("%-75s agree %ld, tie %ld, wrong %ld, undecided %ld, largest error %.1e\n", m.name.c_str(),
                row[Tally::agree], row[Tally::tie], row[Tally::wrong], row[Tally::undecided], row.maxError);
    EXPECT_EQ(row[Tally::asked], kProblems) << m.name;
    EXPECT_LE(row[Tally::undecided], 2) << m.name;
    EXPECT_EQ(row[Tally::agree] + row[Tally::tie] + row[Tally::wrong] + row[Tally::undecided], kProblems) << m.name;
    const bool exact = m.name.starts_with("admm") || m.name == "siconos";
    EXPECT_LE(row[Tally::wrong], exact ? 2 : kProblems / 4) << m.name;
    EXPECT_GT(rowOf<D>(v, m.name, "hyperstatic")[Tally::agree], 2) << m.name;
    EXPECT_EQ(m.info.role == AlgorithmRole::witness, row.role == AlgorithmRole::witness);
  }
}
TEST(VerifyVelocities, OursAndSiconosAgree2) { agree<2>(); }
TEST(VerifyVelocities, OursAndSiconosAgree3) { agree<3>(); }

// info().failures of admm: its default of 100 iterations leaves problems that the settings of convergedResolvers()
// solve.
template <int D>
void needsManyIterations() {
  std::vector<Method<D>> methods = {registered<D>({"admm", {}})};
  for (const Spec& spec : convergedResolvers(D)) {
    if (spec.name == "admm") methods.push_back(registered<D>(spec));
  }
  ASSERT_EQ(methods.size(), 2u);
  const Verified v = asked<D>(methods, kProblems);
  const auto wrong = [&](const Method<D>& m) { return rowOf<D>(v, m.name)[Tally::wrong]; };
  std::printf("%dD: %ld of %d wrong by default, %ld converged\n", D, wrong(methods[0]), kProblems, wrong(methods[1]));
  EXPECT_GE(wrong(methods[0]), kProblems / 10);
  EXPECT_LE(wrong(methods[1]), 1);
}
TEST(VerifyVelocities, AdmmNeedsManyIterations) { needsManyIterations<2>(), needsManyIterations<3>(); }

template <int D>
Method<D> witness(std::function<std::unique_ptr<VelocityResolver<D>>()> create) {
  AlgorithmInfo info;
  info.role = AlgorithmRole::witness;
  return {"planted", info, std::move(create)};
}

// A witness with one fault is found.
template <int D>
void finds(const char* what, typename Planted<D>::Change change) {
  const Method<D> planted = witness<D>([change] { return std::make_unique<Planted<D>>(change); });
  test::expectCaught(std::string("VerifyVelocities a witness that takes ") + what,
                     rowOf<D>(asked<D>({planted}, kProblems), "planted")[Tally::wrong] < 5);
}
TEST(VerifyVelocities, FindsAWitnessThatIsWrong) {
  finds<2>("friction for twice as large", [](Manifold<2>& m) { m.friction *= 2; });
  finds<3>("friction for a hundredth larger", [](Manifold<3>& m) { m.friction *= Real(1.01); });
  finds<3>("gaps for contacts", [](Manifold<3>& m) {
    for (ContactPoint<3>& c : m.points) c.separation = std::min(c.separation, Real(0));
  });
}

/// Returns the right impulses and another velocity.
class Elsewhere final : public VelocityResolver<3> {
 public:
  void solve(const VelocityInput<3>& in) override {
    createStage<VelocityResolver<3>>(convergedResolvers(3)[0])->solve(in);
    in.bodies.motion.back().v[0] += Real(0.01);
  }
};
TEST(VerifyVelocities, JudgesVelocitiesNotImpulses) {
  const Method<3> planted = witness<3>([] { return std::make_unique<Elsewhere>(); });
  test::expectCaught("VerifyVelocities right impulses and another velocity",
                     rowOf<3>(asked<3>({planted}, kProblems), "planted")[Tally::wrong] < kProblems / 2);
}

/// The number of verdicts that change, even in the last bit, when a method runs alone instead of among all.
template <int D>
int differing(const std::vector<Method<D>>& methods) {
  int out = 0;
  for (int i = 0; i < kProblems / 2; ++i) {
    const FrozenProblem<D> problem = drawProblem<D>(1, i).problem;
    const std::vector<Verdict> among = verifyProblem<D>(problem, methods);
    for (std::size_t k = 0; k < methods.size(); ++k) {
      const Verdict alone = verifyProblem<D>(problem, std::span(&methods[k], 1))[0];
      out += alone.end != among[k].end || alone.error != among[k].error || alone.value != among[k].value;
    }
  }
  return out;
}

// A method's verdict, right or wrong, does not depend on the other methods. Siconos is among them, which may leave a
// smaller residual than any of ours.
template <int D>
void alike() {
  const auto twice = [](Manifold<D>& m) { m.friction *= 2; };
  std::vector<Method<D>> methods = {registered<D>({"siconos", {}}),
                                    witness<D>([twice] { return std::make_unique<Planted<D>>(twice); })};
  for (const Spec& spec : convergedResolvers(D)) methods.push_back(registered<D>(spec));
  EXPECT_EQ(differing<D>(methods), 0);
  // Planted bug: a reference taken from the tested methods. One wrong resolver replaces our converging ones.
  for (std::size_t k = 2; k < methods.size(); ++k) methods[k].create = methods[1].create;
  test::expectCaught("VerifyVelocities a reference of those that are asked", differing<D>(methods) == 0);
}
TEST(VerifyVelocities, VerdictsAreIndependentOfOtherMethods2) { alike<2>(); }
TEST(VerifyVelocities, VerdictsAreIndependentOfOtherMethods3) { alike<3>(); }

// The problem of a number is reproducible, and has rows to solve.
TEST(VerifyVelocities, DrawsTheSameAgain) {
  std::map<std::string, int> families;
  for (int i = 0; i < 100; ++i) {
    const DrawnProblem<3> once = drawProblem<3>(7, i), again = drawProblem<3>(7, i);
    ++families[once.family];
    ASSERT_GT(once.problem.points(), 0);
    ASSERT_EQ(once.problem.points(), again.problem.points());
    ASSERT_EQ(once.problem.bodies.motion.back().v, again.problem.bodies.motion.back().v);
  }
  EXPECT_EQ(families.size(), 6u);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::verify_velocities_test
