// SPDX-License-Identifier: Zlib
// Scenes with large motion per step, and what trials report of each method of continuous collision.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace continuous_trial_test { namespace {

using namespace test;

nlohmann::json metricsOf(const Workspace& w, const std::string& arguments) {
  const Outcome out = w.lpc("run --json " + arguments);
  const std::size_t begin = out.text.find('{');
  EXPECT_NE(begin, std::string::npos) << out.text;
  return nlohmann::json::parse(out.text.substr(std::min(begin, out.text.size()))).at("metrics");
}

TEST(ContinuousTrial, BulletsStayBeforeTheWall) {
  const Workspace w;
  for (const std::string dimension : {"2", "3"}) {
    const auto run = [&](const std::string& method) {
      return metricsOf(w, "bullet_wall --dimension " + dimension + " --pipeline continuous=" + method);
    };
    const auto none = run("none");
    expectCaught("nobody looks, in " + dimension + "D", none.at("tunnelled") == 0);
    EXPECT_EQ(none.at("lost_time"), 0);
    EXPECT_EQ(none.at("work_swept_pairs"), 0);
    for (const char* method : {"ray", "speculative", "cast"}) {
      const auto m = run(method);
      EXPECT_EQ(m.at("tunnelled"), 0) << method << " in " << dimension << "D";
      EXPECT_EQ(m.at("ghost_hits"), 0) << method << " in " << dimension << "D";
    }
    const auto cast = run("cast");
    EXPECT_GT(cast.at("lost_time"), 0);
    EXPECT_LE(cast.at("lost_time"), 20.0 / 60) << "of 20 bullets, a step each";
  }
}

TEST(ContinuousTrial, ABulletHitsTheFirstDomino) {
  const Workspace w;
  for (const std::string dimension : {"2", "3"}) {
    const auto moved = [&](const std::string& method) {  // distance of the first domino, the highest body
      return metricsOf(w, "bullet_dominoes --dimension " + dimension + " --pipeline continuous=" + method)
          .at("end_drift_top")
          .get<double>();
    };
    expectCaught("nobody looks at a domino, in " + dimension + "D", moved("none") > 0.01);
    for (const char* method : {"ray", "speculative", "cast"}) {
      EXPECT_GT(moved(method), 0.03) << method << " in " << dimension << "D";
    }
  }
}

// A ball passes the edge of a static box. Any deflection is a ghost collision; a method without look-ahead has none.
TEST(ContinuousTrial, GhostsAreCounted) {
  const Workspace w;
  const std::string file = w.write("ghost.toml", R"(
name = "ghost"
summary = "a ball passes by a corner"
dimensions = [2, 3]
needs = ["cache", "continuous", "rotation"]
gravity = [0, 0, 0]
steps = 3
[[body]]
type = "fixed"
position = [0, -2, 0]
shapes = [{ kind = "box", half = [0.5, 2, 2] }]
[[body]]
position = [-3, 1.2, 0]
velocity = [300, -80, 0]
shapes = [{ kind = "sphere", radius = 0.2 }]
)");
  for (const std::string dimension : {"2", "3"}) {
    const auto ghosts = [&](const std::string& method) {
      return metricsOf(w, file + " --dimension " + dimension + " --pipeline continuous=" + method)
          .at("ghost_hits")
          .get<double>();
    };
    expectCaught("contacts ahead are never ghosts, in " + dimension + "D", ghosts("speculative") == 0);
    for (const char* method : {"none", "ray", "cast"}) EXPECT_EQ(ghosts(method), 0) << method;
  }
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::continuous_trial_test
