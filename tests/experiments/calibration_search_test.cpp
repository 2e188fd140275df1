// SPDX-License-Identifier: Zlib
// The search of settings on stores with rows written by the test: with known times, interrupted, resumed, in parts. No
// trial runs, except through the command.
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "experiments/runner/calibration.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace calibration_search_test { namespace {

using nlohmann::json;
using test::ask;
using test::Outcome;
using test::Workspace;

// `setting = "n"` distinguishes the name of the axis from that of the parameter.
std::string twoMethods(const std::string& metric, const std::string& more) {
  return "summary = \"s\"\nkind = \"world\"\ncalibrate = { equal = \"cost\", metric = \"" + metric +
         "\", setting = \"n\", most = 64 }\n" + more + R"(
[axes]
scene = "pendulum"
dimension = 2
steps = 10
[axes.resolver]
"catto" = "solver=split_solver{velocity=catto{iterations=$n},position=none}"
"soft" = "solver=soft_step{substeps=$n}"
)";
}
const std::string kTimed = "timed = true\nrepeats = 5\nbudgets = [1, 4.5]\n";

// Result of a trial with n iterations, written into the store instead of a run.
using Law = std::function<TrialResult(const json& axes)>;
void write(Store& store, const PlannedTrial& t, const Law& law) {
  TrialResult result;
  if (!t.unsupported.empty()) result.fail("unsupported", t.unsupported, 0);
  store.put(t, t.unsupported.empty() ? law(t.axes) : result, timeStamp(), 0);
}

struct Found {
  std::map<std::string, std::set<long>> settings;  // by method and budget; 0: none found
  long rows = 0, asked = 0;                        // trials planned; trials measured for the search
  bool operator==(const Found&) const = default;
};

// Works as `lpc sweep`, with rows from `law`; stops after `rounds` rounds.
Found search(const std::string& path, Store& store, const Law& law, int rounds = 100,
             const std::vector<std::string>& only = {}, bool retry = false) {
  PlannedSweep sweep = planSweeps(path, only).at(0);
  Found out;
  std::set<std::string> here;
  const auto done = [&](const std::string& key) {
    const auto outcome = store.outcome(key);
    return outcome && !(retry && *outcome == "timeout" && !here.count(key));
  };
  calibrate(
      sweep, store,
      [&](const PlannedSweep& round) {
        if (rounds-- <= 0) return false;
        for (const PlannedTrial& t : round.trials) {
          if (!done(t.key)) write(store, t, law), ++out.asked;
          here.insert(t.key);
        }
        return true;
      },
      done);
  store.plan(sweep, only.empty());
  for (const PlannedTrial& t : sweep.trials) {
    if (rounds >= 0 && !store.outcome(t.key)) write(store, t, law);
    out.settings[t.axes.at("resolver").get<std::string>() + " " + t.axes.at("budget").dump()].insert(
        t.axes.value("n", 0L));
  }
  out.rows = static_cast<long>(sweep.trials.size());
  return out;
}

std::string rowsPlanned(const std::string& store, const std::string& where = "1") {
  return ask(store, "SELECT count(*) FROM planned p LEFT JOIN trial t ON p.key = t.key WHERE " + where);
}

// A step with n iterations takes n/2 ms; a disturbed repeat takes twenty times as long.
TrialResult halfMillisecondEach(const json& axes) {
  TrialResult r;
  r.metrics["ms_per_step_median"] = 0.5 * axes.at("n").get<double>() * (axes.at("repeat").get<int>() < 2 ? 20 : 1);
  return r;
}

TEST(CalibrationSearch, ATimeIsTheMedianOfAllRepeats) {
  Workspace w;
  const std::string path = w.write("s.toml", twoMethods("ms_per_step_median", kTimed));
  Store store(w.path("s.db"), true);
  const auto right = [](const Found& found) {
    return found.settings == std::map<std::string, std::set<long>>{
                                 {"catto 1.0", {2}}, {"catto 4.5", {9}}, {"soft 1.0", {2}}, {"soft 4.5", {9}}};
  };
  const Found found = search(path, store, halfMillisecondEach);
  EXPECT_TRUE(right(found)) << json(found.settings);
  EXPECT_EQ(found.rows, 2 * 2 * 5) << "each budget has all its repeats";
  Store other(w.path("mean.db"), true);
  test::expectCaught("the first repeat alone decides", right(search(path, other, [](const json& axes) {
                       json first = axes;
                       first["repeat"] = 0;
                       return halfMillisecondEach(first);
                     })));
  const Found again = search(path, store, halfMillisecondEach);
  EXPECT_EQ(again.asked, 0) << "what the store has is not measured again, though it is a time";
  EXPECT_EQ(again.settings, found.settings);
}

