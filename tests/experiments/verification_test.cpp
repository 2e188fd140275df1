// SPDX-License-Identifier: Zlib
// `lpc verify` as a program: blocks, resuming, lost workers, kept failures.
#include "experiments/runner/verification.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "experiments/runner/store.h"
#include "framework/math/random.h"
#include "tests/check_property.h"
#include "tests/experiments/process.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace verification_test { namespace {

using test::ask;
using test::Outcome;
using test::Workspace;

const std::string kPlugin = LPC_BINARY_DIR "/lib/liblpc_planted.so";

// The ledger as text, without times.
std::string ledgerText(const std::string& path) {
  std::string out;
  for (const auto& [k, e] : Store(path, false).ledger()) {
    out += k.stage + k.precision + std::to_string(k.dimension) + k.kindA + k.kindB + k.axis + k.value + k.method;
    for (const long n : e.tallies) out += " " + std::to_string(n);
    for (const auto& [decade, n] : e.histogram) out += " " + decade + ":" + std::to_string(n);
    out += " " + std::to_string(e.maxError * 1e20) + e.worst + "\n";
  }
  return out;
}

TEST(Verification, RecordsOnceAndContinues) {
  Workspace w;
  const std::string command = "verify --stage pair_query,broadphase --dimension 2 --methods closed_form naive --quiet";
  const Outcome first = w.lpc(command);
  ASSERT_EQ(first.code, 0) << first.text;
  EXPECT_NE(first.text.find("LPC's own methods: all correct"), std::string::npos) << first.text;
  const std::string store = w.path("results/verify.db"), once = ledgerText(store);
  EXPECT_NE(once.find("closed_form"), std::string::npos);
  EXPECT_NE(w.lpc(command).text.find(": 0 inputs tested"), std::string::npos);
  EXPECT_EQ(ledgerText(store), once);
  // More pairs and other seeds add up.
  const std::string all = "SELECT sum(asked) FROM ledger WHERE axis='all' AND method='closed_form'";
  const long asked = std::stol(ask(store, all));
  ASSERT_EQ(w.lpc(command + " --pairs 400").code, 0);
  EXPECT_EQ(std::stol(ask(store, all)), 2 * asked);
  ASSERT_EQ(w.lpc(command + " --seed 2").code, 0);
  EXPECT_EQ(std::stol(ask(store, all)), 3 * asked);
  for (const char* axis : {"family", "regime", "scale", "offset"}) {
    EXPECT_EQ(std::stol(ask(store, "SELECT sum(asked) FROM ledger WHERE method='closed_form' AND axis='" +
                                       std::string(axis) + "'")),
              3 * asked)
        << axis;
  }
}

// Changes that must not affect the answer are tested together with the answers, and recorded once.
TEST(Verification, MetamorphicIsRecordedOnce) {
  Workspace w;
  const std::string plain = "verify --stage pair_query --dimension 2 --methods closed_form --quiet";
  const std::string command = plain + " --metamorphic";
  const Outcome first = w.lpc(command);
  ASSERT_EQ(first.code, 0) << first.text;
  EXPECT_NE(first.text.find("violations per million"), std::string::npos) << first.text;
  const std::string store = w.path("results/verify.db"), once = ledgerText(store);
  EXPECT_EQ(ask(store, "SELECT DISTINCT axis FROM ledger"), "relation");
  EXPECT_NE(w.lpc(command).text.find(": 0 inputs tested"), std::string::npos);
  EXPECT_EQ(ledgerText(store), once);
  EXPECT_EQ(w.lpc(plain).text.find(": 0 inputs tested"), std::string::npos);
  EXPECT_EQ(w.lpc("verify --metamorphic --stage contacts").code, 2);
}

// If a method's code changes, the numbers recorded with the old code leave its sums.
TEST(Verification, ChangedCodeStartsAgain) {
  Workspace w;
  const std::string command = "verify --stage broadphase --dimension 2 --methods naive sort_and_sweep --quiet";
  ASSERT_EQ(w.lpc(command).code, 0);
  const std::string store = w.path("results/verify.db"), before = ledgerText(store);
  {
    SQLite::Database db(store, SQLite::OPEN_READWRITE);
    db.exec("UPDATE verified_block SET key='old' || key, code='old' WHERE method='naive'");
    db.exec("UPDATE ledger SET asked = asked + 7 WHERE method='naive'");
  }
  const Outcome again = w.lpc(command);
  EXPECT_NE(again.text.find(": 200 inputs tested"), std::string::npos) << again.text;
  EXPECT_EQ(ledgerText(store), before);
}

