// SPDX-License-Identifier: Zlib
// What holds for every store of a sweep, whether the sweep was killed, resumed, reordered or run in parallel. Stores of
// wrong runners break these rules.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <set>
#include <thread>

#include "experiments/runner/trial_plan.h"
#include "framework/math/random.h"
#include "tests/check_property.h"
#include "tests/experiments/process.h"
#include "tests/experiments/workspace.h"
#include "tests/planted_bugs/store_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace sweep_rules_test { namespace {

using nlohmann::json;
using test::ask;
using test::Outcome;
using test::timeless;
using test::Workspace;

const std::string kPlugin = LPC_BINARY_DIR "/lib/liblpc_planted.so";

// Depends on the moment, not on the trial: times, and the machine's load.
bool isTime(const std::string& metric) {
  return metric.starts_with("ns_") || metric.starts_with("ms_") || metric == "load";
}

// The rules that this store breaks.
std::vector<std::string> broken(const std::string& store) {
  std::vector<std::string> faults;
  SQLite::Database db(store, SQLite::OPEN_READONLY);
  SQLite::Statement open(db, "SELECT count(*) FROM planned p LEFT JOIN trial t ON p.key = t.key WHERE t.key IS NULL");
  open.executeStep();
  if (open.getColumn(0).getInt() > 0) faults.push_back("a planned cell has no row");

  std::map<std::string, std::set<std::string>> names;  // metrics, by kind of trial
  std::map<std::string, std::map<std::string, double>> repeats;
  SQLite::Statement s(db,
                      "SELECT t.key, t.canonical, t.outcome, t.metrics, t.commit_id, m.description "
                      "FROM trial t LEFT JOIN machine m ON t.machine = m.id ORDER BY t.key");
  while (s.executeStep()) {
    const std::string key = s.getColumn(0).getString();
    json canonical = json::parse(s.getColumn(1).getString());
    const auto fault = [&](const std::string& what) { faults.push_back("row " + key + " " + what); };
    for (const char* needed : {"seed", "precision", "core", "code", "repeat"}) {
      if (!canonical.contains(needed)) fault("does not name its " + std::string(needed));
    }
    if (trialKey(canonical) != key) fault("is not what its key says");
    if (s.getColumn(4).getString().empty()) fault("does not name its build");
    if (s.getColumn(5).isNull()) fault("does not name its machine");
    if (s.getColumn(2).getString() != "ok" || !canonical.contains("repeat")) continue;

    std::set<std::string> here;
    std::map<std::string, double> values;
    const json metrics = json::parse(s.getColumn(3).getString());
    for (const auto& [name, value] : metrics.items()) {
      here.insert(name);
      if (!isTime(name)) values[name] = value.is_number() ? value.get<double>() : 0;
    }
    const std::string kind = canonical.at("kind").get<std::string>() + (canonical.at("timed") ? ", timed" : "");
    if (names.emplace(kind, here).first->second != here) fault("has other metrics than the rest of its kind");
    canonical.erase("repeat"), canonical.erase("timed");
    if (repeats.emplace(canonical.dump(), values).first->second != values) fault("measures otherwise when repeated");
  }
  return faults;
}

// Key, start and duration of each row with outcome ok: a resume must not change them.
std::map<std::string, std::string> rows(const std::string& store) {
  std::map<std::string, std::string> out;
  SQLite::Database db(store, SQLite::OPEN_READONLY);
  SQLite::Statement s(db, "SELECT key, started || ' ' || wall FROM trial WHERE outcome = 'ok'");
  while (s.executeStep()) out[s.getColumn(0).getString()] = s.getColumn(1).getString();
  return out;
}
bool leftAlone(const std::map<std::string, std::string>& before, const std::map<std::string, std::string>& after) {
  for (const auto& [key, row] : before) {
    const auto found = after.find(key);
    if (found == after.end() || found->second != row) return false;
  }
  return true;
}

// Cells, some with metrics that are 0; repeated, timed and untimed.
std::string sweepText(const std::string& sizes, const std::string& methods) {
  return "summary = \"s\"\nkind = \"boxes\"\ntimed = true\nuntimed = true\nrepeats = 2\n"
         "[axes]\ndimension = 2\ndistribution = \"uniform\"\nframes = 14\nn = [" +
         sizes + "]\nbroadphase = [" + methods + "]\n";
}
const std::string kSizes = "8, 16, 32", kMethods = "\"naive\", \"planted_slow\", \"region_tree\"";

std::string sweepCommand(const std::string& store, const std::string& more = "") {
  return "--plugin " + kPlugin + " sweep s.toml --quiet --store " + store + " " + more;
}

