// SPDX-License-Identifier: Zlib
// Measures of rest: which bodies are supported, have sunk or have left, and a body that must fall beside resting ones.
#include "experiments/trial/measure/rest.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/runner/sweep_file.h"
#include "experiments/trial/measure/control.h"
#include "experiments/trial/trial.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace rest_test { namespace {

using test::Workspace;

TrialResult run(const std::string& scene, WorldCell cell) {
  Planner planner;
  const PlannedTrial t = planner.world(scene, cell);
  return runTrial(t.request);
}

TrialResult run(const std::string& scene, const std::string& pipeline, const ParameterValues& params = {},
                std::optional<long> steps = {}) {
  WorldCell cell;
  cell.pipeline = pipeline, cell.params = params, cell.steps = steps;
  return run(scene, cell);
}

TrialResult runText(const std::string& text, const std::string& pipeline = "") {
  Workspace w;
  return run(w.write("scene.toml", "name = \"s\"\nsummary = \"s\"\ndimensions = [2, 3]\n" + text), pipeline);
}

TEST(Rest, SharesAreOfTheSmallestBodyBeyondTheSlop) {
  Rest r;
  r.size = 0.5, r.levels = 4, r.fall = 0.1, r.sag = 0.1 + 4 * 0.005 + 0.01, r.depth = 0.015, r.sinking = 0.001;
  EXPECT_NEAR(r.sagShare(), 0.02, 1e-6);  // the slop is a float in f32
  EXPECT_NEAR(r.depthShare(), 0.02, 1e-6);
  EXPECT_NEAR(r.sinkingShare(), 0.002, 1e-12);
  EXPECT_EQ(r.share(), std::max(r.sagShare(), r.depthShare()));
  r.sinking = std::nan("");
  EXPECT_NEAR(r.share(), 0.02, 1e-6) << "of a run of less than a second nobody knows it";
  r.sag = 0, r.depth = 0;
  EXPECT_EQ(r.share(), 0);
}

// A box of 1 m into which another has sunk by nearly a metre: it rests, keeps its neighbours, and supports nothing.
TEST(Rest, ASunkBodyIsNotSupported) {
  const TrialResult through = run("mass_ratio", "solver=avbd{iterations=1}", {{"ratio", 10000}}, 600);
  EXPECT_EQ(through.outcome, "sank") << through.reason;
  EXPECT_NE(through.reason.find("of the smallest body (1 m), over 1 %"), std::string::npos) << through.reason;
  EXPECT_GT(through.metrics.at("sunk"), 0.9);
  const TrialResult held = run("mass_ratio", "solver=split_solver{velocity=direct_lcp}", {{"ratio", 100}});
  EXPECT_EQ(held.outcome, "ok") << held.reason;
  EXPECT_LT(held.metrics.at("sunk"), kRestShare);
  EXPECT_EQ(held.metrics.at("smallest_body"), 1);
  // The planted bug: drift alone, as in an early version.
  EXPECT_LT(through.metrics.at("lateral_max"), 0.5) << "nobody went aside, and all touch whom they touched";
}

// A run that ends while a body is still falling does not decide whether it is supported.
TEST(Rest, ABodyNotYetAtRestIsNotJudged) {
  const TrialResult early = run("mass_ratio", "solver=avbd{iterations=1}", {{"ratio", 10000}}, 59);
  EXPECT_EQ(early.outcome, "ok") << early.reason;
  EXPECT_GT(early.metrics.at("sunk"), kRestShare) << "but it is told";
}

TEST(Rest, ARepeatHasTheOutcomeOfTheFirst) {
  WorldCell cell;
  cell.pipeline = "solver=avbd{iterations=1}", cell.params = {{"ratio", 10000}}, cell.steps = 300, cell.timed = true;
  const TrialResult first = run("mass_ratio", cell);
  cell.repeat = 1;
  const TrialResult again = run("mass_ratio", cell);
  EXPECT_EQ(first.outcome, "sank");
  EXPECT_EQ(again.outcome, "sank");
  EXPECT_EQ(again.reason, first.reason);
  EXPECT_EQ(again.metrics.at("sunk"), first.metrics.at("sunk"));
}

