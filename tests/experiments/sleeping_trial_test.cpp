// SPDX-License-Identifier: Zlib
// What trials report on scenes made for sleeping: the wave of the 2009 report, gentle touches, and slow balls.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/runner/locations.h"
#include "experiments/runner/sweep_file.h"
#include "experiments/trial/trial.h"

namespace lpc { inline namespace LPC_PRECISION { namespace sleeping_trial_test { namespace {

TrialResult run(const std::string& scene, const std::string& sleep, int dimension, const ParameterValues& params = {}) {
  Planner planner;
  WorldCell cell;
  cell.params = params, cell.dimension = dimension;
  cell.pipeline = "sleep=" + sleep;
  const PlannedTrial t = planner.world(findToml("scenes", scene), cell);
  return runTrial(t.request);
}

// A policy that waits for a gap wakes each body a step after the one below, as in the report (6.5.1); an island wakes
// in one step.
TEST(SleepingTrial, TheWaveTakesAStepForEachBodyOrNone) {
  for (const int dimension : {2, 3}) {
    for (const double n : {3.0, 5.0}) {
      const auto wave = [&](const std::string& sleep) {
        return run("sleep_wave", sleep, dimension, {{"n", n}}).metrics;
      };
      for (const char* sleep : {"split_average", "millington"}) {
        const auto m = wave(sleep);
        EXPECT_EQ(m.at("woken"), n) << sleep << ' ' << dimension << 'D';
        EXPECT_EQ(m.at("wake_steps"), n - 1) << sleep << ' ' << dimension << 'D';
      }
      const auto island = wave("timer_island"), none = wave("none");
      EXPECT_EQ(island.at("woken"), n) << dimension << 'D';
      EXPECT_EQ(island.at("wake_steps"), 0) << dimension << 'D';
      EXPECT_EQ(none.at("woken"), 0) << dimension << 'D';
      EXPECT_EQ(none.at("awake_mean"), n) << dimension << 'D';
      EXPECT_LT(island.at("awake_mean"), n) << dimension << 'D';
    }
  }
}

// The ball itself does not count. Slower than a blow it wakes no body, faster it wakes the body that it hits. An island
// wakes at any speed.
TEST(SleepingTrial, GentleTouchesWakeIslandsAlone) {
  for (const int dimension : {2, 3}) {
    const auto woken = [&](const std::string& sleep, double speed) {
      return run("sleep_touch", sleep, dimension, {{"speed", speed}}).metrics.at("woken");
    };
    for (const char* sleep : {"split_average", "millington"}) {
      EXPECT_EQ(woken(sleep, 0.05), 0) << sleep << ' ' << dimension << 'D';
      EXPECT_GT(woken(sleep, 1), 0) << sleep << ' ' << dimension << 'D';
    }
    EXPECT_EQ(woken("timer_island", 0.05), 5) << dimension << 'D';
    EXPECT_EQ(woken("none", 0.05), 0) << dimension << 'D';
  }
}

// The distance of a rolling ball shows when it was put to sleep: 20 s at its speed if never.
TEST(SleepingTrial, SlowRollersStopOrRollOn) {
  for (const int dimension : {2, 3}) {
    const auto seconds = [&](const std::string& sleep, double speed) {
      return run("sleep_roll", sleep, dimension, {{"speed", speed}}).metrics.at("end_drift_max") / speed;
    };
    for (const double speed : {0.001, 0.1, 1.0}) EXPECT_NEAR(seconds("none", speed), 20, 0.1) << speed;
    EXPECT_LT(seconds("split_average", 0.001), 0.1);
    EXPECT_NEAR(seconds("split_average", 0.1), 20, 0.1) << "it turns faster than 0.01 rad/s";
    EXPECT_NEAR(seconds("timer_island", 0.001), 0.5, 0.05);
    EXPECT_NEAR(seconds("timer_island", 0.1), 20, 0.1);
    EXPECT_NEAR(seconds("millington", 0.001), 1, 0.05);
    EXPECT_NEAR(seconds("millington", 0.1), 1.13, 0.1) << "b^t 2 eps + (1 - b^t) (v^2 + w^2) = eps";
    EXPECT_NEAR(seconds("millington", 1), 20, 0.1);
  }
}

// A scene with a script that does nothing has no wave.
TEST(SleepingTrial, WithoutAnActionNoBodyIsWoken) {
  const auto m = run("sleep_roll", "none", 2).metrics;
  EXPECT_TRUE(std::isnan(m.at("woken")));
  EXPECT_TRUE(std::isnan(m.at("wake_steps")));
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::sleeping_trial_test
