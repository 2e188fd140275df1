// SPDX-License-Identifier: Zlib
// A script in its own file, played in any scene; and its mistakes, reported with its file and line.
#include <gtest/gtest.h>

#include <map>

#include "experiments/runner/locations.h"
#include "experiments/runner/trial_plan.h"
#include "experiments/trial/scene/scene_file.h"
#include "framework/scene/director.h"
#include "framework/shape/mass.h"
#include "framework/world/world.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace scene_script_test { namespace {

using test::expectCaught;
using test::Workspace;

const std::string kScene = R"t(name = "room"
summary = "s"
dimensions = [2, 3]
settings = "2009"
steps = 10
[parameters]
wide = { default = 3, min = 0, max = 9, meaning = "m" }
[[body]]
name = "floor"
type = "fixed"
shapes = [{ kind = "box", half = [5, 1, 5] }]
[[body]]
name = "box"
position = ["rand(0, 1)", 3]
shapes = [{ kind = "box", half = [1, 1, 1] }]
)t";
const std::string kScript = R"t(summary = "three circles, and a push"
steps = "20 * late"
[parameters]
late = { default = 5, min = 0, max = 99, meaning = "step" }
[[body]]
name = "circle"
from = "late"
repeat = { i = 3 }
position = ["3 * i", "8 + rand(0, 1)"]
shapes = [{ kind = "circle", radius = 0.5 }]
[[event]]
do = "push"
step = "late + 1"
body = "box"
impulse = [4, 0]
)t";

SceneFile with(const std::string& script, const std::string& sceneText = kScene) {
  return SceneFile::parse(sceneText, "room.toml", script, "play.toml");
}

template <int D>
void plays() {
  const SceneFile alone = SceneFile::parse(kScene, "room.toml"), both = with(kScript);
  const SceneSpec<D> before = alone.build<D>({}, 1), after = both.build<D>({{"late", 7}}, 1);
  EXPECT_EQ(before.steps, 10);
  EXPECT_EQ(after.steps, 140) << "a script knows when it ends";
  ASSERT_EQ(after.spawns.size(), 5u);
  EXPECT_EQ(after.spawns[1].body.X_WB.p, before.spawns[1].body.X_WB.p) << "it draws none of the scene's numbers";
  EXPECT_EQ(after.spawns[2].step, 7);
  EXPECT_EQ(after.spawns[4].body.X_WB.p[0], 6);
  EXPECT_EQ(after.spawns[4].body.shapes[0].restitution, Real(0.4)) << "settings are the scene's";
  EXPECT_EQ(after.events.size(), 1u);
  EXPECT_NE(both.build<D>({}, 2).spawns[4].body.X_WB.p, both.build<D>({}, 1).spawns[4].body.X_WB.p);
  const auto still = both.build<D>({}, 1), moved = both.build<D>({{"perturb", 1e-3}}, 1);
  EXPECT_NE(still.spawns[4].body.X_WB.p, moved.spawns[4].body.X_WB.p) << "its bodies are perturbed as all are";
}
TEST(SceneScript, PlaysInAScene) { plays<2>(), plays<3>(); }

// Whether the script is part of the content from which a trial's key is computed.
bool inTheContent(const std::string& changed) { return with(changed).content() != with(kScript).content(); }
TEST(SceneScript, IsInTheContent) {
  std::string changed = kScript;
  changed.replace(changed.find("8 + rand"), 1, "9");
  EXPECT_TRUE(inTheContent(changed));
  expectCaught("a script that is not in the key", inTheContent(kScript));
  EXPECT_NE(with(kScript).content(), SceneFile::parse(kScene, "room.toml").content());
  const auto key = [](const std::string& script) {
    WorldCell cell;
    cell.script = script, cell.steps = 1;
    return Planner().world("preset_0", cell);
  };
  EXPECT_NE(key("").key, key("director_0").key);
  EXPECT_NE(key("rain").key, key("meteors").key);
  EXPECT_EQ(key("1").key, key("director_1").key);
  EXPECT_EQ(key("1").canonical.at("script"), "director_1");
  EXPECT_FALSE(key("").canonical.contains("script"));
}

