// SPDX-License-Identifier: Zlib
// The kind of a scene's joints as a parameter of the scene and as an axis of a sweep: new kinds are included
// automatically.
#include <map>
#include <set>

#include "experiments/runner/sweep_file.h"
#include "framework/problem/joint.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace joint_axis_test { namespace {

using test::Outcome;
using test::Workspace;
using Names = std::set<std::string>;

// A kind that exists in one dimension only.
template <int D>
class Flat final : public JointKind<D> {
 public:
  using Params = NoParams;
  explicit Flat(const Params&) {}
  static AlgorithmInfo info() {
    return {.name = "flat", .summary = "holds nothing", .paper = "", .complexity = "0 rows"};
  }
  void rows(const JointRecord<D>&, const Pose<D>&, const Pose<D>&, JointRows<D>&) const override {}
};
LPC_REGISTER(JointKind, Flat, 2);

Names kindsIn(int dimension) {
  Names names;
  for (const Registered* r : Registry::instance().list(StageKind::joint, dimension)) names.insert(r->info.name);
  return names;
}

// Two links on a rope of any kind; a script adds the second joint.
const std::string kLinks = R"(name = "links"
summary = "two links"
dimensions = [2, 3]
needs = ["joints", "rotation"]
gravity = [0, -10, 0]
steps = 30
[parameters]
joint = { default = "pivot", meaning = "kind of joint" }
mass = { default = 1, min = 0.1, max = 10, meaning = "of a link, kg" }
[[body]]
name = "link"
repeat = 2
position = ["k", 0, 0]
shapes = [{ kind = "circle", radius = 0.2, density = "mass" }]
[[joint]]
kind = "$joint"
a = "world"
b = "link"
anchor = [-0.5, 0, 0]
[[event]]
do = "joint"
step = 3
kind = "$joint"
a = "link[0]"
b = "link[1]"
anchor = [0.5, 0, 0]
)";

PlannedSweep planned(const Workspace& w, const std::string& axes, const std::string& scene = kLinks) {
  w.write("links.toml", scene);
  return planSweeps(w.write("s.toml", "summary = \"s\"\nkind = \"world\"\n[axes]\nscene = \"links\"\n" + axes), {})
      .at(0);
}
std::string mistakeOf(const Workspace& w, const std::string& axes, const std::string& scene = kLinks) {
  try {
    planned(w, axes, scene);
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}
std::string edited(std::string text, const std::string& old, const std::string& now) {
  const std::size_t at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), now);
}
std::string chosen(const PlannedTrial& t) { return t.canonical["params"]["joint"]; }

TEST(JointAxis, AStarIsEveryRegisteredKind) {
  Workspace w;
  const auto everyKind = [](const PlannedSweep& sweep) {
    Names names;
    for (const PlannedTrial& t : sweep.trials) names.insert(t.axes["joint"].get<std::string>());
    return names == kindsIn(2);
  };
  const PlannedSweep star = planned(w, "joint = \"*\"\n");
  EXPECT_TRUE(everyKind(star));
  EXPECT_EQ(star.roles.at("joint"), "stage") << "charts compare kinds as they compare methods";
  test::expectCaught("a sweep that lists kinds by hand", everyKind(planned(w, "joint = [\"pivot\", \"weld\"]\n")));
}

TEST(JointAxis, TheKindIsInTheKeyWithAllItsParameters) {
  Workspace w;
  const auto sweep = planned(w, "torque = [3, 5]\njoint = \"hinge{motor_speed=1,motor_torque=$torque}\"\n");
  ASSERT_EQ(sweep.trials.size(), 2u);
  const auto canonical = [](const std::string& text) {
    return Registry::instance().find(StageKind::joint, 2, "hinge").canonical(Spec::parse(text)).text();
  };
  EXPECT_EQ(chosen(sweep.trials[0]), canonical("hinge{motor_speed=1,motor_torque=3}"));
  EXPECT_EQ(chosen(sweep.trials[1]), canonical("hinge{motor_speed=1,motor_torque=5}"));
  EXPECT_EQ(sweep.roles.at("torque"), "setting");
  for (const PlannedTrial& t : sweep.trials) {
    EXPECT_EQ(t.canonical["code"].count("joint/hinge"), 1u) << t.canonical["code"];
    EXPECT_EQ(t.canonical["code"].count("joint/pivot"), 0u) << "the default takes no part";
  }
  // Numbers stay numbers, so that results of scenes without kinds keep their keys.
  EXPECT_EQ(sweep.trials[0].canonical["params"]["mass"].dump(), "1.0");
  // Spelled out or not, it is the same trial.
  EXPECT_EQ(planned(w, "joint = \"distance\"\n").trials[0].canonical["params"],
            planned(w, "joint = \"distance{mode=rod,length=-1}\"\n").trials[0].canonical["params"]);
}