// Killed at random moments, with its workers, and restarted, it ends with the result of an uninterrupted run.
TEST(Verification, ResumesAfterSigkill) {
  Workspace w;
  const std::string arguments =
      "verify --stage pair_query --dimension 2 --role competitor --pairs 600 --quiet --store ";
  ASSERT_EQ(w.lpc(arguments + "whole.db").code, 0);
  Random random(test::seedOf("verify, killed"));
  const int most = std::clamp(test::caseCount(6), 2, 30);
  int kills = 0, workers = 0;
  for (int turn = 0; (kills < most || workers == 0) && turn < 10 * most; ++turn) {
    test::Process verify(w, arguments + "pieces.db");
    const auto wait = [&] { std::this_thread::sleep_for(std::chrono::milliseconds(random.below(40))); };
    if (verify.isBusy(w.path("pieces.db"))) {
      wait();
      for (const pid_t worker : verify.workers()) workers += kill(worker, SIGKILL) == 0;
      wait();
      verify.signal(SIGKILL);
    }
    if (verify.wait() == 128 + SIGKILL) {
      ++kills;
    } else {  // it had finished
      EXPECT_EQ(ledgerText(w.path("pieces.db")), ledgerText(w.path("whole.db")));
      std::filesystem::remove(w.path("pieces.db"));
    }
  }
  EXPECT_GE(kills, most);
  EXPECT_GT(workers, 0);
  const Outcome last = w.lpc(arguments + "pieces.db");
  ASSERT_EQ(last.code, 0) << last.text;
  EXPECT_EQ(ledgerText(w.path("pieces.db")), ledgerText(w.path("whole.db")));
}

// A method that crashes its worker is isolated pair by pair; the others keep their answers.
TEST(Verification, CrashesAndWrongAnswersAreRecordedAndKept) {
  Workspace w;
  const std::string command = "--plugin " + kPlugin +
                              " verify --stage pair_query --dimension 2 --quiet --store v/s.db --methods planted_abort "
                              "planted_half closed_form";
  const Outcome run = w.lpc(command);
  ASSERT_EQ(run.code, 1) << run.text;
  const auto tally = [&](const std::string& column, const std::string& method) {
    return std::stol(ask(w.path("v/s.db"), "SELECT sum(" + column +
                                               ") FROM ledger WHERE axis='all' AND kind_a='sphere' "
                                               "AND kind_b='sphere' AND method='" +
                                               method + "'"));
  };
  EXPECT_EQ(tally("asked", "planted_abort"), kVerifyBlock);
  EXPECT_GT(tally("crashed", "planted_abort"), 0);
  EXPECT_EQ(tally("crashed + agree + tie", "planted_abort"), kVerifyBlock);
  EXPECT_GT(tally("wrong", "planted_half"), 0);
  EXPECT_EQ(tally("crashed + refused + not_finite", "planted_half"), 0);
  EXPECT_EQ(tally("agree + tie", "closed_form"), kVerifyBlock);
  // The simplest pair of each failure is saved in a file that can be replayed with all methods.
  EXPECT_TRUE(std::filesystem::exists(w.path("v/s.db.found/planted_abort-crashed-2d-f64.json")));
  // Without the plugin it does not count as fixed.
  const Outcome gone = w.lpc("verify --cases v/s.db.found/planted_half-wrong_distance-2d-f64.json");
  EXPECT_EQ(gone.code, 2);
  EXPECT_TRUE(
      gone.text.starts_with("lpc: v/s.db.found/planted_half-wrong_distance-2d-f64.json: case 'pair_query-2d-f64-"))
      << gone.text;
  EXPECT_NE(gone.text.find("': the method 'planted_half' is neither built in nor of a --plugin; valid: "),
            std::string::npos)
      << gone.text;
  EXPECT_EQ(std::count(gone.text.begin(), gone.text.end(), '\n'), 1) << gone.text;
  const Outcome replay =
      w.lpc("--plugin " + kPlugin + " verify --cases v/s.db.found/planted_half-wrong_distance-2d-f64.json");
  EXPECT_EQ(replay.code, 1);
  EXPECT_NE(replay.text.find("planted_half"), std::string::npos) << replay.text;
  // The pair with the largest error of each method that was wrong is saved, too.
  const std::string worst = "v/s.db.found/planted_half-worst-2d-f64.json", largest = ask(w.path("v/s.db"), R"(
      SELECT max(max_error) FROM ledger WHERE method='planted_half' AND axis='all')");
  std::ifstream in(w.path(worst));
  const nlohmann::json kept = nlohmann::json::parse(in);
  EXPECT_NEAR(kept.at("cases").at(0).at("found").at("error").get<double>(), std::stod(largest), 1e-12);
  EXPECT_EQ(w.lpc("--plugin " + kPlugin + " verify --cases " + worst).code, 1);
  EXPECT_FALSE(std::filesystem::exists(w.path("v/s.db.found/closed_form-worst-2d-f64.json")));
  EXPECT_NE(run.text.find("worst pair of this method: v/s.db.found/planted_half-worst-2d-f64.json"), std::string::npos);
  // A new store of this name removes the failures of the old one, and keeps other files.
  w.write("v/s.db.found/notes.json", readFile(w.path(worst)));
  std::filesystem::remove(w.path("v/s.db"));
  ASSERT_EQ(w.lpc("verify --stage pair_query --dimension 2 --quiet --store v/s.db --methods closed_form").code, 0);
  std::vector<std::string> left;
  for (const auto& file : std::filesystem::directory_iterator(w.path("v/s.db.found"))) {
    left.push_back(file.path().filename().string());
  }
  EXPECT_EQ(left, std::vector<std::string>{"notes.json"});
}