// Adds the same bodies at the same places and steps as the scenes director_1 and director_2, which have another room.
void sameAsScene(const std::string& name, const ParameterValues& values, const ParameterValues& own, bool places) {
  const SceneFile script = SceneFile::load(findToml("scenes", "0"), findToml("scripts", name));
  const SceneSpec<2> a = script.build<2>(values, 1), b = SceneFile::load(findToml("scenes", name)).build<2>(own, 1);
  EXPECT_EQ(a.steps, b.steps);
  ASSERT_EQ(a.spawns.size(), b.spawns.size());
  for (std::size_t i = 4; i < a.spawns.size(); ++i) {
    ASSERT_EQ(a.spawns[i].step, b.spawns[i].step);
    ASSERT_EQ(a.spawns[i].body.shapes[0].shape.view().radius, b.spawns[i].body.shapes[0].shape.view().radius);
    if (!places) continue;
    ASSERT_EQ(a.spawns[i].body.X_WB.p, b.spawns[i].body.X_WB.p);
    ASSERT_EQ(a.spawns[i].body.velocity, b.spawns[i].body.velocity);
  }
}
TEST(SceneScript, TheDirectorsOfTheReport) {
  sameAsScene("director_1", {}, {}, true);
  sameAsScene("director_2", {{"stop", 400}}, {{"until", 400}}, false);
  const SceneFile two = SceneFile::load(findToml("scenes", "0"), findToml("scripts", "2"));
  const SceneSpec<2> spec = two.build<2>({{"gravity", 0.0}, {"restitution", 1.0}, {"stop", 400}}, 1);
  EXPECT_EQ(spec.settings.gravity, Vec<2>(0, 0));
  EXPECT_EQ(spec.spawns.back().body.shapes[0].restitution, 1);
  const SceneFile none = SceneFile::load(findToml("scenes", "0"), findToml("scripts", "0"));
  EXPECT_EQ(census(none.build<2>({}, 1)), census(SceneFile::load(findToml("scenes", "0")).build<2>({}, 1)));
}

template <int D>
void everyScriptPlays() {
  for (const std::string& path : listToml("scripts")) {
    SCOPED_TRACE(path);
    const SceneFile file = SceneFile::load(findToml("scenes", "0"), path);
    const SceneSpec<D> scene = file.build<D>({}, 1);
    World<D> world({}, scene.settings);
    Director<D> director(scene);
    for (int i = 0; i < 100; ++i) director.advance(world), world.step(scene.dt);
    const bool empty = path.find("director_0") != path.npos;
    EXPECT_EQ(world.bodyCount() > (D == 2 ? 4 : 6), !empty);
    for (const Pose<D>& pose : world.bodies().pose) EXPECT_LT(std::abs(pose.p[0]), 30) << "out of the room";
  }
}
TEST(SceneScript, EveryOneThatShipsPlays) { everyScriptPlays<2>(), everyScriptPlays<3>(); }

// Evenly distributed: the velocities sum to zero, all sparks are equally fast, and no two overlap.
template <int D>
bool even(const SceneSpec<D>& scene) {
  Vec<D> sum = Vec<D>::Zero();
  std::vector<Vec<D>> at;
  for (const auto& s : scene.spawns) {
    if (s.body.name != "spark") continue;
    if (std::abs(s.body.velocity.norm() - 10) > 1e-9) return false;
    sum += s.body.velocity, at.push_back(s.body.X_WB.p);
  }
  for (std::size_t i = 0; i < at.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if ((at[i] - at[j]).norm() < 0.1) return false;
    }
  }
  return at.size() == 36 && sum.norm() < 36 * 10 * 0.02;
}
template <int D>
void firework() {
  const SceneFile file = SceneFile::load(findToml("scenes", "0"), findToml("scripts", "firework"));
  SceneSpec<D> scene = file.build<D>({}, 1);
  EXPECT_TRUE(even(scene));
  scene.spawns.back().body.velocity *= Real(1.01);
  expectCaught("a spark that is faster", even(scene));
}
TEST(SceneScript, AFireworkIsEven) { firework<2>(), firework<3>(); }

// Polygons with every number of corners from 3 (3D: 4) to 8, on a circle of radius 0.5 m, none too thin.
template <int D>
bool random3To8(const SceneSpec<D>& scene) {
  std::map<std::size_t, int> seen;
  for (const auto& s : scene.spawns) {
    if (s.body.name != "polygon") continue;
    const auto& vertices = s.body.shapes[0].shape.view().hull->vertices;
    ++seen[vertices.size()];
    for (const Vec<D>& v : vertices) {
      if (std::abs(v.norm() - Real(0.5)) > 1e-6) return false;
    }
    const Real size = massProperties(s.body.shapes[0].shape, Real(1)).mass;  // a circle has 0.785, a ball 0.524
    if (size < (D == 2 ? Real(0.075) : Real(0.0125))) return false;
  }
  return seen.size() == (D == 2 ? 6 : 5) && seen.begin()->first == (D == 2 ? 3 : 4) && seen.rbegin()->first == 8;
}
template <int D>
std::vector<Vec<D>> cornersOf(const SceneSpec<D>& scene) {
  std::vector<Vec<D>> out;
  for (const auto& s : scene.spawns) {
    if (s.body.name != "polygon") continue;
    const auto& vertices = s.body.shapes[0].shape.view().hull->vertices;
    out.insert(out.end(), vertices.begin(), vertices.end());
  }
  return out;
}
template <int D>
void polygons() {
  const SceneFile file = SceneFile::load(findToml("scenes", "0"), findToml("scripts", "polygons"));
  const auto made = [&](std::uint64_t seed) { return cornersOf(file.build<D>({}, seed)); };
  EXPECT_EQ(made(1), made(1));
  EXPECT_NE(made(1), made(2));
  for (const std::uint64_t seed : {1, 2, 3}) EXPECT_TRUE(random3To8(file.build<D>({{"end", 6000}}, seed))) << seed;
  expectCaught("never three or four corners", random3To8(file.build<D>({{"fewest", 5}}, 1)));
  expectCaught("nine corners", random3To8(file.build<D>({{"end", 6000}, {"most", 9}}, 1)));
  expectCaught("a larger circle", random3To8(file.build<D>({{"end", 6000}, {"size", 0.6}}, 1)));
}
TEST(SceneScript, PolygonsHaveThreeToEightCorners) { polygons<2>(), polygons<3>(); }

