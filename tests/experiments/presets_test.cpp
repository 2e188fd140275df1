// SPDX-License-Identifier: Zlib
// The worlds of the 2009 sandbox, by number: they are found, have the report's settings, and do what the report says.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "experiments/runner/locations.h"
#include "experiments/trial/scene/scene_file.h"
#include "framework/scene/director.h"
#include "framework/world/settings.h"
#include "framework/world/world.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace presets_test { namespace {

using test::expectCaught;

template <int D>
struct Play {
  SceneSpec<D> scene;
  World<D> world;
  Director<D> director;

  explicit Play(const std::string& name, const ParameterValues& values = {}, const std::string& pipeline = "",
                std::uint64_t seed = 1)
      : scene(SceneFile::load(findToml("scenes", name)).build<D>(values, seed)),
        world(Pipeline::parse(pipeline), scene.settings),
        director(scene) {}
  void steps(long n) {
    for (long i = 0; i < n; ++i) director.advance(world), world.step(scene.dt);
  }
  /// Pose of the i-th body of that name.
  Pose<D> pose(const std::string& name, int i = 0) const { return world.pose(director.body(spawn(name, i))); }
  Vec<D> start(const std::string& name, int i = 0) const {
    return scene.spawns[static_cast<std::size_t>(spawn(name, i))].body.X_WB.p;
  }
  int spawn(const std::string& name, int i) const {
    for (std::size_t s = 0; s < scene.spawns.size(); ++s) {
      if (scene.spawns[s].body.name == name && i-- == 0) return static_cast<int>(s);
    }
    throw UserError("no " + name);
  }
  int count(const std::string& name) const {
    return static_cast<int>(
        std::count_if(scene.spawns.begin(), scene.spawns.end(), [&](const auto& s) { return s.body.name == name; }));
  }
  Real moved(const std::string& name) const {  // largest motion among them
    Real most = 0;
    for (int i = 0; i < count(name); ++i) most = std::max(most, (pose(name, i).p - start(name, i)).norm());
    return most;
  }
  /// Number of bodies of that name tilted by more than about 45 degrees.
  int fallen(const std::string& name) const {
    int out = 0;
    for (int i = 0; i < count(name); ++i) out += (pose(name, i).q * Vec<D>::Unit(1))[1] < Real(0.7);
    return out;
  }
};

const std::string kSleep = "sleep=split_average";

// --- by number ------------------------------------------------------------------------------------------------------

TEST(Presets, ANumberIsAName) {
  const auto found = [](const char* folder, const char* number) {
    return std::filesystem::path(findToml(folder, number)).stem().string();
  };
  EXPECT_EQ(found("scenes", "5"), "preset_5");
  EXPECT_EQ(found("scenes", "preset_5"), "preset_5");
  EXPECT_EQ(found("scenes", "10"), "preset_10");
  EXPECT_EQ(found("scripts", "1"), "director_1");
  const auto refusal = [](const char* folder, const char* number) {
    try {
      return findToml(folder, number);
    } catch (const UserError& e) {
      return std::string(e.what());
    }
  };
  for (const char* wrong : {"12", "05", "99999999999999999999"}) {
    const std::string message = refusal("scenes", wrong);
    EXPECT_TRUE(message.starts_with("no preset_" + std::string(wrong) + "; valid: 0, 1, 2, 3")) << message;
    EXPECT_TRUE(message.ends_with("9, 10, 11")) << message;
  }
  EXPECT_EQ(refusal("scripts", "3"), "no director_3; valid: 0, 1, 2");
  EXPECT_NE(refusal("scenes", "-1").find("no such name"), std::string::npos) << "a sign is no number";
  EXPECT_NE(refusal("sweeps", "1").find("no such name"), std::string::npos) << "sweeps have no numbers";
}

TEST(Presets, ANumberRuns) {
  test::Workspace w;
  const test::Outcome run = w.lpc("run 4 --steps 2"), wrong = w.lpc("run 12");
  EXPECT_EQ(run.code, 0) << run.text;
  EXPECT_NE(run.text.find("preset_4 in 2D"), run.text.npos) << run.text;
  EXPECT_EQ(wrong.code, 2);
  EXPECT_EQ(std::count(wrong.text.begin(), wrong.text.end(), '\n'), 1) << wrong.text;
}