// Each kept failure, of any stage and precision, wrong or crashed, is queried again in the precision in which it was
// found and with the method's parameters. It fails again with the same error.
TEST(Verification, EveryKeptFailureFailsAgain) {
  Workspace w;
  const std::string plugin = "--plugin " + kPlugin + " ";
  const std::string precisions = test::kSingle ? "f64,f32" : "f64";
  w.lpc(plugin +
        "verify --stage pair_query,broadphase --dimension 2 --quiet --store s.db --methods planted_abort "
        "planted_half planted_forget");
  w.lpc("verify --stage pair_query --dimension 2 --quiet --store s.db --precision " + precisions +
        " --methods bullet_gjk_epa libccd_mpr{tolerance=1e-14}");
  // Each case is in its own file; here all are in one.
  nlohmann::json all = {{"cases", nlohmann::json::array()}};
  for (const auto& file : std::filesystem::directory_iterator(w.path("s.db.found"))) {
    std::ifstream in(file.path());
    all["cases"].push_back(nlohmann::json::parse(in).at("cases").at(0));
  }
  w.write("all.json", all.dump());
  EXPECT_GE(all["cases"].size(), test::kSingle ? 10u : 7u);
  const Outcome run = w.lpc(plugin + "verify --cases all.json");
  EXPECT_EQ(run.code, 1) << run.text;  // the planted ones are LPC's
  const std::string n = std::to_string(all["cases"].size());
  EXPECT_NE(run.text.find("failures found earlier: " + n + ", of which " + n + " still fail\n"), std::string::npos)
      << run.text;
  for (const nlohmann::json& c : all["cases"]) {
    const auto& found = c.at("found");
    const std::string id = c.at("id"), method = found.at("method"), failure = found.at("failure");
    // The method's line; its error is printed with two digits.
    std::string line;
    std::istringstream lines(run.text);
    while (std::getline(lines, line)) {
      if (line.starts_with(id + " ") && line.find(" " + method + " ") != line.npos &&
          line.ends_with("fails again: " + failure))
        break;
    }
    EXPECT_TRUE(line.starts_with(id)) << id << ' ' << method << ' ' << failure << '\n' << run.text;
  }
  EXPECT_NE(all.dump().find("planted_forget"), std::string::npos);
  EXPECT_NE(all.dump().find("\"crashed\""), std::string::npos);
  EXPECT_NE(all.dump().find("libccd_mpr{tolerance=1e-14}"), std::string::npos);
}

