// SPDX-License-Identifier: Zlib
// Equal cost and equal error: a sweep finds the setting that arithmetic gives, or a run of every setting.
#include "experiments/runner/calibration.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace calibration_test { namespace {

using nlohmann::json;
using test::ask;
using test::Outcome;
using test::Workspace;

// A pendulum has no contacts: each sweep over the rows costs the same, so row updates are proportional to iterations.
const std::string kPendulum = R"(
summary = "s"
kind = "world"
pipeline = "solver=split_solver{velocity=catto{iterations=$iterations},position=none}"
)";
const std::string kAxes = "[axes]\nscene = \"pendulum\"\ndimension = 2\nsteps = 30\n";

std::string calibrated(const std::string& equal, const std::string& metric, const std::string& budgets,
                       const std::string& more = "") {
  return "calibrate = { equal = \"" + equal + "\", metric = \"" + metric + "\", setting = \"iterations\"" + more +
         " }\nbudgets = [" + budgets + "]\n";
}

struct Cell {
  long iterations = 0;  // 0: none found
  std::string outcome, reason;
  double value = 0;
};

// The store's rows of the sweep `s`, by budget.
std::map<double, Cell> cellsOf(const std::string& store, const std::string& metric) {
  std::map<double, Cell> out;
  SQLite::Database db(store, SQLite::OPEN_READONLY);
  SQLite::Statement s(db,
                      "SELECT p.axes, t.outcome, t.reason, t.metrics FROM planned p LEFT JOIN trial t ON p.key = t.key "
                      "WHERE p.sweep = 's'");
  while (s.executeStep()) {
    const json axes = json::parse(s.getColumn(0).getString());
    Cell& cell = out[axes.at("budget").get<double>()];
    cell.iterations = axes.value("iterations", 0L), cell.outcome = s.getColumn(1).getString();
    cell.reason = s.getColumn(2).getString();
    const json metrics = json::parse(s.getColumn(3).getString());
    if (metrics.contains(metric)) cell.value = metrics[metric];
  }
  return out;
}

// The metric by iterations, each setting run on its own.
std::map<long, double> measured(const Workspace& w, const std::string& head, const std::string& axes,
                                const std::string& metric, const std::string& iterations) {
  w.write("plain.toml", head + axes + "iterations = [" + iterations + "]\n");
  EXPECT_EQ(w.lpc("sweep plain.toml --store plain.db --quiet").code, 0);
  std::map<long, double> out;
  SQLite::Database db(w.path("plain.db"), SQLite::OPEN_READONLY);
  SQLite::Statement s(db, "SELECT p.axes, t.metrics FROM planned p JOIN trial t ON p.key = t.key");
  while (s.executeStep()) {
    out[json::parse(s.getColumn(0).getString()).at("iterations").get<long>()] =
        json::parse(s.getColumn(1).getString()).at(metric).get<double>();
  }
  return out;
}

// The most iterations within the budget if one costs `each`.
long affordable(double budget, double each) { return static_cast<long>(std::floor(budget / each)); }