// --- settings -------------------------------------------------------------------------------------------------------

SceneSpec<2> scene(const std::string& keys, const std::string& rest = "", const std::string& shape = "") {
  return SceneFile::parse("name = \"t\"\nsummary = \"s\"\ndimensions = [2]\n" + keys + "\n" + rest +
                              "\n[[body]]\nshapes = [{ kind = \"circle\", radius = 1" + shape + " }]\n",
                          "t.toml")
      .build<2>({}, 1);
}
// Whether the settings are those of `Settings::lpc2009`.
bool of2009(const SceneSpec<2>& s) {
  const Settings report = Settings::lpc2009();
  const ShapeDef<2>& shape = s.spawns.at(0).body.shapes.at(0);
  return s.settings.gravity == Vec<2>(0, report.gravity) && s.dt == report.dt && s.settings.mixing == report.mixing &&
         s.settings.restitutionThreshold == report.restitutionThreshold && shape.density == report.density &&
         shape.restitution == report.restitution && shape.friction == report.friction;
}

TEST(Presets, KeysOfASceneOverrideSettings) {
  const std::string key = "settings = \"2009\"";
  EXPECT_TRUE(of2009(scene(key)));
  expectCaught("a scene without them", of2009(scene("")));
  EXPECT_EQ(scene(key, "gravity = [0, -3]").settings.gravity, Vec<2>(0, -3));
  EXPECT_EQ(scene(key, "dt = 0.5").dt, 0.5);
  EXPECT_EQ(scene(key, "restitution_threshold = 3").settings.restitutionThreshold, 3);
  EXPECT_EQ(scene(key, "[mixing]\nfriction = \"minimum\"").settings.mixing.friction, MixRule::minimum);
  const auto shape = [](const SceneSpec<2>& s) { return s.spawns.at(0).body.shapes.at(0); };
  const SceneSpec<2> both = scene(key, "[defaults]\nfriction = 0.25\nrestitution = 0.75", ", restitution = 0.125");
  EXPECT_EQ(shape(both).friction, 0.25);
  EXPECT_EQ(shape(both).restitution, 0.125);
  EXPECT_EQ(shape(both).density, 1);
  try {
    scene("settings = \"209\"");
    FAIL();
  } catch (const UserError& e) {
    EXPECT_STREQ(e.what(), "t.toml:4: unknown settings '209'; did you mean '2009'? valid: 2009");
  }
}

TEST(Presets, AllHaveTheReportsSettings) {
  for (const std::string number : {"0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11"}) {
    const SceneSpec<2> s = SceneFile::load(findToml("scenes", number)).build<2>({}, 1);
    EXPECT_EQ(s.settings.gravity, Vec<2>(0, Real(-9.8))) << number;
    EXPECT_EQ(s.dt, Real(1) / 60) << number;
    for (const auto& spawn : s.spawns) {
      if (number == "8" && spawn.body.name == "ball") continue;  // of the cradle: full restitution
      for (const auto& shape : spawn.body.shapes) EXPECT_EQ(shape.restitution, Real(0.4)) << number;
    }
  }
}

// --- behaviour ------------------------------------------------------------------------------------------------------

// "Technically this is mathematically correct"; with "a small random offset" the circles roll off and the squares
// stand.
template <int D>
void towers(const std::string& sleep) {
  Play<D> aligned("2", {{"circles", 6}, {"squares", 6}}, sleep);
  Play<D> offset("2", {{"circles", 6}, {"squares", 6}, {"perturb", 1e-3}});
  aligned.steps(600), offset.steps(600);
  EXPECT_LT(aligned.moved("circle"), 0.05);
  EXPECT_LT(aligned.moved("square"), 0.1);
  EXPECT_GT(offset.moved("circle"), 1);
  EXPECT_LT(offset.moved("square"), 0.1);
}
TEST(Presets, ExactTowersOfCirclesStandAndOthersDoNot) { towers<2>(""), towers<2>(kSleep), towers<3>(""); }

