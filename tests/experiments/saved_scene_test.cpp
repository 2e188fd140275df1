// SPDX-License-Identifier: Zlib
// Worlds that a run saves, and runs that start from them.
#include <nlohmann/json.hpp>

#include "experiments/parse/toml_reader.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace saved_scene_test { namespace {

using nlohmann::json;
using test::Outcome;
using test::Workspace;

std::string hashOf(const Workspace& w, const std::string& arguments) {
  const Outcome out = w.lpc("run --json " + arguments);
  const std::size_t begin = out.text.find('{');
  return begin == std::string::npos ? out.text : json::parse(out.text.substr(begin)).value("hash", out.text);
}

// Whether an uninterrupted run and a saved, continued one end equal, bit for bit.
bool goesOn(const Workspace& w, const std::string& scene, const std::string& with, const std::string& pipeline) {
  const std::string options = " --pipeline '" + pipeline + "' " + with;
  const std::string whole = hashOf(w, scene + options + " --steps 80 --save 30:later.toml");
  return hashOf(w, "./later.toml" + options) == whole;
}

TEST(SavedScene, GoesOnBitForBit) {
  const Workspace w;
  for (const std::string pipeline : {"", "2009", "solver=avbd", "contacts=query_clip cache=recycling"}) {
    EXPECT_TRUE(goesOn(w, "3", "", pipeline)) << pipeline;
  }
  EXPECT_TRUE(goesOn(w, "pyramid --param base=4", "--dimension 3", "solver=soft_step sleep=timer_island"));
  EXPECT_TRUE(goesOn(w, "chain", "", ""));  // joints
  if (test::kSingle) {
    EXPECT_TRUE(goesOn(w, "pyramid --param base=4", "--precision f32", ""));
  }
  const std::string whole = hashOf(w, "pyramid --param base=4 --steps 80 --save 30:other.toml");
  w.shell("sed -i 's/^dt = .*/dt = 0.0166/' other.toml");
  test::expectCaught("a saved scene with another time step", hashOf(w, "./other.toml") == whole);
}

TEST(SavedScene, IsASceneOfASweep) {
  const Workspace w;
  ASSERT_EQ(w.lpc("run pyramid --param base=3 --steps 60 --save 20:a.toml --save 60:b.toml").code, 0);
  w.write("plain.toml",
          "summary = \"s\"\nkind = \"world\"\n[axes]\nscene = [\"a\", \"b\"]\nsolver = [\"split_solver\", "
          "\"soft_step\"]\n");
  const Outcome out = w.lpc("sweep ./plain.toml --store s.db");
  EXPECT_EQ(out.code, 0) << out.text;
  EXPECT_EQ(test::ask(w.path("s.db"), "SELECT count(*) FROM trial WHERE outcome = 'ok'"), "4");
}

TEST(SavedScene, MistakesAreOneLine) {
  const Workspace w;
  ASSERT_EQ(w.lpc("run pyramid --param base=3 --steps 40 --save 20:a.toml").code, 0);
  const auto refused = [&](const std::string& arguments, const std::string& said) {
    const Outcome out = w.lpc("run " + arguments);
    EXPECT_EQ(out.code, 2) << arguments << out.text;
    EXPECT_NE(out.text.find(said), std::string::npos) << arguments << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
  };
  refused("pyramid --save 20", "valid: a step and a file name");
  refused("pyramid --save x:b.toml", "valid: a step and a file name");
  refused("pyramid --save 20:b.world", "valid: NAME.toml");
  refused("pyramid --steps 10 --save 20:b.toml", "asked: step 20");
  refused("./a.toml --save 1:a.toml", "a.toml");  // it would be overwritten
  refused("./a.toml --param perturb=0.01", "perturb = 0");
  refused("./a.toml --dimension 3", "3D");
  const std::string scene = readFile(w.path("a.toml")), world = readFile(w.path("a.world"));
  const auto with = [&](const std::string& line, const std::string& said) {
    w.write("b.toml", line + scene);
    refused("./b.toml", said);
  };
  with("gravity = [0, -1]\n", "'gravity' is given with 'saved'");
  with("settings = \"2009\"\n", "'settings' is given with 'saved'");
  w.write("b.toml", scene.substr(0, scene.find("dt = ")) + "\n");
  refused("./b.toml", "'saved' needs 'dt'");
  w.write("a.world", world.substr(0, world.size() / 2));
  refused("./a.toml", "a.toml:");
  w.write("a.world", std::string("LPCWORLD3", 10) + world.substr(10));
  refused("./a.toml", "LPCWORLD3");
  w.write("a.world", "no world");
  refused("./a.toml", "a.toml:");
  std::filesystem::remove(w.path("a.world"));
  refused("./a.toml", "a.world");
  EXPECT_FALSE(std::filesystem::exists(w.path("b.world")));
}

