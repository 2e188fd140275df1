// SPDX-License-Identifier: Zlib
// Engines in place of pipelines: in `lpc run`, in sweeps, in the store.
#include <nlohmann/json.hpp>

#include "experiments/runner/code_identity.h"
#include "experiments/runner/sweep_file.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace engine_trial_test { namespace {

using nlohmann::json;
using test::ask;
using test::Outcome;
using test::Workspace;

// An f32 worker left by an earlier configuration does not belong to this build.
bool built(const std::string& worker) {
  return (test::kSingle || !worker.ends_with("f32")) && std::filesystem::exists(LPC_BINARY_DIR "/bin/" + worker);
}

json runScene(const Workspace& w, const std::string& arguments) {
  const Outcome out = w.lpc("run --json " + arguments);
  const std::size_t begin = out.text.find('{');
  return begin == std::string::npos ? json{{"outcome", out.text}} : json::parse(out.text.substr(begin));
}

TEST(EngineTrial, RunsInEachPrecision) {
  const Workspace w;
  for (const std::string precision : {"f64", "f32"}) {
    if (!built("lpc-engine-worker-" + precision)) continue;
    const std::string arguments =
        "pyramid --dimension 3 --param base=4 --steps 120 --pipeline 'engine=bullet{iterations=20}' --precision ";
    const json a = runScene(w, arguments + precision), b = runScene(w, arguments + precision);
    ASSERT_EQ(a["outcome"], "ok") << a.dump();
    EXPECT_EQ(a["hash"], b["hash"]);
    EXPECT_LT(a["metrics"]["penetration_poses"], 0.02);
    EXPECT_LT(a["metrics"]["end_drift_max"], 0.03) << "four rows that each sink by the slop of 5 mm, and some";
    EXPECT_GE(a["metrics"]["contacts_end"], 4 * 10);
    EXPECT_TRUE(a["metrics"]["max_penetration"].is_null()) << "contacts are not told";
    EXPECT_TRUE(a["metrics"]["work_row_updates"].is_null()) << "work is not counted";
    EXPECT_GT(a["metrics"]["ms_per_step_median"], 0);
  }
}

TEST(EngineTrial, PenetrationIsMeasuredAlikeForOurWorlds) {
  const Workspace w;
  const json ours = runScene(w, "vertical_stack --param n=3 --param gap=0 --steps 120");
  ASSERT_EQ(ours["outcome"], "ok");
  double contacts = 0;  // of the steps with recorded poses
  for (std::size_t i = 9; i < 120; i += 10)
    contacts = std::max(contacts, ours["series"]["max_penetration"][i].get<double>());
  EXPECT_GT(contacts, 0);
  EXPECT_NEAR(ours["metrics"]["penetration_poses"], contacts, 0.01 * contacts)
      << "flat boxes: a contact's depth is the pair's";
  const json& depths = ours["series"]["penetration_poses"];
  double deepest = 0;
  for (std::size_t i = 0; i < 120; ++i) {
    ASSERT_EQ(depths[i].is_null(), (i + 1) % 10 != 0) << "step " << i + 1;
    if (!depths[i].is_null()) deepest = std::max(deepest, depths[i].get<double>());
  }
  EXPECT_EQ(ours["metrics"]["penetration_poses"], deepest);
}

// The players of a script: LPC's own worlds, and each engine in one precision and dimension.
std::vector<std::string> players() {
  std::vector<std::string> out = {"--dimension 3 --precision f64", "--dimension 2 --precision f64"};
  if (built("lpc-engine-worker-f64")) out.push_back("--dimension 3 --precision f64 --pipeline engine=bullet");
  if (built("lpc-engine-worker-f32")) out.push_back("--dimension 2 --precision f32 --pipeline engine=box2d");
  return out;
}
// A box of 2 kg, alone in space.
const std::string kScripted = R"(name = "scripted"
summary = "s"
dimensions = [2, 3]
needs = ["joints", "rotation"]
gravity = [0, 0, 0]
dt = 0.015625
steps = 64
[limits]
drift = 100
[[body]]
name = "box"
position = [1, 2, 3]
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5], density = 2 }]
)";

