// SPDX-License-Identifier: Zlib
// Sweeps: planning, keys, outcomes, merging. sweep_rules_test.cpp tests what holds for every store.
#include <regex>

#include "experiments/runner/code_identity.h"
#include "experiments/runner/sweep_file.h"
#include "tests/experiments/process.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace sweep_test { namespace {

using test::ask;
using test::Outcome;
using test::timeless;
using test::Workspace;

const std::string kPlugin = LPC_BINARY_DIR "/lib/liblpc_planted.so";

std::string boxes(const std::string& axes, const std::string& more = "") {
  return "summary = \"s\"\nkind = \"boxes\"\n" + more +
         "[axes]\ndimension = 2\ndistribution = \"uniform\"\nframes = 12\n" + axes;
}

std::string messageOf(const std::string& path, const std::vector<std::string>& only = {}) {
  try {
    planSweeps(path, only);
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}

TEST(SweepPlan, isTheProductOfItsAxes) {
  Workspace w;
  const auto sweeps = planSweeps(
      w.write("s.toml", boxes("n = [8, 16]\nbroadphase = [\"naive\", \"sort_and_sweep{axis=0}\"]\n[[group]]\n"
                              "[[group]]\naxes = { n = [16, 32], seed = 2 }\n",
                              "timed = true\nuntimed = true\nrepeats = 3\n")),
      {});
  ASSERT_EQ(sweeps.size(), 1u);
  EXPECT_EQ(sweeps[0].name, "s");
  EXPECT_EQ(sweeps[0].trials.size(), 2u * 2 * 2 * (1 + 3));
  EXPECT_EQ(sweeps[0].trials[0].axes["broadphase"], "naive");
  EXPECT_EQ(sweeps[0].trials[0].axes["kind"], "boxes");
}

TEST(SweepPlan, onlySelectsByMethod) {
  Workspace w;
  const std::string path = w.write("s.toml", boxes("n = [8, 16]\nbroadphase = \"*\"\n"));
  const auto all = planSweeps(path, {}), some = planSweeps(path, {"naive"});
  EXPECT_EQ(some[0].trials.size(), 2u);
  EXPECT_GT(all[0].trials.size(), some[0].trials.size());
  for (const auto& t : some[0].trials) {
    EXPECT_TRUE(std::any_of(all[0].trials.begin(), all[0].trials.end(), [&](const auto& a) { return a.key == t.key; }));
  }
  EXPECT_NE(messageOf(path, {"naive", "nobody"}).find("--only nobody"), std::string::npos);
}

TEST(SweepPlan, PrecisionSelectsTrials) {
  Workspace w;
  w.write("a.toml",
          "summary = \"s\"\nkind = \"world\"\n[axes]\nscene = \"box_drop\"\nprecision = [\"f64\", \"f32\"]\n");
  w.write("b.toml", boxes("n = 8\nbroadphase = \"naive\"\n"));
  w.write("both.toml", "summary = \"s\"\nsweeps = [\"a.toml\", \"b.toml\"]\n");
  const auto planned = [&](const std::string& more) {
    const std::string text = w.lpc("sweep both.toml --dry-run --store s.db" + more).text;
    return std::pair(text.find("    1 trials") != text.npos, text.find("\nb ") != text.npos);
  };
  EXPECT_EQ(planned(""), std::pair(true, true));  // the trial of b
  EXPECT_EQ(planned(" --precision f64"), std::pair(true, true));
  EXPECT_EQ(planned(" --precision f32"), std::pair(true, false)) << "a sweep without a trial is no part of it";
}

// The plan is made in f64 and writes every parameter out, so a default in f64 must be valid in f32.
TEST(SweepRun, DefaultsHoldInEitherPrecision) {
  if (!test::kSingle) GTEST_SKIP() << "this build has no f32";
  Workspace w;
  const std::string axes = "precision = \"f32\"\ndimension = [2, 3]\n";
  w.write("pairs.toml", "summary = \"s\"\nkind = \"pairs\"\n[axes]\n" + axes +
                            "pair_query = \"*\"\nkind_a = \"box\"\nkind_b = \"box\"\nn = 10\n");
  w.write("worlds.toml",
          "summary = \"s\"\nkind = \"world\"\n[axes]\n" + axes + "scene = \"box_drop\"\nsteps = 1\ncontacts = \"*\"\n");
  w.lpc("sweep pairs.toml --store s.db --quiet");
  w.lpc("sweep worlds.toml --store s.db --quiet");
  EXPECT_GT(std::stoi(ask(w.path("s.db"), "SELECT count(*) FROM trial WHERE outcome='ok'")), 8);
  EXPECT_EQ(ask(w.path("s.db"), "SELECT group_concat(reason) FROM trial WHERE reason LIKE '%valid:%'"), "");
}

// A key depends on inputs and on the code that takes part, and on nothing else.
TEST(SweepPlan, keysAreStable) {
  Workspace w;
  const auto one = [&](const std::string& axes) {
    return planSweeps(w.write("s.toml", boxes(axes)), {})[0].trials.at(0);
  };
  const PlannedTrial a = one("n = 8\nbroadphase = \"sort_and_sweep\"\n");
  EXPECT_EQ(a.key, one("broadphase = \"sort_and_sweep\"\nn = 8\n").key) << "the order of axes";
  EXPECT_EQ(a.key, one("n = 8\nbroadphase = \"sort_and_sweep{axis=-1}\"\n").key) << "a default written out";
  EXPECT_NE(a.key, one("n = 9\nbroadphase = \"sort_and_sweep\"\n").key);
  EXPECT_NE(a.key, one("n = 8\nbroadphase = \"sort_and_sweep{axis=1}\"\n").key);
  EXPECT_NE(a.key, one("n = 8\nseed = 2\nbroadphase = \"sort_and_sweep\"\n").key);
  ASSERT_EQ(a.canonical["code"].size(), 1u) << "code of algorithms that take no part";
  EXPECT_TRUE(a.canonical["code"].contains("broadphase/sort_and_sweep"));
  EXPECT_FALSE(a.canonical["core"].get<std::string>().empty());
  EXPECT_EQ(trialKey(a.canonical), a.key);
  // The hash covers the algorithm's content, not its name: two algorithms differ.
  EXPECT_NE(codeHashes(StageKind::broadphase, {"naive", {}}, 2)["broadphase/naive"],
            a.canonical["code"]["broadphase/sort_and_sweep"]);
}

TEST(SweepPlan, mistakesHaveFileAndLine) {
  struct Case {
    std::string text;
    std::vector<const char*> parts;
  };
  const Case cases[] = {
      {"summary = 3\n", {"s.toml:1: ", "string"}},
      {"summary = \"s\"\nkind = \"worlds\"\n", {"s.toml:2: ", "'worlds'", "boxes"}},
      {boxes("n = 8\nbroadphase = \"naiv\"\n"), {"s.toml:", "'naiv'", "naive"}},
      {boxes("n = 8\nbroadphase = \"naive\"\nspeed = 3\n"), {"s.toml:", "'speed'"}},
      {boxes("n = 8\nbroadphase = \"sort_and_sweep{axi=0}\"\n"), {"s.toml:", "'axi'", "axis"}},
      {boxes("broadphase = \"naive\"\n"), {"s.toml:", "'n'"}},
      {boxes("n = 8\nbroadphase = \"naive\"\n", "repeat = 2\n"), {"s.toml:3: ", "'repeat'", "repeats"}},
      {boxes("n = 8\nbroadphase = \"naive\"\n", "poses_every = 1\n"), {"s.toml:3: ", "'poses_every'", "valid: world"}},
      {boxes("n = 8\nbroadphase = \"naive\"\n", "series = false\n"), {"s.toml:3: ", "'series'", "valid: world"}},
      {"summary = \"s\"\nkind = \"world\"\nposes_every = 0\n", {"s.toml:3: ", "'poses_every' is 0", "above 0"}},
      {"summary = \"s\"\nkind = \"world\"\n[axes]\nscene = [\"nowhere\"]\n", {"s.toml:4: ", "'nowhere'", "pyramid"}},
      {"summary = \"s\"\nsweeps = [\"nowhere\"]\n", {"s.toml:2: ", "'nowhere'", "quick"}},
  };
  Workspace w;
  for (const Case& c : cases) {
    const std::string message = messageOf(w.write("s.toml", c.text));
    for (const char* part : c.parts) {
      EXPECT_NE(message.find(part), std::string::npos) << c.text << "\nmessage: " << message;
    }
  }
  EXPECT_EQ(w.lpc("sweep s.toml --store never.db").code, 2);
  EXPECT_FALSE(std::filesystem::exists(w.path("never.db"))) << "half-written";
}

// A failure is a data point: each planted algorithm gives a row with its outcome.
TEST(SweepRun, failuresAreRows) {
  Workspace w;
  w.write("bad.toml", boxes("n = 64\nbroadphase = [\"planted_hang\", \"planted_crash\", \"planted_allocate\", "
                            "\"planted_forget\", \"naive\"]\n",
                            "wall_limit = 10\nmemory_limit = 0.3\n"));
  const Outcome run = w.lpc("--plugin " + kPlugin + " sweep bad.toml --store s.db --quiet");
  ASSERT_EQ(run.code, 0) << run.text;
  const std::map<std::string, std::pair<std::string, std::string>> expected = {
      {"planted_hang", {"timeout", "10 s"}},
      {"planted_crash", {"crash", "signal 6"}},
      {"planted_allocate", {"out_of_memory", "GiB"}},
      {"planted_forget", {"wrong", "1 pairs missing"}},
      {"naive", {"ok", ""}}};
  for (const auto& [name, what] : expected) {
    const std::string where = " FROM trial WHERE json_extract(canonical, '$.broadphase') = '" + name + "'";
    EXPECT_EQ(ask(w.path("s.db"), "SELECT outcome" + where), what.first) << name;
    EXPECT_NE(ask(w.path("s.db"), "SELECT reason" + where).find(what.second), std::string::npos) << name;
  }
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM planned"), "5");
  // Finished trials run again only with --retry, and only those that may end differently.
  EXPECT_NE(w.lpc("--plugin " + kPlugin + " sweep bad.toml --store s.db --quiet").text.find("5 were done, 0 run"),
            std::string::npos);
  EXPECT_NE(w.lpc("--plugin " + kPlugin + " sweep bad.toml --store s.db --quiet --retry --only planted_crash,naive")
                .text.find("1 were done, 1 run"),
            std::string::npos);
}

// A force kind that a plugin registers, named in a scene.
TEST(SweepRun, scenesNameForcesOfPlugins) {
  Workspace w;
  w.write(
      "push.toml",
      "name = \"push\"\nsummary = \"s\"\ndimensions = [2]\nsteps = 60\ngravity = [0, 0, 0]\n[[body]]\nname = \"a\"\n"
      "shapes = [{ kind = \"box\", half = [0.5, 0.5] }]\n"
      "[[force]]\nkind = \"planted_push\"\nb = \"a\"\nparameters = { force = 3 }\n");
  const Outcome run = w.lpc("--plugin " + kPlugin + " run push.toml");
  ASSERT_EQ(run.code, 0) << run.text;
  const std::size_t at = run.text.find("max_speed");
  ASSERT_NE(at, run.text.npos) << run.text;
  EXPECT_NEAR(std::stod(run.text.substr(at + 9)), 3, 1e-6) << "3 N on 1 kg for a second";
  const Outcome without = w.lpc("run push.toml");
  EXPECT_EQ(without.code, 2);
  EXPECT_NE(without.text.find("unknown force 'planted_push' in 2D"), without.text.npos) << without.text;
}

// A script is an axis, found as scenes are; its parameters belong to the scene.
TEST(SweepRun, aScriptIsAnAxis) {
  Workspace w;
  w.write("room.toml",
          "name = \"room\"\nsummary = \"s\"\ndimensions = [2]\nneeds = []\nsteps = 20\n[[body]]\nname = \"box\"\n"
          "shapes = [{ kind = \"box\", half = [1, 1] }]\n");
  w.write("hit.toml",
          "summary = \"s\"\n[parameters]\nblow = { default = 4, min = 0, max = 9, meaning = \"N s\" }\n"
          "[[event]]\ndo = \"push\"\nstep = 3\nbody = \"box\"\nimpulse = [\"blow\", 0]\n");
  const auto sweep = [&](const std::string& axes) {
    return w.write("s.toml", "summary = \"s\"\nkind = \"world\"\n[axes]\nscene = \"room\"\n" + axes);
  };
  const auto plan = planSweeps(sweep("script = [\"none\", \"hit\"]\n"), {});
  ASSERT_EQ(plan[0].trials.size(), 2u);
  EXPECT_EQ(plan[0].roles.at("script"), "run");
  EXPECT_FALSE(plan[0].trials[0].canonical.contains("script"));
  EXPECT_EQ(plan[0].trials[0].axes["script"], "none");
  EXPECT_EQ(plan[0].trials[1].axes["script"], "hit");
  EXPECT_NE(plan[0].trials[0].key, plan[0].trials[1].key);
  const auto lone = planSweeps(sweep(""), {});
  EXPECT_EQ(plan[0].trials[0].key, lone[0].trials[0].key) << "as without the axis";
  EXPECT_EQ(planSweeps(sweep("script = [0, 1]\nsteps = 5\n"), {})[0].trials[1].axes["script"], "director_1");

  sweep("script = \"hit\"\nblow = [4, 8]\n");
  const Outcome run = w.lpc("sweep s.toml --store s.db");
  ASSERT_EQ(run.code, 0) << run.text;
  for (const std::string blow : {"4", "8"}) {
    const std::string alone = w.lpc("run --json room.toml --script hit.toml --param blow=" + blow).text;
    const std::string hash = nlohmann::json::parse(alone.substr(alone.find('{'))).at("hash");
    EXPECT_EQ(test::ask(w.path("s.db"), "SELECT count(*) FROM trial WHERE outcome = 'ok' AND hash = '" + hash + "'"),
              "1")
        << blow;
  }
  const auto refused = [&](const std::string& axes, const std::string& said) {
    sweep(axes);
    const Outcome out = w.lpc("sweep s.toml --dry-run");
    EXPECT_EQ(out.code, 2) << out.text;
    EXPECT_NE(out.text.find(said), std::string::npos) << out.text;
  };
  refused("script = \"hat\"\n", "s.toml:5: ");
  refused("script = \"none\"\nblow = 4\n", "'blow' is unknown");

  // Two files of one name would be one value of the axis, and their results repeats of one run.
  std::filesystem::create_directory(w.path("other"));
  std::filesystem::copy(w.path("room.toml"), w.path("other/room.toml"));
  std::filesystem::copy(w.path("hit.toml"), w.path("other/hit.toml"));
  std::filesystem::copy(w.path("hit.toml"), w.path("other/none.toml"));
  refused("script = [\"hit\",\n \"other/hit.toml\"]\n", "s.toml:6: axis 'script': 'hit' is both ");
  refused("script = [\"none\",\n \"other/none.toml\"]\n", "s.toml:6: axis 'script': 'none' is both no file and ");
  refused("[[group]]\n[[group]]\naxes = { scene = \"other/room.toml\" }\n", "axis 'scene': 'room' is both ");
  EXPECT_EQ(planSweeps(sweep("script = [\"hit\", \"other/../hit.toml\"]\n"), {})[0].trials.size(), 1u) << "one file";
}

// The last line counts every trial once: finished before, run now by outcome, shared, and left.
TEST(SweepRun, theLastLineAddsUp) {
  Workspace w;
  w.write("a.toml", boxes("n = [8, 16]\nbroadphase = [\"naive\", \"planted_forget\", \"region_tree\"]\n"));
  w.write("b.toml", boxes("n = [16, 32]\nbroadphase = [\"naive\", \"planted_forget\"]\n"));  // two cells of a's
  w.write("both.toml", "summary = \"s\"\nsweeps = [\"a.toml\", \"b.toml\"]\n");
  const std::string run = "--plugin " + kPlugin + " sweep both.toml --store s.db --quiet";
  EXPECT_EQ(w.lpc(run + " --only region_tree").text,
            "s.db: 2 trials planned, 0 were done, 2 run, 0 of these not ok (2 ok)\n");
  EXPECT_EQ(
      w.lpc(run).text,
      "s.db: 10 trials planned, 2 were done, 6 run, 3 of these not ok (3 ok, 3 wrong: 3 of other stages), 2 shared\n");
  EXPECT_EQ(w.lpc(run).text, "s.db: 10 trials planned, 8 were done, 0 run, 0 of these not ok, 2 shared\n");
}

// A line says how many trials run again because something in their keys has changed.
TEST(SweepRun, OneLineSaysWhatRunsAgain) {
  Workspace w;
  const std::string scene = readFile(LPC_SOURCE_DIR "/experiments/scenes/box_drop.toml");
  w.write("drop.toml", scene);
  w.write("s.toml", "summary = \"s\"\nkind = \"world\"\n[axes]\nscene = \"drop.toml\"\nsteps = [1, 2]\n");
  const std::string again = "run again", run = "sweep s.toml --store s.db --quiet";
  EXPECT_EQ(w.lpc(run).text.find(again), std::string::npos) << "of an empty store";
  EXPECT_EQ(w.lpc(run).text.find(again), std::string::npos) << "of a store that is whole";
  w.write("drop.toml", scene + "\n# changed\n");
  EXPECT_EQ(w.lpc(run).text.find(
                "lpc: 2 trials of s.db run again, because their scene, code, compiler or options have changed\n"),
            0u);
}

// Replaces all workers with a program in the folder "workers".
std::string workers(const Workspace& w, const std::string& text, bool executable = true) {
  std::filesystem::create_directory(w.path("workers"));
  for (const char* name : {"workers/lpc-worker-f64", "workers/lpc-worker-f32"}) {
    const std::string path = w.write(name, text);
    if (executable) std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  }
  return "LPC_WORKERS=" + w.path("workers");
}

// The sweep continues whatever a worker does, and the row gives the true reason why the worker ended.
TEST(SweepRun, everyEndOfAWorkerIsARow) {
  Workspace w;
  w.write("s.toml", boxes("n = [8, 16, 24]\nbroadphase = \"naive\"\n", "wall_limit = 5\nmemory_limit = 0.02\n"));
  const std::pair<const char*, const char*> kinds[] = {
      {"exit 1", "crash: exit code 1"},
      {"echo no >&2; exit 3", "crash: exit code 3: no"},
      {"exit 0", "crash: the worker's result is unreadable"},
      {"exec 0<&-; kill -9 $$", "crash: signal 9 (Killed)"},
      {"exec yes", "out_of_memory: its output has 0.0"},
  };
  for (const auto& [text, row] : kinds) {
    const std::string environment = workers(w, std::string("#!/bin/sh\n") + text + "\n");
    const Outcome run = w.lpc("sweep s.toml --store s.db --quiet --retry", environment);
    EXPECT_EQ(run.code, 0) << text << "\n" << run.text;
    const std::string rows = "SELECT count(*) FROM trial WHERE outcome || ': ' || reason LIKE '";
    EXPECT_EQ(ask(w.path("s.db"), rows + std::regex_replace(row, std::regex("'"), "''") + "%'"), "3") << text;
  }
  w.write("s.toml", boxes("n = [8, 16, 24]\nbroadphase = \"naive\"\n"));
  EXPECT_EQ(w.lpc("sweep s.toml --store s.db --quiet --retry").code, 0);
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM trial WHERE outcome = 'ok'"), "3");
}

// A worker that cannot be started gives a one-line message, and no store is made.
TEST(SweepRun, aMissingWorkerEndsIt) {
  Workspace w;
  w.write("s.toml", boxes("n = [8, 16]\nbroadphase = \"naive\"\n"));
  for (const bool executable : {false, true}) {
    const std::string environment = workers(w, "no program", executable);
    for (const char* command : {"sweep s.toml --store s.db", "verify --store s.db", "run box_drop --record s.rec",
                                "needs box_drop --store s.db"}) {
      const Outcome out = w.lpc(command, environment);
      EXPECT_EQ(out.code, 2) << command << "\n" << out.text;
      EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
      EXPECT_NE(out.text.find("lpc-worker-f64: cannot be started: "), std::string::npos) << out.text;
      EXPECT_FALSE(std::filesystem::exists(w.path("s.db")) || std::filesystem::exists(w.path("s.rec.partial")))
          << command;
    }
  }
  // If all trials are done, no worker is started.
  ASSERT_EQ(w.lpc("sweep s.toml --store s.db --quiet").code, 0);
  EXPECT_EQ(w.lpc("sweep s.toml --store s.db --quiet", workers(w, "no program")).code, 0);
  EXPECT_EQ(w.lpc("sweep s.toml --store s.db --quiet --set n=9", workers(w, "no program")).code, 2);
}

TEST(SweepRun, aRepeatWithAnotherHashIsNondeterministic) {
  Workspace w;
  w.write("dice.toml", boxes("n = 64\nbroadphase = [\"planted_dice\", \"naive\"]\n", "repeats = 12\n"));
  ASSERT_EQ(w.lpc("--plugin " + kPlugin + " sweep dice.toml --store s.db --quiet").code, 0);
  const std::string where = " WHERE outcome='nondeterministic' AND canonical LIKE ";
  EXPECT_NE(ask(w.path("s.db"), "SELECT count(*) FROM trial" + where + "'%planted_dice%'"), "0");
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM trial" + where + "'%broadphase/naive%'"), "0");
}

TEST(SweepRun, unsupportedTrialsAreRows) {
  Workspace w;
  w.write("holes.toml",
          "summary = \"s\"\nkind = \"boxes\"\n[axes]\ndimension = [2, 3]\ndistribution = \"uniform\"\n"
          "frames = 12\nn = 8\nbroadphase = \"planted_slow\"\n");
  ASSERT_EQ(w.lpc("--plugin " + kPlugin + " sweep holes.toml --store s.db --quiet").code, 0);
  EXPECT_EQ(ask(w.path("s.db"),
                "SELECT group_concat(outcome) FROM (SELECT outcome FROM trial ORDER BY "
                "json_extract(canonical, '$.dimension'))"),
            "ok,unsupported");
}

TEST(SweepRun, interruptKeepsWhatWasFinished) {
  Workspace w;
  w.write("s.toml", boxes("n = [8, 16, 24, 32, 40, 48]\nframes = 100\nbroadphase = \"planted_slow\"\n"));
  // A repeated key `frames` is a TOML error; the sweep below has it once.
  EXPECT_EQ(w.lpc("--plugin " + kPlugin + " sweep s.toml --store s.db").code, 2);
  w.write("s.toml",
          "summary = \"s\"\nkind = \"boxes\"\n[axes]\ndimension = 2\ndistribution = \"uniform\"\n"
          "frames = 250\nn = [8, 16, 24, 32, 40, 48]\nbroadphase = \"planted_slow\"\n");
  // Once the first trial is in the store, five are left, each of which sleeps for half a second.
  test::Process run(w, "--plugin " + kPlugin + " sweep s.toml --quiet --jobs 1 --store s.db");
  ASSERT_TRUE(run.isBusy(w.path("s.db"))) << run.said();
  while (!run.ended() && ask(w.path("s.db"), "SELECT count(*) FROM trial") == "0") usleep(1000);
  run.signal(SIGINT);
  EXPECT_EQ(run.wait(), 130) << run.said();
  EXPECT_NE(run.said().find("the same command continues"), std::string::npos) << run.said();
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM trial WHERE outcome != 'ok'"), "0");
  const Outcome rest = w.lpc("--plugin " + kPlugin + " sweep s.toml --quiet --store s.db");
  EXPECT_EQ(rest.code, 0) << rest.text;
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM trial WHERE outcome = 'ok'"), "6");
}

// A second runner on a store is told which process holds it and changes nothing; readers do not wait.
TEST(SweepRun, oneRunnerAtATime) {
  Workspace w;
  w.write("s.toml", boxes("n = 8\nbroadphase = [\"naive\", \"planted_hang\"]\n", "wall_limit = 1000\n"));
  const std::string sweep = "--plugin " + kPlugin + " sweep s.toml --quiet --store s.db";
  test::Process first(w, sweep);
  ASSERT_TRUE(first.isBusy(w.path("s.db"))) << first.said();
  while (!first.ended() && ask(w.path("s.db"), "SELECT count(*) FROM trial") != "1") usleep(1000);
  const std::string before = timeless(w.path("s.db"));
  std::filesystem::create_symlink("s.db", w.path("other_name.db"));
  for (const std::string& second : {sweep, std::string("sweep s.toml --only naive --store other_name.db"),
                                    std::string("verify --store s.db"), std::string("needs box_drop --store s.db")}) {
    const Outcome out = w.lpc((second == sweep ? "" : "--plugin " + kPlugin + " ") + second);
    EXPECT_EQ(out.code, 2) << second << "\n" << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
    EXPECT_NE(out.text.find("process " + std::to_string(first.pid()) + ")"), std::string::npos) << out.text;
  }
  EXPECT_EQ(timeless(w.path("s.db")), before);
  EXPECT_EQ(w.lpc(sweep + " --dry-run").code, 0);
  EXPECT_EQ(w.lpc("merge other.db s.db").text, "s.db: 1 trials copied\n");
  // The lock ends with its holder, however that ends; workers do not hold it.
  first.signal(SIGKILL);
  first.wait();
  EXPECT_EQ(w.lpc("--plugin " + kPlugin + " sweep s.toml --quiet --store s.db --only naive").code, 0);
}

TEST(Store, merges) {
  Workspace w;
  w.write("a.toml", boxes("n = [8, 16]\nbroadphase = \"naive\"\n"));
  w.write("b.toml", boxes("n = [16, 32]\nbroadphase = \"naive\"\n"));
  ASSERT_EQ(w.lpc("sweep a.toml --quiet --store a.db").code, 0);
  ASSERT_EQ(w.lpc("sweep b.toml --quiet --store b.db").code, 0);
  const Outcome merged = w.lpc("merge all.db a.db b.db");
  ASSERT_EQ(merged.code, 0) << merged.text;
  EXPECT_EQ(ask(w.path("all.db"), "SELECT count(*) FROM trial"), "3");
  EXPECT_EQ(ask(w.path("all.db"), "SELECT count(*) FROM planned"), "4");
  EXPECT_EQ(ask(w.path("all.db"), "SELECT count(*) FROM trial t JOIN machine m ON t.machine = m.id"), "3");
  const std::string before = timeless(w.path("all.db"));
  ASSERT_EQ(w.lpc("merge all.db a.db").code, 0);
  EXPECT_EQ(timeless(w.path("all.db")), before);
}

TEST(Store, takesBenchmarks) {
  Workspace w;
  w.write("bench.json", R"({"context": {}, "benchmarks": [{"name": "a", "cpu_time": 1, "real_time": 1e3}]})");
  ASSERT_EQ(w.lpc("import-benchmark bench.json --store x.db").code, 0);
  EXPECT_EQ(ask(w.path("x.db"), "SELECT json_extract(data, '$.benchmarks[0].name') FROM benchmark"), "a");
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::sweep_test