TEST(Verification, FoundCasesRunInTheirOwnPrecision) {
  if (!test::kSingle) GTEST_SKIP() << "this build has no f32";
  Workspace w;
  const std::string found = LPC_SOURCE_DIR "/tests/regressions/found_cases.json";
  const Outcome run = w.lpc("verify --cases " + found);
  EXPECT_EQ(run.code, 0) << run.text;
  EXPECT_NE(run.text.find(", of which 0 still fail\n"), std::string::npos) << run.text;
  // A case with a number beyond its precision fails alone; each other is asked.
  w.write("large.json", R"({"cases": [{"id": "x", "dim": 2, "query": "broadphase", "slots": 1, "steps": [[{"added": 0,
    "lo": [0, 0], "hi": [1e300, 1], "body": 0, "active": true, "category": 1, "mask": 1}]], "expected": {}, "found":
    {"stage": "broadphase", "precision": "f32", "method": "naive", "failure": "x", "error": null, "seed": 1, "number": 1}},
    {"id": "y", "dim": 2, "query": "signed_distance", "shapeA": {"type": "circle", "radius": 1}, "poseA": {"t": [0, 0]},
    "shapeB": {"type": "circle", "radius": 1}, "poseB": {"t": [3, 0]}}, {"id": "z", "dim": 2}]})");
  EXPECT_EQ(w.lpc("verify --cases large.json").text, "lpc: large.json: case 'z': field 'query' is missing\n");
  for (const std::string precision : {"f64", "f32"}) {
    const Outcome large = w.lpc("verify --cases large.json --skip-broken --csv x.csv --precision " + precision);
    EXPECT_EQ(large.code, 0) << large.text;
    EXPECT_NE(large.text.find("cases that cannot be read, skipped: 2\n"), std::string::npos) << large.text;
    const std::string csv = readFile(w.path("x.csv"));
    EXPECT_NE(csv.find("x,-,f32,refused,,,,\"field 'hi' holds 1.0000000000000001e+300, which is too large for f32\"\n"),
              csv.npos)
        << csv;
    EXPECT_NE(csv.find("y,gjk_epa," + precision + ",ok,1,1,0,\"\"\n"), csv.npos) << csv;
    EXPECT_NE(csv.find("z,-,f64,refused,,,,\"field 'query' is missing\"\n"), csv.npos) << csv;
  }
  const Outcome both = w.lpc("verify --cases large.json --skip-broken --precision f32,f64");
  EXPECT_NE(both.text.find("\ngjk_epa              ok 2\n"), both.text.npos) << both.text;
  const Outcome half =
      w.lpc("verify --cases " + w.write("half.json", R"({"cases": [{"id": "x", "dim": 2, "query": "contacts",
    "found": {"stage": "contacts", "precision": "f16", "method": "sat", "failure": "x", "seed": 1, "number": 1},
    "expected": {"signed_distance": 0}}]})"));
  EXPECT_EQ(half.code, 2);
  EXPECT_NE(half.text.find("field 'precision' holds 'f16'; valid: f64, f32"), std::string::npos) << half.text;
}

