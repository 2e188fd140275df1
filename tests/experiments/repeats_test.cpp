// SPDX-License-Identifier: Zlib
// Repeats of timed trials: their order, and what each reports.
#include <algorithm>

#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace repeats_test { namespace {

using test::ask;
using test::Workspace;

// Repeat and method of the timed trials, in the order in which they finished.
std::vector<std::pair<int, std::string>> inOrder(const std::string& store) {
  std::vector<std::pair<int, std::string>> out;
  SQLite::Database db(store, SQLite::OPEN_READONLY);
  SQLite::Statement s(db,
                      "SELECT json_extract(canonical, '$.repeat'), json_extract(canonical, '$.broadphase') FROM trial "
                      "WHERE timed = 1 ORDER BY rowid");
  while (s.executeStep()) out.emplace_back(s.getColumn(0).getInt(), s.getColumn(1).getString());
  return out;
}

// Whether each round holds every cell once, and the cell of the method that is timed twice as often twice.
bool inRounds(std::vector<std::pair<int, std::string>> trials, int repeats, const std::string& twice) {
  const std::size_t size = trials.size() / static_cast<std::size_t>(repeats);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const int turn = trials[i].second == twice ? trials[i].first / 2 : trials[i].first;
    if (turn != static_cast<int>(i / size)) return false;
  }
  return true;
}

TEST(Repeats, areInterleavedAndOneMethodIsTimedTwice) {
  Workspace w;
  const std::string text =
      "summary = \"s\"\nkind = \"boxes\"\ntimed = true\nrepeats = 3\ntwice = \"naive\"\n[axes]\ndimension = 2\n"
      "distribution = \"uniform\"\nframes = 11\nn = 8\nbroadphase = [\"naive\", \"region_tree\", \"uniform_grid\"]\n";
  w.write("s.toml", text);
  ASSERT_EQ(w.lpc("sweep ./s.toml --quiet --store s.db").code, 0);
  auto trials = inOrder(w.path("s.db"));
  ASSERT_EQ(trials.size(), 3u * 4u);
  std::string naive;
  for (const auto& [repeat, method] : trials) {
    if (method.starts_with("naive")) naive = method;
  }
  EXPECT_TRUE(inRounds(trials, 3, naive));
  std::stable_sort(trials.begin(), trials.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  EXPECT_FALSE(inRounds(trials, 3, naive)) << "one cell after another was not seen";
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM trial WHERE json_extract(metrics, '$.load') >= 0"), "12");
  w.write("t.toml", "twice = \"nobody\"\n" + text.substr(0, text.find("twice")) + text.substr(text.find("[axes]")));
  EXPECT_NE(w.lpc("sweep ./t.toml --dry-run").text.find("no axis has the value 'nobody'; valid: naive, region_tree"),
            std::string::npos);
  w.write("t.toml", "summary = \"s\"\nkind = \"boxes\"\n" + text.substr(text.find("twice")));
  const test::Outcome untimed = w.lpc("sweep ./t.toml --dry-run");
  EXPECT_EQ(untimed.code, 2) << untimed.text;
  EXPECT_NE(untimed.text.find("t.toml:3: 'twice' without times; valid: timed = true"), std::string::npos)
      << untimed.text;
}

TEST(Repeats, afterTheFirstReportOnlyTimes) {
  Workspace w;
  w.write("s.toml",
          "summary = \"s\"\nkind = \"world\"\ntimed = true\nrepeats = 2\n[axes]\nscene = \"vertical_stack\"\nn = 3\n"
          "steps = 80\n");
  ASSERT_EQ(w.lpc("sweep ./s.toml --quiet --store s.db").code, 0);
  const auto of = [&](int repeat, const std::string& what) {
    return ask(w.path("s.db"), "SELECT " + what + " FROM trial t WHERE json_extract(canonical, '$.repeat') = " +
                                   std::to_string(repeat));
  };
  EXPECT_EQ(of(0, "hash"), of(1, "hash"));
  EXPECT_EQ(of(0, "outcome"), "ok");
  EXPECT_EQ(of(0, "(SELECT count(*) > 0 FROM poses s WHERE s.key = t.key)"), "1");
  EXPECT_EQ(of(1, "(SELECT count(*) > 0 FROM poses s WHERE s.key = t.key)"), "0");
  EXPECT_EQ(of(0, "(SELECT count(*) > 9 FROM series s WHERE s.key = t.key)"), "1");
  EXPECT_EQ(of(1, "(SELECT group_concat(name) FROM series s WHERE s.key = t.key)"), "seconds");
  const auto metric = [&](int repeat, const std::string& name) {
    return of(repeat, "json_extract(metrics, '$." + name + "')");
  };
  EXPECT_EQ(metric(0, "max_penetration"), metric(1, "max_penetration"));
  EXPECT_NE(metric(0, "penetration_poses"), "");
  EXPECT_EQ(metric(1, "penetration_poses"), "") << "unknown, and not 0";
  for (const int repeat : {0, 1}) {
    EXPECT_GT(std::stod(metric(repeat, "ms_per_step_median")), 0);
    EXPECT_GE(std::stod(metric(repeat, "ms_per_step_p99")), std::stod(metric(repeat, "ms_per_step_median")));
    EXPECT_GE(std::stod(metric(repeat, "ms_per_step_worst")), std::stod(metric(repeat, "ms_per_step_p99")));
  }
  EXPECT_GT(std::stod(metric(0, "residual_median")), 0);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::repeats_test