// A setting of one kind is valid in the cells of other kinds, too; these cells are one trial.
TEST(JointAxis, SettingsApplyToKindsThatHaveThem) {
  Workspace w;
  const auto kinds = [](const PlannedSweep& sweep) {
    std::multiset<std::string> out;
    for (const PlannedTrial& t : sweep.trials) out.insert(Spec::parse(chosen(t)).name);
    return out;
  };
  const std::string slack = "slack = [0.1, 0.2]\n";
  EXPECT_EQ(kinds(planned(w, slack + "joint = [\"weld\", \"distance{mode=rope,length=$slack}\"]\n")),
            (std::multiset<std::string>{"distance", "distance", "weld"}));
  const auto star = kinds(planned(w, "torque = [3, 5]\njoint = \"*{motor_torque=$torque}\"\n"));
  EXPECT_EQ(star.count("hinge"), 2u);
  EXPECT_EQ(star.count("weld"), 1u);
  EXPECT_NE(mistakeOf(w, slack + "joint = \"weld\"\n").find("axis 'slack' is unknown"), std::string::npos);
}

TEST(JointAxis, ImpossibleKindsAreUnsupportedWithAReason) {
  Workspace w;
  std::map<std::string, std::string> reasons;
  for (const PlannedTrial& t : planned(w, "dimension = [2, 3]\njoint = \"*\"\n").trials) {
    reasons[t.axes["joint"].get<std::string>() + " " + t.axes["dimension"].dump()] = t.unsupported;
  }
  for (const auto& [cell, reason] : reasons) {
    const std::string kind = cell.substr(0, cell.find(' '));
    if (kind == "distance") {
      EXPECT_EQ(reason, "parameter 'joint': 'distance' is a rod of length 0; valid: two points apart, or a pivot");
    } else {
      EXPECT_EQ(reason, cell == "flat 3" ? "joint flat does not exist in 3D" : "") << cell;
    }
  }
}

TEST(JointAxis, RunsWithTheKindThatIsAsked) {
  Workspace w;
  w.write("links.toml", kLinks);
  w.write("s.toml", R"(
summary = "s"
kind = "world"
[axes]
scene = "links"
joint = ["pivot", "distance{mode=rope,length=0.1}", "distance"]
)");
  const Outcome out = w.lpc("sweep s.toml --store s.db --quiet");
  ASSERT_EQ(out.code, 0) << out.text;
  const Store store(w.path("s.db"), false);
  std::map<std::string, std::string> hashes, outcomes;
  SQLite::Database db(w.path("s.db"), SQLite::OPEN_READONLY);
  SQLite::Statement rows(
      db, "SELECT json_extract(axes, '$.joint'), outcome, hash, reason FROM planned JOIN trial USING (key)");
  while (rows.executeStep()) {
    hashes[rows.getColumn(0)] = rows.getColumn(2).getString();
    outcomes[rows.getColumn(0)] = rows.getColumn(1).getString() + " " + rows.getColumn(3).getString();
  }
  EXPECT_EQ(outcomes.at("pivot"), "ok ");
  EXPECT_EQ(outcomes.at("distance{mode=rope,length=0.1}"), "ok ");
  EXPECT_EQ(outcomes.at("distance"),
            "unsupported parameter 'joint': 'distance' is a rod of length 0; valid: two points apart, or a pivot");
  EXPECT_NE(hashes.at("pivot"), hashes.at("distance{mode=rope,length=0.1}"));

  const auto hashOf = [&](const std::string& options) {
    const Outcome run = w.lpc("run ./links.toml " + options);
    const std::size_t at = run.text.find("hash ");
    return at == std::string::npos ? run.text : run.text.substr(at + 10, 16);
  };
  EXPECT_EQ(hashOf("--param joint=pivot"), hashes.at("pivot"));
  EXPECT_EQ(hashOf(""), hashes.at("pivot"));
  EXPECT_EQ(hashOf("--param 'joint=distance{mode=rope,length=0.1}'"), hashes.at("distance{mode=rope,length=0.1}"));
  // As if the scene file contained it.
  std::string said = edited(kLinks, "kind = \"$joint\"", "kind = \"weld\"");
  said = edited(said, "kind = \"$joint\"", "kind = \"weld\"");
  w.write("welded.toml", said);
  const Outcome welded = w.lpc("run ./welded.toml");
  EXPECT_NE(welded.text.find(hashOf("--param joint=weld")), std::string::npos) << welded.text;
}

TEST(JointAxis, OnlyKeepsTheCellsOfAKind) {
  Workspace w;
  w.write("links.toml", kLinks);
  w.write("s.toml", "summary = \"s\"\nkind = \"world\"\n[axes]\nscene = \"links\"\njoint = \"*-distance\"\n");
  const Outcome out = w.lpc("sweep s.toml --only weld --dry-run");
  EXPECT_NE(out.text.find(" 1 trials, 0 timed, 0 unsupported"), std::string::npos) << out.text;
}

