// SPDX-License-Identifier: Zlib
// Scenes contain what their names say.
#include <gtest/gtest.h>

#include "experiments/runner/locations.h"
#include "experiments/trial/scene/scene_file.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace scenes_test { namespace {

using Census = std::map<std::string, int>;

SceneFile load(const std::string& name) { return SceneFile::load(findToml("scenes", name)); }

template <int D>
SceneSpec<D> build(const std::string& name, const ParameterValues& values = {}) {
  const SceneFile file = load(name);
  return file.build<D>(values, file.defaultSeed());
}

// Contents of each scene with default parameters: equal in both dimensions except for the walls of the directors'
// rooms.
const std::map<std::string, Census> kExpected = {
    {"bouncing_ball", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 1}, {"dynamic sphere", 1}}},
    {"box_drop", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 1}, {"dynamic box", 1}}},
    {"box_pile", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 200}, {"dynamic box", 200}}},
    {"bridge", {{"dynamic", 11}, {"dynamic box", 11}, {"pivot", 12}}},
    {"circle_rain", {{"fixed", 3}, {"fixed box", 3}, {"dynamic", 200}, {"dynamic sphere", 200}}},
    {"circle_towers", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 100}, {"dynamic sphere", 100}}},
    {"square_towers", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 100}, {"dynamic box", 100}}},
    {"washboard",
     {{"fixed", 2},
      {"fixed box", 1},
      {"fixed chain", 1},
      {"dynamic", 18},
      {"dynamic box", 6},
      {"dynamic sphere", 6},
      {"dynamic capsule", 6}}},
    {"compounds", {{"fixed", 2}, {"fixed box", 3}, {"dynamic", 12}, {"dynamic compound", 12}}},
    {"gears", {{"kinematic", 1}, {"kinematic compound", 1}, {"dynamic", 1}, {"dynamic compound", 1}, {"pinned", 1}}},
    {"cylinders", {{"fixed", 1}, {"fixed plane", 1}, {"dynamic", 6}, {"dynamic cylinder", 6}}},
    {"director_1", {{"fixed", 4}, {"fixed box", 4}, {"dynamic", 236}, {"dynamic sphere", 236}, {"scripted", 190 + 36}}},
    {"director_2", {{"fixed", 4}, {"fixed box", 4}, {"dynamic", 1500}, {"dynamic sphere", 1500}, {"scripted", 1499}}},
    {"high_mass_ratio_1", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 165}, {"dynamic box", 165}}},
    {"bullet_ragdolls",
     {{"fixed", 1},
      {"fixed box", 1},
      {"dynamic", 136 * 11},
      {"dynamic capsule", 136 * 11},
      {"hinge", 136 * 5},
      {"cone_twist", 136 * 5}}},
    {"bullet_stacks", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 1076}, {"dynamic box", 1076}}},
    {"card_house_peel", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 40}, {"dynamic box", 40}}},
    {"ccd_walls", {{"fixed", 5}, {"fixed plane", 1}, {"fixed box", 4}, {"dynamic", 10}, {"dynamic box", 10}}},
    {"keva", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 5320}, {"dynamic box", 5320}}},
    {"large_pyramid", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 5050}, {"dynamic box", 5050}}},
    {"large_pyramid_3d", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 5050}, {"dynamic box", 5050}}},
    {"large_world",
     {{"fixed", 10000}, {"fixed box", 10000}, {"dynamic", 100}, {"dynamic sphere", 100}, {"scripted", 100}}},
    {"mass_ratio", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 2}, {"dynamic box", 2}}},
    {"overlap_recovery", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 10}, {"dynamic box", 10}}},
    {"pendulum", {{"fixed", 1}, {"fixed sphere", 1}, {"dynamic", 1}, {"dynamic sphere", 1}, {"pivot", 1}}},
    {"pyramid", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 210}, {"dynamic box", 210}}},
    {"pyramid_15", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 120}, {"dynamic box", 120}}},
    {"pyramid_25", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 325}, {"dynamic box", 325}}},
    {"slope", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 1}, {"dynamic box", 1}}},
    {"stress_joint_ball",
     {{"fixed", 26}, {"fixed sphere", 26}, {"dynamic", 9974}, {"dynamic sphere", 9974}, {"pivot", 19800}}},
    {"towers", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 20}, {"dynamic sphere", 10}, {"dynamic box", 10}}},
    {"vertical_stack", {{"fixed", 1}, {"fixed box", 1}, {"dynamic", 15}, {"dynamic box", 15}}},
};