TEST(EngineTrial, EveryEventIsPlayedAlike) {
  const Workspace w;
  const std::string head = "[[event]]\nbody = \"box\"\n", go = "do = \"set\"\nstep = 0\nvelocity = [2, 0, 0]\n";
  const std::string wall =
      "[[event]]\ndo = \"add\"\nstep = 1\ntype = \"fixed\"\nposition = [3.9, 2, 3]\nname = \"wall\"\n"
      "shapes = [{ kind = \"circle\", radius = 0.5 }]\n";
  struct Script {
    std::string events;
    double way, energy;  // of the box after a second: m from its start; J
  };
  // 2 kg, and 1/3 kg m^2 about z.
  const Script scripts[] = {
      {head + "do = \"push\"\nstep = 32\nimpulse = [3, 0, 0]", 0.5 * 3 / 2, 2.25},
      {head + "do = \"push\"\nstep = 0\nimpulse = [0, 3, 0]\nat = [0.5, 0, 0]\nangular_impulse = 1", 1.5,
       2.25 + 1.5 * 2.5 * 2.5},
      {head + go, 2, 4},
      {head + "do = \"set\"\nstep = 9\nposition = [4, 6, 3]\nangle = 1", 5, 0},
      {head + "do = \"force\"\nstep = 0\nuntil = 32\nforce = [4, 0, 0]", 2 * (32 * 33 / 2) / 4096. + 0.5, 1},
      {head + "do = \"force\"\nstep = 0\nuntil = 4\ntorque = 3", 0, 1.5 * 0.1875 * 0.1875},
      {head + go +
           "[[event]]\ndo = \"joint\"\nstep = 32\nkind = \"weld\"\na = \"world\"\nb = \"box\"\nanchor = [2, 2, 3]",
       1, 0},
      {"[[event]]\ndo = \"gravity\"\nstep = 32\ngravity = [4, 0, 0]", 4 * (32 * 33 / 2) / 4096., 4},
      {head + go + wall + "[[event]]\ndo = \"remove\"\nstep = 9\nbody = \"wall\"", 2, 4}};
  for (const auto& [events, way, energy] : scripts) {
    const std::string scene = w.write("scripted.toml", kScripted + events + "\n");
    for (const std::string& player : players()) {
      SCOPED_TRACE(player + "\n" + events);
      const json r = runScene(w, scene + " " + player);
      ASSERT_EQ(r["outcome"], "ok") << r.dump();
      EXPECT_NEAR(r["series"]["drift"].back().get<double>(), way, 2e-4);
      EXPECT_NEAR(r["series"]["kinetic"].back().get<double>(), energy, 1e-4 * (1 + energy));
    }
  }
  // The static body stops the box, a skin before it or a slop inside it.
  const std::string scene = w.write("walled.toml", kScripted + head + go + wall);
  for (const std::string& player : players()) {
    EXPECT_NEAR(runScene(w, scene + " " + player)["series"]["drift"].back().get<double>(), 1.9, 0.03) << player;
  }
}

// Rejected before the first step. Waking has no effect if nothing sleeps.
TEST(EngineTrial, AnUnsupportedEventIsARowWithAReason) {
  if (!built("lpc-engine-worker-f64")) GTEST_SKIP() << "this build has no engines";
  const Workspace w;
  const std::string head = "[[event]]\nstep = 32\ndo = ", wake = "\"wake\"\n", clear = "\"clear\"\n";
  const auto outcome = [&](const std::string& event) {
    return runScene(w, w.write("ours.toml", kScripted + head + event) + " --dimension 3 --pipeline engine=bullet");
  };
  EXPECT_EQ(outcome(wake)["outcome"], "ok");
  const json r = outcome(clear);
  EXPECT_EQ(r["outcome"], "unsupported");
  EXPECT_NE(r["reason"].get<std::string>().find("is not supported by engines"), std::string::npos) << r["reason"];
}

TEST(EngineTrial, AJointThatAnEngineLacksIsARowWithAReason) {
  if (!built("lpc-engine-worker-f64")) GTEST_SKIP() << "this build has no engines";
  const Workspace w;
  const std::string scene =
      w.write("rod.toml", kScripted +
                              "[[joint]]\nkind = \"distance\"\na = \"world\"\nb = \"box\"\nanchor = [1, 4, 3]\n"
                              "anchor_b = [1, 2, 3]\n");
  const json r = runScene(w, scene + " --dimension 3 --pipeline engine=bullet");
  EXPECT_EQ(r["outcome"], "unsupported");
  EXPECT_EQ(r["reason"], "bullet: no joint of kind distance");
}

TEST(EngineTrial, MistakesAreOneLine) {
  const Workspace w;
  const std::pair<const char*, const char*> wrong[] = {
      {"engine=bulet", "unknown engine 'bulet' in 3D; did you mean 'bullet'? valid: bullet"},
      {"engine=bullet{iteration=3}",
       "'bullet' has no parameter 'iteration'; did you mean 'iterations'? valid: iterations, slop, warm_start, "
       "split_impulse"},
      {"engine=bullet solver=soft_step", "unexpected text after the end"},
      {"engine=box2d", "engine box2d does not exist in 3D"},
      {"solver=soft_step engine=bullet", "an engine replaces all stages: engine=bullet"}};
  for (const auto& [pipeline, message] : wrong) {
    const Outcome out = w.lpc("run pyramid --dimension 3 --pipeline '" + std::string(pipeline) + "'");
    EXPECT_EQ(out.code, 2) << pipeline;
    EXPECT_NE(out.text.find(message), std::string::npos) << out.text;
  }
}

