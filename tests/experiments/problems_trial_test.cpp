// SPDX-License-Identifier: Zlib
// Resolvers alone on frozen problems: the residual falls as the spectrum of W predicts, and a method that cannot run
// says why.
#include <nlohmann/json.hpp>

#include "experiments/runner/sweep_file.h"
#include "experiments/trial/formats/problem_file.h"
#include "experiments/trial/measure/problem_spectrum.h"
#include "experiments/trial/trial.h"
#include "framework/stage/profiler.h"
#include "oracles/witnesses/witness_resolver.h"
#include "tests/expect_caught.h"
#include "tests/experiments/refused.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace problems_trial_test { namespace {

using nlohmann::json;
using test::Workspace;

TEST(Spectrum, PredictsTheRateOfConvergence) {
  const std::vector<double> two = {2, 1, 1, 2};
  const Spectrum s = spectrumOf(two, 2);
  EXPECT_EQ(s.rank, 2);
  EXPECT_NEAR(s.gaussSeidel, 0.25, 1e-12);
  // Masses of 1 and 100 in one row each: the unit of a row does not affect convergence.
  const Spectrum scaled = spectrumOf(std::vector<double>{2, 10, 10, 200}, 2);
  EXPECT_NEAR(scaled.gaussSeidel, 0.25, 1e-12);
  // The same contact twice: one update of either solves both.
  const Spectrum twice = spectrumOf(std::vector<double>{1, 1, 1, 1}, 2);
  EXPECT_EQ(twice.rank, 1);
  EXPECT_NEAR(twice.gaussSeidel, 0, 1e-12);
}

/// catto, but its second iteration gives NaN.
template <int D>
class NotANumber final : public VelocityResolver<D> {
 public:
  enum class Where { nowhere, impulse, velocity, turn };
  struct Params {
    Where where = Where::nowhere;
    int rounds = 1;
    void visit(ParamVisitor& v) {
      v.choice("where", where, {"nowhere", "impulse", "velocity", "turn"}, "what is spoiled");
      v.integer("rounds", rounds, 0, 100, "sweeps", ParamRole::effort);
    }
  };
  explicit NotANumber(const Params& params) : m_params(params) {}
  static AlgorithmInfo info() {
    return {.name = "planted_nan",
            .summary = "planted bug",
            .paper = "",
            .complexity = "that of catto",
            .friction = FrictionLaw::coulomb,
            .role = AlgorithmRole::witness};
  }
  void solve(const VelocityInput<D>& in) override {
    Spec right{"catto", {}};
    right.set("iterations", {std::to_string(m_params.rounds), {}});
    createStage<VelocityResolver<D>>(right)->solve(in);
    if (m_params.rounds != 2) return;
    const Real nan = std::numeric_limits<Real>::quiet_NaN();
    if (m_params.where == Where::impulse) in.manifolds.back().points[0].impulse[0] = nan;
    if (m_params.where == Where::velocity) in.bodies.motion.back().v[0] = nan;
    if (m_params.where == Where::turn) in.bodies.motion.back().w[0] = nan;
  }

 private:
  Params m_params;
};
LPC_REGISTER(VelocityResolver, NotANumber, 2);

/// A witness that might run in its own process and reports its own time.
template <int D>
class WithAClock final : public WitnessResolver<D> {
 public:
  struct Params {
    void visit(ParamVisitor&) {}
  };
  explicit WithAClock(const Params&) {}
  static AlgorithmInfo info() {
    return {.name = "planted_clock",
            .summary = "a clock of its own",
            .paper = "",
            .complexity = "1",
            .friction = FrictionLaw::coulomb,
            .role = AlgorithmRole::witness};
  }
  void solve(const VelocityInput<D>&) override {}
  double nanoseconds() const override { return 3e9; }
};
LPC_REGISTER(VelocityResolver, WithAClock, 2);

template <int D>
struct LastProblem final : VelocityWatcher<D> {
  FrozenProblem<D> frozen;
  void see(const VelocityInput<D>& in) override { frozen = freeze(in, defaultGravity<D>()); }
};

/// Saves the problem of the world's last step in a file of the workspace.
template <int D>
std::string problemFile(const Workspace& w, World<D>& world, int steps) {
  LastProblem<D> last;
  world.watch(&last);
  for (int i = 0; i < steps; ++i) world.step(Real(1) / 60);
  std::ofstream out(w.path("stack.json"));
  writeProblems<D>(out, {{"stack", steps - 1, last.frozen}});
  return w.path("stack.json");
}

std::string stackFile(const Workspace& w, int n) {
  World<2> world;
  test::addGround(world);
  for (int i = 0; i < n; ++i) {
    world.add(test::body<2>(Shape<2>::box({Real(0.5), Real(0.5)}), test::at<2>(0, 0.5 + 0.999 * i)));
  }
  return problemFile<2>(w, world, 20);
}