// If a method crashes its worker, only methods of LPC count as faults.
TEST(Verification, LostWorkersAreFaultsOnlyOfOurMethods) {
  Workspace w;
  std::filesystem::create_directory(w.path("bin"));
  const auto worker = [&](const std::string& ofMethods, const std::string& ofReferee) {
    w.write("bin/lpc-worker-f64",
            "#!/bin/sh\nrequest=$(cat)\ncase \"$request\" in *'\"questions\":[[0,\"referee\"]]'*) " + ofReferee +
                ";; *) " + ofMethods + ";; esac\n");
    std::filesystem::permissions(w.path("bin/lpc-worker-f64"), std::filesystem::perms::owner_all);
  };
  const std::string right = "printf %s \"$request\" | " LPC_BINARY_DIR "/bin/lpc-worker-f64", crash = "kill -SEGV $$";
  worker(crash, right);
  const std::string shape = R"({"type": "box", "half_extents": [1, 1]})";
  w.write("c.json", R"({"cases": [{"id": "x", "dim": 2, "query": "signed_distance", "shapeA": )" + shape +
                        R"(, "shapeB": )" + shape + R"(, "poseA": {"t": [0, 0]}, "poseB": {"t": [3, 0]},
    "expected": {"signed_distance": 1}, "found": {"stage": "pair_query", "precision": "f64", "method": "sat",
    "failure": "crashed", "error": null, "seed": 1, "number": 1}}]})");
  const Outcome run = w.lpc("verify --cases c.json", "LPC_WORKERS=" + w.path("bin"));
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.text.find("referee"), std::string::npos) << run.text;
  EXPECT_NE(run.text.find("failures found earlier: 1, of which 1 still fail\nwrong answers of LPC's own methods: 6\n"),
            std::string::npos)
      << "by_kind, closed_form, core_margin, gjk_epa, mpr, sat\n" + run.text;
  // Any other end of a worker is not the method's fault, and without the referee there is no verdict.
  for (const auto& [ofMethods, ofReferee] : {std::pair<std::string, std::string>("exit 1", right),
                                             {"kill -KILL $$", right},
                                             {"echo none", right},
                                             {crash, crash},
                                             {crash, "exit 1"}}) {
    worker(ofMethods, ofReferee);
    const Outcome none = w.lpc("verify --cases c.json", "LPC_WORKERS=" + w.path("bin"));
    EXPECT_EQ(none.code, 1) << ofMethods << none.text;
    EXPECT_TRUE(none.text.starts_with("lpc: x, ")) << ofMethods << none.text;
    EXPECT_EQ(std::count(none.text.begin(), none.text.end(), '\n'), 1) << none.text;
  }
}

// A witness that is judged at one tolerance must be allowed that tolerance: FCL's default is 1e-6. All are also queried
// away from the origin, as an engine would.
TEST(Verification, WitnessesAlsoRunAtTheirTightestToleranceAndAwayFromTheOrigin) {
  int tight = 0;
  for (const Registered* r : Registry::instance().list(StageKind::pairQuery, 3)) {
    const std::vector<Spec> specs = specsToVerify(*r);
    ASSERT_FALSE(specs.empty());
    EXPECT_EQ(specs[0].text(), r->info.name);
    const bool foreign = r->info.name.starts_with("fcl_") || r->info.name.starts_with("libccd_");
    const bool witness = r->info.role == AlgorithmRole::witness;
    ASSERT_EQ(specs.size(), foreign   ? 3u
                            : witness ? 2u
                                      : 1u)
        << r->info.name << ": ours have their defaults, Bullet's "
        << "are constants";
    if (witness) {
      EXPECT_EQ(specs.back().text(), r->info.name + "{frame=world}");
    }
    if (!foreign) continue;
    EXPECT_EQ(specs[1].text(), r->info.name + "{tolerance=1e-14}");
    EXPECT_NO_THROW(r->create(specs[1]));
    ++tight;
  }
  EXPECT_EQ(tight, 5);
}

TEST(Verification, SinglePrecisionRunsInItsOwnWorker) {
  if (!test::kSingle) GTEST_SKIP() << "this build has no f32";
  Workspace w;
  ASSERT_EQ(w.lpc("verify --stage pair_query --dimension 2 --precision f32 --methods closed_form --quiet").code, 0);
  EXPECT_EQ(ask(w.path("results/verify.db"), "SELECT DISTINCT precision FROM ledger"), "f32");
  EXPECT_GT(std::stod(ask(w.path("results/verify.db"), "SELECT max(max_error) FROM ledger")), 1e-9);
}

TEST(Verification, StoresMergeByMethod) {
  Workspace w;
  const std::string command = "verify --stage broadphase --dimension 2 --quiet --methods ";
  ASSERT_EQ(w.lpc(command + "naive --store a.db").code, 0);
  ASSERT_EQ(w.lpc(command + "naive sort_and_sweep --store b.db").code, 0);
  ASSERT_EQ(w.lpc("merge a.db b.db").code, 0);
  EXPECT_EQ(ledgerText(w.path("a.db")), ledgerText(w.path("b.db")));
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::verification_test