TEST(EngineTrial, SweepsMixEnginesAndPipelines) {
  if (!built("lpc-engine-worker-f32")) GTEST_SKIP() << "this build has no f32";
  const Workspace w;
  const std::string sweep = w.write("mine.toml", R"(
summary = "two engines and a world"
kind = "world"
pipeline = "sleep=none"
[axes]
scene = "vertical_stack"
n = 2
gap = 0
steps = 30
dimension = [2, 3]
precision = ["f64", "f32"]
iterations = 7
[axes.resolver]
"ours" = "solver=split_solver{velocity=catto{iterations=$iterations}}"
"bullet" = "engine=bullet{iterations=$iterations}"
"box2d" = "engine=box2d{iterations=$iterations}"
)");
  const std::string store = w.path("s.db");
  const Outcome out = w.lpc("sweep " + sweep + " --store " + store + " --quiet");
  ASSERT_EQ(out.code, 0) << out.text;
  const auto of = [&](const std::string& what, const std::string& where) {
    return ask(store, "SELECT " + what + " FROM trial t JOIN planned p ON t.key = p.key WHERE " + where);
  };
  const std::string bullet = "p.axes->>'resolver' = 'bullet'", box2d = "p.axes->>'resolver' = 'box2d'";
  EXPECT_EQ(of("count(*)", bullet + " AND outcome = 'ok' AND p.axes->>'dimension' = 3"), "2");
  EXPECT_EQ(of("reason", bullet + " AND outcome = 'unsupported'"), "engine bullet does not exist in 2D");
  EXPECT_EQ(of("count(*)", box2d + " AND outcome = 'ok'"), "1");
  EXPECT_EQ(of("reason", box2d + " AND p.axes->>'dimension' = 2 AND outcome = 'unsupported'"),
            "box2d runs in f32 only; valid: precision f32");
  EXPECT_EQ(of("count(*)", "p.axes->>'resolver' = 'ours' AND outcome = 'ok'"), "4");
  // The row holds everything that decides it: all parameters, the adapter, its library, and the differences that no
  // setting removes.
  const json row = json::parse(of("canonical", box2d + " AND outcome = 'ok'"));
  EXPECT_EQ(row["pipeline"], "engine=box2d{iterations=7,position_iterations=4,warm_start=true}");
  EXPECT_EQ(row["engine"]["name"], "box2d");
  EXPECT_NE(row["engine"]["differs"].get<std::string>().find("1 to 1.5 cm apart"), std::string::npos);
  EXPECT_TRUE(row["code"].contains("engine/box2d"));
  EXPECT_TRUE(row["code"]["library"].get<std::string>().starts_with("Box2D 2.4"));
  EXPECT_EQ(row["code"].size(), 2u) << "no stage of ours took part: " << row["code"].dump();
  // Finished trials are not run again.
  EXPECT_NE(w.lpc("sweep " + sweep + " --store " + store).text.find("12 were done"), std::string::npos);
  // --only finds engines by name.
  EXPECT_EQ(planSweeps(sweep, {"bullet"}).front().trials.size(), 4u);
}

TEST(EngineTrial, AnAxisNamedEngineTakesAll) {
  const Workspace w;
  const std::string sweep = w.write("all.toml", R"(
summary = "all engines"
kind = "world"
[axes]
scene = "slope"
engine = "*"
)");
  std::set<std::string> names;
  const auto planned = planSweeps(sweep, {});
  for (const PlannedTrial& t : planned.front().trials) names.insert(t.canonical["engine"]["name"]);
  EXPECT_EQ(names, (std::set<std::string>{"box2d", "bullet"}));
}

TEST(EngineTrial, TheRefereesCodeDoesNotIncludeThem) {
  const SourceHash plain[] = {{"oracles/referee/referee.h", "1"}};
  const SourceHash more[] = {{"oracles/referee/referee.h", "1"}, {"oracles/engines/engine_world.h", "2"}};
  EXPECT_EQ(judgesHash(plain), judgesHash(more)) << "an engine changes no key of a pairs trial";
}

// Towers of boxes, alternately 1 cm to the left and right, 0.1 m apart at the start, 10 iterations, 30 s. In Box2D ten
// boxes stand and twelve fall, as measured without this adapter. In LPC twelve lean and stand, fifteen fall.
std::string towers(const std::string& pipeline, std::initializer_list<int> heights) {
  const Workspace w;
  std::string outcomes;
  for (const int n : heights) {
    const json r = runScene(w, "vertical_stack --steps 1800 --param n=" + std::to_string(n) + " " + pipeline);
    outcomes += (outcomes.empty() ? "" : " ") + r["outcome"].get<std::string>();
  }
  return outcomes;
}
TEST(EngineTrial, TowersFallInBox2dAsTheyDid) {
  if (!built("lpc-engine-worker-f32")) GTEST_SKIP() << "this build has no f32";
  EXPECT_EQ(towers("--precision f32 --pipeline 'engine=box2d{iterations=10}'", {10, 12}), "ok collapsed");
}
TEST(EngineTrial, TowersOfOursFallLater) {
  EXPECT_EQ(towers("--pipeline 'solver=split_solver{velocity=catto{iterations=10}}'", {12, 15}), "ok collapsed");
  EXPECT_EQ(towers("--pipeline 'solver=soft_step{substeps=10}'", {12, 15}), "ok collapsed");
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::engine_trial_test