// The text of a store without metrics that are times.
std::string untimed(const std::string& store) {
  const std::string copy = store + ".untimed";
  std::filesystem::copy_file(store, copy, std::filesystem::copy_options::overwrite_existing);
  SQLite::Database(copy, SQLite::OPEN_READWRITE)
      .exec(
          "UPDATE trial SET metrics = (SELECT json_group_object(key, value) FROM json_each(metrics) "
          "WHERE key != 'load' AND key NOT LIKE 'ns\\_%' ESCAPE '\\' AND key NOT LIKE 'ms\\_%' ESCAPE '\\')");
  return timeless(copy);
}

TEST(SweepRules, HoldForARightStoreAndNotForWrongOnes) {
  Workspace w;
  w.write("s.toml", sweepText(kSizes, kMethods));
  ASSERT_EQ(w.lpc(sweepCommand("right.db")).code, 0);
  const std::string right = w.path("right.db"), text = timeless(right);
  EXPECT_EQ(broken(right), std::vector<std::string>{});
  for (const test::StoreTwin& twin : test::kStoreTwins) {
    const std::string wrong = w.path("wrong.db");
    std::filesystem::copy_file(right, wrong, std::filesystem::copy_options::overwrite_existing);
    test::damage(wrong, twin);
    const bool caught = !broken(wrong).empty() || !leftAlone(rows(right), rows(wrong)) || timeless(wrong) != text;
    EXPECT_TRUE(caught) << twin.name;
  }
}

TEST(SweepRules, NeitherOrderNorParallelismMatters) {
  Workspace w;
  w.write("s.toml", sweepText(kSizes, kMethods));
  ASSERT_EQ(w.lpc(sweepCommand("one.db", "--jobs 1")).code, 0);
  w.write("s.toml", sweepText("32, 8, 16", "\"region_tree\", \"naive\", \"planted_slow\""));
  ASSERT_EQ(w.lpc(sweepCommand("turned.db", "--jobs 4")).code, 0);
  EXPECT_EQ(untimed(w.path("turned.db")), untimed(w.path("one.db")));
}

// Twenty kills of runners that start or work; before half of them all workers are killed, too. No row is run twice or
// written half, and the result equals that of an uninterrupted sweep.
TEST(SweepRules, SurviveTwentyKills) {
  Workspace w;
  w.write("s.toml", sweepText("8, 16, 24, 32, 40, 48", kMethods));
  ASSERT_EQ(w.lpc(sweepCommand("whole.db")).code, 0);
  const std::string pieces = w.path("pieces.db");
  const auto endsAsTheWhole = [&] {
    const Outcome last = w.lpc(sweepCommand("pieces.db", "--retry"));
    ASSERT_EQ(last.code, 0) << last.text;
    EXPECT_EQ(broken(pieces), std::vector<std::string>{});
    EXPECT_EQ(untimed(pieces), untimed(w.path("whole.db")));
    EXPECT_NE(w.lpc(sweepCommand("pieces.db", "--retry")).text.find(" 0 run"), std::string::npos);
  };
  Random random(test::seedOf("twenty kills"));
  const int most = std::clamp(test::caseCount(20), 10, 250);  // more would take minutes
  int kills = 0, workers = 0;
  std::map<std::string, std::string> before;
  for (int turn = 0; (kills < most || workers == 0) && turn < 10 * most && !HasFailure(); ++turn) {
    test::Process sweep(w, sweepCommand("pieces.db", "--retry"));
    const auto wait = [&] { std::this_thread::sleep_for(std::chrono::milliseconds(random.below(40))); };
    if (kills % 5 && !sweep.isBusy(pieces)) {  // all is done
      endsAsTheWhole();
      std::filesystem::remove(pieces);
      before.clear();
      continue;
    }
    wait();
    if (kills % 2) {
      for (const pid_t worker : sweep.workers()) workers += kill(worker, SIGKILL) == 0;
      wait();
    }
    sweep.signal(SIGKILL);
    kills += sweep.wait() == 128 + SIGKILL;
    if (!std::filesystem::exists(pieces)) continue;
    try {
      const auto after = rows(pieces);
      EXPECT_TRUE(leftAlone(before, after)) << "after kill " << kills;
      before = after;
    } catch (const SQLite::Exception&) {  // killed before its tables existed
      EXPECT_TRUE(before.empty());
    }
  }
  EXPECT_GE(kills, most);
  EXPECT_GT(workers, 0);

  // A journal with a truncated end, as after a crash of the machine: committed rows are kept, the rest is run again.
  const std::filesystem::path journal = pieces + "-wal";
  if (std::filesystem::exists(journal) && std::filesystem::file_size(journal) > 100) {
    std::filesystem::resize_file(journal, std::filesystem::file_size(journal) - 100);
  }
  endsAsTheWhole();
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::sweep_rules_test