TEST(SceneScript, MistakesAreOneLineOfTheScript) {
  const std::string circle = "shapes = [{ kind = \"circle\", radius = 1 }]\n", head = "summary = \"s\"\n";
  const std::pair<std::string, std::vector<std::string>> cases[] = {
      {head + "[[event]]\ndo = \"push\"\nstep = 1\nbody = \"bax\"\nimpulse = [1, 0]\n",
       {"play.toml:5: ", "'bax'", "valid: box, floor"}},
      {head + "[[body]]\nfrom = 20\nevery = 5\nuntil = 10\n" + circle,
       {"play.toml:5: ", "'until' is 10; valid: from step 20 on"}},
      {head + "[[event]]\ndo = \"force\"\nstep = 20\nuntil = 10\nbody = \"box\"\nforce = [1, 0]\n",
       {"play.toml:5: ", "'until' is 10; valid: from step 20 on"}},
      {head + "[[body]]\nfrom = 20\nremove = 10\n" + circle, {"play.toml:4: ", "'remove' is 10", "step 20"}},
      {head + "[[body]]\nname = \"late\"\nfrom = 20\n" + circle +
           "[[event]]\ndo = \"remove\"\nstep = 10\nbody = \"late\"\n",
       {"play.toml:6: ", "at step 10 'late' does not exist: it is added at 20"}},
      {head + "[[body]]\nposition = [\"nobody\", 0]\n" + circle, {"play.toml:3: ", "'nobody'"}},
      {head + "gravity = [0, 0]\n", {"play.toml:2: ", "'gravity'"}},
      {"steps = 3\n", {"play.toml:1: ", "'summary' is missing"}},
      {head + "[parameters]\nwide = { default = 3, min = 0, max = 9, meaning = \"m\" }\n",
       {"play.toml:3: ", "'wide' is also a parameter of scene 'room'"}},
      {head + "[[body]\n", {"play.toml:2: "}},
  };
  for (const auto& [script, parts] : cases) {
    std::string message = "no error";
    try {
      with(script).build<2>({}, 1);
    } catch (const UserError& e) {
      message = e.what();
    }
    for (const std::string& part : parts) EXPECT_NE(message.find(part), message.npos) << script << "\n" << message;
    EXPECT_EQ(message.find('\n'), message.npos) << message;
  }
  // A mistake in the scene is still reported for the scene.
  try {
    with(head, kScene + "oops = 1\n").build<2>({}, 1);
    FAIL();
  } catch (const UserError& e) {
    EXPECT_TRUE(std::string(e.what()).starts_with("room.toml:")) << e.what();
  }
}

TEST(SceneScript, OfTheCommandLine) {
  Workspace w;
  w.write("room.toml", kScene);
  w.write("play.toml", kScript);
  w.write("wrong.toml", "summary = \"s\"\n[[event]]\ndo = \"remove\"\nstep = 3\nbody = \"nobody\"\n");
  const test::Outcome run = w.lpc("run room.toml --script play.toml --param late=1");
  EXPECT_EQ(run.code, 0) << run.text;
  EXPECT_NE(run.text.find("script    play\n"), run.text.npos) << run.text;
  EXPECT_NE(run.text.find("steps_done                 20"), run.text.npos) << run.text;
  EXPECT_EQ(w.lpc("run 0 --script 1 --steps 3").code, 0);
  for (const std::string bad : {"wrong.toml", "3", "nobody"}) {
    const test::Outcome out = w.lpc("run room.toml --profile p.csv --script " + bad);
    EXPECT_EQ(out.code, 2) << bad;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
    EXPECT_FALSE(std::filesystem::exists(w.path("p.csv"))) << "half-written";
  }
  EXPECT_NE(w.lpc("run room.toml --script wrong.toml").text.find("wrong.toml:5: "), std::string::npos);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::scene_script_test