TEST(Scenes, buildWhatTheirNamesSay) {
  for (const auto& [name, expected] : kExpected) {
    SCOPED_TRACE(name);
    const SceneFile file = load(name);
    if (file.has(2)) {
      EXPECT_EQ(census(file.build<2>({}, file.defaultSeed())), expected);
    }
    if (file.has(3)) {
      Census solid = expected;
      if (name.starts_with("director")) solid["fixed"] = solid["fixed box"] = 6;  // a room has six walls in 3D
      if (solid.erase("fixed chain")) solid["fixed mesh"] = 1;
      EXPECT_EQ(census(file.build<3>({}, file.defaultSeed())), solid);
    }
  }
}

TEST(Scenes, parametersScaleThem) {
  EXPECT_EQ(census(build<2>("vertical_stack", {{"n", 7}}))["dynamic box"], 7);
  EXPECT_EQ(census(build<3>("pyramid", {{"base", 4}}))["dynamic box"], 10);
  EXPECT_EQ(census(build<2>("towers", {{"circles", 0}, {"squares", 3}}))["dynamic"], 3);
  EXPECT_EQ(census(build<2>("box_pile", {{"n", 10000}}))["dynamic box"], 10000);
  EXPECT_EQ(census(build<2>("director_1", {{"rain_until", 1000}}))["dynamic"], 40 + 36);
}

// A pile of balls stays between walls; without them the balls roll forever.
TEST(Scenes, mixedPileComesToRestInItsBin) {
  test::Workspace w;
  const std::string path = findToml("scenes", "mixed_pile");
  std::string open = readFile(path);
  const std::size_t walls = open.find("# The bin");
  ASSERT_NE(walls, open.npos);
  open.erase(walls, open.find("# Body i", walls) - walls);
  open.replace(open.find("\"mixed_pile\""), 12, "\"open_pile\"");
  w.write("open_pile.toml", open);
  w.write("s.toml",
          "summary = \"s\"\nkind = \"world\"\n[axes]\nscene = [\"mixed_pile\", \"open_pile\"]\ndimension = [2, 3]\n"
          "n = 100\nseed = [1, 2, 3]\n");
  ASSERT_EQ(w.lpc("sweep ./s.toml --quiet --store s.db").code, 0);
  const auto fastest = [&](const std::string& scene, int dimension) {
    return std::stod(test::ask(w.path("s.db"),
                               "SELECT max(json_extract(metrics, '$.max_speed_end')) FROM trial WHERE "
                               "json_extract(canonical, '$.scene') = '" +
                                   scene +
                                   "' AND json_extract(canonical, '$.dimension') = " + std::to_string(dimension)));
  };
  for (const int dimension : {2, 3}) {
    EXPECT_LT(fastest("mixed_pile", dimension), 0.5) << dimension << "D, m/s";
    EXPECT_GT(fastest("open_pile", dimension), 0.5) << dimension << "D: the pile without walls was not seen";
  }
}

// solver2d's numbers: half 0.5, y = 0.55 + 1.1 i, x alternates by a centimetre, friction 0.3.
TEST(Scenes, verticalStackIsSolver2ds) {
  const SceneSpec<2> scene = build<2>("vertical_stack");
  for (std::size_t i = 0; i < 15; ++i) {
    const auto& body = scene.spawns[1 + i].body;
    EXPECT_NEAR(body.X_WB.p[0], i % 2 ? -0.01 : 0.01, 1e-12);
    EXPECT_NEAR(body.X_WB.p[1], 0.55 + 1.1 * static_cast<double>(i), 1e-12);
    EXPECT_NEAR(body.shapes.at(0).friction, 0.3, 1e-12);
  }
  EXPECT_EQ(scene.settings.gravity, Vec<2>(0, -10));
  EXPECT_FALSE(scene.settings.model.joints);
  EXPECT_TRUE(scene.settings.model.friction);
}

// Box2D's numbers: row i from 0, y = (2i + 1) / 2, x = (i + 1) / 2 + (j - i) - base / 2 for j from i.
TEST(Scenes, largePyramidIsBox2Ds) {
  const SceneSpec<2> scene = build<2>("large_pyramid");
  std::size_t at = 1;
  for (int i = 0; i < 100; ++i) {
    for (int j = i; j < 100; ++j, ++at) {
      ASSERT_NEAR(scene.spawns[at].body.X_WB.p[0], 0.5 * (i + 1) + (j - i) - 50, 1e-9);
      ASSERT_NEAR(scene.spawns[at].body.X_WB.p[1], 0.5 * (2 * i + 1), 1e-9);
    }
  }
}

