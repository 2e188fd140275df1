// SPDX-License-Identifier: Zlib
// Stars in sweeps: whoever is registered is in, wherever a method's name may stand.
#include "experiments/runner/sweep_axis.h"

#include <map>
#include <set>

#include "experiments/runner/sweep_file.h"
#include "framework/registry.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using test::Workspace;
using Names = std::set<std::string>;

Names registered(StageKind kind, Role role = Role::competitor) {
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

// The axis `name` of this text: label and what it stands for.
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

TEST(SweepStar, IsEveryRegisteredOneOfAnyStage) {
  for (const StageInfo& stage : kStages) {
    const std::string name{stage.name};
    SCOPED_TRACE(name);
    const Names all = registered(stage.kind, stage.kind == StageKind::engine ? Role::engine : Role::competitor);
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

// A parameter goes to those who have it: the others are in the sweep all the same.
TEST(SweepStar, GivesParametersToThoseWhoHaveThem) {
  const auto axis = axisOf("r", R"({ "$velocity" = "solver=split_solver{velocity=*{iterations=$n}}" })");
  EXPECT_EQ(axis.at("catto"), "solver=split_solver{velocity=catto{iterations=$n}}");
  EXPECT_EQ(axis.at("millington"), "solver=split_solver{velocity=millington}");
  EXPECT_EQ(axisOf("velocity", "\"*-naive-catto{iteration_factor=3}\"").count("millington{iteration_factor=3}"), 1u);
}

TEST(SweepStar, PlansAlsoThoseWithoutTheParameter) {
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
      {R"({ "$velocity" = "solver=split_solver{velocity=*{sweeps=4}}" })", {"s.toml:1: ", "no velocity has 'sweeps'"}},
      {R"({ "$velocity" = "solver=split_solver{velocity=*-cato}" })", {"s.toml:1: ", "'cato'", "valid: catto"}},
      {R"({ "$velocity" = "solver=split_solver{velocity=*all}" })", {"s.toml:1: ", "'*all'", "*witness"}},
      {R"({ "$velocity" = "solver=split_solver{velocity=*" })", {"s.toml:1: ", "'}' is missing"}},
      {R"({ "$solvers" = "solvers=*" })", {"s.toml:1: ", "unknown stage 'solvers'"}},
      {R"({ "$velocity" = "solver=split_solver{velocity=*}", "catto" = "solver=split_solver" })",
       {"s.toml:1: ", "two methods have the label 'catto'"}},
      {"[\"*\"]", {"s.toml:1: ", "'r', which is no stage's"}}};
  for (const auto& [text, parts] : cases) {
    const std::string message = errorOf("r", text);
    for (const char* part : parts) EXPECT_NE(message.find(part), std::string::npos) << text << "\n" << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

// Marks that nobody replaced are refused by name, not as bad syntax.
TEST(SweepStar, IsNobodysName) {
  Workspace w;
  const test::Outcome run = w.lpc("run box_drop --pipeline 'solver=split_solver{velocity=*}'");
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.text.find("there is no velocity '*' in"), std::string::npos) << run.text;
  EXPECT_NE(run.text.find("valid: catto"), std::string::npos) << run.text;
}

// Registered methods of the stages whose sweeps these are, in no cell of a plan.
Names lacking(const PlannedSweep& sweep) {
  Names missing;
  for (const StageKind kind : {StageKind::solver, StageKind::velocity, StageKind::position}) {
    for (const std::string& n : registered(kind)) missing.insert(std::string(stageName(kind)) + "/" + n);
  }
  for (const PlannedTrial& t : sweep.trials) {
    for (const auto& [method, hash] : t.canonical["code"].items()) missing.erase(method);
  }
  return missing;
}

TEST(ShippedSweeps, HoldEveryResolver) {
  for (const char* name : {"resolvers", "resolvers_full", "breaking_points_stack", "breaking_points_stack_full",
                           "breaking_points_mass_ratio", "breaking_points_dt"}) {
    EXPECT_EQ(lacking(planSweeps(name, {}).at(0)), Names{}) << name;
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

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
