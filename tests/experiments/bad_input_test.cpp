// SPDX-License-Identifier: Zlib
// User mistakes and damaged files: a one-line message says where, what was found and what is valid; exit code 2; no
// half-written file. scene_file_test, sweep_test and command_line_test cover unknown names and keys.
#include "experiments/parse/toml_reader.h"
#include "experiments/runner/sweep_file.h"
#include "framework/math/check.h"
#include "tests/experiments/refused.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bad_input_test { namespace {

using test::ask;
using test::Outcome;
using test::Workspace;

using test::expectParts;
using test::filesIn;
using test::Parts;
using test::refused;

struct Case {
  std::string text;
  Parts parts;
};

const std::string kHead = "name = \"t\"\nsummary = \"s\"\ndimensions = [2, 3]\n";  // lines 1 to 3
const std::string kBall = "shapes = [{ kind = \"circle\", radius = 1 }]\n";

template <int D>
std::string sceneMessage(const std::string& text) {
  try {
    SceneFile::parse(text, "t.toml").build<D>({}, 1);
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}

std::string shape(const std::string& fields) { return "[[body]]\nshapes = [\n{ " + fields + " }]\n"; }

std::string joint(const std::string& parameter) {
  return "needs = [\"joints\"]\n[[body]]\nname = \"a\"\n" + kBall +
         "[[joint]]\na = \"world\"\nb = \"a\"\nanchor = [0, 0]\nanchor_b = [1, 0]\nkind = \"distance\"\nparameters = { "
         "mode = "
         "\"spring\", " +
         parameter + " }\n";
}

std::string spring(const std::string& parameter) {
  return "[[body]]\nname = \"a\"\n" + kBall +
         "[[force]]\na = \"world\"\nb = \"a\"\nkind = \"spring\"\nparameters = { " + parameter + " }\n";
}

TEST(BadInput, NumbersOfScenesHaveAPlaceAndARange) {
  const std::vector<Case> cases = {
      {"dt = 0\n", {"t.toml:4: ", "'dt' is 0 s", "above 0"}},
      {"dt = -1\n", {"t.toml:4: ", "'dt' is -1", "0 to 10"}},
      {"dt = 1e30\n", {"t.toml:4: ", "'dt' is 1e+30", "0 to 10"}},
      {"dt = nan\n", {"t.toml:4: ", "nan", "finite"}},
      {"dt = \"1 / 0\"\n", {"t.toml:4: ", "'1 / 0'", "finite"}},
      {"steps = -1\n", {"t.toml:4: ", "'steps' is -1"}},
      {"steps = 2.5\n", {"t.toml:4: ", "'steps' is 2.5", "whole"}},
      {"seed = -1\n", {"t.toml:4: ", "'seed' is -1", "0 or more"}},
      {"gravity = [0, nan]\n", {"t.toml:4: ", "nan", "finite"}},
      {"gravity = [0, -inf]\n", {"t.toml:4: ", "-inf", "finite"}},
      {"margin = -0.1\n", {"t.toml:4: ", "'margin' is -0.1", "0 or more"}},
      {"restitution_threshold = -1\n", {"t.toml:4: ", "'restitution_threshold' is -1"}},
      {"[mixing]\nfriction = \"sum\"\n", {"t.toml:5: ", "'friction' is 'sum'", "geometric_mean"}},
      {"[mixing]\nbounce = \"minimum\"\n", {"t.toml:5: ", "bounce"}},
      {"[limits]\nspeed = -1\n", {"t.toml:5: ", "'speed' is -1"}},
      {"[parameters]\nn = { default = nan, min = 0, max = 5, meaning = \"m\" }\n", {"t.toml:5: ", "nan", "finite"}},
      {"[defaults]\ndensity = -2\n[[body]]\n" + kBall, {"t.toml:5: ", "'density' is -2", "0 or more"}},
      {shape("kind = \"circle\", radius = 1, density = -1"), {"t.toml:6: ", "'density' is -1", "0 or more"}},
      {shape("kind = \"circle\", radius = 1, density = nan"), {"t.toml:6: ", "nan", "finite"}},
      {shape("kind = \"circle\", radius = 1, density = 0"), {"t.toml:4: ", "mass of 0 kg", "above 0"}},
      {shape("kind = \"circle\", radius = 1, density = 1e-310"), {"t.toml:4: ", "too small to invert", "larger"}},
      {shape("kind = \"circle\", radius = 0"), {"t.toml:4: ", "mass of 0 kg", "above 0"}},
      {shape("kind = \"circle\", radius = 1, friction = -0.5"), {"t.toml:6: ", "'friction' is -0.5"}},
      {shape("kind = \"circle\", radius = 1, restitution = -1"), {"t.toml:6: ", "'restitution' is -1"}},
      {shape("kind = \"circle\", radius = 1, category = -1"), {"t.toml:6: ", "'category' is -1", "0 to 4294967295"}},
      {shape("kind = \"circle\", radius = 1, mask = 0.5"), {"t.toml:6: ", "'mask' is 0.5", "whole"}},
      {shape("kind = \"circle\", radius = nan"), {"t.toml:6: ", "nan", "finite"}},
      {shape("kind = \"box\", half = [1, 0, 1]"), {"t.toml:6: ", "box", "half extent", "above zero"}},
      {shape("kind = \"box\", half = [1, -1, 1]"), {"t.toml:6: ", "box", "half extent", "above zero"}},
      {shape("kind = \"box\", half = [nan, 1, 1]"), {"t.toml:6: ", "nan", "finite"}},
      {shape("kind = \"box\", half = [1]"), {"t.toml:6: ", "a list", "two or three"}},
      {shape("kind = \"capsule\", half_length = 1, radius = -1"), {"t.toml:6: ", "capsule", "radius"}},
      {shape("kind = \"polytope\", points = [[0, 0], [1, 0], [0, 1]], depth = -1"), {"t.toml:6: ", "'depth' is -1"}},
      {"[[body]]\nposition = [nan, 0]\n" + kBall, {"t.toml:5: ", "nan", "finite"}},
      {"[[body]]\nangle = nan\n" + kBall, {"t.toml:5: ", "nan", "finite"}},
      {"[[body]]\nvelocity = [0, inf]\n" + kBall, {"t.toml:5: ", "inf", "finite"}},
      {"[[body]]\nfrom = -3\n" + kBall, {"t.toml:5: ", "'from' is -3"}},
      {"[[body]]\nremove = 1e30\n" + kBall, {"t.toml:5: ", "'remove' is 1e+30"}},
      {"[[body]]\nevery = 1\nuntil = 1e9\nwhen = 0\n" + kBall, {"t.toml:4: ", "more than 1000000"}},
      {"[[body]]\nrepeat = 1e9\n" + kBall, {"t.toml:5: ", "a loop runs 1e+09 times"}},
      {"[[body]]\nname = \"a\"\n" + kBall + "[measures.slope]\nbody = \"b\"\nangle = 0\nfriction = 0\n",
       {"t.toml:8: ", "unknown body 'b'", "valid: a"}},
      {"[[body]]\nname = \"a\"\ntype = \"fixed\"\n" + kBall +
           "[measures.slope]\nbody = \"a\"\nangle = 0\nfriction = 0\n",
       {"t.toml:", "'body' does not move", "dynamic"}},
      {"[[body]]\nname = \"a\"\n" + kBall + "[measures.slope]\nbody = \"a\"\nangle = 2\nfriction = 0\n",
       {"t.toml:9: ", "'angle' is 2", "0 to 1.57"}},
      {"[[body]]\nname = \"a\"\n" + kBall + "[measures.slpoe]\nbody = \"a\"\n", {"t.toml:", "slpoe", "slope"}},
      {spring("stiffness = nan"), {"t.toml:", "nan", "finite"}},
      {spring("damping = -1"), {"t.toml:7: ", "'damping' of 'spring' is '-1'", "from 0"}},
      {spring("stiffnes = 1"), {"t.toml:7: ", "'stiffnes'", "stiffness"}},
      {joint("stiffness = inf"), {"t.toml:", "inf", "finite"}},
      {joint("stiffness = -1"), {"t.toml:8: ", "'stiffness' of 'distance' is '-1'", "from 0 to 1e+12"}},
      {joint("stiffness = 1e300"), {"t.toml:8: ", "'1e+300'", "from 0 to 1e+12"}},
  };
  for (const Case& c : cases) {
    for (const std::string& message : {sceneMessage<2>(kHead + c.text), sceneMessage<3>(kHead + c.text)}) {
      expectParts(message, c.parts, c.text);
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }
  for (const char* angle : {"0.3", "pi / 4", "1.2"}) {  // a needle oblique to the axes
    const std::string needle = shape("kind = \"box\", half = [1, 1e-12, 1e-12], density = 1e24, angle = [0, 0, \"" +
                                     std::string(angle) + "\"]");
    expectParts(sceneMessage<3>(kHead + needle), {"t.toml:4: ", "inertia is too small to invert", "valid: larger"},
                needle);
  }
  expectParts(sceneMessage<2>("name = \"t\"\nsummary = \"s\"\ndimensions = []\n"), {"t.toml:3: ", "[2, 3]"}, "none");
}

TEST(BadInput, PolygonsAndHullsNeedAVolume) {
  const std::vector<Case> flat = {{"[[0, 0], [1, 0]]", {"t.toml:6: ", "2 points", "at least 3"}},
                                  {"[]", {"t.toml:6: ", "0 points", "at least 3"}},
                                  {"[[0, 0], [1, 1], [2, 2], [3, 3]]", {"t.toml:6: ", "line"}},
                                  {"[[1, 1], [1, 1], [1, 1]]", {"t.toml:6: ", "points"}},
                                  {"[[0, 0], [1, 0], [nan, 1]]", {"t.toml:6: ", "nan", "finite"}}};
  const std::vector<Case> solid = {{"[[0, 0, 0], [1, 0, 0], [0, 1, 0]]", {"t.toml:6: ", "3 points", "at least 4"}},
                                   {"[[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]", {"t.toml:6: ", "plane"}},
                                   {"[[0, 0, 0], [1, 1, 1], [2, 2, 2], [3, 3, 3]]", {"t.toml:6: ", "line"}},
                                   {"[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, inf]]", {"t.toml:6: ", "inf", "finite"}}};
  const auto text = [](const Case& c) { return kHead + shape("kind = \"polytope\", points = " + c.text); };
  for (const Case& c : flat) expectParts(sceneMessage<2>(text(c)), c.parts, c.text);
  for (const Case& c : solid) expectParts(sceneMessage<3>(text(c)), c.parts, c.text);
}

TEST(BadInput, TheCommandRunRefuses) {
  Workspace w;
  w.write("broken.toml", "name = \"t\"\nsummary = [");
  w.write("heavy.toml", kHead + shape("kind = \"circle\", radius = 1, density = nan"));
  w.write("good.toml", kHead + "steps = 5\n[[body]]\n" + kBall);
  w.write("file", "a regular file");
  std::filesystem::create_directory(w.path("folder"));
  refused(w, "run broken.toml", {"broken.toml:2: "});
  refused(w, "run heavy.toml --record r.rec --profile p.csv", {"heavy.toml:6: ", "nan", "finite"});
  refused(w, "run absent.toml", {"'absent.toml'", "valid", "pyramid"});
  refused(w, "run folder", {"'folder'", "valid", "pyramid"});
  refused(w, "run good.toml --dt nan", {"--dt", "'nan'", "finite"});
  refused(w, "run good.toml --dt 0", {"dt is 0 s", "above 0"});
  refused(w, "run good.toml --steps -5", {"-5", "0 or more"});
  refused(w, "run good.toml --seed -5", {"--seed", "-5", "0 to"});
  refused(w, "run good.toml --dimension 0", {"dimension is 0", "2, 3"});
  refused(w, "run good.toml --pipeline solver=split_solver{", {"character 21", "missing"});
  refused(w, "run good.toml --pipeline solver=soft_step{substeps=nan}", {"'substeps'", "'nan'", "whole number"});
  refused(w, "run good.toml --pipeline broadphase=uniform_grid{cell=-1}", {"'cell'", "'-1'", "a number from"});
  refused(w, "run good.toml --record file/r.rec", {"file/r.rec", "cannot be written", "Not a directory"});
  refused(w, "run good.toml --profile absent/p.csv", {"absent/p.csv", "cannot be written", "No such file"});
  refused(w, "run good.toml --record folder", {"folder: ", "cannot be written", "Is a directory"});
  refused(w, "run good.toml --record /dev/full --profile p.csv", {"/dev/full", "No space left on device"});
  refused(w, "run good.toml --record r.rec --profile /dev/full", {"/dev/full", "No space left on device"});
  const Outcome deaf = w.shell("{ " LPC_BINARY_DIR "/bin/lpc run good.toml --json 2>&1 >&3; } 3> /dev/full");
  EXPECT_EQ(deaf.code, 2);
  EXPECT_EQ(deaf.text, "lpc: standard output cannot be written: No space left on device\n");
}

// An earlier file stays complete until the new one is complete.
TEST(BadInput, AFailedRunKeepsTheEarlierFile) {
  Workspace w;
  w.write("good.toml", kHead + "steps = 5\n[[body]]\n" + kBall);
  w.write("p.csv", "earlier");
  refused(w, "run good.toml --profile p.csv --record /dev/full", {"/dev/full"});
  EXPECT_EQ(readFile(w.path("p.csv")), "earlier");
  ASSERT_EQ(w.lpc("run good.toml --profile p.csv").code, 0);
  EXPECT_EQ(readFile(w.path("p.csv")).substr(0, 6), "# step");
}

// Huge forces end the run at their step, with every integrator, also if the scene sets no limit.
TEST(BadInput, AbsurdForcesEndTheRunAtTheirStep) {
  Workspace w;
  const auto spring = [&](const std::string& stiffness) {
    return kHead + "steps = 50\n[[body]]\nname = \"a\"\nposition = [10, 0]\n" + kBall +
           "[[body]]\nposition = [0, 9]\nfrom = 2\nname = \"late\"\n" + kBall +
           "[[force]]\nkind = \"spring\"\na = \"a\"\nb = \"late\"\nparameters = { stiffness = " + stiffness + " }\n";
  };
  w.write("large.toml", spring("1e30"));
  w.write("infinite.toml", spring("1e308"));
  for (const char* pipeline : {"\"\"", "solver=soft_step", "solver=split_solver{integrator=rk4}",
                               "solver=split_solver{integrator=explicit_euler}"}) {
    for (const char* scene : {"large.toml", "infinite.toml"}) {
      for (const char* dimension : {"2", "3"}) {
        const std::string arguments =
            std::string("run ") + scene + " --dimension " + dimension + " --pipeline " + pipeline;
        const Outcome out = w.lpc(arguments);
        EXPECT_EQ(out.code, 1) << arguments << "\n" << out.text;
        const bool known = out.text.find("outcome   exploded at step 3: speed") != std::string::npos ||
                           out.text.find("outcome   diverged at step 3: nan") != std::string::npos;
        EXPECT_TRUE(known) << arguments << "\n" << out.text;
      }
    }
  }
}

// So do events with finite numbers if their product is not finite.
TEST(BadInput, EventsBeyondAllNumbersEndTheRunAtTheirStep) {
  Workspace w;
  const std::pair<const char*, const char*> events[] = {
      {"push", "impulse = [1e308, 0]\nat = [0, 100]\n"},
      {"force", "force = [1.7e308, 0]\nstrength = 1.7e308\ntowards = [1000, 0]\n"}};
  for (const auto& [kind, numbers] : events) {
    w.write("t.toml", kHead + "steps = 20\n[[body]]\nname = \"a\"\n" + kBall + "[[event]]\nstep = 2\ndo = \"" + kind +
                          "\"\nbody = \"a\"\n" + numbers);
    for (const char* pipeline : {"", " --dimension 3 --pipeline engine=bullet"}) {
      const Outcome out = w.lpc(std::string("run t.toml") + pipeline);
      EXPECT_EQ(out.code, 1) << kind << pipeline << "\n" << out.text;
      EXPECT_NE(out.text.find("outcome   diverged at step 2: "), std::string::npos) << kind << "\n" << out.text;
    }
  }
}

std::string sweepMessage(const Workspace& w, const std::string& text) {
  try {
    planSweeps(w.write("s.toml", text), {});
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}

TEST(BadInput, SweepsWithoutCellsOrWithWrongValues) {
  Workspace w;
  const auto boxes = [](const std::string& axes, const std::string& more = "") {
    return "summary = \"s\"\nkind = \"boxes\"\n" + more +
           "[axes]\ndistribution = \"uniform\"\nbroadphase = \"naive\"\n" + axes;  // axes start on line 6
  };
  const auto world = [](const std::string& axes) {
    return "summary = \"s\"\nkind = \"world\"\n[axes]\nscene = \"pyramid\"\n" + axes;
  };
  const std::string good = "dimension = 2\nn = 8\n";
  const std::vector<Case> cases = {
      {"summary = \"s\"\nsweeps = []\n", {"s.toml:2: ", "'sweeps' is empty"}},
      {boxes("dimension = 2\nn = []\n"), {"s.toml:7: ", "'n' is empty"}},
      {world("[axes.resolver]\n"), {"s.toml:5: ", "'resolver' is empty"}},
      {boxes(good, "wall_limit = 0\n"), {"s.toml:3: ", "'wall_limit' is 0", "above 0"}},
      {boxes(good, "memory_limit = nan\n"), {"s.toml:3: ", "nan", "finite"}},
      {boxes(good, "repeats = 2000000000\n"), {"s.toml:", "2e+09 trials (repeats 2e+09)", "100000 in all"}},
      {boxes("dimension = 2.5\nn = 8\n"), {"s.toml:", "'dimension'", "2.5", "2 to 3"}},
      {boxes("dimension = \"flat\"\nn = 8\n"), {"s.toml:", "'dimension'", "flat", "2 to 3"}},
      {boxes("dimension = 2\nn = -5\n"), {"s.toml:", "'n'", "-5", "whole numbers from 1"}},
      {boxes("dimension = 2\nn = 1e30\n"), {"s.toml:", "'n'", "1e+30", "whole numbers"}},
      {boxes("dimension = 2\nn = nan\n"), {"s.toml:7: ", "nan", "finite"}},
      {boxes(good + "frames = 0\n"), {"s.toml:", "'frames'", "0"}},
      {boxes(good + "seed = -1\n"), {"s.toml:", "'seed'", "-1"}},
      {boxes(good + "precision = \"f16\"\n"), {"s.toml:", "'f16'", "f64, f32"}},
      {"summary = \"s\"\nkind = \"pairs\"\n[axes]\ndimension = 2\npair_query = \"sat\"\nkind_a = 3\nkind_b = \"box\"\n",
       {"s.toml:", "'kind_a' is 3", "a name"}},
      {"summary = \"s\"\nkind = \"world\"\n[axes]\nscene = 33\n", {"s.toml:4: ", "no preset_33", "11"}},
      {world("dt = \"fast\"\n"), {"s.toml:", "'dt'", "fast", "numbers"}},
      {world("dt = -1\n"), {"s.toml:", "dt is -1 s", "above 0"}},
      {world("steps = -1\n"), {"s.toml:", "'steps' is -1"}},
      {world("iterations = -1\n[axes.resolver]\n\"c\" = "
             "\"solver=split_solver{velocity=catto{iterations=$iterations}}\"\n"),
       {"s.toml:", "'iterations' of 'catto' is '-1'", "from 0 to 100000"}},
      {world("base = \"ten\"\n"), {"s.toml:", "'base'", "ten", "numbers"}},
      {world("base = 1e9\n"), {"s.toml:", "'base'", "1e+09", "1 to 200"}},
  };
  for (const Case& c : cases) {
    const std::string message = sweepMessage(w, c.text);
    expectParts(message, c.parts, c.text);
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  w.write("s.toml", "summary = \"s\"\nsweeps = []\n");
  refused(w, "sweep s.toml --store new/never.db", {"s.toml:2: ", "'sweeps' is empty"});
  refused(w, "sweep s.toml --jobs 0", {"--jobs", "0", "1 to"});
}

// A missing plugin: the message names the line that names its method, whatever precedes it.
TEST(BadInput, AMissingMethodIsReportedAtItsLine) {
  Workspace w;
  const std::string head = "summary = \"s\"\nkind = \"world\"\n", mine = "\"solver=split_solver{velocity=mine}\"\n",
                    scene = "[axes]\nscene = \"pyramid\"\nbase = [4]\n",
                    counted = "[axes]\nscene = \"pyramid\"\niterations = [4]\n",  // the word also occurs in a message
      catto = "[axes.resolver]\n\"catto\" = \"solver=split_solver{velocity=catto{iterations=$iterations}}\"\n";
  const std::string boxes =
      "summary = \"s\"\nkind = \"boxes\"\n[axes]\ndimension = 2\nn = 8\ndistribution = \"uniform\"\n";
  const std::vector<Case> cases = {
      {head + "pipeline = " + mine + scene, {"s.toml:3: ", "'mine'"}},
      {head + counted + catto + "\"mine\" = " + mine, {"s.toml:8: ", "'mine'"}},
      {head + "pipeline = " + mine + scene + "[axes.resolver]\n\"none\" = \"cache=none\"\n", {"s.toml:3: ", "'mine'"}},
      {head + counted + catto + "\"slip\" = \"solver=split_solver{velocity=catto{iteration=4}}\"\n",
       {"s.toml:8: ", "no parameter 'iteration'"}},
      {head + scene + "broadphase = [\n\"naive\",\n\"mine\"]\n", {"s.toml:8: ", "'mine'"}},
      {head + scene + "[[group]]\npipeline = " + mine, {"s.toml:7: ", "'mine'"}},
      {boxes + "broadphase = [\n\"naive\",\n\"planted_hang\"]\n", {"s.toml:9: ", "'planted_hang'"}},
  };
  for (const Case& c : cases) expectParts(sweepMessage(w, c.text), c.parts, c.text);
}

const std::string kSweep =
    "summary = \"s\"\nkind = \"boxes\"\n[axes]\ndimension = 2\ndistribution = \"uniform\"\nframes = 60\n"
    "n = [8, 16, 24, 32, 40, 48]\nbroadphase = [\"naive\", \"sort_and_sweep\"]\n";

TEST(BadInput, InvalidStores) {
  Workspace w;
  w.write("s.toml", kSweep);
  w.write("text.db", "no database, but text enough for the header of one: " + std::string(200, '.'));
  w.write("empty.db", "");
  std::filesystem::create_directory(w.path("folder.db"));
  ASSERT_EQ(w.lpc("sweep s.toml --quiet --store whole.db").code, 0);
  std::filesystem::copy(w.path("whole.db"), w.path("short.db"));
  std::filesystem::resize_file(w.path("short.db"), std::filesystem::file_size(w.path("short.db")) / 2);
  std::filesystem::copy(w.path("whole.db"), w.path("future.db"));
  SQLite::Database(w.path("future.db"), SQLite::OPEN_READWRITE).exec("UPDATE meta SET value='999'");
  SQLite::Database(w.path("foreign.db"), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec("CREATE TABLE other(x)");
  const std::string foreign = readFile(w.path("foreign.db"));
  const std::vector<Case> cases = {{"text.db", {"text.db: ", "not a result store", "not a database"}},
                                   {"short.db", {"short.db: ", "damaged", "malformed"}},
                                   {"folder.db", {"folder.db: ", "not a result store"}},
                                   {"future.db", {"future.db: ", "schema 999", "reads schema"}},
                                   {"foreign.db", {"foreign.db: ", "not a result store", "'meta'"}}};
  for (const Case& c : cases) {
    refused(w, "sweep s.toml --store " + c.text, c.parts);
    refused(w, "sweep s.toml --dry-run --store " + c.text, c.parts);
    refused(w, "merge all.db whole.db " + c.text, c.parts);
  }
  refused(w, "merge all.db empty.db", {"empty.db: ", "not a result store"});
  refused(w, "merge whole.db whole.db", {"whole.db", "also a store to read"});
  refused(w, "merge all.db absent.db", {"absent.db: ", "this store does not exist"});
  refused(w, "sweep s.toml --store text.db/s.db", {"text.db/s.db: ", "cannot be created", "Not a directory"});
  refused(w, "sweep s.toml --store /proc/nowhere/s.db", {"/proc/nowhere/s.db: "});
  refused(w, "sweep s.toml --dry-run --store text.db/s.db", {"text.db/s.db: ", "cannot be created", "Not a directory"});
  // Damaged in the middle: without a check, a sweep would notice only when it reads that page.
  std::filesystem::copy(w.path("whole.db"), w.path("torn.db"));
  const auto pages = std::filesystem::file_size(w.path("torn.db")) / 4096;
  for (auto page = pages / 2; page < pages; ++page) {
    std::fstream torn(w.path("torn.db"), std::ios::in | std::ios::out | std::ios::binary);
    torn.seekp(static_cast<std::streamoff>(page * 4096)), torn << std::string(4096, '!');
  }
  refused(w, "sweep s.toml --dry-run --store torn.db", {"torn.db: ", "damaged"});
  refused(w, "merge all.db torn.db", {"torn.db", "damaged"});
  // Damage that would be noticed only while writing.
  for (const char* damage : {"DROP TABLE metrics", "ALTER TABLE trial RENAME COLUMN key TO k"}) {
    std::filesystem::copy_file(w.path("whole.db"), w.path("lost.db"),
                               std::filesystem::copy_options::overwrite_existing);
    SQLite::Database(w.path("lost.db"), SQLite::OPEN_READWRITE).exec(damage);
    const std::string lost = readFile(w.path("lost.db"));
    for (const char* command : {"sweep s.toml --store lost.db", "sweep s.toml --dry-run --store lost.db",
                                "merge all.db lost.db", "merge whole.db lost.db"}) {
      refused(w, command, {"lost.db: ", "damaged", "no column"});
    }
    EXPECT_EQ(readFile(w.path("lost.db")), lost);
  }
  std::filesystem::copy(w.path("whole.db"), w.path("garbled.db"));
  SQLite::Database(w.path("garbled.db"), SQLite::OPEN_READWRITE).exec("UPDATE sweep SET roles='{'");
  refused(w, "sweep s.toml --quiet --only naive --store garbled.db", {"garbled.db: ", "damaged", "JSON"});
  const auto before = filesIn(w);
  EXPECT_EQ(w.lpc("sweep s.toml --dry-run --store deep/new.db").code, 0);
  EXPECT_EQ(w.lpc("sweep s.toml --dry-run --store empty.db").code, 0);
  EXPECT_EQ(filesIn(w), before) << "a dry run left something behind";
  EXPECT_EQ(w.lpc("sweep s.toml --dry-run --store whole.db").code, 0);
  EXPECT_EQ(readFile(w.path("foreign.db")), foreign) << "a file of somebody else's was written to";
  EXPECT_EQ(w.lpc("sweep s.toml --quiet --store empty.db").code, 0) << "killed while it was made, it is empty";
}

// A full disk ends the sweep. Finished trials stay, and with free space the same command continues.
TEST(BadInput, AFullDisk) {
  Workspace w;
  w.write("s.toml", kSweep);
  refused(w, "sweep s.toml --store s.db", {"s.db: ", "full"}, "LPC_STORE_MAX_PAGES=3");
  refused(w, "sweep s.toml --store s.db", {"LPC_STORE_MAX_PAGES is 'many'"}, "LPC_STORE_MAX_PAGES=many");
  ASSERT_EQ(w.lpc("sweep s.toml --quiet --only nobody --store s.db").code, 2);
  { Store made(w.path("s.db"), true); }
  Outcome out;
  int pages = 0;
  std::string done;
  for (pages = 20; pages < 200; ++pages) {  // the first limit that lets a trial through
    out = w.lpc("sweep s.toml --quiet --store s.db", "LPC_STORE_MAX_PAGES=" + std::to_string(pages));
    done = ask(w.path("s.db"), "SELECT count(*) FROM trial");
    if (done != "0") break;
  }
  EXPECT_EQ(out.code, 2) << out.text;
  EXPECT_NE(out.text.find("s.db: database or disk is full"), std::string::npos) << out.text;
  EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
  EXPECT_LT(std::stoi(done), 12) << pages;
  EXPECT_NE(w.lpc("sweep s.toml --quiet --store s.db").text.find(done + " were done"), std::string::npos) << done;
  ASSERT_EQ(w.lpc("sweep s.toml --quiet --store whole.db").code, 0);
  EXPECT_EQ(test::timeless(w.path("s.db")), test::timeless(w.path("whole.db")));
}

TEST(BadInput, CaseFiles) {
  Workspace w;
  const std::string start = "{\"cases\": [{\"id\": \"c1\", \"query\": \"signed_distance\", \"dim\": ";
  std::filesystem::create_directory(w.path("folder"));
  const std::vector<Case> cases = {
      {"", {"empty"}},
      {"not json", {"line 1"}},
      {"{\"cases\": [\n{", {"line 2"}},
      {"[]", {"'cases'"}},
      {"{\"cases\": 3}", {"'cases'"}},
      {"{\"cases\": []}", {"'cases' is empty"}},
      {"{\"cases\": [{\"id\": 3}]}", {"number 0", "'id' holds 3", "a text"}},
      {start + "4, \"expected\": {}}]}", {"'c1'", "'dim' holds 4", "2, 3"}},
      {start + "2}]}", {"'c1'", "'poseA' is missing"}},
      {start + "2, \"expected\": 3, \"poseA\": {\"t\": [0]}}]}", {"'c1'"}},
      {start + "2, \"expected\": {}, \"poseA\": {\"t\": [0, \"x\"]}}]}", {"'c1'", "'t' holds \"x\"", "a number"}},
      {start + "3, \"expected\": {}, \"poseA\": {\"t\": [0, 0, 0], \"q_wxyz\": [0, 0, 0, 0]}}]}", {"'c1'", "unit"}},
      {start + "3, \"expected\": {}, \"poseA\": {\"t\": [0, 0, 1e999]}}]}", {"1e999"}},
  };
  for (const Case& c : cases) {
    w.write("c.json", c.text);
    Parts parts = c.parts;
    parts.push_back("c.json: ");
    refused(w, "verify --cases c.json", parts);
  }
  refused(w, "verify --cases absent.json", {"absent.json: cannot be read: No such file or directory"});
  refused(w, "verify --cases folder", {"folder: cannot be read: Is a directory"});
  refused(w, "verify --cases /dev/null", {"/dev/null: is empty"});
  w.write("c.json", "[]");
  refused(w, "verify --cases c.json --csv absent/t.csv", {"absent/t.csv: ", "No such file"});
  refused(w, "verify --csv t.csv", {"--csv requires --cases"});
  refused(w, "verify --store c.json/s.db", {"c.json/s.db: ", "Not a directory"});
  refused(w, "verify --store s.db --pairs 0", {"--pairs", "0"});
  refused(w, "verify --store s.db --precision f16", {"'f16'", "f64, f32"});
  refused(w, "verify --store s.db --methods absent", {"'absent'", "gjk_epa"});
}

TEST(BadInput, BenchmarksPluginsAndScripts) {
  Workspace w;
  w.write("bench.json", "{\"benchmarks\": 3}");
  w.write("cut.json", "{\"benchmarks\": [{\"name\"");
  std::filesystem::create_directory(w.path("folder"));
  refused(w, "import-benchmark bench.json --store s.db", {"bench.json: ", "list \"benchmarks\""});
  refused(w, "import-benchmark cut.json --store s.db", {"cut.json: ", "not JSON of Google Benchmark"});
  refused(w, "import-benchmark folder --store s.db", {"folder: cannot be read: Is a directory"});
  refused(w, "--plugin absent.so list", {"absent.so: cannot be read: No such file or directory"});
  refused(w, "--plugin folder list", {"folder: "});
  for (const char* command : {"experiments/run", "experiments/run slow", "experiments/run quick --jobs",
                              "experiments/run quick full", "tests/run --fast", "tests/run -R"}) {
    const Outcome out = w.shell(LPC_SOURCE_DIR "/" + std::string(command));
    EXPECT_EQ(out.code, 2) << command << "\n" << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << command << "\n" << out.text;
  }
}

// Hides the Python packages behind files of the same names that fail to import.
TEST(BadInput, AReportWithoutItsPackages) {
  Workspace w;
  std::filesystem::create_directory(w.path("hidden"));
  w.write("hidden/jinja2.py", "raise ImportError('planted', name='jinja2')\n");
  const std::string hidden = "PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=" + w.path("hidden");
  refused(w, "report s.db --out out", {"no python3 imports", "python3-jinja2"}, hidden + " LPC_PYTHON=");
  refused(w, "report s.db --out out", {"LPC_PYTHON=/absent/python3", "python3-jinja2"}, "LPC_PYTHON=/absent/python3");
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::bad_input_test