TEST(Calibration, EqualCostIsWhatArithmeticGives) {
  Workspace w;
  const auto cost = measured(w, kPendulum, kAxes, "work_row_updates", "1, 2, 7, 40");
  const double each = cost.at(1);
  ASSERT_GT(each, 0);
  for (const auto& [iterations, value] : cost) ASSERT_DOUBLE_EQ(value, static_cast<double>(iterations) * each);

  const std::vector<double> budgets = {0.5 * each, each, 5 * each, 5.9 * each, 23.5 * each, 90 * each};
  std::string list;
  for (const double b : budgets) list += (list.empty() ? "" : ", ") + json(b).dump();
  w.write("s.toml", kPendulum + calibrated("cost", "work_row_updates", list, ", most = 64") + kAxes);
  const Outcome plan = w.lpc("sweep s.toml --store s.db --dry-run");  // 1, 2, .. 64, then between 32 and 64
  EXPECT_NE(plan.text.find(" 6 trials, 0 timed, 0 unsupported, after 6 searches of iterations at budgets of "
                           "work_row_updates (1 cell), each over at most 12 settings\n"),
            std::string::npos)
      << plan.text;
  const Outcome first = w.lpc("sweep s.toml --store s.db --quiet");
  ASSERT_EQ(first.code, 0) << first.text;
  EXPECT_EQ(test::ask(w.path("s.db"), "SELECT count(*) FROM planned"), "6") << "as the dry run has it";
  const auto cells = cellsOf(w.path("s.db"), "work_row_updates");
  ASSERT_EQ(cells.size(), budgets.size()) << "a budget vanished";
  const auto wrong = [&](const std::function<long(double)>& wanted) {
    for (const auto& [budget, cell] : cells) {
      if (cell.iterations != wanted(budget)) return true;
    }
    return false;
  };
  EXPECT_FALSE(wrong([&](double b) { return std::min(64L, affordable(b, each)); }));
  test::expectCaught("one iteration over the budget",
                     !wrong([&](double b) { return std::min(64L, affordable(b, each) + 1); }));
  test::expectCaught("no largest setting", !wrong([&](double b) { return affordable(b, each); }));
  EXPECT_DOUBLE_EQ(cells.at(budgets[4]).value, 23 * each) << "the cell is run at what was found";

  const Cell& none = cells.at(budgets[0]);
  EXPECT_EQ(none.outcome, "unsupported");
  EXPECT_EQ(none.reason,
            "iterations=1 costs " + asText(each) + " (work_row_updates), the budget is " + asText(each / 2));

  const Outcome second = w.lpc("sweep s.toml --store s.db --quiet");
  EXPECT_NE(second.text.find(" 0 run,"), std::string::npos) << second.text;
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM planned"), "6");
  EXPECT_EQ(json::parse(ask(w.path("s.db"), "SELECT roles FROM sweep"))["calibrate"],
            json({{"equal", "cost"}, {"metric", "work_row_updates"}, {"setting", "iterations"}, {"most", 64}}));
}

// The error of a stack of four falls as its iterations grow; the test runs each setting on its own.
TEST(Calibration, EqualErrorTakesTheFewestIterations) {
  Workspace w;
  const std::string metric = "penetration_poses";
  const std::string axes = "[axes]\nscene = \"vertical_stack\"\nn = 4\ngap = 0\ndimension = 2\nsteps = 60\n";
  const auto error = measured(w, kPendulum, axes, metric, "1, 2, 3, 4, 5, 6, 7, 8");
  for (long i = 2; i <= 8; ++i) ASSERT_LT(error.at(i), error.at(i - 1)) << "the test needs another scene";
  const double between = (error.at(5) + error.at(6)) / 2;
  w.write("s.toml", kPendulum +
                        calibrated("error", metric, json(between).dump() + ", " + json(error.at(1)).dump() + ", 1e-15",
                                   ", most = 8") +
                        axes);
  const Outcome out = w.lpc("sweep s.toml --store s.db --quiet");
  ASSERT_EQ(out.code, 0) << out.text;
  const auto cells = cellsOf(w.path("s.db"), metric);
  EXPECT_EQ(cells.at(between).iterations, 6);
  EXPECT_EQ(cells.at(error.at(1)).iterations, 1);
  EXPECT_EQ(cells.at(1e-15).iterations, 0);
  EXPECT_EQ(cells.at(1e-15).reason, "iterations=8, the most, has the error " + asText(error.at(8)) +
                                        " (penetration_poses), the budget is 1e-15");
}