TEST(JointAxis, MistakesAreOneLine) {
  Workspace w;
  using Parts = std::vector<const char*>;
  struct Case {
    std::string message;
    Parts parts;
  };
  const std::string number = "joint = { default = 1, min = 0, max = 2, meaning = \"m\" }";
  const std::string text = "joint = { default = \"pivot\", meaning = \"kind of joint\" }";
  const std::vector<Case> cases = {
      {mistakeOf(w, "joint = \"hinges\"\n"), {"s.toml:5: ", "scene 'links'", "'hinges'", "valid: "}},
      {mistakeOf(w, "joint = \"hinge{uper=1}\"\n"), {"s.toml:5: ", "'joint'", "'uper'", "upper"}},
      {mistakeOf(w, "joint = \"hinge{lower=2,upper=1}\"\n"), {"s.toml:5: ", "has lower above upper"}},
      {mistakeOf(w, "joint = \"hinge{lower=2\"\n"), {"s.toml:5: ", "'}' is missing"}},
      {mistakeOf(w, "joint = \"*-hinges\"\n"), {"s.toml:5: ", "'hinges'", "valid: "}},
      {mistakeOf(w, "joint = 3\n"), {"s.toml:5: ", "unknown joint '3'"}},
      {mistakeOf(w, "mass = \"weld\"\n"), {"s.toml:5: ", "axis 'mass'", "valid: numbers"}},
      {mistakeOf(w, "joint = \"weld\"\n", edited(kLinks, text, number)), {"s.toml:5: ", "axis 'joint'", "numbers"}},
      {mistakeOf(w, "", edited(kLinks, text, number)), {"links.toml:16: ", "no parameter 'joint'", "as text"}},
      {mistakeOf(w, "", edited(kLinks, text, "")), {"links.toml:16: ", "no parameter 'joint'"}},
      {mistakeOf(w, "", edited(kLinks, "\"pivot\"", "\"\"")), {"links.toml:8: ", "'joint' is empty"}},
      {mistakeOf(w, "", edited(kLinks, "\"pivot\"", "\"pivt\"")), {"links.toml:", "'pivt'", "valid: "}},
      {mistakeOf(w, "", edited(kLinks, "\"pivot\", ", "\"pivot\", min = 0, ")), {"links.toml:8: ", "'min'"}},
      {mistakeOf(w, "", edited(kLinks, "joint = {", "knee = {")), {"links.toml:8: ", "'pivot'", "number"}},
      {mistakeOf(w, "", edited(kLinks, "a = \"world\"", "a = \"world\"\nparameters = { upper = 1 }")),
       {"links.toml:18: ", "'parameters'", "in the text of 'joint'"}},
      {mistakeOf(w, "", edited(kLinks, "a = \"world\"", "a = \"world\"\nbreak_force = -1")),
       {"links.toml:15: ", "breaks at", "> 0"}},
      {w.lpc("run ./links.toml --param joint=hinges").text, {"lpc: ", "'hinges'", "valid: "}},
  };
  for (const auto& [message, parts] : cases) {
    for (const char* part : parts) EXPECT_NE(message.find(part), std::string::npos) << part << " in\n" << message;
    EXPECT_LE(std::count(message.begin(), message.end(), '\n'), 1) << message;
  }
  w.write("links.toml", kLinks);
  for (const char* arguments : {"run ./links.toml --param joint=hinges", "run ./links.toml --param joint=3",
                                "run ./links.toml --param joint=", "run ./links.toml --param joint=distance",
                                "run ./links.toml --param mass=weld", "run pyramid --param joint=weld"}) {
    const Outcome out = w.lpc(arguments);
    EXPECT_EQ(out.code, 2) << arguments << "\n" << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << arguments << "\n" << out.text;
  }
}

TEST(JointAxis, IsListed) {
  Workspace w;
  w.write("links.toml", kLinks);
  const auto all = nlohmann::json::parse(w.lpc("list --json").text);
  bool found = false;
  for (const auto& scene : all["scenes"]) {
    if (scene["name"] != "bridge") continue;
    for (const auto& p : scene["params"]) {
      if (p["name"] != "joint") continue;
      found = true;
      EXPECT_EQ(p["default"], "pivot");
      EXPECT_EQ(p.count("min"), 0u);
    }
  }
  EXPECT_TRUE(found);
  EXPECT_NE(w.lpc("list --name bridge").text.find("joint=pivot  (lpc list --stage joint)"), std::string::npos);
}

// The shipped sweep contains every kind and has no empty cell.
TEST(ShippedSweeps, HoldEveryKindOfJoint) {
  const PlannedSweep sweep = planSweeps("joints", {}).at(0);
  Names missing = kindsIn(3);
  for (const PlannedTrial& t : sweep.trials) {
    for (const auto& [method, hash] : t.canonical["code"].items()) {
      if (method.starts_with("joint/")) missing.erase(method.substr(6));
    }
    if (chosen(t) == "flat") continue;
    EXPECT_EQ(t.unsupported, "") << chosen(t);
  }
  EXPECT_EQ(missing, Names{});
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::joint_axis_test
