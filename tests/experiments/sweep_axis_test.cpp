// SPDX-License-Identifier: Zlib
// Stars in sweeps include every registered method, wherever a method's name may appear.
#include "experiments/runner/sweep_axis.h"

#include <algorithm>
#include <map>
#include <set>

#include "experiments/runner/sweep_file.h"
#include "framework/stage/registry.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace sweep_axis_test { namespace {

using nlohmann::json;
using test::Workspace;
using Names = std::set<std::string>;

Names registered(StageKind kind, AlgorithmRole role = AlgorithmRole::competitor) {
  Names names;
  for (const auto& [key, entry] : Registry::instance().all()) {
    if (entry.stage == kind && entry.info.role == role) names.insert(entry.info.name);
  }
  return names;
}
Names without(Names names, const Names& some) {
  for (const std::string& n : some) names.erase(n);
  return names;
}

// The axis `name` of this text: labels and pipelines.
std::map<std::string, std::string> axisOf(const std::string& name, const std::string& text) {
  const toml::table table = parseToml(name + " = " + text + "\n", "s.toml");
  std::map<std::string, std::string> out;
  for (const AxisValue& v : readAxis("s.toml", name, *table.get(name)).values) out[v.label] = v.pipeline;
  return out;
}
Names labelsOf(const std::string& name, const std::string& text) {
  Names labels;
  for (const auto& [label, pipeline] : axisOf(name, text)) labels.insert(label);
  return labels;
}
std::string errorOf(const std::string& name, const std::string& text) {
  try {
    axisOf(name, text);
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}

TEST(SweepStar, IsEveryRegisteredMethodOfAStage) {
  for (const StageInfo& stage : kStages) {
    const std::string name{stage.name};
    SCOPED_TRACE(name);
    const Names all =
        registered(stage.kind, stage.kind == StageKind::engine ? AlgorithmRole::engine : AlgorithmRole::competitor);
    ASSERT_FALSE(all.empty());
    EXPECT_EQ(labelsOf(name, "\"*\""), all);
    EXPECT_EQ(labelsOf(name, "[\"*-" + *all.begin() + "\"]"), without(all, {*all.begin()}));
  }
}

TEST(SweepStar, StandsInsideAnotherMethod) {
  const auto axis =
      axisOf("resolver", R"({ "catto+$position" = "solver=split_solver{velocity=catto{iterations=$n},position=*}" })");
  Names labels;
  for (const std::string& p : registered(StageKind::position)) labels.insert("catto+" + p);
  EXPECT_EQ(labelsOf("resolver", R"({ "catto+$position" = "solver=split_solver{velocity=catto,position=*}" })"),
            labels);
  EXPECT_EQ(axis.at("catto+none"), "solver=split_solver{velocity=catto{iterations=$n},position=none}");
  EXPECT_EQ(
      axisOf("r", R"({ "$velocity+$position $cache" = "cache=* solver=split_solver{velocity=*,position=*}" })").size(),
      registered(StageKind::velocity).size() * registered(StageKind::position).size() *
          registered(StageKind::cache).size());
}

// A parameter applies to the methods that have it; the others are still in the sweep.
TEST(SweepStar, GivesParametersToMethodsThatHaveThem) {
  const auto axis = axisOf("r", R"({ "$velocity" = "solver=split_solver{velocity=*{iterations=$n}}" })");
  EXPECT_EQ(axis.at("catto"), "solver=split_solver{velocity=catto{iterations=$n}}");
  EXPECT_EQ(axis.at("millington"), "solver=split_solver{velocity=millington}");
  EXPECT_EQ(axisOf("velocity", "\"*-naive-catto{iteration_factor=3}\"").count("millington{iteration_factor=3}"), 1u);
}

TEST(SweepStar, PlansAlsoMethodsWithoutTheParameter) {
  Workspace w;
  const auto sweeps = planSweeps(w.write("s.toml", R"(
summary = "s"
kind = "world"
[axes]
scene = "box_drop"
iterations = [4, 10]
[axes.resolver]
"$velocity" = "solver=split_solver{velocity=*{iterations=$iterations}}"
)"),
                                 {});
  std::map<std::string, int> cells;
  for (const PlannedTrial& t : sweeps[0].trials) ++cells[t.axes["resolver"]];
  EXPECT_EQ(cells.at("catto"), 2);
  EXPECT_EQ(cells.at("millington"), 1) << "the same cell twice runs once";
}

TEST(SweepStar, MistakesAreOneLine) {
  const std::pair<std::string, std::vector<const char*>> cases[] = {
      {R"({ "all" = "solver=split_solver{velocity=*}" })", {"s.toml:1: ", "'all'", "$velocity"}},
      {R"({ "$velocity" = "solver=split_solver{velocity=*{hurry=4}}" })",
       {"s.toml:1: ", "no velocity has the parameter 'hurry'"}},
      {R"({ "$velocity" = "solver=split_solver{velocity=*-cato}" })", {"s.toml:1: ", "'cato'", "valid: ", " catto,"}},
      {R"({ "$velocity" = "solver=split_solver{velocity=*all}" })", {"s.toml:1: ", "'*all'", "*witness"}},
      {R"({ "$velocity" = "solver=split_solver{velocity=*" })", {"s.toml:1: ", "'}' is missing"}},
      {R"({ "$solvers" = "solvers=*" })", {"s.toml:1: ", "unknown stage 'solvers'"}},
      {R"({ "$velocity" = "solver=split_solver{velocity=*}", "catto" = "solver=split_solver" })",
       {"s.toml:1: ", "two methods have the label 'catto'"}},
      {"[\"*\"]", {"s.toml:1: ", "'r', which belongs to no stage"}}};
  for (const auto& [text, parts] : cases) {
    const std::string message = errorOf("r", text);
    for (const char* part : parts) EXPECT_NE(message.find(part), std::string::npos) << text << "\n" << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

// Marks that were not replaced are rejected by name, not as a syntax error.
TEST(SweepStar, IsNoValidName) {
  Workspace w;
  const test::Outcome run = w.lpc("run box_drop --pipeline 'solver=split_solver{velocity=*}'");
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.text.find("unknown velocity '*' in"), std::string::npos) << run.text;
  EXPECT_NE(run.text.find(" catto, "), std::string::npos) << run.text;
}

// Registered methods of these stages that occur in no cell of the plan.
Names lacking(const PlannedSweep& sweep) {
  Names missing;
  for (const StageKind kind : {StageKind::solver, StageKind::velocity, StageKind::position}) {
    for (const std::string& n : registered(kind)) missing.insert(std::string(stageName(kind)) + "/" + n);
  }
  const auto found = [&](const std::vector<PlannedTrial>& trials) {
    for (const PlannedTrial& t : trials) {
      for (const auto& [method, hash] : t.canonical["code"].items()) missing.erase(method);
    }
  };
  found(sweep.trials);
  for (const CalibratedCell& cell : sweep.calibrated) {
    if (missing.empty()) break;
    found(cell.plan(1));
  }
  for (const Ladder& ladder : sweep.ladders) {
    if (missing.empty()) break;
    found(ladder.plan({ladder.question.from, 1, 1, false}));
  }
  return missing;
}

// Direct methods: their cost cannot be set.
const Names kWithoutSweeps = {"direct_lcp", "proximal_newton"};
// Methods with the same trials for every calibrated setting, by their first cell that can run.
Names withoutSetting(const PlannedSweep& sweep) {
  Names out, seen;
  const auto look = [&](const json& axes, const auto& planAt) {
    const std::string label = axes["resolver"];
    if (seen.contains(label)) return;
    const PlannedTrial one = planAt(1).at(0);
    if (!one.unsupported.empty()) return;
    seen.insert(label);
    if (one.key == planAt(2).at(0).key) out.insert(label);
  };
  for (const CalibratedCell& cell : sweep.calibrated) look(cell.axes, cell.plan);
  for (const Ladder& ladder : sweep.ladders) {
    look(ladder.axes, [&](long setting) { return ladder.plan({ladder.question.from, 1, setting, false}); });
  }
  return out;
}

TEST(ShippedSweeps, HoldEveryResolver) {
#if defined(LPC_SANITIZED)
  GTEST_SKIP() << "plans are the same in every build, and long to make in this one";
#endif
  for (const char* name : {"resolvers", "resolvers_full", "breaking_points_stack", "breaking_points_stack_full",
                           "breaking_points_mass_ratio", "breaking_points_dt", "reference", "breaking_map", "momenta",
                           "quick_resolvers", "quick_scenes", "quick_breaking_points"}) {
    const PlannedSweep sweep = planSweeps(name, {}).at(0);
    EXPECT_EQ(lacking(sweep), Names{}) << name;
    EXPECT_EQ(without(withoutSetting(sweep), kWithoutSweeps), Names{}) << name;
  }
  Workspace w;
  const std::string byHand = w.write("s.toml", R"(
summary = "three by name"
kind = "world"
[axes]
scene = "box_drop"
[axes.resolver]
"naive" = "solver=split_solver{velocity=naive,position=linear}"
"catto" = "solver=split_solver{velocity=catto,position=none}"
"soft_step" = "solver=soft_step"
)");
  test::expectCaught("a sweep that lists its resolvers by hand", lacking(planSweeps(byHand, {}).at(0)).empty());
}

// A column for each cache, a row for each solver and velocity resolver.
TEST(ShippedSweeps, HoldEveryCache) {
#if defined(LPC_SANITIZED)
  GTEST_SKIP() << "plans are the same in every build, and long to make in this one";
#endif
  const PlannedSweep sweep = planSweeps("cache_solver", {}).at(0);
  Names caches, resolvers;
  for (const CalibratedCell& cell : sweep.calibrated) {
    caches.insert(cell.axes["cache"].get<std::string>()), resolvers.insert(cell.axes["resolver"].get<std::string>());
  }
  EXPECT_EQ(caches, registered(StageKind::cache));
  EXPECT_EQ(without(withoutSetting(sweep), kWithoutSweeps), Names{});
  Names all = registered(StageKind::velocity);
  for (const std::string& n : registered(StageKind::solver)) all.insert(n);
  all.erase("split_solver");
  EXPECT_EQ(resolvers, all);
}

Names resolversOf(const PlannedSweep& sweep) {
  Names labels;
  for (const PlannedTrial& t : sweep.trials) labels.insert(t.axes["resolver"].get<std::string>());
  return labels;
}

const std::string kTwoResolvers = R"(
summary = "s"
kind = "world"
[axes]
scene = "box_drop"
iterations = [4, 10]
[axes.resolver]
"naive" = "solver=split_solver{velocity=naive{iterations=$iterations}}"
[[group]]
[[group]]
axes = { scene = "pyramid", resolver = { "millington" = "solver=split_solver{velocity=millington{iteration_factor=$iterations}}" } }
)";

// Whatever the parameter's name is. Methods without effort have no value of the setting.
TEST(SweepStar, GivesEffortByItsRole) {
  const auto axis = axisOf("r", R"({ "$velocity" = "solver=split_solver{velocity=*{effort=$n}}" })");
  EXPECT_EQ(axis.at("catto"), "solver=split_solver{velocity=catto{iterations=$n}}");
  EXPECT_EQ(axis.at("millington"), "solver=split_solver{velocity=millington{iteration_factor=$n}}");
  EXPECT_EQ(axis.at("direct_lcp"), "solver=split_solver{velocity=direct_lcp}");
  const auto solvers = axisOf("r", R"({ "$solver" = "solver=*-split_solver{effort=$n}" })");
  EXPECT_EQ(solvers.at("avbd"), "solver=avbd{iterations=$n}");
  EXPECT_EQ(solvers.at("tgs"), "solver=tgs{substeps=$n}");
  Workspace w;
  const std::string path = w.write("s.toml", R"(
summary = "s"
kind = "world"
[axes]
scene = "box_drop"
iterations = [2, 4]
[axes.resolver]
"$velocity" = "solver=split_solver{velocity=*{effort=$iterations}}"
)");
  const auto valuesOf = [](const std::vector<PlannedSweep>& sweeps) {
    std::map<std::string, Names> out;
    for (const PlannedTrial& t : sweeps[0].trials) {
      out[t.axes["resolver"]].insert(t.axes.contains("iterations") ? t.axes["iterations"].dump() : "none");
    }
    return out;
  };
  auto at = valuesOf(planSweeps(path, {}));
  EXPECT_EQ(at["direct_lcp"], Names{"none"});
  EXPECT_EQ(at["catto"], (Names{"2", "4"}));
  EXPECT_EQ(at["millington"], (Names{"2", "4"}));
  // A method takes the stages that it does not replace from the common pipeline.
  const std::string base = w.write("b.toml", R"(
summary = "s"
kind = "world"
pipeline = "cache=none solver=split_solver{velocity=catto{iterations=$iterations}}"
[axes]
scene = "box_drop"
iterations = [2, 4]
[axes.resolver]
"fixed" = "solver=xpbd"
"both" = "broadphase=naive"
"box2d" = "engine=box2d"
)");
  EXPECT_EQ(valuesOf(planSweeps(base, {})),
            (std::map<std::string, Names>{{"fixed", {"none"}}, {"both", {"2", "4"}}, {"box2d", {"none"}}}));
}

TEST(SweepWith, AMethodOfTheCommandLineJoinsTheLabelledAxis) {
  Workspace w;
  const std::string path = w.write("s.toml", kTwoResolvers);
  const auto sweeps = planSweeps(path, {}, {"damped=solver=split_solver{velocity=catto{iterations=$iterations}}"});
  std::map<std::string, int> cells;
  for (const PlannedTrial& t : sweeps[0].trials)
    ++cells[t.axes["resolver"].get<std::string>() + " " + t.axes["scene"].get<std::string>()];
  const std::map<std::string, int> right = {{"naive box_drop", 2}, {"damped box_drop", 2}, {"millington pyramid", 2}};
  EXPECT_EQ(cells, right) << "a group with an axis of its own keeps it";
  for (const PlannedTrial& t : sweeps[0].trials) {
    const std::string n = std::to_string(t.axes["iterations"].get<int>()), pipeline = t.canonical["pipeline"];
    EXPECT_EQ(pipeline.find("velocity=catto{iterations=" + n) != pipeline.npos, t.axes["resolver"] == "damped");
  }
  Names all = {"naive", "millington"};
  for (const Registered* r : Registry::instance().list(StageKind::velocity, 2)) {
    if (r->info.name != "naive" && r->info.role == AlgorithmRole::competitor) all.insert(r->info.name + "+none");
  }
  EXPECT_EQ(
      resolversOf(planSweeps(path, {}, {"$velocity+none=solver=split_solver{velocity=*-naive,position=none}"})[0]),
      all);
  EXPECT_EQ(resolversOf(planSweeps(path, {"soft"}, {"soft=solver=soft_step{substeps=$iterations}"})[0]), Names{"soft"});
}

TEST(SweepWith, ShippedSweepsTakeOneMore) {
#if defined(LPC_SANITIZED)
  GTEST_SKIP() << "plans are the same in every build, and long to make in this one";
#endif
  const std::string method =
      "mine=solver=split_solver{velocity=catto{iterations=$iterations},position=none} cache=none";
  bool resolvers = false;
  const Names compare = {"resolvers",       "momenta",      "equal_cost",           "equal_work",
                         "quick_resolvers", "quick_scenes", "quick_breaking_points"};
  for (const char* set : {"quick", "standard"}) {
    for (const PlannedSweep& s : planSweeps(set, {}, {method})) {
      const auto isIt = [](const auto& cell) { return cell.axes.value("resolver", "") == "mine"; };
      const bool here = std::any_of(s.trials.begin(), s.trials.end(), isIt) ||
                        std::any_of(s.calibrated.begin(), s.calibrated.end(), isIt);
      resolvers = resolvers || s.name == "resolvers";
      EXPECT_EQ(here, compare.count(s.name) || s.name.starts_with("breaking_points")) << s.name;
    }
  }
  EXPECT_TRUE(resolvers);
}

TEST(SweepWith, MistakesAreOneLine) {
  Workspace w;
  w.write("s.toml", kTwoResolvers);
  w.write("boxes.toml",
          "summary = \"s\"\nkind = \"boxes\"\n[axes]\ndimension = 2\nn = 8\ndistribution = \"uniform\"\nbroadphase = "
          "\"*\"\n");
  const std::pair<const char*, std::vector<const char*>> cases[] = {
      {"s.toml --with catto", {"--with 'catto'", "valid: LABEL=PIPELINE"}},
      {"s.toml --with =solver=soft_step", {"--with '=solver=soft_step'", "valid: LABEL=PIPELINE"}},
      {"s.toml --with soft=soft_step", {"--with 'soft=soft_step'", "valid: LABEL=PIPELINE"}},
      {"s.toml --with naive=solver=soft_step", {"--with 'naive=", "two methods have the label 'naive'"}},
      {"s.toml --with 'again=solver=split_solver{velocity=naive{iterations=$iterations}}'",
       {"--with again: ", "s.toml has the same trials under another label"}},
      {"s.toml --with mine=solver=soft_stpe", {"--with mine: ", "'soft_stpe'", "soft_step"}},
      {"s.toml --with mine=sovler=soft_step", {"--with mine: ", "'sovler'", "solver"}},
      {"s.toml --with 'mine=solver=split_solver{velocity=*}'", {"--with 'mine=", "a label with $velocity"}},
      {"s.toml --with 'mine=solver=soft_step{substeps=$substeps}'",
       {"--with 'mine=", "'s.toml'", "an axis for each $name"}},
      {"boxes.toml --with mine=broadphase=naive", {"--with 'mine=", "'boxes.toml'", "labelled methods"}}};
  for (const auto& [arguments, parts] : cases) {
    const test::Outcome out = w.lpc(std::string("sweep --store never.db ") + arguments);
    EXPECT_EQ(out.code, 2) << arguments << "\n" << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
    for (const char* part : parts) EXPECT_NE(out.text.find(part), std::string::npos) << arguments << "\n" << out.text;
  }
  EXPECT_FALSE(std::filesystem::exists(w.path("never.db")));
}

TEST(SweepSet, OneValueReplacesAnAxisEverywhere) {
  Workspace w;
  const std::string path = w.write("s.toml", kTwoResolvers);
  const auto sweeps = planSweeps(path, {}, {}, {"iterations=7"});
  ASSERT_EQ(sweeps[0].trials.size(), 2u);
  for (const PlannedTrial& t : sweeps[0].trials) EXPECT_EQ(t.axes["iterations"], 7);
  std::set<int> bodies;
  for (const PlannedSweep& s : planSweeps("choose", {}, {}, {"n=50", "dimension=3"})) {
    for (const PlannedTrial& t : s.trials) {
      EXPECT_EQ(t.axes["dimension"], 3) << s.name;
      bodies.insert(t.axes["n"].get<int>());
    }
  }
  EXPECT_EQ(bodies, std::set<int>{50});
}

// Recommendations must hold for other start positions and exceed the noise of the timing.
TEST(SweepSet, ChooseTimesEveryMethodUnderTwentySeedsFourTimes) {
  const auto fewest = [](const std::vector<PlannedSweep>& sweeps) {
    std::map<std::string, std::map<int, int>> repeats;  // of each cell and seed
    for (const PlannedSweep& s : sweeps) {
      EXPECT_TRUE(s.notes.empty()) << s.name << ": " << s.notes.at(0);  // the note that seeds have no effect
      for (const PlannedTrial& t : s.trials) {
        nlohmann::json cell = t.axes;
        for (const char* name : {"seed", "repeat", "timed"}) cell.erase(name);
        repeats[s.name + cell.dump()][t.axes.value("seed", 1)] += t.timed();
      }
    }
    std::pair<std::size_t, int> out = {1000, 1000};
    for (const auto& [cell, of] : repeats) {
      out.first = std::min(out.first, of.size());
      for (const auto& [seed, count] : of) out.second = std::min(out.second, count);
    }
    return out;
  };
  for (const char* name : {"choose", "choose_together"}) {
    EXPECT_EQ(fewest(planSweeps(name, {})), (std::pair<std::size_t, int>(20, 4))) << name;
    EXPECT_EQ(fewest(planSweeps(name, {}, {}, {"seed=3"})).first, 1u) << name << ": one seed was not seen";
  }
}

// The best method of each stage, all together, runs beside the pipeline in which each stage was compared.
TEST(SweepSet, TheTakenMethodsRunBesideTheGivenPipeline) {
  const auto sweeps = planSweeps("choose_together", {}, {"taken=broadphase=naive solver=soft_step"}, {"n=50"});
  std::set<std::string> labels;
  for (const PlannedTrial& t : sweeps.at(0).trials) labels.insert(t.axes.at("together"));
  EXPECT_EQ(labels, (std::set<std::string>{"given", "taken"}));
}

TEST(SweepSet, MistakesAreOneLine) {
  Workspace w;
  w.write("s.toml", kTwoResolvers);
  const std::string head = "summary = \"s\"\nkind = \"world\"\n[axes]\ndt = 0.01\nscene = ";
  w.write("dt.toml", head + "\"pyramid\"\n");
  w.write("wrong.toml", head + "\"pyramud\"\n");
  std::string none = "*witness";  // as in a build without oracles
  for (const std::string& name : registered(StageKind::broadphase, AlgorithmRole::witness)) none += "-" + name;
  w.write("none.toml", head + "\"pyramid\"\nbroadphase = \"" + none + "\"\n");
  const std::pair<const char*, std::vector<const char*>> cases[] = {
      {"s.toml --set iterations", {"--set 'iterations'", "valid: AXIS=VALUE"}},
      {"s.toml --set =7", {"--set '=7'", "valid: AXIS=VALUE"}},
      {"s.toml --set bodies=7", {"--set 'bodies=7'", "'s.toml'", "axis 'bodies'"}},
      {"s.toml --set resolver=catto", {"--set 'resolver=catto'", "labelled methods"}},
      {"choose --set n=many", {"--set 'n=many'", "'n'", "valid: numbers"}},
      {"choose --set dimension=4", {"--set 'dimension=4'", "2 to 3"}},
      {"choose --set broadphase=*", {"--set 'broadphase=*'", "a star stands for many values", "one value"}},
      {"choose --set broadphase=nosuch", {"--set 'broadphase=nosuch'", "naive"}},
      {"s.toml --set scene=nosuch", {"--set 'scene=nosuch'", "pyramid"}},
      {"s.toml --set iterations=200000", {"--set 'iterations=200000'", "100000"}},
      {"dt.toml --set dt=-1", {"--set 'dt=-1'", "above 0"}},
      {"none.toml --set broadphase=5", {"--set 'broadphase=5'", "naive"}},
      {"wrong.toml --set dt=0.01", {"wrong.toml:5: ", "'pyramud'"}}};
  for (const auto& [arguments, parts] : cases) {
    const test::Outcome out = w.lpc(std::string("sweep --store never.db ") + arguments);
    EXPECT_EQ(out.code, 2) << arguments << "\n" << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
    for (const char* part : parts) EXPECT_NE(out.text.find(part), std::string::npos) << arguments << "\n" << out.text;
  }
}

TEST(SweepAxis, NamesOfOtherColumnsAreRefused) {
  for (const std::string_view name : kNoAxes) {
    EXPECT_NE(
        errorOf(std::string(name), "[\"a\", \"b\"]").find("s.toml:1: axis '" + std::string(name) + "' is reserved"),
        std::string::npos)
        << name;
  }
  EXPECT_EQ(errorOf("reports", "[\"a\", \"b\"]"), "no error");
  // The list is complete: each entry among the roles is an axis or in the list.
  Workspace w;
  w.write("s.toml", R"(
summary = "s"
kind = "world"
report = ["equal_cost"]
calibrate = { equal = "cost", metric = "work_row_updates", setting = "iterations", most = 2 }
budgets = [1e9]
[axes]
scene = "pendulum"
steps = 2
[axes.resolver]
"catto" = "solver=split_solver{velocity=catto{iterations=$iterations}}"
)");
  ASSERT_EQ(w.lpc("sweep s.toml --store s.db --quiet").code, 0);
  const auto roles = nlohmann::json::parse(test::ask(w.path("s.db"), "SELECT roles FROM sweep"));
  for (const auto& [name, role] : roles.items()) {
    const bool kept = std::find(kNoAxes.begin(), kNoAxes.end(), name) != kNoAxes.end();
    EXPECT_EQ(kept, !role.is_string()) << name;
  }
}

TEST(SweepReport, TheStoreNamesTheChartsOfASweep) {
  Workspace w;
  const auto text = [](const std::string& charts) {
    return "summary = \"s\"\nkind = \"boxes\"\nreport = " + charts +
           "\n[axes]\ndimension = 2\nn = 8\nframes = 12\ndistribution = \"uniform\"\nbroadphase = \"naive\"\n";
  };
  w.write("s.toml", text("[\"broadphase\"]"));
  ASSERT_EQ(w.lpc("sweep s.toml --store a.db --quiet").code, 0);
  EXPECT_EQ(nlohmann::json::parse(test::ask(w.path("a.db"), "SELECT roles FROM sweep"))["report"],
            nlohmann::json({"broadphase"}));
  w.write("s.toml", text("[\"boradphase\", \"ledger\"]"));
  const test::Outcome wrong = w.lpc("sweep s.toml --store b.db --quiet");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.text.find("s.toml:3: 'report' names the chart 'boradphase'; did you mean 'broadphase'? valid: "),
            std::string::npos)
      << wrong.text;
  EXPECT_EQ(wrong.text.find("ledger,"), std::string::npos) << "which is of a store and no sweep's: " << wrong.text;
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::sweep_axis_test
