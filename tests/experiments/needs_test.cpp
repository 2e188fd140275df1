// SPDX-License-Identifier: Zlib
// `lpc needs`: what each part of a scene's model costs and what it changes.
#include "experiments/runner/needs.h"

#include <csignal>
#include <regex>

#include "experiments/runner/scene_model.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace needs_test { namespace {

using test::Outcome;
using test::Workspace;

TEST(Needs, EverySwitchIsTurnedOnce) {
  Planner planner;
  const SceneFile& slope = planner.scene("slope");  // needs cache and friction, in 2D and 3D
  EXPECT_EQ(otherModels(slope, 2), (std::vector<std::string>{"3d", "-cache", "+continuous", "-friction", "+joints",
                                                             "+restitution", "+rotation", "+sleeping"}));
  EXPECT_EQ(otherModels(slope, 3)[0], "2d");
  EXPECT_EQ(otherModels(planner.scene("gears"), 2)[0], "-cache") << "there are no gears in 3D";
  const auto features = [&](const std::string& model) {
    WorldCell cell;
    applyModel(slope, model, cell);
    return *cell.features;
  };
  EXPECT_EQ(features("minimal"), "cache,friction");
  EXPECT_EQ(features("-friction"), "cache");
  EXPECT_EQ(features("-joints"), "cache,friction") << "what is not there cannot be taken away";
  EXPECT_EQ(features("+rotation"), "cache,friction,rotation");
  EXPECT_EQ(features("2d"), "cache,friction");
  EXPECT_THROW(features("+frition"), UserError);
}

TEST(Needs, PlansEachModelForEachSeedAndItsOwnTwice) {
  NeedsQuestion q;
  q.scene = "slope", q.seeds = 3, q.steps = 10;
  const PlannedSweep sweep = planNeeds(q);
  EXPECT_EQ(sweep.trials.size(), 3u * (2 + 8));
  std::set<std::string> keys;
  for (const PlannedTrial& t : sweep.trials) {
    keys.insert(t.key);
    EXPECT_TRUE(t.timed());
  }
  EXPECT_EQ(keys.size(), sweep.trials.size());
}

// The default methods for sleeping and continuous collision do nothing, so enabling them must choose a real method.
TEST(Needs, ASwitchUsesARealMethod) {
  EXPECT_EQ(withPolicies(""), Pipeline::parse("sleep=timer_island continuous=cast").text());
  EXPECT_EQ(withPolicies("sleep=millington"), Pipeline::parse("sleep=millington continuous=cast").text());
  EXPECT_EQ(withPolicies("sleep=none"), Pipeline::parse("sleep=none continuous=cast").text())
      << "who says none has none";
  EXPECT_EQ(withPolicies("engine=box2d"), "engine=box2d");
  Workspace w;
  const std::string ask = "needs mass_ratio --param ratio=1 --seeds 1 --steps 180 --quiet --store ";
  const auto updates = [](const std::string& text) {  // of +sleeping, relative to minimal
    std::smatch row;
    const bool found = std::regex_search(text, row, std::regex("\n\\+sleeping +[^)]+\\) +([0-9.]+)"));
    return found ? std::stod(row[1]) : -1;
  };
  const Outcome out = w.lpc(ask + "n.db"), none = w.lpc(ask + "none.db --pipeline \"sleep=none cache=none\"");
  EXPECT_LT(updates(out.text), 0.8) << out.text;
  EXPECT_NE(out.text.find(" sleep=timer_island"), std::string::npos) << out.text;
  EXPECT_TRUE(std::regex_search(none.text, std::regex("\n\\+sleeping .* nothing to measure: sleep=none\n")))
      << none.text;
  EXPECT_TRUE(std::regex_search(none.text, std::regex("\n-cache .* nothing to measure: cache=none\n"))) << none.text;
}

// A block sliding on a slope: without friction it slides elsewhere; joints and restitution have no effect.
TEST(Needs, ReportsWhatChangesAndWhatDoesNot) {
  Workspace w;
  const std::string command = "needs slope --seeds 2 --steps 60 --quiet --store n.db";
  const Outcome out = w.lpc(command);
  ASSERT_EQ(out.code, 0) << out.text;
  EXPECT_NE(out.text.find("slope in 2D: model by its file: cache,friction\n"), std::string::npos) << out.text;
  const auto farthest = [&](const std::string& model) {
    std::smatch row;
    // model, time (from .. to), multiply-adds, median, farthest
    const bool found = std::regex_search(
        out.text, row,
        std::regex("\n" + model + " +[0-9.]+ \\([0-9.]+ \\.\\. [0-9.]+\\) +[0-9.]+ +([^ ]+) +([^ \n]+)"));
    EXPECT_TRUE(found) << model << "\n" << out.text;
    return found ? std::stod(row[2]) : -1;
  };
  EXPECT_TRUE(std::regex_search(out.text, std::regex("\nminimal, again .* the noise"))) << out.text;
  EXPECT_GT(farthest("-friction"), 0.1);
  EXPECT_EQ(farthest("\\+joints"), 0);
  EXPECT_NE(out.text.find("equal work counts"), std::string::npos) << out.text;
  // The store holds all of it for the report.
  EXPECT_EQ(test::ask(w.path("n.db"), "SELECT count(*) FROM planned WHERE sweep='needs_slope'"), "20");
  EXPECT_EQ(test::ask(w.path("n.db"), "SELECT baseline FROM sweep"), "minimal");
  const std::string first = test::ask(w.path("n.db"), "SELECT group_concat(started || wall) FROM trial");
  const Outcome again = w.lpc(command);
  EXPECT_EQ(again.text, out.text);
  EXPECT_EQ(test::ask(w.path("n.db"), "SELECT group_concat(started || wall) FROM trial"), first) << "it ran again";
}

TEST(Needs, MistakesAreOneLine) {
  Workspace w;
  const std::pair<const char*, const char*> cases[] = {
      {"needs slop", "did you mean 'slope'?"},
      {"needs gears --dimension 3", "does not exist in 3D"},
      {"needs slope --seeds 0", "--seeds"},
      {"needs slope --param angel=1", "did you mean 'angle'?"},
      {"needs slope --pipeline velocity=catto", "solver=split_solver{velocity=catto}"},
  };
  for (const auto& [arguments, part] : cases) {
    const Outcome out = w.lpc(arguments);
    EXPECT_EQ(out.code, 2) << out.text;
    EXPECT_NE(out.text.find(part), std::string::npos) << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
    EXPECT_TRUE(std::filesystem::is_empty(w.path(""))) << arguments << " left something behind";
  }
}

// Ctrl-C keeps finished trials, and the same command continues.
TEST(Needs, ContinuesAfterCtrlC) {
  Workspace w;
  const std::string run = "needs slope --steps 100 --seeds 8 --store n.db";
  // Interrupted at the first progress message, so that the machine's speed does not matter.
  const Outcome stopped =
      w.shell("{ " LPC_BINARY_DIR "/bin/lpc " + run +
              " 2> told & until grep -q ' of ' told || ! kill -0 $!; do sleep 0.01; done; kill -INT $!; wait $!; }");
  ASSERT_EQ(stopped.code, 130) << stopped.text;
  EXPECT_NE(stopped.text.find("the same command continues"), std::string::npos) << stopped.text;
  const Outcome whole = w.lpc(run);
  EXPECT_EQ(whole.code, 0) << whole.text;
  EXPECT_NE(whole.text.find("minimal, again"), std::string::npos) << whole.text;
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::needs_test