TEST(Presets, TheTowerOfDominoesIsStable) {
  for (const std::string& pipeline : {std::string(), kSleep}) {
    Play<2> play("3", {}, pipeline);
    Real wobble = 0;
    for (int i = 0; i < 600; ++i) play.steps(1), wobble = std::max(wobble, play.moved("lying"));
    EXPECT_LT(wobble, play.scene.limits.drift);
    EXPECT_EQ(wobble > Real(0.05), pipeline.empty()) << "the outermost wobble until slept: " << wobble;
    EXPECT_LT(play.moved("standing"), 0.05);
    EXPECT_LT(play.moved("lying"), 0.05);
  }
}

// Falls by 0.5 m, bounces to 0.4^2 of that height, and comes to rest.
TEST(Presets, TheBoxFallsBouncesAndLies) {
  Play<2> play("4");
  Real up = 0;
  bool down = false;
  for (int i = 0; i < 300; ++i) {
    play.steps(1);
    const Real height = play.pose("box").p[1] - Real(0.5);
    down = down || height < Real(0.02);
    if (down) up = std::max(up, height);
  }
  EXPECT_NEAR(up, 0.16 * 0.5, 0.03);
  EXPECT_NEAR(play.pose("box").p[1], 0.5, 0.006);
  EXPECT_LT(std::abs(play.pose("box").q.radians()), 1e-3);
}

// In the report, pyramid 5 explodes; here it sinks by the drop height and stands. Pyramid 6, with "small row spacing",
// is the more stable one in the report.
TEST(Presets, PyramidsFallAndStand) {
  Play<2> play("5", {{"base", 10}});
  play.steps(400);
  EXPECT_LT(play.moved("box"), 0.5 + 0.3);
  Play<2> spaced("6", {{"base", 10}});
  spaced.steps(400);
  EXPECT_LT(spaced.moved("box"), 0.5 + 9 * 0.05 + 0.3);
}

// Preset 1, its circles, compounds and line shapes: each comes to rest on a round or pointed part. Without the capsule,
// the pentagon and what they lean on.
TEST(Presets, EachShapeLiesOnItsOwn) {
  Play<2> play("1");
  play.steps(600);
  struct Lies {
    const char* body;
    Vec<2> point;  // of the body: a corner or the centre of a circle
    Real height;   // m: 0 or the circle's radius
  };
  const Lies all[] = {
      {"circle", {0, 0}, 1},
      {"rectangle", {Real(-1.5), Real(-0.5)}, 0},
      {"rectangle", {Real(1.5), Real(-0.5)}, 0},
      {"conjoined", {0, 0}, 1},
      {"conjoined", {Real(1.4), Real(0.4)}, Real(0.7)},
      {"triangle", {0, 0}, 0},
      {"triangle", {2, 0}, 0},
      {"cross", {-1, -1}, Real(0.4)},
      {"cross", {1, -1}, Real(0.4)},
      {"seesaw", {-1, -2}, Real(0.2)},  // on its circle and on an end of its line
      {"seesaw", {5, -2}, 0},
      {"dense", {Real(0.25), 1}, Real(1.5)},
      {"dense", {Real(-0.25), -1}, Real(1.5)},
  };
  const auto off = [](const Play<2>& played, const Lies& l) { return (played.pose(l.body) * l.point)[1] - l.height; };
  for (const Lies& l : all)
    EXPECT_NEAR(off(play, l), 0, Real(1.1) * kLinearSlop) << l.body << " " << l.point.transpose();
  Play<2> before("1");
  before.steps(1);
  for (const Lies& l : all) {
    expectCaught(std::string("a world that stands still: ") + l.body, std::abs(off(before, l)) < kLinearSlop);
  }
}

// In 3D the larger pyramid is a wall one box thick, and its rows slide on each other: bodies that sleep on a sliding
// support must wake.
TEST(Presets, TheWallIn3dStandsWithTheReportsSleeping) {
  Play<3> play("6", {}, kSleep);
  play.steps(450);
  EXPECT_LT(play.moved("box"), play.scene.limits.drift);
}