TrialResult trialOf(const std::string& file, const std::string& velocity, int iterations, const char* start = "cold",
                    const char* friction = "on", const char* order = "recorded", bool timed = false) {
  ProblemRequest asked;
  asked.velocity = velocity, asked.iterations = iterations, asked.timed = timed;
  asked.cold = std::string_view(start) == "cold", asked.friction = std::string_view(friction) == "on";
  asked.coloured = std::string_view(order) == "coloured";
  return runTrial({.trial = asked, .sceneFile = file});
}

TEST(ProblemsTrial, ResidualFallsAsTheMatrixSays) {
  Workspace w;
  const std::string file = stackFile(w, 6);
  for (const char* order : {"recorded", "coloured"}) {
    const TrialResult r = trialOf(file, "catto", 150, "cold", "off", order);
    ASSERT_EQ(r.outcome, "ok") << r.reason;
    const double predicted = r.metrics.at("predicted_rate"), rate = r.metrics.at("rate");
    EXPECT_GT(predicted, 0.5) << order;
    EXPECT_LT(predicted, 1) << order;
    EXPECT_NEAR(rate, predicted, 0.02 * (1 - predicted) + 0.005) << order;
    test::expectCaught("ProblemsTrial a rate that is squared",
                       std::abs(rate * rate - predicted) < 0.02 * (1 - predicted) + 0.005);
    EXPECT_EQ(r.metrics.at("rows"), 12);
  }
}

TEST(ProblemsTrial, MeasuresTheResidual) {
  Workspace w;
  const std::string file = stackFile(w, 2);
  const TrialResult cold = trialOf(file, "catto", 200), warm = trialOf(file, "catto", 200, "warm");
  const auto& curve = cold.series.at("problem_residual");
  ASSERT_EQ(curve.size(), 201u);
  EXPECT_GT(curve[0], 0.5) << "nothing is pushed yet: all of g dt is left";
  EXPECT_LT(curve[200], 1e-3 * curve[0]);
  EXPECT_LT(warm.series.at("problem_residual")[0], 0.1 * curve[0]);
  EXPECT_LT(cold.metrics.at("velocity_error"), 0.01);
  EXPECT_GT(cold.series.at("velocity_error")[0], 0.5);
  EXPECT_LT(cold.metrics.at("unexplained_velocity"), 1e-9);
  const auto first = static_cast<std::size_t>(cold.metrics.at("iterations_to_thousandth"));
  EXPECT_GT(curve.at(first - 1), 1e-3);
  EXPECT_LE(curve.at(first), 1e-3);
  EXPECT_EQ(cold.metrics.at("multiply_adds_to_thousandth"), cold.series.at("multiply_adds")[first]);
  EXPECT_LT(cold.series.at("multiply_adds")[0], cold.series.at("multiply_adds")[1]) << "at first rows are made alone";
  EXPECT_EQ(cold.metrics.count("ns_per_solve"), 0u);
  EXPECT_GT(trialOf(file, "catto", 5, "cold", "on", "recorded", true).metrics.at("ns_per_solve"), 0);
  // A method that creates momentum is detected. By its impulses alone it would look better than its velocities are.
  EXPECT_GT(trialOf(file, "shock_propagation", 3).metrics.at("unexplained_velocity"), 1e-3);
  for (const char* method : {"millington", "direct_lcp"}) {
    const TrialResult once = trialOf(file, method, 100);
    EXPECT_EQ(once.series.at("problem_residual").size(), 1u) << method << " has no number of iterations";
    EXPECT_TRUE(std::isnan(once.metrics.at("iterations_to_thousandth"))) << method;
  }
}

TEST(ProblemsTrial, AWitnessReportsItsOwnTime) {
  Workspace w;
  const std::string file = stackFile(w, 2);
  EXPECT_NEAR(trialOf(file, "planted_clock", 1, "cold", "on", "recorded", true).metrics.at("ns_per_solve"), 3e9, 1);
}

// A box that slides obliquely in 3D, where friction laws differ: each method has no residual by its own law.
TEST(ProblemsTrial, HasNoResidualByItsOwnLaw) {
  Workspace w;
  World<3> world;
  test::addGround(world);
  BodyDef<3> box = test::body<3>(Shape<3>::box(Vec<3>::Constant(Real(0.5))), test::at<3>(0, 0.499));
  box.velocity = Vec<3>(2, 0, 1);
  world.add(box);
  const std::string file = problemFile<3>(w, world, 3);
  const auto left = [&](const std::string& method, const char* measure) {
    const TrialResult r = trialOf(file, method, 400, "warm");
    EXPECT_EQ(r.outcome, "ok") << r.reason;
    return r.metrics.at(measure);
  };
  for (const char* method : {"catto", "catto{friction=pyramid}", "admm{correction=none}"}) {
    EXPECT_LT(left(method, "own_residual"), 1e-6) << method;
    EXPECT_EQ(left(method, "problem_residual") > 1e-3, std::string(method) != "catto") << method;
  }
  // Without De Saxce's correction the measure accepts a box that its sliding lifts.
  test::expectCaught("ProblemsTrial a natural map without De Saxce's correction",
                     left("admm{correction=none}", "own_residual") > 1e-3);
  EXPECT_TRUE(std::isnan(left("direct_lcp", "own_residual"))) << "where its facets lie only it knows";
  // Box friction: its limits come from the normal impulse of the last step and are zero without one.
  EXPECT_LT(left("catto{friction=box}", "own_residual"), 1e-6);
}

