// SPDX-License-Identifier: Zlib
// Ensembles: seeds change every scene, or the user is told that they have no effect.
#include <algorithm>
#include <filesystem>
#include <utility>

#include "experiments/runner/locations.h"
#include "experiments/runner/sweep_file.h"
#include "experiments/trial/scene/scene_file.h"
#include "experiments/trial/scene/scene_parsed.h"
#include "framework/scene/director.h"
#include "framework/world/invariants.h"
#include "framework/world/world.h"
#include "tests/experiments/scene_states.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace perturb_test { namespace {

using test::ask;
using test::Outcome;
using test::Workspace;

constexpr double kAmount = 1e-3;
constexpr std::size_t kBodies = 500;  // larger scenes are similar but slow to build

std::vector<SceneFile> scenes() {
  std::vector<SceneFile> out;
  for (const std::string& path : listToml("scenes")) out.push_back(SceneFile::load(path));
  return out;
}

double angleBetween(const Rot<2>& a, const Rot<2>& b) { return std::abs((a * b.inverse()).radians()); }
double angleBetween(const Rot<3>& a, const Rot<3>& b) {
  const Rot<3> turn = a * b.inverse();
  return 2 * std::atan2(Vec<3>(turn.x, turn.y, turn.z).norm(), std::abs(turn.w));
}

template <int D>
bool samePoses(const SceneSpec<D>& a, const SceneSpec<D>& b) {
  return std::equal(a.spawns.begin(), a.spawns.end(), b.spawns.begin(), b.spawns.end(),
                    [](const auto& x, const auto& y) {
                      return x.body.X_WB.p == y.body.X_WB.p && x.body.X_WB.q.matrix() == y.body.X_WB.q.matrix();
                    });
}

template <int D>
double centersApart(BodyDef<D> a, BodyDef<D> b) {  // distance of the centres of mass, m
  World<D> world;
  world.add(a), world.add(b);
  return (world.bodies().pose[0].p - world.bodies().pose[1].p).norm();
}

// What is wrong with `moved`, which should be `still` perturbed by kAmount; empty if nothing is.
template <int D>
std::string fault(const SceneSpec<D>& still, const SceneSpec<D>& moved) {
  if (still.spawns.size() != moved.spawns.size()) return "other bodies";
  int shifted = 0, dynamic = 0;
  for (std::size_t i = 0; i < still.spawns.size(); ++i) {
    const BodyDef<D>&a = still.spawns[i].body, &b = moved.spawns[i].body;
    const double shift = (a.X_WB.p - b.X_WB.p).cwiseAbs().maxCoeff(), turn = angleBetween(a.X_WB.q, b.X_WB.q);
    const std::string body = "body " + std::to_string(i) + " ";
    if (shift > kAmount * (1 + 1e-9)) return body + "is too far off";
    if (turn > 2 * kAmount) return body + "turned too far";
    if (a.type != BodyType::dynamic && (shift != 0 || turn != 0)) return body + "is not dynamic and moved";
    if (a.pinned && centersApart(a, b) > 1e-12) return body + "is pinned and moved";
    const bool turns = a.type == BodyType::dynamic && a.rotatable && still.settings.model.rotation;
    if (turns != (turn != 0)) return body + (turns ? "did not turn" : "cannot turn and did");
    const bool free = a.type == BodyType::dynamic && !a.pinned;
    dynamic += free, shifted += free && shift > 0;
  }
  return shifted < dynamic ? "bodies that did not move" : "";
}

template <int D>
void everyScene() {
  for (const SceneFile& file : scenes()) {
    if (!file.has(D) || test::bodiesOf(file.name(), D) > kBodies) continue;
    SCOPED_TRACE(file.name() + " in " + std::to_string(D) + "D");
    const std::uint64_t seed = file.defaultSeed();
    const SceneSpec<D> still = file.build<D>({}, seed), moved = file.build<D>({{"perturb", kAmount}}, seed);
    EXPECT_TRUE(samePoses(still, file.build<D>({{"perturb", 0.0}}, seed)));
    EXPECT_EQ(fault(still, moved), "");
    EXPECT_TRUE(samePoses(moved, file.build<D>({{"perturb", kAmount}}, seed)));
    const bool moves = std::any_of(still.spawns.begin(), still.spawns.end(),
                                   [](const auto& s) { return s.body.type == BodyType::dynamic; });
    EXPECT_EQ(moves, file.name() != "preset_0") << "the one scene that is only a room";
    EXPECT_NE(samePoses(moved, file.build<D>({{"perturb", kAmount}}, seed + 1)), moves);
    EXPECT_EQ(still.seeded, !samePoses(still, file.build<D>({}, seed + 1)));
    EXPECT_EQ(moved.seeded, moves);
    // Planted bugs: a perturbation that is too large, and one of each body that must not move, including a floor.
    SceneSpec<D> wrong = moved;
    wrong.spawns[0].body.X_WB.p[0] += Real(3 * kAmount);
    EXPECT_NE(fault(still, wrong), "");
    wrong = moved;
    for (std::size_t i = 0; i < moved.spawns.size(); ++i) {
      if (still.spawns[i].body.type == BodyType::dynamic) continue;
      Real& x = wrong.spawns[i].body.X_WB.p[0];
      const Real was = std::exchange(x, x + Real(kAmount / 2));
      EXPECT_EQ(fault(still, wrong), "body " + std::to_string(i) + " is not dynamic and moved");
      x = was;
    }
  }
}