// Its 17 stones fill the arch side by side, between the two curves of its points, at 0.25 times the source's size.
TEST(Scenes, archIsSolver2ds) {
  const SceneSpec<2> scene = build<2>("arch_solver2d");
  std::vector<std::vector<Vec<2>>> stones;
  for (const auto& spawn : scene.spawns) {
    if (spawn.body.name != "stone") continue;
    stones.emplace_back();
    for (const Vec<2>& p : spawn.body.shapes.at(0).shape.view().hull->vertices) {
      stones.back().push_back(spawn.body.X_WB * p);
    }
    EXPECT_EQ(stones.back().size(), 4u);
  }
  ASSERT_EQ(stones.size(), 17u);
  const auto shared = [&](std::size_t i, std::size_t j) {
    int count = 0;
    for (const Vec<2>& p : stones[i]) {
      for (const Vec<2>& q : stones[j]) count += (p - q).norm() < 1e-12;
    }
    return count;
  };
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(shared(i, i + 1), 2) << "right, " << i;
  for (std::size_t i = 8; i < 15; ++i) EXPECT_EQ(shared(i, i + 1), 2) << "left, " << i;
  EXPECT_EQ(shared(7, 16), 2) << "the keystone";
  EXPECT_EQ(shared(15, 16), 2) << "the keystone";
  Real left = 0, right = 0, top = 0;
  for (const auto& stone : stones) {
    for (const Vec<2>& p : stone) left = std::min(left, p[0]), right = std::max(right, p[0]), top = std::max(top, p[1]);
  }
  EXPECT_NEAR(left, -24 / 4, 1e-12);
  EXPECT_NEAR(right, 24 / 4, 1e-12);
  EXPECT_NEAR(top, 44.28891593799322 / 4, 1e-12);
  EXPECT_NEAR(scene.spawns.back().body.X_WB.p[1], top + 3.5, 1e-12) << "the highest of four boxes";
}

TEST(Scenes, highMassRatioHasHeavyTops) {
  std::vector<Real> densities;
  Real highest = 0;
  for (const auto& spawn : build<2>("high_mass_ratio_1").spawns) {
    if (spawn.body.shapes.at(0).density != 1) densities.push_back(spawn.body.shapes.at(0).density);
    highest = std::max(highest, spawn.body.X_WB.p[1]);
  }
  EXPECT_EQ(densities, (std::vector<Real>{100, 200, 300}));
  EXPECT_NEAR(highest, 1 + 2 * 9 + 2, 1e-12);
}

// Chapter 7.4.1: ten vertical lines, rain that stops at 5000, 36 small circles in all directions between the two
// central towers, the end at 10000.
TEST(Scenes, directorOneFollowsTheReport) {
  const SceneSpec<2> scene = build<2>("director_1");
  EXPECT_EQ(scene.steps, 10000);
  std::map<Real, int> lines;
  int firework = 0;
  Vec<2> sum = Vec<2>::Zero();
  for (const auto& spawn : scene.spawns) {
    if (spawn.body.name == "rain") {
      EXPECT_LT(spawn.step, 5000);
      ++lines[spawn.body.X_WB.p[0]];
    } else if (spawn.body.name == "firework") {
      EXPECT_EQ(spawn.step, 5000);
      EXPECT_LT(std::abs(spawn.body.X_WB.p[0]), 1.0);
      sum += spawn.body.velocity;
      ++firework;
    }
  }
  EXPECT_EQ(lines.size(), 10u);
  for (const auto& [x, count] : lines) EXPECT_EQ(count, 20) << x;
  EXPECT_EQ(firework, 36);
  EXPECT_LT(sum.norm(), 1e-9);
  long last = 0;
  for (const auto& spawn : scene.spawns) EXPECT_LE(last, spawn.step), last = spawn.step;
}

TEST(Scenes, directorTwoDrawsTheSameInBothDimensions) {
  const SceneSpec<2> flat = build<2>("director_2", {{"until", 200}});
  const SceneSpec<3> solid = build<3>("director_2", {{"until", 200}});
  ASSERT_EQ(flat.spawns.size() + 2, solid.spawns.size());
  for (std::size_t i = 4; i < flat.spawns.size(); ++i) {
    EXPECT_EQ(flat.spawns[i].body.X_WB.p[0], solid.spawns[i + 2].body.X_WB.p[0]);
    EXPECT_EQ(flat.spawns[i].body.X_WB.p[1], solid.spawns[i + 2].body.X_WB.p[1]);
    EXPECT_EQ(flat.spawns[i].step, 20 * static_cast<long>(i - 4));
  }
  EXPECT_EQ(flat.settings.gravity.norm(), 0);
  EXPECT_EQ(flat.spawns.back().body.shapes.at(0).restitution, 1);
  const SceneFile file = load("director_2");
  const auto other = file.build<2>({{"until", 200}}, 2);
  EXPECT_NE(other.spawns.back().body.X_WB.p[0], flat.spawns.back().body.X_WB.p[0]) << "the seed means nothing";
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::scenes_test