// Methods without the setting or the dimension, or that stop early: each has its rows.
TEST(Calibration, MethodsThatCannotBeSearchedHaveRows) {
  Workspace w;
  w.write("s.toml", R"(
summary = "s"
kind = "world"
)" + calibrated("cost", "work_row_updates", "100", ", most = 16") +
                        R"([axes]
scene = "pendulum"
dimension = 2
steps = 10
[axes.resolver]
"catto" = "solver=split_solver{velocity=catto{iterations=$iterations},position=none}"
"fixed" = "solver=split_solver{velocity=catto{iterations=3},position=none}"
"bullet" = "engine=bullet{iterations=$iterations}"
)");
  const Outcome out = w.lpc("sweep s.toml --store s.db --quiet");
  ASSERT_EQ(out.code, 0) << out.text;
  const auto of = [&](const std::string& method, const std::string& what) {
    return ask(w.path("s.db"), "SELECT " + what +
                                   " FROM planned p JOIN trial t ON p.key = t.key WHERE axes LIKE '%\"resolver\":\"" +
                                   method + "\"%'");
  };
  EXPECT_EQ(of("catto", "outcome"), "ok");
  EXPECT_FALSE(json::parse(of("fixed", "axes")).contains("iterations")) << "it has one setting, and says so";
  EXPECT_EQ(of("bullet", "outcome"), "unsupported");
  EXPECT_FALSE(of("bullet", "reason").empty());
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM planned"), "3");
}

TEST(Calibration, MistakesAreOneLine) {
  Workspace w;
  const std::string good = calibrated("cost", "work_row_updates", "10");
  const std::pair<std::string, std::vector<const char*>> cases[] = {
      {calibrated("price", "work_row_updates", "10") + kAxes, {"s.toml:5: ", "'price'", "cost, error"}},
      {calibrated("cost", "penetration_poses", "10") + kAxes,
       {"s.toml:5: ", "is not a metric of cost", "ms_per_step_median"}},
      {calibrated("error", "work_row_updates", "10") + kAxes,
       {"s.toml:5: ", "is not a metric of error", "penetration_poses"}},
      {calibrated("error", "penetrations", "10") + kAxes, {"s.toml:5: ", "'penetrations'", "max_penetration"}},
      {calibrated("cost", "ms_per_step_median", "10") + kAxes, {"s.toml:", "a time", "timed = true"}},
      {calibrated("cost", "work_row_updates", "") + kAxes, {"s.toml:6: ", "'budgets' is empty"}},
      {calibrated("cost", "work_row_updates", "-1") + kAxes, {"s.toml:6: ", "-1", "above 0"}},
      {calibrated("cost", "work_row_updates", "5, 5") + kAxes, {"s.toml:6: ", "5 twice"}},
      {calibrated("cost", "work_row_updates", "5", ", most = 0") + kAxes, {"s.toml:5: ", "'most' is 0", "1 to"}},
      {calibrated("cost", "work_row_updates", "5", ", least = 0") + kAxes, {"s.toml:5: ", "least"}},
      {good + kAxes + "iterations = [1, 2]\n", {"s.toml:11: ", "'iterations' is set by 'calibrate'"}},
      {"calibrate = { equal = \"cost\", metric = \"work_row_updates\", setting = \"budget\" }\nbudgets = [5]\n" + kAxes,
       {"s.toml:5: ", "'setting' is 'budget'", "another name"}},
      {"budgets = [5]\n" + kAxes, {"s.toml:5: ", "'budgets' without 'calibrate'"}},
      {"calibrate = \"cost\"\n" + kAxes, {"s.toml:5: ", "'calibrate' is the string 'cost'", "a table"}},
      {good.substr(0, good.find("budgets")) + kAxes, {"s.toml:", "'calibrate' needs budgets"}}};
  for (const auto& [text, parts] : cases) {
    w.write("s.toml", kPendulum + text);
    const Outcome out = w.lpc("sweep s.toml --store never.db");
    EXPECT_EQ(out.code, 2) << text << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
    for (const char* part : parts) EXPECT_NE(out.text.find(part), std::string::npos) << text << out.text;
  }
  EXPECT_FALSE(std::filesystem::exists(w.path("never.db")));
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::calibration_test