TEST(Perturb, movesTheDynamicBodiesOfEveryScene) {
  everyScene<2>();
  everyScene<3>();
}

// A see-saw with a board defined from its end: the pivot is at its centre of mass and stays there.
TEST(Perturb, aPinnedBodyTurnsAboutItsCentreOfMass) {
  SceneSpec<2> still;
  BodyDef<2> board;
  board.pinned = true;
  board.shapes.push_back({.shape = Shape<2>::box(Vec<2>(1, Real(0.1))), .X_BS = {Vec<2>(1, 0), Rot<2>()}});
  still.spawns.push_back({.body = board});
  SceneSpec<2> moved = still;
  perturb(moved, 0.1, 1);
  const Pose<2>& X = moved.spawns[0].body.X_WB;
  EXPECT_NE(X.q.radians(), 0);
  EXPECT_LT((X * Vec<2>(1, 0) - Vec<2>(1, 0)).norm(), 1e-6);
  EXPECT_TRUE(moved.seeded);
  // A body that may neither move nor rotate is not perturbed.
  still.spawns[0].body.rotatable = false;
  perturb(still, 0.1, 1);
  EXPECT_FALSE(still.seeded);
}

// Joint errors of a world at the start (m; rad).
template <int D>
double errorAtStart(const SceneSpec<D>& scene) {
  World<D> world(Pipeline::parse(""), scene.settings);
  Director<D> director(scene);
  director.advance(world);
  const StateInvariants<D> start = stateInvariants(world);
  return std::max(start.jointError, start.jointTurn);
}

TEST(Perturb, noJointStartsWithAnError) {
  const SceneFile bridge = SceneFile::load(findToml("scenes", "bridge"));
  for (const char* kind : {"pivot", "weld", "hinge"}) {
    const ParameterValues values = {{"joint", std::string(kind)}, {"perturb", kAmount}};
    const SceneSpec<3> moved = bridge.build<3>(values, 1);
    ASSERT_FALSE(moved.joints.empty());
    EXPECT_LT(errorAtStart(moved), 1e-12) << kind;
    // Planted bug: joints are made before the bodies are perturbed.
    World<3> world(Pipeline::parse(""), moved.settings);
    Director<3> director(bridge.build<3>({{"joint", std::string(kind)}}, 1));
    director.advance(world);
    for (std::size_t i = 0; i < moved.spawns.size(); ++i) {
      world.setPose(director.body(static_cast<int>(i)), moved.spawns[i].body.X_WB);
    }
    EXPECT_GT(stateInvariants(world).jointError, kAmount / 10) << "the planted bug was not seen";
  }
}

TEST(Perturb, itsNameIsReserved) {
  Workspace w;
  const std::string text = "name = \"s\"\nsummary = \"s\"\ndimensions = [2]\n[parameters]\n";
  w.write("s.toml", text + "perturb = { default = 1, min = 0, max = 2, meaning = \"m\" }\n");
  const Outcome out = w.lpc("run ./s.toml");
  EXPECT_EQ(out.code, 2);
  EXPECT_NE(out.text.find("s.toml:5: 'perturb' is a parameter of every scene; valid: another name"), out.text.npos)
      << out.text;
  EXPECT_NE(
      w.lpc("run pyramid --param perturb=1 --steps 1").text.find("'perturb' of scene 'pyramid' is 1; valid: 0 to 0.1"),
      std::string::npos);
}

std::string ensemble(const std::string& scene, const std::string& more) {
  return "summary = \"s\"\nkind = \"world\"\n[axes]\nscene = \"" + scene + "\"\nsteps = 5\nseed = [1, 2, 3]\n" + more;
}

TEST(Perturb, aSeedWithoutEffectIsReported) {
  Workspace w;
  w.write("idle.toml", ensemble("vertical_stack", ""));
  w.write("moved.toml", ensemble("vertical_stack", "perturb = 1e-6\n"));
  w.write("drawn.toml", ensemble("box_pile", "n = 8\n"));
  const std::string note =
      "sweep idle: the seed has no effect in scene 'vertical_stack'; set its parameter 'perturb', such as 1e-6";
  EXPECT_NE(w.lpc("sweep ./idle.toml --dry-run").text.find(note), std::string::npos);
  EXPECT_EQ(w.lpc("sweep ./moved.toml --dry-run").text.find("has no effect"), std::string::npos);
  EXPECT_EQ(w.lpc("sweep ./drawn.toml --dry-run").text.find("has no effect"), std::string::npos);
  // Per cell, not per scene: half of these cells run the same trial three times; the others are perturbed.
  // The final states confirm it.
  w.write("half.toml", ensemble("vertical_stack", "n = [2, 3]\nperturb = [0, 1e-6]\n"));
  const Outcome half = w.lpc("sweep ./half.toml --dry-run");
  EXPECT_NE(half.text.find("no effect in scene 'vertical_stack' where perturb=0; set"), half.text.npos) << half.text;
  const std::string count = "SELECT count(DISTINCT hash) || ' of ' || count(*) FROM trial WHERE outcome = 'ok'";
  for (const auto& [name, hashes] : {std::pair("idle", "1 of 3"), std::pair("moved", "3 of 3"),
                                     std::pair("drawn", "3 of 3"), std::pair("half", "8 of 12")}) {
    const std::string store = std::string(name) + ".db";
    ASSERT_EQ(w.lpc("sweep ./" + std::string(name) + ".toml --quiet --store " + store).code, 0);
    EXPECT_EQ(ask(w.path(store), count), hashes) << name;
  }
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::perturb_test
