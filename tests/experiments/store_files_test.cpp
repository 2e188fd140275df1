// SPDX-License-Identifier: Zlib
// Where a store is: names that SQLite reads in its own way, media that cannot be written, a folder that is gone. What
// is imported into it.
#include <nlohmann/json.hpp>

#include "tests/experiments/process.h"
#include "tests/experiments/refused.h"

namespace lpc { inline namespace LPC_PRECISION { namespace store_files_test { namespace {

using nlohmann::json;
using test::ask;
using test::filesIn;
using test::Outcome;
using test::Process;
using test::refused;
using test::Workspace;

json benchmark() { return {{"name", "broadphase/2D/naive/64"}, {"cpu_time", 1.5}, {"real_time", 2}}; }
std::string imported(const json& entries, const json& context = json::object()) {
  return json{{"context", context}, {"benchmarks", entries}}.dump();
}

TEST(StoreFiles, AnyNameIsThatOfAFile) {
  Workspace w;
  w.write("b.json", imported(json::array({benchmark()})));
  for (const std::string name : {"a?b#c%d.db", "file:a.db", "file:///a.db?mode=memory", ":memory:", "?", "new/#?.db"}) {
    const Outcome out = w.lpc("import-benchmark b.json --store '" + name + "'");
    ASSERT_EQ(out.code, 0) << name << out.text;
    ASSERT_TRUE(std::filesystem::exists(w.path(name))) << name;
    EXPECT_EQ(ask(w.path(name), "SELECT count(*) FROM benchmark"), "1") << name;
    EXPECT_EQ(w.lpc("merge m.db '" + name + "'").text, name + ": 0 trials copied\n");
  }
  EXPECT_EQ(filesIn(w).size(), 10u) << "six stores, two folders, m.db and b.json";
  const std::string longest(255 - 8, 'x');  // SQLite adds "-journal"
  EXPECT_EQ(w.lpc("import-benchmark b.json --store " + longest).code, 0);
  const std::vector<std::string> invalid = {"", "new/", "b.json/x.db", "absent/" + longest + "y",
                                            "absent/" + longest + "yyyyyyyyy"};
  for (const std::string& name : invalid) {
    for (const std::string command :
         {"import-benchmark b.json", "verify --pairs 1", "needs pyramid", "sweep streams --dry-run"}) {
      refused(w, command + " --store '" + name + "'", {name.empty() ? "name of the store is empty" : name});
    }
  }
  const auto before = filesIn(w);
  EXPECT_EQ(w.lpc("sweep streams --dry-run --store absent/file:x.db").code, 0);
  EXPECT_EQ(filesIn(w), before) << "a dry run creates nothing";
}

// A folder named as SQLite's -wal file has the effect of a read-only medium, for root too.
TEST(StoreFiles, AReadOnlyMediumIsRead) {
  Workspace w;
  w.write("b.json", imported(json::array({benchmark()})));
  ASSERT_EQ(w.lpc("import-benchmark b.json --store 'a?%.db'").code, 0);
  std::filesystem::create_directory(w.path("a?%.db-wal"));
  const auto before = readFile(w.path("a?%.db"));
  EXPECT_EQ(w.lpc("merge m.db 'a?%.db'").text, "a?%.db: 0 trials copied\n");
  refused(w, "import-benchmark b.json --store 'a?%.db'", {"a?%.db: "});
  EXPECT_EQ(readFile(w.path("a?%.db")), before);
}

TEST(StoreFiles, OnlyBenchmarksAreImported) {
  Workspace w;
  const auto without = [](const char* field) {
    json out = benchmark();
    out.erase(field);
    return out;
  };
  const auto with = [](const char* field, const json& value) {
    json out = benchmark();
    out[field] = value;
    return out;
  };
  for (const json& entry : std::vector<json>{nullptr,
                                             5,
                                             "x",
                                             json::array(),
                                             without("name"),
                                             without("cpu_time"),
                                             without("real_time"),
                                             with("name", 7),
                                             with("name", {"a"}),
                                             with("run_name", 7),
                                             with("run_name", nullptr),
                                             with("cpu_time", nullptr),
                                             with("cpu_time", "1.5"),
                                             with("real_time", -1),
                                             with("real_time", true),
                                             with("time_unit", "min"),
                                             with("time_unit", 3),
                                             with("run_type", 3),
                                             with("aggregate_name", 3),
                                             with("name", std::string(301, 'x'))}) {
    w.write("b.json", imported(json::array({benchmark(), entry})));
    refused(w, "import-benchmark b.json --store s.db", {"b.json: benchmark 1: "});
  }
  for (const json& context : std::vector<json>{3, {{"load_avg", {"x"}}}, {{"load_avg", {nullptr}}}}) {
    w.write("b.json", imported(json::array({benchmark()}), context));
    refused(w, "import-benchmark b.json --store s.db", {"b.json: "});
  }
  json failed = {{"name", "x"}, {"error_occurred", true}, {"error_message", "did not start"}};
  json fit = {{"name", "x_BigO"}, {"run_type", "aggregate"}, {"aggregate_name", "BigO"}, {"cpu_coefficient", 1}};
  w.write("b.json",
          imported(json::array({benchmark(), failed, fit, with("time_unit", "ms"), with("run_type", "iteration")})));
  EXPECT_EQ(w.lpc("import-benchmark b.json --store s.db").text, "5 benchmarks imported into s.db\n");
  EXPECT_NE(ask(w.path("s.db"), "SELECT count(*) FROM metrics"), "0") << "the report asks what metrics mean";
}

TEST(StoreFiles, ADeletedFolderIsToldInOneLine) {
  Workspace w;
  const char* gone = "mkdir gone && cd gone && rmdir ../gone && " LPC_BINARY_DIR "/bin/lpc ";
  for (const std::string command :
       {"verify --pairs 1", "sweep streams --dry-run", "import-benchmark x.json", "replay x.rec", "needs pyramid",
        "merge a.db b.db", "verify --cases x.json", "run pyramid --record x.rec"}) {
    const Outcome out = w.shell(gone + command);
    EXPECT_EQ(out.code, 2) << command << '\n' << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << command << '\n' << out.text;
    EXPECT_EQ(out.text.find("filesystem error"), std::string::npos) << command << '\n' << out.text;
  }
}

// Both while Python is looked for and while it runs.
TEST(StoreFiles, AnInterruptEndsAReport) {
  Workspace w;
  w.write("b.json", imported(json::array({benchmark()})));
  ASSERT_EQ(w.lpc("import-benchmark b.json --store s.db").code, 0);
  for (const char* pause : {"case $1 in -c) touch busy; exec sleep 100;; esac",
                            "case $1 in -c) exit 0;; esac\ntouch busy\nexec sleep 100"}) {
    w.write("python", std::string("#!/bin/sh\n") + pause + "\n");
    std::filesystem::permissions(w.path("python"), std::filesystem::perms::owner_all);
    std::filesystem::remove(w.path("busy"));
    setenv("LPC_PYTHON", w.path("python").c_str(), 1);
    Process process(w, "report s.db --out out");
    unsetenv("LPC_PYTHON");
    while (!process.ended() && !std::filesystem::exists(w.path("busy"))) usleep(1000);
    process.signal(SIGINT);
    const int code = process.wait();
    EXPECT_TRUE(code == 130 || code == 128 + SIGINT) << code << process.said();
    EXPECT_EQ(process.said().find("do not import"), std::string::npos) << process.said();
  }
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::store_files_test