template <int D>
void pinball() {
  Play<D> play("7", {{"n", 50}, {"rows", 3}});
  play.steps(900);
  int caught = 0;
  Real turned = 0;
  for (int i = 0; i < 50; ++i) {
    const Vec<D> p = play.pose("ball", i).p;
    caught += p[1] < 2 && p[1] > 0 && std::abs(p[0]) < 10 && (D == 2 || std::abs(p[D - 1]) < Real(0.7));
  }
  for (int i = 0; i < play.count("spinner"); ++i) {
    turned = std::max(turned, turnOf(play.pose("spinner", i).q).norm());
    EXPECT_LT((play.pose("spinner", i).p - play.start("spinner", i)).norm(), 1e-9) << "a pinned one stays";
  }
  EXPECT_GE(caught, 48) << "some may lie on a peg";
  EXPECT_GT(turned, 0.3);
}
TEST(Presets, PinballEndsInItsHoppers) { pinball<2>(), pinball<3>(); }

TEST(Presets, AllDominoesFall) {
  Play<2> play("9");
  play.steps(30);
  EXPECT_EQ(play.fallen("domino"), 0) << "the circle is still on its slope";
  play.steps(500);
  EXPECT_EQ(play.fallen("domino"), 15);
}

// Sliding boxes have a = g (sin - mu cos) once contacts have settled: each half second they go a / 4 farther than in
// the one before. mu is the geometric mean with the slope's 0.5.
bool slides(const std::array<double, 4>& frictions) {
  Play<2> play("10");
  std::array<std::array<Vec<2>, 4>, 3> at;
  for (std::size_t k = 0; k < 3; ++k) {
    play.steps(30);
    for (int i = 0; i < 4; ++i) at[k][static_cast<std::size_t>(i)] = play.pose("rectangle", i).p;
  }
  bool right = true;
  for (std::size_t i = 0; i < 4; ++i) {
    const double farther = (at[2][i] - at[1][i]).norm() - (at[1][i] - at[0][i]).norm();
    const double mu = std::sqrt(0.5 * frictions[i]), s = std::sqrt(0.2), c = 2 * s;  // tan = 0.5
    right = right && std::abs(farther - std::max(0.0, 9.8 * (s - mu * c)) / 4) < 0.003;
    if (mu > 0.5) right = right && (at[2][i] - play.start("rectangle", static_cast<int>(i))).norm() < 1e-3;
  }
  return right;
}
TEST(Presets, FourRectanglesSlideByTheirFriction) {
  EXPECT_TRUE(slides({0.05, 0.2, 0.45, 0.8}));
  expectCaught("a friction of 0.43 for 0.45", slides({0.05, 0.2, 0.43, 0.8}));
  expectCaught("the last slides", slides({0.05, 0.2, 0.45, 0.45}));
}

template <int D>
void throwsItsBox() {
  Play<D> play("11");
  Real highest = play.start("thrown")[1];
  for (int i = 0; i < 600; ++i) play.steps(1), highest = std::max(highest, play.pose("thrown").p[1]);
  EXPECT_EQ(play.fallen("first"), play.count("first"));
  EXPECT_EQ(play.fallen("second"), play.count("second"));
  EXPECT_GT(turnOf(play.pose("lever").q).norm(), 0.3);
  EXPECT_GT(turnOf(play.pose("seesaw").q)[kAngDim<D> - 1], 0.2) << "its left end is down";
  EXPECT_GT(highest, play.start("thrown")[1] + 0.5);
}
TEST(Presets, TheChainOfDominoesThrowsItsBox) { throwsItsBox<2>(), throwsItsBox<3>(); }