// All seeds share one setting, found from the median of the first five, so that a disturbed one does not decide. Each
// seed has its trials at that setting.
TEST(CalibrationSearch, SeedsHaveOneSetting) {
  Workspace w;
  std::string text = twoMethods("ms_per_step_median", "timed = true\nbudgets = [4.5]\n");
  text.insert(text.find("[axes.resolver]"), "seed = [1, 2, 3, 4, 5, 6, 7]\nperturb = 0.001\n");
  const std::string path = w.write("s.toml", text);
  Store store(w.path("s.db"), true);
  // Half a millisecond an iteration, except the first two seeds, which are disturbed, and the last two, which the
  // search does not use.
  const auto law = [](const json& axes) {
    const long seed = axes.at("seed");
    TrialResult r;
    r.metrics["ms_per_step_median"] = 0.5 * axes.at("n").get<double>() * (seed < 3 ? 20 : seed > 5 ? 0.1 : 1);
    return r;
  };
  const Found found = search(path, store, law);
  const auto right = [](const Found& f) {
    return f.settings == std::map<std::string, std::set<long>>{{"catto 4.5", {9}}, {"soft 4.5", {9}}};
  };
  EXPECT_TRUE(right(found)) << json(found.settings);
  EXPECT_EQ(found.rows, 2 * 7) << "every seed has a trial at the setting";
  EXPECT_EQ(rowsPlanned(w.path("s.db"), "json_extract(p.axes, '$.seed') = 7"), "2");
  Store other(w.path("first.db"), true);
  test::expectCaught("the first seed alone decides", right(search(path, other, [&](const json& axes) {
                       json first = axes;
                       first["seed"] = 1;
                       return law(first);
                     })));
  EXPECT_EQ(search(path, store, law).asked, 0);
}

TEST(CalibrationSearch, AResumedSearchEndsAsAnUninterruptedOne) {
  Workspace w;
  const std::string path = w.write("s.toml", twoMethods("ms_per_step_median", kTimed));
  Store whole(w.path("whole.db"), true);
  const Found straight = search(path, whole, halfMillisecondEach, 100, {"catto"});
  for (int rounds = 0; rounds < 8; ++rounds) {
    SCOPED_TRACE(rounds);
    const std::string name = w.path(std::to_string(rounds) + ".db");
    Store store(name, true);
    const Found stopped = search(path, store, halfMillisecondEach, rounds, {"catto"});
    EXPECT_EQ(rowsPlanned(name), "10") << "what is missing is told";
    Found resumed = search(path, store, halfMillisecondEach, 100, {"catto"});
    EXPECT_EQ(stopped.asked + resumed.asked, straight.asked);
    EXPECT_EQ(resumed.settings, straight.settings);
    EXPECT_EQ(rowsPlanned(name), "10");
    EXPECT_EQ(rowsPlanned(name, "t.key IS NULL"), "0") << "rows of the stopped search stay for ever";
    search(path, store, halfMillisecondEach, 100, {"soft"});
    EXPECT_EQ(rowsPlanned(name), "20") << "another part is added, and takes nothing away";
  }
}

// Timeouts of a temporarily slow machine are measured again on request, once.
TEST(CalibrationSearch, RetryReachesTheSearch) {
  Workspace w;
  const std::string path = w.write("s.toml", twoMethods("work_row_updates", "budgets = [8]\n"));
  Store store(w.path("s.db"), true);
  const auto quick = [&](const json& axes) {
    TrialResult r;
    r.metrics["work_row_updates"] = axes.value("n", 0.0);
    return r;
  };
  const auto slow = [&](const json& axes) {
    if (axes.value("n", 0L) < 4) return quick(axes);
    TrialResult r;
    r.fail("timeout", "no result within 1 s", -1);
    return r;
  };
  using Settings = std::map<std::string, std::set<long>>;
  EXPECT_EQ(search(path, store, slow).settings, (Settings{{"catto 8.0", {3}}, {"soft 8.0", {3}}}));
  EXPECT_EQ(search(path, store, quick).asked, 0);
  const Found retried = search(path, store, quick, 100, {}, true);
  EXPECT_EQ(retried.settings, (Settings{{"catto 8.0", {8}}, {"soft 8.0", {8}}}));
  EXPECT_EQ(rowsPlanned(w.path("s.db")), "2");
  EXPECT_EQ(search(path, store, slow, 100, {}, true).asked, 0) << "nothing is left to be run again";
}

// The same through the command, with a timeout row that the test writes.
TEST(CalibrationSearch, RetryOfTheCommandReachesTheSearch) {
  Workspace w;
  const std::string path = w.write("s.toml", twoMethods("work_row_updates", "budgets = [1e9]\n"));
  {
    Store store(w.path("s.db"), true);
    const PlannedSweep sweep = planSweeps(path, {}).at(0);
    for (const CalibratedCell& cell : sweep.calibrated) {
      write(store, cell.plan(1).at(0), [](const json&) {
        TrialResult r;
        r.fail("timeout", "no result within 1 s", -1);
        return r;
      });
    }
  }
  const std::string ended = "t.outcome = 'unsupported' AND t.reason LIKE 'n=1 ends in timeout: no result%'";
  ASSERT_EQ(w.lpc("sweep s.toml --store s.db --quiet").code, 0);
  EXPECT_EQ(rowsPlanned(w.path("s.db"), ended), "2");
  const Outcome out = w.lpc("sweep s.toml --store s.db --quiet --retry --only catto");
  ASSERT_EQ(out.code, 0) << out.text;
  EXPECT_EQ(rowsPlanned(w.path("s.db"), "t.outcome = 'ok' AND p.axes LIKE '%\"n\":64%'"), "1");
  EXPECT_EQ(rowsPlanned(w.path("s.db"), ended), "1") << "the other method was not asked for";
  EXPECT_EQ(rowsPlanned(w.path("s.db")), "2") << "the cell has one row";
}