// A method that starts at one iteration also has a value for zero: the impulses of the last step, or none.
TEST(ProblemsTrial, CurvesBeginAtZeroIterations) {
  Workspace w;
  const std::string file = stackFile(w, 2);
  for (const char* start : {"cold", "warm"}) {
    const TrialResult admm = trialOf(file, "admm", 3, start), catto = trialOf(file, "catto", 3, start);
    ASSERT_EQ(admm.series.at("problem_residual").size(), 4u);
    EXPECT_NEAR(admm.series.at("problem_residual")[0], catto.series.at("problem_residual")[0], 1e-9);
    EXPECT_EQ(admm.series.at("multiply_adds")[0], 0);
  }
}

TEST(ProblemsTrial, NaNIsARowWithAReason) {
  Workspace w;
  const std::string file = stackFile(w, 3);
  EXPECT_EQ(trialOf(file, "planted_nan", 4).outcome, "ok");
  for (const char* where : {"impulse", "velocity", "turn"}) {
    for (const int iterations : {2, 4}) {  // at the end, and on the way
      const TrialResult r = trialOf(file, std::string("planted_nan{where=") + where + "}", iterations);
      EXPECT_EQ(r.outcome, "diverged") << where;
      EXPECT_EQ(r.reason, "nan");
      EXPECT_EQ(r.step, 2);
      const bool pushed = std::string(where) == "impulse";
      for (const char* name : {"problem_residual", "own_residual"}) {
        EXPECT_EQ(std::isnan(r.series.at(name)[2]), pushed) << where << ' ' << name;
        EXPECT_TRUE(std::isfinite(r.series.at(name)[1])) << where << ' ' << name;
      }
      EXPECT_EQ(std::isnan(r.metrics.at("cone_error")), pushed && iterations == 2) << where;
      EXPECT_EQ(std::isnan(r.metrics.at("unexplained_velocity")), iterations == 2) << where;
    }
  }
}

TEST(ProblemsTrial, SweepsNameProblemsBesideThem) {
  Workspace w;
  stackFile(w, 3);
  const std::string head = "summary = \"s\"\nkind = \"problems\"\n[axes]\n";
  w.write("s.toml", head + "problems = \"stack\"\nvelocity = [\"*\", \"soft_step\"]\nstart = [\"cold\", \"warm\"]\n" +
                        "iterations = 5\n");
  const auto sweeps = planSweeps(w.path("s.toml"), {}, {}, {});
  ASSERT_EQ(sweeps.size(), 1u);
  std::size_t resolvers = 0, unsupported = 0;
  for (const Registered* r : Registry::instance().list(StageKind::velocity, 2)) {
    resolvers += r->info.role == AlgorithmRole::competitor;
  }
  EXPECT_EQ(sweeps[0].trials.size(), 2 * (resolvers + 1));
  for (const PlannedTrial& trial : sweeps[0].trials) {
    EXPECT_EQ(trial.canonical["dimension"], 2);
    if (trial.unsupported.empty()) continue;
    ++unsupported;
    EXPECT_NE(trial.unsupported.find("soft_step integrates between its passes"), std::string::npos);
  }
  EXPECT_EQ(unsupported, 2u);
  const test::Outcome ran = w.lpc("sweep s.toml --store s.db");
  EXPECT_EQ(ran.code, 0) << ran.text;
  EXPECT_EQ(test::ask(w.path("s.db"), "SELECT COUNT(*) FROM trial WHERE outcome='ok'"), std::to_string(2 * resolvers));

  const auto bad = [&](const std::string& axes, const test::Parts& parts) {
    w.write("bad.toml", head + axes);
    test::refused(w, "sweep bad.toml --store none.db", parts);
  };
  bad("problems = \"stuck\"\nvelocity = \"catto\"\n", {"bad.toml:", "no file 'stuck'"});
  bad("velocity = \"catto\"\n", {"needs the axis 'problems'"});
  bad("problems = \"stack\"\nvelocity = \"cato\"\n", {"'cato'", "catto"});
  bad("problems = \"stack\"\nvelocity = \"catto\"\nproblem = 1\n", {"axis 'problem' is 1", "from 0 to 0"});
  bad("problems = \"stack\"\nvelocity = \"catto\"\nstart = \"hot\"\n", {"axis 'start' is \"hot\"", "warm"});
  bad("problems = \"stack\"\nvelocity = \"catto\"\nscene = \"pyramid\"\n", {"axis 'scene' is unknown"});
  w.write("stack.json", "{}");
  bad("problems = \"stack\"\nvelocity = \"catto\"\n", {"stack.json: not a file of problems"});
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::problems_trial_test
