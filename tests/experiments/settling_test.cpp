// SPDX-License-Identifier: Zlib
// Measures of how a scene settles, on flights, slides, falls and rest with closed forms.
#include "experiments/trial/measure/settling.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/runner/sweep_file.h"
#include "experiments/trial/trial.h"
#include "tests/experiments/workspace.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace settling_test { namespace {

using test::Workspace;

const std::string kHead = R"(
name = "settling"
summary = "a ball or a box with one second and more to go"
dimensions = [2, 3]
needs = ["cache", "friction", "rotation"]
dt = 0.01
steps = 200
)";

TrialResult run(const std::string& rest, const std::string& pipeline = "") {
  Workspace w;
  Planner planner;
  WorldCell cell;
  cell.pipeline = pipeline;
  const PlannedTrial t = planner.world(w.write("scene.toml", kHead + rest), cell);
  return runTrial(t.request);
}

TEST(Settling, FreeFlightIsSidewaysAndDown) {
  const auto m = run(R"(
gravity = [0, -10, 0]
[[body]]
position = [0, 0, 0]
velocity = [3, 0, 0]
angular_velocity = 0.5
shapes = [{ kind = "circle", radius = 0.5 }]
)")
                     .metrics;
  EXPECT_NEAR(m.at("lateral_max"), 6, 1e-4);
  EXPECT_NEAR(m.at("sag_end"), 20, 0.2);  // g t^2 / 2, and g t dt / 2 from the integrator
  EXPECT_NEAR(m.at("tilt_end"), 1, 1e-4);
  EXPECT_NEAR(m.at("creep"), std::hypot(3, 15), 0.1);
  EXPECT_TRUE(std::isnan(m.at("rest_since")));
  EXPECT_EQ(m.at("supports_changed"), 0);
  EXPECT_EQ(m.at("fell_through"), 0);
}

TEST(Settling, WithoutGravityAllMotionIsLateral) {
  const auto m = run(R"(
gravity = [0, 0, 0]
[[body]]
position = [0, 0, 0]
velocity = [3, 4, 0]
shapes = [{ kind = "circle", radius = 0.5 }]
)")
                     .metrics;
  EXPECT_NEAR(m.at("lateral_max"), 10, 1e-4);
  EXPECT_EQ(m.at("sag_end"), 0);
  EXPECT_NEAR(m.at("creep"), 5, 1e-4);
  EXPECT_NEAR(m.at("jitter"), 5, 1e-4);
  EXPECT_NEAR(m.at("angular_momentum_error"), 0, 1e-4);
}

const std::string kTable = R"(
gravity = [0, -10, 0]
[[body]]
type = "fixed"
position = [0, -1, 0]
shapes = [{ kind = "box", half = [2, 1, 2], friction = 0 }]
)";

struct Blow final : ForceGenerator<2> {
  void apply(const ForceState<2>&, Real, std::span<Wrench<2>> out) const override {
    out[0].force[0] = std::numeric_limits<Real>::quiet_NaN();
  }
};

// A body at NaN has no measured sinking, and it is not at rest.
TEST(Settling, ABodyAtNaNHasNotSettled) {
  World<2> world;
  for (const double x : {0.0, 9.0}) world.add(test::body<2>(Shape<2>::sphere(1), test::at<2>(x, 0)));
  world.add(std::make_shared<const Blow>());
  Settling<2> seen;
  seen.start(world, {0, 1});
  for (int i = 0; i < 70; ++i) world.step(Real(1) / 60), seen.observe(world, 1.0 / 60);
  for (const double x : {seen.sag, seen.rise, seen.lateral, seen.lateralMax}) EXPECT_TRUE(std::isnan(x));
  EXPECT_TRUE(std::isnan(seen.jitter()));
  EXPECT_TRUE(std::isnan(seen.restSince()));
  EXPECT_TRUE(std::isnan(quantile({1, std::nan(""), 2}, 0.5)));
}

// The number of steps in the last second must not determine memory.
TEST(Settling, TinyStepsAreKeptOneByOne) {
  World<2> world;
  world.add(test::body<2>(Shape<2>::sphere(1), test::at<2>(0, 0)));
  Settling<2> seen;
  seen.start(world, {0});
  for (const double dt : {1e-9, 1e-300}) {
    for (int i = 0; i < 5; ++i) seen.observe(world, dt);
  }
  EXPECT_TRUE(std::isnan(seen.creep()) && std::isnan(seen.jitter()));
}

TEST(Settling, RestIsReportedFromItsStart) {
  const auto m = run(kTable + R"(
[[body]]
position = [0, 0.5, 0]
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5] }]
)")
                     .metrics;
  EXPECT_NEAR(m.at("rest_since"), 0, 0.1);
  EXPECT_LT(m.at("creep"), 1e-3);
  EXPECT_LT(m.at("jitter"), 1e-3);
  EXPECT_EQ(m.at("supports_changed"), 0);
}

TEST(Settling, SlidingOffATableChangesTheSupports) {
  const auto m = run(kTable + R"(
[[body]]
position = [0, 0.5, 0]
velocity = [1.6, 0, 0]
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5] }]
[limits]
creep = 0.1
)");
  EXPECT_EQ(m.metrics.at("supports_changed"), 1);
  EXPECT_EQ(m.outcome, "collapsed");
  EXPECT_NE(m.reason.find("in a second, over 0.1 m"), std::string::npos) << m.reason;
}

TEST(Settling, ABodyInTheFloorFellThrough) {
  const auto m = run(kTable + R"(
[[body]]
position = [0, -1, 0]
shapes = [{ kind = "circle", radius = 0.1 }]
)",
                     "solver=split_solver{position=none}")
                     .metrics;
  EXPECT_EQ(m.at("fell_through"), 1);
}

// One sweep over three boxes leaves most of the residual, hundreds leave almost none. A method without a velocity
// problem has no residual.
TEST(NaturalMap, IsTheResidualOfAStep) {
  const auto left = [](const std::string& solver) {
    return run(kTable + R"(
[[body]]
repeat = { i = "3" }
position = [0, "0.5 + i", 0]
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5], friction = 0.5 }]
)",
               "solver=" + solver)
        .metrics.at("natural_map_median");
  };
  EXPECT_GT(left("split_solver{velocity=catto{iterations=1,warm_start=false}}"), 0.1);
  EXPECT_LT(left("split_solver{velocity=catto{iterations=500}}"), 1e-6);
  EXPECT_TRUE(std::isnan(left("soft_step")));
}

// Soft contacts under a heavy load sink by more than the limit but hold. The same motion without a support is a
// collapse.
TEST(Settling, SaggingIsNoCollapse) {
  const std::string load = R"(
[[body]]
position = [0, 0.5, 0]
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5] }]
[[body]]
position = [0, 1.5, 0]
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5], density = 200 }]
[limits]
drift = 0.1
)";
  const auto sags = run(kTable + load, "solver=soft_step{hertz=6}");
  EXPECT_EQ(sags.outcome, "ok") << sags.reason;
  EXPECT_GT(sags.metrics.at("sag_end"), 0.1);
  // A lifted load has risen.
  const auto lifted = run(R"(
gravity = [0, -10, 0]
[[body]]
type = "kinematic"
position = [0, -1, 0]
velocity = [0, 0.5, 0]
shapes = [{ kind = "box", half = [2, 1, 2] }]
)" + load,
                          "solver=split_solver");
  EXPECT_EQ(lifted.outcome, "collapsed");
  EXPECT_EQ(run("gravity = [0, -10, 0]\n" + load, "solver=soft_step{hertz=6}").outcome, "collapsed");
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::settling_test