// Methods that agree at one iteration, and groups that share budgets.
TEST(CalibrationSearch, NoMethodAndNoBudgetIsLost) {
  Workspace w;
  const std::string path = w.write("s.toml", R"(
summary = "s"
kind = "world"
calibrate = { equal = "cost", metric = "work_row_updates", setting = "n", most = 64 }
[axes]
scene = "pendulum"
[axes.resolver]
"sub" = "solver=soft_step{substeps=$n,relax=1}"
"relax" = "solver=soft_step{substeps=1,relax=$n}"
"fixed" = "solver=soft_step{substeps=3,relax=1}"
[[group]]
budgets = [500]
[[group]]
budgets = [1000, 500]
)");
  const PlannedSweep sweep = planSweeps(path, {}).at(0);
  std::map<std::string, std::vector<double>> budgets;
  std::set<std::string> atOne;
  for (const CalibratedCell& cell : sweep.calibrated) {
    budgets[cell.axes.at("resolver")] = cell.budgets;
    atOne.insert(cell.plan(1).at(0).key);
  }
  const std::vector<double> both = {500, 1000};
  EXPECT_EQ(budgets, (std::map<std::string, std::vector<double>>{{"sub", both}, {"relax", both}, {"fixed", both}}));
  test::expectCaught("methods that agree at one iteration are one", atOne.size() == budgets.size());
  EXPECT_EQ(sweep.calibrated.size(), 3u) << "a cell in which groups meet is one";
}

TEST(CalibrationSearch, TheLargestSettingIsPlannedFirst) {
  Workspace w;
  std::string text = twoMethods("work_row_updates", "budgets = [1e9]\n");
  w.write("s.toml", text.replace(text.find("most = 64"), 9, "most = 200000"));
  const Outcome out = w.lpc("sweep s.toml --store never.db");
  EXPECT_EQ(out.code, 2);
  EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
  for (const char* part : {"s.toml:11: ", "'iterations' of 'catto' is '200000'", "100000", "most = 200000"}) {
    EXPECT_NE(out.text.find(part), std::string::npos) << part << "\n" << out.text;
  }
  EXPECT_FALSE(std::filesystem::exists(w.path("never.db")));
}

// The timed code names the parts of a step, so a wrong name is detected only after a run.
TEST(CalibrationSearch, AnUnknownMetricIsAMistake) {
  Workspace w;
  w.write("s.toml", twoMethods("work_row_update", "budgets = [8]\n"));
  const Outcome counts = w.lpc("sweep s.toml --store never.db");
  EXPECT_EQ(counts.code, 2);
  EXPECT_NE(counts.text.find("s.toml:3: 'work_row_update' is not a metric of cost; did you mean 'work_row_updates'?"),
            std::string::npos)
      << counts.text;
  EXPECT_FALSE(std::filesystem::exists(w.path("never.db")));

  const auto times = [](const json& axes) {
    TrialResult r;
    r.metrics["us_solver"] = 3 * axes.at("n").get<double>();
    if (axes.at("resolver") == "soft") r.metrics["us_solver_relax"] = axes.at("n").get<double>();
    return r;
  };
  const auto message = [&](const std::string& metric) -> std::string {
    Store store(w.path(metric + ".db"), true);
    try {
      search(w.write("s.toml", twoMethods(metric, kTimed)), store, times);
    } catch (const UserError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message("us_slover")
                .find("s.toml:3: no trial of the sweep has the metric 'us_slover'; did you mean "
                      "'us_solver'? valid: us_solver, us_solver_relax"),
            std::string::npos)
      << message("us_slover");
  EXPECT_EQ(message("us_solver"), "");
  EXPECT_EQ(message("us_solver_relax"), "") << "one method has it: the other has a row with the reason";
}

// With --with and --set, as in any sweep.
TEST(CalibrationSearch, TakesAMethodAndAValueOfTheCommandLine) {
  Workspace w;
  const std::string path = w.write("s.toml", twoMethods("work_row_updates", "budgets = [8]\n"));
  const auto sweep =
      planSweeps(path, {}, {"mine=solver=split_solver{velocity=millington{iteration_factor=$n}}"}, {"steps=7"}).at(0);
  std::set<std::string> methods;
  for (const CalibratedCell& cell : sweep.calibrated) {
    methods.insert(cell.axes.at("resolver").get<std::string>());
    EXPECT_EQ(cell.axes.at("steps"), 7);
    for (const PlannedTrial& t : cell.plan(5)) EXPECT_EQ(t.canonical.at("steps"), 7);
  }
  EXPECT_EQ(methods, (std::set<std::string>{"catto", "soft", "mine"}));
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::calibration_search_test