const std::string kFloor = R"(
needs = []
gravity = [0, -10, 0]
steps = 240
[[body]]
type = "fixed"
position = [0, -1, 0]
shapes = [{ kind = "box", half = [2, 1, 2] }]
)";
const std::string kSlides = R"([[body]]
position = [0, 0.5, 0]
velocity = [4, 0, 0]
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5] }]
)";

TEST(Rest, ABodyBelowAllSupportsHasLeft) {
  const TrialResult over = runText(kFloor + kSlides);
  EXPECT_EQ(over.outcome, "left") << over.reason;
  EXPECT_NE(over.reason.find("over an edge"), std::string::npos) << over.reason;
  EXPECT_GT(over.step, 30);
  const TrialResult through = runText(kFloor + R"([[body]]
position = [0, 3, 0]
velocity = [0, -300, 0]
shapes = [{ kind = "box", half = [0.1, 0.1, 0.1] }]
)");
  EXPECT_EQ(through.outcome, "left") << through.reason;
  EXPECT_NE(through.reason.find("through it"), std::string::npos) << through.reason;
  const std::string may = "[limits]\nmay_leave = 1\n";
  EXPECT_EQ(runText(kFloor + may + kSlides).outcome, "ok");
  EXPECT_EQ(runText("needs = []\nsteps = 240\n" + kSlides).outcome, "ok") << "nothing is fixed, and all fall";
  const std::string plane = R"(
needs = []
steps = 240
[[body]]
type = "fixed"
position = [0, 0, 0]
shapes = [{ kind = "plane" }]
)";
  EXPECT_EQ(runText(plane + kSlides).outcome, "ok");
}

TEST(Rest, AHangingBodyHasNotLeft) {
  const std::string nail = R"(
needs = ["joints", "rotation"]
steps = 120
[[body]]
name = "nail"
type = "fixed"
shapes = [{ kind = "circle", radius = 0.05, mask = 0 }]
[[body]]
name = "bob"
position = [0, -9, 0]
shapes = [{ kind = "circle", radius = 0.1 }]
)";
  EXPECT_EQ(runText(nail + "[[joint]]\nkind = \"pivot\"\na = \"nail\"\nb = \"bob\"\nanchor = [0, 0, 0]\n").outcome,
            "ok");
  EXPECT_EQ(runText(nail).outcome, "left");
}

// A motion of 1e-8 m a step vanishes where an ulp is 1e-7 m: all bodies rest, whatever supports them.
std::string far(double y) {
  return R"(
needs = []
gravity = [0, -1e-6, 0]
steps = 120
[limits]
levels = 1
[[body]]
type = "fixed"
position = [0, )" +
         std::to_string(y - 1) + R"(, 0]
shapes = [{ kind = "box", half = [2, 1, 2] }]
[[body]]
position = [0, )" +
         std::to_string(y + 0.5) + R"(, 0]
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5] }]
)";
}

TEST(Rest, StillnessIsFrozenIfAFreeBodyDoesNotFall) {
  EXPECT_EQ(runText(far(0)).outcome, "ok");
  const TrialResult frozen = runText(far(1e9));
  EXPECT_EQ(frozen.outcome, "frozen") << frozen.reason;
  EXPECT_NE(frozen.reason.find("falls by 0 m"), std::string::npos) << frozen.reason;
  EXPECT_EQ(frozen.metrics.at("sunk"), 0) << "by sinking alone this run would be held";
}

TEST(Rest, ABodyAloneFallsByTheClosedFormWhateverMovesIt) {
  for (const char* pipeline : {"", "solver=soft_step", "solver=xpbd", "solver=avbd", "sleep=timer_island"}) {
    for (const double dt : {1. / 60, 0.13, 1e-3}) {
      SceneSpec<2> scene;
      scene.dt = Real(dt);
      BodyDef<2> body;
      body.X_WB.p = {0, 1000};
      body.shapes.push_back({Shape<2>::sphere(Real(0.5))});
      const Control control = dropAlone<2>(pipeline, scene, body);
      EXPECT_TRUE(control.falls()) << pipeline << " " << dt << ": " << control.reason();
      EXPECT_NEAR(control.right, 9.81 / 8, 0.2);
    }
  }
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::rest_test