// With the stages of 2009, where it sleeps, or with 20 iterations. Ten are not converged.
TEST(Presets, JengaStandsAlsoWithoutABlock) {
  const auto moved = [](auto& play, long steps = 300) {  // the topmost block, m
    play.steps(steps);
    const int last = play.count("block") - 1;
    return (play.pose("block", last).p - play.start("block", last)).norm();
  };
  const std::string flat = Settings::named("2009", 2).pipeline().text(),
                    solid = Settings::named("2009", 3).pipeline().text(), twenty = "velocity=catto{iterations=20}";
  Play<3> nine("jenga_tower", {{"courses", 9}}), whole("jenga_tower", {}, solid),
      pulled("jenga_tower", {{"pulled", 9}}, solid);
  Play<2> report("jenga_tower", {}, flat), awake("jenga_tower", {}, "solver=split_solver{" + twenty + "}"),
      falls("jenga_tower");
  EXPECT_LT(moved(nine), Real(0.05));
  EXPECT_LT(moved(whole, 200), Real(0.05));
  EXPECT_LT(moved(pulled, 200), Real(0.05));
  EXPECT_EQ(pulled.world.bodyCount(), whole.world.bodyCount() - 1);
  EXPECT_LT(moved(report), Real(0.05));
  EXPECT_LT(moved(awake), Real(0.05));
  EXPECT_GT(moved(falls, 59), Real(0.125));
}

// Figures 7.1, 7.2, 7.4 and 7.5, in the pipeline of their sweeps: towers of single circles, a heap after the firework,
// rest. Under `rounded_polygon`, the generator of 2009, rounding makes the towers fall earlier.
TEST(Presets, ScriptOneStandsCollapsesAndRests) {
  Play<2> play("director_1", {},
               "broadphase=region_tree contacts=sat_clip cache=by_feature "
               "solver=split_solver{velocity=catto{iterations=10},position=split_impulse} sleep=split_average");
  const auto points = [&] {
    int n = 0;
    for (const Manifold<2>& m : play.world.manifolds()) n += m.count;
    return n;
  };
  const auto awake = [&] {
    const Bodies<2>& bodies = play.world.bodies();
    int n = 0;
    for (int i = 0; i < bodies.size(); ++i) n += bodies.active(i);
    return n;
  };
  play.steps(5000);
  EXPECT_EQ(points(), 200);
  EXPECT_EQ(awake(), 0);
  play.steps(200);
  EXPECT_GT(awake(), 100);
  play.steps(4800);
  EXPECT_GT(points(), 400);
  EXPECT_EQ(awake(), 0);
}

// The report sets small velocities to zero (5.5.2); here sleep alone does.
TEST(Presets, TinyVelocitiesStayUntilABodySleeps) {
  const Real tiny = std::numeric_limits<Real>::min();
  Settings free = Settings::named("2009", 2);
  free.gravity = 0;
  World<2> world(free.pipeline(), free.world<2>());
  BodyDef<2> ball;
  ball.shapes.push_back({.shape = Shape<2>::sphere(1)});
  ball.velocity = Vec<2>(tiny, 0);
  const BodyHandle slow = world.add(ball);
  for (int i = 0; i < 60; ++i) world.step(free.dt);
  EXPECT_EQ(world.motion(slow).v[0], tiny);
  Play<2> box("preset_4", {}, Settings::named("2009", 2).pipeline().text());
  box.steps(600);
  const BodyHandle lies = box.director.body(static_cast<int>(box.scene.spawns.size()) - 1);
  EXPECT_FALSE(box.world.awake(lies));
  EXPECT_EQ(box.world.motion(lies).v, Vec<2>(0, 0));
}

TEST(Presets, NothingFallsThroughAFloorOfSpheres) {
  Play<3> play("floor_of_spheres", {{"side", 12}, {"n", 16}});
  play.steps(240);
  const auto& bodies = play.world.bodies();
  for (int i = 0; i < bodies.size(); ++i) {
    const auto slot = static_cast<std::size_t>(i);
    if (bodies.type[slot] != BodyType::dynamic) continue;
    EXPECT_GT(bodies.pose[slot].p[1], 0) << i;
  }
}

// Each row of the fan knocks over the next, so that all fall.
TEST(Presets, TheFanFallsAsAWhole) {
  Play<3> play("many_dominoes_3d", {{"rows", 6}, {"particles", 10}});
  play.steps(400);
  EXPECT_EQ(play.count("domino"), 21);
  EXPECT_EQ(play.fallen("domino"), 21);
  EXPECT_EQ(play.count("particle"), 10);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::presets_test
