// SPDX-License-Identifier: Zlib
// The search for breaking points with known laws, and the command that starts it.
#include "experiments/runner/breaking.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>

#include "experiments/runner/sweep_file.h"
#include "tests/expect_caught.h"
#include "tests/experiments/refused.h"

namespace lpc { inline namespace LPC_PRECISION { namespace breaking_test { namespace {

using nlohmann::json;
using test::ask;
using test::Outcome;
using test::refused;
using test::Workspace;

BreakQuestion question(double from, double to, bool falling = false) {
  BreakQuestion q;
  q.parameter = "n", q.from = from, q.to = to, q.falling = falling;
  return q;
}

// Number of failures among five seeds, by value; scaled to the number of seeds tried.
using Law = std::function<long(double)>;
Broken climb(const BreakQuestion& q, bool whole, const Law& law, int* tried = nullptr) {
  std::vector<Rung> known;
  for (std::vector<WantedRung> next; !(next = nextRungs(q, whole, known)).empty();) {
    for (const auto& [value, seeds] : next) {
      Rung r;
      r.value = value, r.failed = (law(value) * seeds + 2) / 5, r.of = seeds;
      std::erase_if(known, [&](const Rung& k) { return k.value == r.value; });
      known.push_back(r);
    }
    EXPECT_LE(static_cast<int>(known.size()), q.mostTried()) << "the search does not end";
    if (static_cast<int>(known.size()) > q.mostTried()) break;
  }
  if (tried) *tried = static_cast<int>(known.size());
  return judge(q, known);
}

TEST(Breaking, WholeNumbersEndAtNeighbours) {
  const auto isRight = [](const std::function<long(double, double)>& law) {
    for (double breaks = 2; breaks <= 60; ++breaks) {
      const Broken b = climb(question(1, 60), true, [&](double n) { return law(n, breaks); });
      if (!b.held || !b.fell || b.held->value != breaks - 1 || b.fell->value != breaks) return false;
    }
    return true;
  };
  EXPECT_TRUE(isRight([](double n, double breaks) { return n < breaks ? 0 : 5; }));
  EXPECT_TRUE(isRight([](double n, double breaks) { return n < breaks ? 1 : 4; })) << "half of the seeds";
  test::expectCaught("two of five seeds are a failure", isRight([](double n, double breaks) {
                       return n + 1 < breaks ? 0 : n < breaks ? 3 : 5;
                     }));
  EXPECT_FALSE(climb(question(1, 60), true, [](double) { return 0; }).fell);
  const Broken none = climb(question(1, 60), true, [](double) { return 5; });
  EXPECT_FALSE(none.held);
  EXPECT_EQ(none.fell->value, 1);
}

// A method that holds at the last value, or fails at the first, is tried there with all seeds.
TEST(Breaking, EndsOfTheRangeUseAllSeeds) {
  BreakQuestion q = question(1, 60);
  q.seeds = 20;
  EXPECT_EQ(climb(q, true, [](double) { return 0; }).held->of, 20);
  EXPECT_EQ(climb(q, true, [](double) { return 5; }).fell->of, 20);
}

TEST(Breaking, FallingAsksForTheSmallestThatHolds) {
  for (double holds = 2; holds <= 60; ++holds) {
    const Broken b = climb(question(1, 60, true), true, [&](double n) { return n >= holds ? 0 : 5; });
    ASSERT_TRUE(b.held && b.fell);
    EXPECT_EQ(b.held->value, holds);
    EXPECT_EQ(b.fell->value, holds - 1);
    EXPECT_EQ(*b.low, holds - 1);
    EXPECT_EQ(*b.high, holds);
  }
}

TEST(Breaking, RealsEndAsNearAsAsked) {
  BreakQuestion q = question(1e-3, 10);
  for (const double ratio : {1.5, 1.05, 1.001}) {
    q.ratio = ratio;
    const Broken b = climb(q, false, [](double x) { return x < 0.2345 ? 0 : 5; });
    ASSERT_TRUE(b.held && b.fell);
    EXPECT_LT(b.held->value, 0.2345);
    EXPECT_GE(b.fell->value, 0.2345);
    EXPECT_LE(b.fell->value / b.held->value, ratio);
  }
}

// A finer grid finds failures that a coarse one skips, with integers and reals.
TEST(Breaking, AFinerGridSeesMore) {
  for (const bool whole : {true, false}) {
    BreakQuestion q = question(1, 64);
    const auto fails = [](double n) { return n > 10 && n < 14 ? 5 : 0; };
    EXPECT_FALSE(climb(q, whole, fails).fell);
    q.step = 1.25;
    const Broken b = climb(q, whole, fails);
    ASSERT_TRUE(b.held && b.fell);
    EXPECT_NEAR(b.held->value, 10, 0.5);
    EXPECT_FALSE(b.passesBeyond.empty());
    if (!whole) continue;
    for (const Rung& r : b.rungs) EXPECT_EQ(r.value, std::round(r.value));
  }
}

// The search finds the lowest breaking point and lists values that hold beyond it.
TEST(Breaking, ValuesThatHoldBeyondAFailureAreListed) {
  const Broken b =
      climb(question(1, 64), true, [](double n) { return n == 8 || n == 64 || n >= 20 ? n == 32 ? 0 : 5 : 0; });
  EXPECT_EQ(b.held->value, 7);
  EXPECT_EQ(b.fell->value, 8);
  EXPECT_EQ(b.passesBeyond, (std::vector<double>{16, 32}));
}

// Half of the seeds start to fail between the last value at which most surely hold and the first at which most surely
// fail.
TEST(Breaking, TheIntervalFollowsTheSharesOfFailures) {
  const Broken b = climb(question(1, 16), true, [](double n) { return n < 5 ? 0 : n < 7 ? 2 : n < 16 ? 3 : 5; });
  EXPECT_EQ(b.held->value, 6);
  EXPECT_EQ(*b.low, 4);
  EXPECT_EQ(*b.high, 16);
  BreakQuestion five = question(1, 16);
  five.seeds = 5;
  const Broken open = climb(five, true, [](double n) { return n < 5 ? 1 : 4; });
  EXPECT_FALSE(open.low) << "one of five may be more than half of all";
  EXPECT_FALSE(open.high);
  const Broken twenty = climb(question(1, 16), true, [](double n) { return n < 5 ? 1 : 4; });
  EXPECT_EQ(*twenty.low, 4);
  EXPECT_EQ(*twenty.high, 5);
  // 95 % intervals of 0 of 5 and of 5 of 10.
  EXPECT_LT(wilson(0, kFewestSeeds).high, 0.5);
  EXPECT_GT(wilson(0, kFewestSeeds - 1).high, 0.5);
  EXPECT_NEAR(wilson(0, 5).high, 0.43448, 1e-4);
  EXPECT_EQ(wilson(0, 5).low, 0);
  EXPECT_NEAR(wilson(5, 10).low, 0.23659, 1e-4);
  EXPECT_NEAR(wilson(5, 10).high, 0.76341, 1e-4);
  EXPECT_EQ(wilson(0, 0).high, 1);
}

// Few seeds far from the breaking point. All seeds at its two sides, and wherever the share of failures is uncertain.
TEST(Breaking, ManySeedsRunOnlyNearTheBreakingPoint) {
  const Broken b = climb(question(1, 64), true, [](double n) { return n < 20 ? 0 : n < 22 ? 2 : n < 23 ? 3 : 5; });
  EXPECT_EQ(b.held->value, 21);
  EXPECT_EQ(b.fell->value, 22);
  EXPECT_EQ(b.held->of, 20);
  EXPECT_EQ(b.fell->of, 20);
  EXPECT_NEAR(*b.half, 21 * std::sqrt(22. / 21), 1e-9) << "8 of 20 fail, and 12 of 20";
  long trials = 0;
  for (const Rung& r : b.rungs) {
    trials += r.of;
    if (r.value < 19 || r.value > 24) {
      EXPECT_EQ(r.of, kFewestSeeds) << r.value;
    }
  }
  EXPECT_LE(trials, question(1, 64).mostTrials());
}

// With 4 seeds, 2 fail by chance; with 20, 9 fail: the search continues where the result of many seeds moves the
// breaking point.
TEST(Breaking, ManySeedsMoveTheBreakingPoint) {
  std::vector<Rung> known;
  const auto failed = [](double n, long seeds) { return n < 10 ? 0 : n > 12 ? seeds : seeds == 20 ? 9 : 2L; };
  for (std::vector<WantedRung> next; !(next = nextRungs(question(1, 64), true, known)).empty();) {
    for (const auto& [value, seeds] : next) {
      std::erase_if(known, [v = value](const Rung& k) { return k.value == v; });
      Rung r;
      r.value = value, r.failed = failed(value, seeds), r.of = seeds;
      known.push_back(r);
    }
    ASSERT_LT(known.size(), 64u);
  }
  const Broken b = judge(question(1, 64), known);
  EXPECT_EQ(b.held->value, 12);
  EXPECT_EQ(b.fell->value, 13);
}

// Works as `lpc sweep`, but takes results from a law instead of runs; stops after `rounds` rounds.
struct Searched {
  std::vector<Broken> broken;
  long asked = 0;
};
Searched search(const std::string& path, Store& store, const Law& law, int rounds = 100) {
  PlannedSweep sweep = planSweeps(path, {}).at(0);
  Searched out;
  const auto done = [&](const std::string& key) { return store.outcome(key).has_value(); };
  findBreaking(
      sweep, store,
      [&](const PlannedSweep& round) {
        if (rounds-- <= 0) return false;
        for (const PlannedTrial& t : round.trials) {
          if (done(t.key)) continue;
          TrialResult result;
          const auto n = t.axes.at("n").get<double>();
          if (t.axes.at("seed") <= law(n)) result.fail("crash", "its worker died", -1);
          // An iteration costs as much as there are boxes.
          result.metrics["work_multiply_adds"] = n * t.axes.value("iterations", 1.0);
          store.put(t, result, timeStamp(), 0), ++out.asked;
        }
        return true;
      },
      done);
  store.plan(sweep, true);
  out.broken = sweep.broken;
  return out;
}

const std::string kTower = R"(
summary = "s"
kind = "world"
pipeline = "solver=split_solver{velocity=catto{iterations=$iterations},position=none}"
break = { parameter = "n", from = 1, to = 24 }
[axes]
scene = "vertical_stack"
)";

TEST(Breaking, AResumedSearchEndsAsAnUninterruptedOne) {
  Workspace w;
  const std::string equal =
      "calibrate = { equal = \"cost\", metric = \"work_multiply_adds\", setting = \"iterations\", most = 64 }\nbudgets "
      "= "
      "[120]\n";
  const auto law = [](double n) { return n < 11 ? 1 : 20; };  // of 4 seeds or of 20
  for (const std::string& text : {kTower + "iterations = 10\n", equal + kTower}) {
    const std::string path = w.write("s.toml", text);
    Store whole(w.path(std::to_string(text.size()) + ".db"), true);
    const Searched straight = search(path, whole, law);
    ASSERT_EQ(straight.broken.size(), 1u);
    EXPECT_EQ(straight.broken[0].held->value, 10) << "a worker that dies is a failure";
    EXPECT_EQ(straight.broken[0].fell->value, 11);
    EXPECT_EQ(straight.broken[0].fell->failure, "crash: its worker died");
    EXPECT_EQ(search(path, whole, law).asked, 0);
    for (const int rounds : {0, 1, 2, 3, 5}) {
      SCOPED_TRACE(rounds);
      const std::string name = w.path(std::to_string(text.size()) + "_" + std::to_string(rounds) + ".db");
      Store store(name, true);
      const Searched stopped = search(path, store, law, rounds);
      EXPECT_NE(ask(name, "SELECT count(*) FROM planned"), "0") << "what is missing is told";
      const Searched resumed = search(path, store, law);
      EXPECT_EQ(stopped.asked + resumed.asked, straight.asked);
      EXPECT_EQ(resumed.broken[0].held->value, 10);
      EXPECT_EQ(ask(name, "SELECT count(*) FROM planned"),
                ask(w.path(std::to_string(text.size()) + ".db"), "SELECT count(*) FROM planned"));
    }
  }
}

// A value fails if even one iteration exceeds the budget: 16 boxes cost 16, the budget is 15.
TEST(Breaking, ValuesBeyondTheBudgetFail) {
  Workspace w;
  const std::string path =
      w.write("s.toml",
              "calibrate = { equal = \"cost\", metric = \"work_multiply_adds\", setting = \"iterations\", most = 64 }\n"
              "budgets = [15]\n" +
                  kTower);
  Store store(w.path("s.db"), true);
  const Searched found = search(path, store, [](double) { return 0; });
  EXPECT_EQ(found.broken.at(0).held->value, 15);
  EXPECT_EQ(found.broken.at(0).held->cost, 15);
  EXPECT_NE(found.broken.at(0).fell->failure.find("iterations=1 costs 16"), std::string::npos)
      << found.broken.at(0).fell->failure;
}

// A block on a slope slides n (n + 1) / 2 dt^2 g (sin a - friction cos a) in n steps.
const std::string kSlope =
    "break slope --parameter friction --falling --from 0.2 --to 0.8 --limit \"slope_distance<1\" "
    "--steps 60 --seeds 1 --perturb 0 --ratio 1.01 --quiet --store b.db ";

TEST(Breaking, TheCommandAgreesWithTheFormula) {
  Workspace w;
  const std::string pipeline = "--pipeline solver=split_solver";
  const Outcome out = w.lpc(kSlope + pipeline);
  ASSERT_EQ(out.code, 0) << out.text;
  const double a = std::atan(0.5), slide = 2 * 60. * 60 / (60 * 61),
               friction = (std::sin(a) - slide / 10) / std::cos(a);
  const std::string line = out.text.substr(out.text.find("\n  ") + 3);
  const double held = std::stod(line);
  EXPECT_GE(held, friction) << out.text;
  EXPECT_LT(held, 1.01 * friction) << out.text;
  EXPECT_NE(line.find(" holds; fewer than 4 seeds give no interval; "), std::string::npos) << out.text;
  EXPECT_NE(line.find(" 1 of 1 fail, slope_distance is 1."), std::string::npos) << out.text;

  const std::string trials = ask(w.path("b.db"), "SELECT count(*) FROM trial");
  EXPECT_EQ(trials, ask(w.path("b.db"), "SELECT count(*) FROM planned"));
  const Outcome again = w.lpc(kSlope + pipeline);
  EXPECT_EQ(again.text, out.text);
  EXPECT_EQ(ask(w.path("b.db"), "SELECT count(*) FROM trial"), trials) << "a second run costs nothing";
  const json about = json::parse(ask(w.path("b.db"), "SELECT roles FROM sweep"));
  EXPECT_EQ(about["break"]["smallest friction"]["parameter"], "friction");
  EXPECT_EQ(about["break"]["smallest friction"]["limit"], "slope_distance<1");
  EXPECT_EQ(about["commands"][0][0], "break");
  EXPECT_EQ(ask(w.path("b.db"), "SELECT count(*) FROM planned WHERE axes LIKE '%\"question\":\"smallest friction\"%'"),
            trials);

  if (std::filesystem::exists(LPC_BINARY_DIR "/bin/lpc-engine-worker-f32")) {  // an engine's work is not counted
    const Outcome engine = w.lpc(kSlope + "--precision f32 --pipeline engine=box2d");
    EXPECT_NE(engine.text.find(" holds; "), std::string::npos) << engine.text;
    EXPECT_EQ(engine.text.find("nan"), std::string::npos) << engine.text;
  }

  const Outcome told = w.lpc(
      "break slope --parameter friction --falling --from 0.2 --to 0.8 --limit \"slope_distance<1\" --steps 60 --seeds "
      "4 "
      "--perturb 0 --ratio 1.01 --truth 0.4 --quiet --store truth.db " +
      pipeline);
  EXPECT_TRUE(std::regex_search(told.text, std::regex("closed form: 0.4, [0-9.]+ % (below|above)"))) << told.text;

  const Outcome missing = w.lpc(kSlope + "--limit \"joint_error_max<1\" " + pipeline);
  EXPECT_EQ(missing.code, 2) << missing.text;
}

TEST(Breaking, MistakesAreOneLine) {
  Workspace w;
  const std::string good = "break slope --parameter friction --from 0.2 --to 0.8 --store never.db ",
                    pipeline = "--pipeline solver=split_solver ";
  refused(w, good, {"--pipeline"});
  refused(w, "break slope " + pipeline, {"--parameter"});
  refused(w, "break slop --parameter n " + pipeline, {"slop"});
  refused(w, "break slope --parameter frict --from 1 --to 2 " + pipeline, {"'frict'", "friction"});
  refused(w, "break slope --parameter friction " + pipeline, {"--from", "0"});
  refused(w, "break slope --parameter dt --from 0.01 " + pipeline, {"--to", "scene 'slope' has no such parameter"});
  refused(w, "break bridge --parameter joint " + pipeline, {"holds a text"});
  refused(w, "break slope --parameter friction --from 2 --to 1 " + pipeline, {"'from' is 2", "above 0"});
  refused(w, "break slope --parameter friction --from 1 --to 11 " + pipeline, {"is 11", "0 to 10"});
  refused(w, good + pipeline + "--param friction=1", {"--param friction is the searched parameter"});
  for (const char* name : {"dimension", "model", "precision", "scene", "seed"}) {
    refused(w, std::string("break slope --parameter ") + name + " --from 2 --to 3 --store never.db " + pipeline,
            {"'" + std::string(name) + "' cannot be searched", "$NAME"});
  }
  refused(w, "break slope --parameter seed " + pipeline, {"'seed' cannot be searched"});
  refused(w, "break slope --parameter steps --from 2 --to 3 --steps 5 " + pipeline,
          {"--steps is the searched parameter"});
  refused(w,
          "break slope --parameter iterations --from 2 --to 3 --equal-cost 100 --pipeline "
          "'solver=split_solver{velocity=catto{iterations=$iterations}}'",
          {"'iterations' is the setting that 'calibrate' finds at equal cost"});
  refused(w, good + pipeline + "--limit ''", {"'limit' is ''", "METRIC<NUMBER"});
  refused(w, good + pipeline + "--limit slope_distance", {"'limit' is 'slope_distance'", "METRIC<NUMBER"});
  refused(w, good + pipeline + "--limit \"slope_distanc<1\"", {"slope_distanc", "did you mean 'slope_distance'"});
  refused(w, good + pipeline + "--limit \"ms_per_step_median<1\"", {"'limit' names the metric"});
  refused(w, good + pipeline + "--seeds 0", {"--seeds", "1 to 1000"});
  refused(w, good + pipeline + "--ratio 1", {"--ratio", "1.001 to 2"});
  refused(w, good + pipeline + "--grid 3", {"--grid", "1.001 to 2"});
  refused(w, good + "--pipeline solver=split_solver{velocity=direct_lcp} --equal-cost 100",
          {"direct_lcp has no effort: it solves the island at once", "$iterations"});
  refused(w, good + "--pipeline solver=soft_step{substeps=4} --equal-cost 100", {"substeps=4", "without it"});
  refused(w, good + "--pipeline engine=bullet{iterations=4} --dimension 3 --equal-cost 100", {"iterations=4"});
  refused(w, good + "--pipeline solver=split_solverr", {"split_solverr"});
}

const std::string kSweep = R"(
summary = "s"
kind = "world"
pipeline = "solver=split_solver{velocity=catto{iterations=$iterations},position=none}"
)";

TEST(Breaking, ASweepOfQuestions) {
  Workspace w;
  // The multiply-adds of a pendulum grow with its iterations; the limit lies within the range.
  w.write("s.toml", kSweep + R"(
[break]
seeds = 1
perturb = 0
[[group]]
break = { question = "most iterations", parameter = "iterations", from = 1, to = 40, limit = "work_multiply_adds<400" }
axes = { scene = "pendulum", steps = 5 }
[[group]]
break = { question = "least friction", parameter = "friction", from = 0.2, to = 0.8, falling = true, limit = "slope_distance<1" }
axes = { scene = "slope", iterations = 5, steps = 60 }
)");
  const Outcome plan = w.lpc("sweep s.toml --store s.db --dry-run");
  EXPECT_NE(plan.text.find("2 searches for breaking points"), std::string::npos) << plan.text;
  const Outcome out = w.lpc("sweep s.toml --store s.db --quiet");
  ASSERT_EQ(out.code, 0) << out.text;
  const auto most = [&](const std::string& where) {
    return ask(w.path("s.db"),
               "SELECT max(CAST(json_extract(p.axes, '$.iterations') AS INTEGER)) FROM planned p JOIN trial t ON p.key "
               "= t.key "
               "WHERE p.axes LIKE '%most iterations%' AND " +
                   where);
  };
  EXPECT_EQ(most("1"), "40");
  const std::string held = most("json_extract(t.metrics, '$.work_multiply_adds') < 400");
  const auto cost = [&](int iterations) {
    return std::stod(ask(w.path("s.db"),
                         "SELECT json_extract(t.metrics, '$.work_multiply_adds') FROM planned p JOIN "
                         "trial t ON p.key = t.key WHERE p.axes LIKE '%most iterations%' AND "
                         "json_extract(p.axes, '$.iterations') = " +
                             std::to_string(iterations)));
  };
  EXPECT_LT(cost(std::stoi(held)), 400);
  EXPECT_GE(cost(std::stoi(held) + 1), 400) << "rows are made once, and updated by each iteration";
  const Outcome again = w.lpc("sweep s.toml --store s.db --quiet");
  EXPECT_NE(again.text.find(" 0 run,"), std::string::npos) << again.text;
}

// Twice the boxes need twice the multiply-adds: at equal cost a method gets fewer iterations at a higher value.
TEST(Breaking, AtEqualCostEveryRungHasItsOwnSetting) {
  Workspace w;
  const Outcome out = w.lpc(
      "break bridge --parameter n --from 2 --to 8 --steps 20 --seeds 2 --equal-cost 1000 --quiet --store e.db "
      "--pipeline 'solver=split_solver{velocity=catto{iterations=$iterations},position=none}'");
  ASSERT_EQ(out.code, 0) << out.text;
  const auto at = [&](int n, const std::string& what) {
    return std::stod("0" + ask(w.path("e.db"), "SELECT " + what +
                                                   " FROM planned p JOIN trial t ON p.key = t.key WHERE "
                                                   "json_extract(p.axes, '$.n') = " +
                                                   std::to_string(n)));
  };
  const std::string iterations = "json_extract(p.axes, '$.iterations')",
                    cost = "json_extract(t.metrics, '$.work_multiply_adds')";
  for (const int n : {2, 4, 8}) EXPECT_LE(at(n, "max(" + cost + ")"), 1000) << n;
  EXPECT_GT(at(2, iterations), at(4, iterations));
  EXPECT_GT(at(4, iterations), at(8, iterations));
}

// The caller need not know how a solver names its iterations.
TEST(Breaking, AtEqualCostTheEffortOfEachMethodIsSearched) {
  Workspace w;
  const Outcome out = w.lpc(
      "break bridge --parameter n --from 2 --to 4 --steps 20 --seeds 1 --perturb 0 --equal-cost 2000 --quiet --store "
      "e.db --pipeline solver=soft_step --pipeline 'solver=split_solver{velocity=millington}' "
      "--pipeline 'solver=soft_step{substeps=$iterations}'");
  ASSERT_EQ(out.code, 0) << out.text;
  const auto count = [&](const std::string& where) {
    return std::stoi(
        ask(w.path("e.db"), "SELECT count(*) FROM planned p JOIN trial t ON p.key = t.key WHERE " + where));
  };
  const std::string pipeline = "json_extract(t.canonical, '$.pipeline') LIKE '%",
                    set = "' || json_extract(p.axes, '$.iterations') || '";
  EXPECT_GT(count(pipeline + "soft_step{substeps=" + set + ",%'"), 0);
  EXPECT_GT(count(pipeline + "millington{iteration_factor=" + set + ",%'"), 0);
  EXPECT_GT(count("json_extract(p.axes, '$.iterations') > 1"), 1);
}

// The dry run also counts the trials that find each value's iterations.
TEST(Breaking, ADryRunBoundsWhatIsRun) {
  Workspace w;
  w.write("s.toml", kSweep + R"(
calibrate = { equal = "cost", metric = "work_multiply_adds", setting = "iterations", most = 64 }
budgets = [60]
break = { parameter = "n", from = 2, to = 8, seeds = 1, perturb = 0 }
[axes]
scene = "bridge"
steps = 20
)");
  const std::string plan = w.lpc("sweep s.toml --store s.db --dry-run").text, before = "with at most ";
  ASSERT_NE(plan.find(before), std::string::npos) << plan;
  ASSERT_EQ(w.lpc("sweep s.toml --store s.db --quiet").code, 0);
  const long run = std::stol(ask(w.path("s.db"), "SELECT count(*) FROM trial"));
  EXPECT_LE(run, std::stol(plan.substr(plan.find(before) + before.size()))) << plan;
  EXPECT_GT(run, 3) << "each of three values has several settings";
}

TEST(Breaking, MistakesInASweepNameTheLine) {
  Workspace w;
  const std::string axes = "[axes]\nscene = \"slope\"\niterations = 5\n";
  const auto with = [](const std::string& fields) {
    return "break = { parameter = \"friction\", from = 0.2, to = 0.8" + fields + " }\n";
  };
  const std::pair<std::string, test::Parts> cases[] = {
      {"break = { from = 1, to = 2 }\n" + axes, {"s.toml:5: ", "a breaking point needs 'parameter'"}},
      {"break = { parameter = \"friction\" }\n" + axes, {"s.toml:5: ", "'from' is 0"}},
      {with(", limit = \"slope_distance=1\"") + axes, {"s.toml:5: ", "METRIC<NUMBER"}},
      {with(", limit = \"\"") + axes, {"s.toml:5: ", "'limit' is ''", "METRIC<NUMBER"}},
      {"break = { parameter = \"seed\", from = 1, to = 2 }\n" + axes, {"s.toml:5: ", "'seed' cannot be searched"}},
      {"break = { parameter = \"iterations\", from = 1, to = 2 }\n"
       "calibrate = { equal = \"cost\", metric = \"work_multiply_adds\", setting = \"iterations\" }\nbudgets = [9]\n"
       "[axes]\nscene = \"slope\"\n",
       {"s.toml:5: ", "'iterations' is the setting that 'calibrate' finds at equal cost"}},
      {with(", step = 1") + axes, {"s.toml:5: ", "step"}},
      {with(", truth = 0.1") + axes, {"s.toml:5: ", "'truth' is 0.1", "from 0.2 to 0.8"}},
      {with(", seeds = 0") + axes, {"s.toml:5: ", "'seeds' is 0", "1 to 1000"}},
      {with(", grid = 1") + axes, {"s.toml:5: ", "'grid' is 1", "1.001 to 2"}},
      {with(", ratio = 1.001, grid = 1.001") + axes, {"s.toml:5: ", "more than 100 values"}},
      {with(", ratio = 1") + axes, {"s.toml:5: ", "'ratio' is 1", "1.001 to 2"}},
      {with("") + axes + "friction = 0.5\n", {"s.toml:9: ", "'friction' is searched by 'break'"}},
      {with("") + axes + "seed = [1, 2]\n", {"s.toml:9: ", "'seed' is searched by 'break'"}},
      {with("") +
           "calibrate = { equal = \"cost\", metric = \"ms_per_step_median\", setting = \"iterations\" }\ntimed = true\n"
           "budgets = [1]\n[axes]\nscene = \"slope\"\n",
       {"s.toml:", "a time, is not possible; valid: a count"}}};
  for (const auto& [text, parts] : cases) {
    w.write("s.toml", kSweep + text);
    refused(w, "sweep s.toml --store never.db", parts);
  }
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::breaking_test
