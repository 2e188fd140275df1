// SPDX-License-Identifier: Zlib
// Siconos and LPC on the shipped problems, in trials and in the ledger: velocities are compared, not impulses.
#include <nlohmann/json.hpp>

#include "experiments/trial/formats/problem_file.h"
#include "experiments/trial/trial.h"
#include "framework/stage/profiler.h"
#include "oracles/verify/verify.h"
#include "oracles/witnesses/witness_resolver.h"
#include "tests/experiments/refused.h"

namespace lpc { inline namespace LPC_PRECISION { namespace siconos_test { namespace {

using test::Workspace;

std::string shipped(const std::string& name) { return LPC_SOURCE_DIR "/experiments/problems/" + name + ".json"; }

template <int D>
void askAll(const std::string& name, const ProblemFile& file, std::map<std::string, Tally>& siconos) {
  std::vector<Spec> specs = convergedResolvers(D);
  specs.push_back({"siconos", {}});
  std::vector<Candidate<VelocityResolver<D>>> methods;
  for (const Spec& spec : specs) {
    methods.push_back({spec.text(), Registry::instance().find(StageKind::velocity, D, spec.name).info,
                       [spec] { return createStage<VelocityResolver<D>>(spec); }});
  }
  ASSERT_EQ(file.size(), 1u) << name;
  const std::vector<Verdict> verdicts = verifyProblem<D>(file.of<D>()[0].problem, methods);
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    const Verdict& v = verdicts[i];
    std::printf("%-18s %-62s %-9s differs %.1e, leaves %.1e m/s\n", name.c_str(), methods[i].name.c_str(),
                std::string(kTallyNames[static_cast<std::size_t>(v.end)]).c_str(), v.error.value_or(-1), v.value);
  }
  EXPECT_EQ(verdicts[0].end, Tally::agree) << name << ": " << methods[0].name;
  EXPECT_TRUE(name == "arch" || verdicts[1].end == Tally::agree) << name << ": " << methods[1].name;
  siconos[name] = verdicts.back().end;
}

// On the arch neither proximal_newton nor Siconos's Gauss-Seidel converges: Siconos's Lemke method does. The card house
// has several solutions: Siconos finds another one, with an equal residual.
TEST(Siconos, AgreesOnTheShippedProblems) {
  std::map<std::string, Tally> siconos;
  for (const char* name :
       {"arch", "card_house", "chain_with_ball", "hyperstatic_table", "mass_ratio", "stack", "wedged_box"}) {
    const ProblemFile file = ProblemFile::load(shipped(name));
    file.dimension == 2 ? askAll<2>(name, file, siconos) : askAll<3>(name, file, siconos);
  }
  if (siconos["stack"] == Tally::refused) GTEST_SKIP() << "Siconos is not in this build";
  for (const auto& [name, end] : siconos) {
    EXPECT_TRUE(end == Tally::agree || (name == "card_house" && end == Tally::tie)) << name;
  }
}

TEST(Siconos, IsAMethodOfTrials) {
  const auto trialOf = [](const char* problem) {
    ProblemRequest asked;
    asked.velocity = "siconos", asked.iterations = 5, asked.cold = true;
    return runTrial({.trial = asked, .sceneFile = shipped(problem)});
  };
  const TrialResult r = trialOf("wedged_box");
  if (r.reason.find("Siconos is not in this build") != r.reason.npos) GTEST_SKIP() << r.reason;
  ASSERT_EQ(r.outcome, "ok") << r.reason;
  EXPECT_EQ(r.series.at("problem_residual").size(), 1u);
  EXPECT_LT(r.metrics.at("problem_residual"), 1e-9);
  EXPECT_LT(r.metrics.at("velocity_error"), 1e-6);
  EXPECT_LT(r.metrics.at("unexplained_velocity"), 1e-9);
}

// Siconos runs in its own process, so this process cannot time it. A test can only check that it reports a time.
TEST(Siconos, ReportsTheTimeOfItsLibrary) {
  FrozenProblem<2> problem = ProblemFile::load(shipped("arch")).of<2>()[0].problem;
  WorkDone work;
  Profiler profiler;
  const auto resolver = createStage<VelocityResolver<2>>(Spec::parse("siconos{sweeps=1}"));
  const auto* siconos = dynamic_cast<const WitnessResolver<2>*>(resolver.get());
  ASSERT_TRUE(siconos);
  try {
    resolver->solve(problem.input(work, profiler));
  } catch (const UserError& e) {
    GTEST_SKIP() << e.what();
  }
  EXPECT_GT(siconos->nanoseconds(), 0);
}

TEST(Siconos, StageOfTheLedger) {
  Workspace w;
  test::refused(w, "verify --stage velocities --store v.db", {"unknown stage 'velocities'", "velocity"});
  test::refused(w, "verify --stage velocity --methods sat --store v.db", {"unknown method 'sat' to verify"});
  const std::string ours = convergedResolvers(2)[0].text();
  const test::Outcome out = w.lpc("verify --stage velocity --dimension 2 --methods '" + ours + "' --store v.db");
  ASSERT_LE(out.code, 1) << out.text;
  const std::string row = " FROM ledger WHERE stage='velocity' AND dimension=2 AND role='competitor'";
  EXPECT_EQ(test::ask(w.path("v.db"), "SELECT asked" + row + " AND axis='all'"), "200");
  EXPECT_EQ(test::ask(w.path("v.db"), "SELECT sum(asked)" + row + " AND axis='family'"), "200");
  EXPECT_GT(std::stoi(test::ask(w.path("v.db"), "SELECT agree" + row + " AND axis='all'")), 190);
  EXPECT_FALSE(std::filesystem::exists(w.path("v.db.found"))) << "a problem is its seed and number";
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::siconos_test