// The message names the missing force and does not call the file damaged.
TEST(SavedScene, OfAPluginNeedsThePlugin) {
  const Workspace w;
  w.write("pushed.toml",
          "name = \"pushed\"\nsummary = \"s\"\ndimensions = [2]\nneeds = []\nsteps = 9\n"
          "[[body]]\nname = \"a\"\nshapes = [{ kind = \"circle\", radius = 1 }]\n"
          "[[force]]\nkind = \"planted_push\"\nb = \"a\"\n");
  const std::string with = "--plugin " LPC_BINARY_DIR "/lib/liblpc_planted.so ";
  ASSERT_EQ(w.lpc(with + "run ./pushed.toml --save 5:a.toml").code, 0);
  EXPECT_EQ(w.lpc(with + "run ./a.toml").code, 0);
  const Outcome without = w.lpc("run ./a.toml");
  EXPECT_EQ(without.code, 2) << without.text;
  EXPECT_NE(without.text.find("the force 'planted_push', which is not registered in 2D"), std::string::npos)
      << without.text;
  EXPECT_EQ(std::count(without.text.begin(), without.text.end(), '\n'), 1) << without.text;
}

TEST(SavedScene, OfTheOtherPrecisionIsUnsupported) {
  if (!test::kSingle) GTEST_SKIP() << "this build has no f32";
  const Workspace w;
  ASSERT_EQ(w.lpc("run pyramid --param base=3 --steps 40 --precision f32 --save 20:a.toml").code, 0);
  const Outcome out = w.lpc("run ./a.toml");
  EXPECT_NE(out.code, 0);
  EXPECT_NE(out.text.find("32-bit numbers"), std::string::npos) << out.text;
}

TEST(SavedScene, AStepThatIsNotReachedIsNotWritten) {
  const Workspace w;
  w.write("fall.toml",
          "name = \"fall\"\nsummary = \"f\"\ndimensions = [2]\nneeds = []\nsteps = 100\n[limits]\ndrift = 0.1\n"
          "[[body]]\nshapes = [{ kind = \"circle\", radius = 1 }]\n");
  const Outcome out = w.lpc("run ./fall.toml --save 5:a.toml --save 90:b.toml");
  EXPECT_EQ(out.code, 1);
  EXPECT_TRUE(std::filesystem::exists(w.path("a.toml")) && std::filesystem::exists(w.path("a.world")));
  EXPECT_FALSE(std::filesystem::exists(w.path("b.toml")) || std::filesystem::exists(w.path("b.world")));
  EXPECT_NE(out.text.find("not saved step 90"), std::string::npos) << out.text;
  w.write("named.toml",
          "name = \"a \\\"b\\\"\"\nsummary = \"f\"\ndimensions = [3]\nneeds = []\nsteps = 9\n"
          "[[body]]\nshapes = [{ kind = \"ellipsoid\", half_x = 1, half_y = 1, half_z = 2 }]\n");
  EXPECT_EQ(w.lpc("run ./named.toml --pipeline contacts=query_clip --save 5:c.toml").code, 0);
  EXPECT_EQ(w.lpc("run ./c.toml --pipeline contacts=query_clip").code, 0);
  w.write("flat.toml",
          "name = \"flat\"\nsummary = \"f\"\ndimensions = [2]\nneeds = []\nsteps = 9\n"
          "[[body]]\nshapes = [{ kind = \"ellipsoid\", half_x = 1, half_y = 2 }]\n");
  const Outcome none = w.lpc("run ./flat.toml --pipeline contacts=rounded_polygon --save 0:d.toml");
  EXPECT_NE(none.text.find("not saved step 0"), std::string::npos) << none.text;
  EXPECT_FALSE(std::filesystem::exists(w.path("d.toml")));
}

TEST(SavedScene, NoSleepingSwitchesSleepOff) {
  const Workspace w;
  EXPECT_NE(hashOf(w, "pyramid --param base=3 --pipeline 2009"), hashOf(w, "pyramid --param base=3"));
  const Outcome asleep = w.lpc("run 2 --pipeline 2009 --steps 240"),
                awake = w.lpc("run 2 --pipeline 2009 --steps 240 --no-sleeping");
  EXPECT_NE(asleep.text.find("sleep=split_average"), std::string::npos) << asleep.text;
  EXPECT_NE(awake.text.find("sleep=none"), std::string::npos) << awake.text;
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::saved_scene_test
