// SPDX-License-Identifier: Zlib
// The corpus of published hard cases, with every method that supports them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <tuple>

#include "framework/math/check.h"
#include "framework/shape/curved_core.h"
#include "framework/stage/stage_narrowphase.h"
#include "oracles/referee/referee.h"
#include "oracles/verify/case_run.h"
#include "oracles/witnesses/witness_process.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

const std::string kCorpus = std::string(LPC_SOURCE_DIR) + "/tests/regressions/hard_cases.json";

TEST(Corpus, IsReadWhole) {
  const std::vector<Case> cases = readCases(kCorpus);
  EXPECT_EQ(cases.size(), 95u);
  std::set<std::string> ids;
  int distances = 0, shapes = 0;
  for (const Case& c : cases) {
    EXPECT_TRUE(ids.insert(c.id).second) << c.id;
    EXPECT_FALSE(c.source.empty()) << c.id;
    EXPECT_NE(c.query, CaseQuery::unknown) << c.id << ": " << c.queryText;
    distances += c.query == CaseQuery::signedDistance;
    std::visit([&](const auto& g) { shapes += g.a.shape && g.b.shape; }, c.geometry);
  }
  EXPECT_EQ(distances, 84);
  EXPECT_EQ(shapes, 84 + 5);  // five pairs are moving
}

TEST(Corpus, CapsulesTurnFromTheirAxis) {
  for (const Case& c : readCases(kCorpus)) {
    if (c.id == "fcl-test-capsule-box-1") {
      const auto& capsule = std::get<CaseGeometry<3>>(c.geometry).a;  // along z in the file
      ASSERT_TRUE(capsule.shape);
      const Vec<3> along = capsule.X_WS.q * Vec<3>::Unit(0);
      EXPECT_NEAR(std::abs(along[2]), 1, 1e-15);
    }
    if (c.id == "parry-205-capsule-triangle") {
      const auto& capsule = std::get<CaseGeometry<2>>(c.geometry).a;  // from (0, -5) to (0, 5)
      ASSERT_TRUE(capsule.shape);
      EXPECT_EQ(capsule.shape->view().half[0], 5);
      EXPECT_NEAR(std::abs((capsule.X_WS.q * Vec<2>::Unit(0))[1]), 1, 1e-15);
    }
  }
}

// For each method, its verdict on each case.
std::map<std::string, std::string> verdictTables(const std::vector<CaseResult>& rows) {
  std::map<std::string, std::string> tables;
  for (const CaseResult& row : rows) {
    std::string& table = tables.try_emplace(row.method, "id,verdict\n").first->second;
    table += row.id + ',' + std::string(caseVerdictName(row.verdict)) + '\n';
  }
  return tables;
}

std::vector<std::string> linesOf(std::istream& in) {
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// The verdict of every method on every case is pinned, for our methods and the libraries, one file per method. A
// changed library shows case by case, and a new method adds its file.
TEST(Corpus, VerdictsAreThePinnedOnes) {
  namespace fs = std::filesystem;
  const fs::path pinned = fs::path(LPC_SOURCE_DIR) / "tests/regressions/verdicts",
                 found = fs::path(LPC_BINARY_DIR) / "verdicts";
  fs::remove_all(found);
  fs::create_directories(found);
  std::set<std::string> methods;
  for (const auto& [method, table] : verdictTables(runCases(readCases(kCorpus)))) {
    if (method == "-") continue;  // a query that no method supports
    methods.insert(method + ".csv");
    std::ofstream(found / (method + ".csv")) << table;
    std::ifstream file(pinned / (method + ".csv"));
    std::istringstream text(table);
    const std::vector<std::string> want = linesOf(file), have = linesOf(text);
    EXPECT_EQ(want.size(), have.size()) << method;
    for (std::size_t i = 0; i < std::min(want.size(), have.size()); ++i) EXPECT_EQ(have[i], want[i]) << method;
  }
  for (const auto& file : fs::directory_iterator(pinned)) {
    EXPECT_TRUE(methods.contains(file.path().filename())) << file.path() << " is of no method";
  }
  if (HasNonfatalFailure())
    std::cout << "when that is meant: cp " << found.string() << "/* " << pinned.string() << '\n';
}

// Prints the same table as `lpc verify --cases`.
TEST(Corpus, OursAreRight) {
  std::ostringstream table, csv;
  const int exitCode = verifyCases(kCorpus, table, &csv);
  std::cout << table.str();
  EXPECT_EQ(exitCode, 0);
  // Both begin with a header; the table ends with counts by method and of our faults.
  std::istringstream lines(table.str()), rows(csv.str());
  const std::vector<std::string> have = linesOf(lines), inFile = linesOf(rows);
  ASSERT_GT(inFile.size(), 800u);
  EXPECT_EQ(inFile[0], "id,method,precision,verdict,value,expected,error,reason");
  std::istringstream header(have[0]);
  std::string names;
  for (std::string word; header >> word;) names += (names.empty() ? "" : ",") + word;
  EXPECT_EQ(names, "id,method,precision,verdict,value,expected,error/s,reason");
  for (std::size_t i = 1; i < inFile.size(); ++i) {
    std::istringstream words(have[i]);
    std::string id, method, precision, verdict;
    words >> id >> method >> precision >> verdict;
    EXPECT_TRUE(inFile[i].starts_with(id + ',' + method + ',' + precision + ',' + verdict + ','))
        << inFile[i] << " against " << have[i];
    EXPECT_TRUE(inFile[i].ends_with('"')) << inFile[i];
  }
}

// Pairs on which one of our methods was wrong once.
TEST(Corpus, FoundCasesStayRight) {
  std::ostringstream table;
  const int exitCode = verifyCases(std::string(LPC_SOURCE_DIR) + "/tests/regressions/found_cases.json", table);
  std::cout << table.str();
  EXPECT_EQ(exitCode, 0);
}

TEST(Corpus, TheRefereeConfirmsEveryExpectedValue) {
  int confirmed = 0;
  for (const CaseResult& row : runCases(readCases(kCorpus))) {
    if (row.role != AlgorithmRole::referee) continue;
    EXPECT_EQ(row.verdict, CaseVerdict::ok) << row.id << ": " << row.value << " against " << row.expected;
    ++confirmed;
  }
  EXPECT_EQ(confirmed, 84 + 5);
}

// Each of these wrong methods must be found and must not stop the run: a corpus that cannot fail is useless.
template <int D>
class WrongWitness final : public IsolatedWitness<3> {
 public:
  static inline int mode = 0;  // 0 right, 1 too deep, 2 flipped normal, 3 NaN, 4 throws, 5 aborts, 6 never returns
  using Params = NoParams;
  explicit WrongWitness(const Params&) {}
  static AlgorithmInfo info() {
    return {.name = "planted_wrong",
            .summary = "wrong on purpose",
            .paper = "",
            .complexity = "1",
            .role = AlgorithmRole::witness};
  }
  bool supports(ShapeKind a, ShapeKind b) const override { return a == ShapeKind::box && b == ShapeKind::box; }

 private:
  void place(const PairView<3>& pair) override { m_depth = 2 * pair.a.half[2] - std::abs(pair.X_AB.p[2]); }
  PairAnswer<3> measure() override {
    if (mode == 4) throw std::runtime_error("planted");
    if (mode == 5) std::abort();
    for (volatile int turns = 0; mode == 6;) turns = turns + 1;
    // Correct for libccd-25-cubes, along z, only.
    PairAnswer<3> answer;
    answer.status = QueryStatus::converged;
    answer.distance = mode == 1 ? Real(-1.1) * m_depth : mode == 3 ? std::nan("") : -m_depth;
    answer.normal = Vec<3>::Unit(2) * Real(mode == 2 ? -1 : 1);
    return answer;
  }

  Real m_depth = 0;
};

// With the file's expected value, or without.
CaseResult cubes(int mode, bool stated = true) {
  static const Registrar<PairQuery, WrongWitness, 3> planted(__FILE__);  // after the table above is printed
  WrongWitness<3>::mode = mode;
  std::vector<Case> cases = readCases(kCorpus);
  std::erase_if(cases, [](const Case& c) { return c.id != "libccd-25-cubes"; });
  if (!stated) cases[0].expected = {};
  for (const CaseResult& row : runCases(cases)) {
    if (row.method == "planted_wrong") return row;
  }
  return {};
}

TEST(Corpus, SeesPlantedWrongMethods) {
  EXPECT_EQ(cubes(0).verdict, CaseVerdict::ok);
  EXPECT_EQ(cubes(1).verdict, CaseVerdict::wrong);
  EXPECT_EQ(cubes(2).verdict, CaseVerdict::wrong);
  EXPECT_EQ(cubes(0, false).verdict, CaseVerdict::ok) << "the referee knows";
  EXPECT_EQ(cubes(1, false).verdict, CaseVerdict::wrong);
  EXPECT_EQ(cubes(2, false).verdict, CaseVerdict::wrong);
  EXPECT_EQ(cubes(3).verdict, CaseVerdict::failed);
  EXPECT_EQ(cubes(3).reason, "not_finite");
  EXPECT_EQ(cubes(4).verdict, CaseVerdict::failed);
  EXPECT_EQ(cubes(4).reason, "threw");
  EXPECT_EQ(cubes(5).verdict, CaseVerdict::failed);
  EXPECT_EQ(cubes(5).reason, "crashed");
  EXPECT_EQ(cubes(6).verdict, CaseVerdict::hang);
  CaseResult ours = cubes(1);
  EXPECT_FALSE(isOurFault(ours));  // it is registered as a witness
  ours.role = AlgorithmRole::competitor;
  EXPECT_TRUE(isOurFault(ours));
  WrongWitness<3>::mode = 0;
}

std::string written(const std::string& text) {
  const std::string path = std::filesystem::temp_directory_path() / ("lpc_cases_" + std::to_string(getpid()) + ".json");
  std::ofstream(path) << text;
  return path;
}

std::string complaint(const std::string& path) {
  try {
    readCases(path);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(Corpus, BadFilesAreRefusedInOneLine) {
  const std::string head = R"({"cases": [{"id": "x", "dim": 2, "query": "signed_distance", )";
  const std::vector<std::pair<std::string, std::string>> bad = {
      {"{", "parse error"},
      {"{}", "no list 'cases'"},
      {R"({"cases": [{}]})", "'id' is missing"},
      {head + R"("shapeA": {"type": "box"}}]})", "'poseA' is missing"},
      {head + R"("expected": 3, "shapeA": {"type": "circle", "radius": 1}, "poseA": {"t": [0, 0]},
        "shapeB": {"type": "circle", "radius": 1}, "poseB": {"t": [0, 0]}}]})",
       "'expected' holds 3; valid: an object"},
      {head + R"("expected": {}, "shapeA": {"type": "box"}, "poseA": {"t": [0]}}]})", "valid: 2 numbers"},
      {head + R"("expected": {}, "shapeA": {"type": "box"}, "poseA": {"t": [0, 0]}}]})", "'half_extents' is missing"},
  };
  for (const auto& [text, what] : bad) {
    const std::string path = written(text), message = complaint(path);
    EXPECT_NE(message.find(what), std::string::npos) << text << " gave: " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
    EXPECT_NE(message.find(path), std::string::npos);
    std::filesystem::remove(path);
  }
  EXPECT_EQ(complaint("/nowhere.json"), "/nowhere.json: cannot be read: No such file or directory");
  EXPECT_EQ(complaint("/tmp"), "/tmp: cannot be read: Is a directory");
  const std::string empty = written("");
  EXPECT_EQ(complaint(empty), empty + ": is empty");
  std::filesystem::remove(empty);
}

// A ball of radius 1/2 at a height of 5/2 above the half-space y <= 0, at rest or falling at 4 m/s.
std::string pairCase(const std::string& id, const std::string& query, const std::string& expected) {
  const bool moves = query == "time_of_impact";
  return R"({"id": ")" + id + R"(", "dim": 3, "query": ")" + query + R"(", "shapeA": {"type": "half_space"},
    "poseA": {"t": [0, 0, 0]}, "shapeB": {"type": "sphere", "radius": 0.5}, "poseB": {"t": [0, 2.5, 0]})" +
         (moves ? R"(, "velocityB": [0, -4, 0], "tmax": 1)" : "") +
         (expected.empty() ? "" : ", \"expected\": " + expected) + "}";
}
std::vector<Case> casesOf(const std::string& list, BrokenCases broken = BrokenCases::refused) {
  return parseCases("{\"cases\": [" + list + "]}", "c.json", broken);
}

// The referee knows the distance and the time. Where the file is wrong the methods are not.
TEST(Corpus, ExpectedValuesMayBeAbsentOrWrong) {
  const std::tuple<const char*, const char*, double> queries[] = {
      {"signed_distance", "signed_distance", 2}, {"contacts", "signed_distance", 2}, {"time_of_impact", "toi", 0.5}};
  for (const auto& [query, field, right] : queries) {
    const auto stated = [&, name = field](const std::string& value) {
      return "{\"" + std::string(name) + "\": " + value + "}";
    };
    for (const std::string& expected : {std::string(), std::string("{}"), stated(std::to_string(right)),
                                        stated(std::to_string(right + 0.125)), stated("-7")}) {
      const std::vector<CaseResult> rows = runCases(casesOf(pairCase("x", query, expected)));
      const bool wrong =
          expected.find(std::to_string(right + 0.125)) != expected.npos || expected.find("-7") != expected.npos;
      int ok = 0;
      for (const CaseResult& row : rows) {
        EXPECT_FALSE(isOurFault(row)) << query << expected << ' ' << row.method << ' ' << row.reason;
        EXPECT_EQ(isFilesFault(row), wrong && row.role == AlgorithmRole::referee) << query << expected;
        if (row.role != AlgorithmRole::competitor) continue;
        ok += row.verdict == CaseVerdict::ok;
        EXPECT_NEAR(row.expected, right, 1e-6) << query << expected;
      }
      EXPECT_GE(ok, 2) << query << expected;
      std::ostringstream table;
      EXPECT_EQ(printCases(rows, table), wrong ? 1 : 0) << table.str();
      EXPECT_EQ(table.str().find("expected values of the file that the referee contradicts: 1\n") != std::string::npos,
                wrong);
      EXPECT_TRUE(table.str().ends_with("wrong answers of LPC's own methods: 0\n")) << table.str();
    }
  }
  // Hulls and masses have no referee: what is compared with nothing is not right.
  const std::string square = R"("dim": 2, "points": [[0, 0], [1, 0], [1, 1], [0, 1]], "shapeA": {"type": "circle",
    "radius": 1}, "poseA": {"t": [0, 0]})";
  for (const std::string query : {"convex_hull", "mass properties"}) {
    const auto rows = runCases(casesOf("{\"id\": \"x\", \"query\": \"" + query + "\", " + square + "}"));
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].verdict, CaseVerdict::refused);
    EXPECT_EQ(rows[0].reason, "nothing_expected");
    EXPECT_FALSE(isOurFault(rows[0]));
  }
}

TEST(Corpus, BrokenCasesAreKeptOnRequest) {
  const std::string good = pairCase("good", "signed_distance", "");
  for (const std::string bad : {R"({"id": "bad"})", "3", "{}", R"({"id": 7})", R"({"id": "bad", "query": "contacts"})",
                                R"({"id": "bad", "query": "contacts", "dim": 4})",
                                R"({"id": "bad", "query": "convex_hull", "dim": 2, "points": 5})"}) {
    const std::string list = good + ", " + bad + ", " + good;
    EXPECT_THROW(casesOf(list), UserError) << bad;
    const std::vector<Case> cases = casesOf(list, BrokenCases::kept);
    ASSERT_EQ(cases.size(), 3u);
    EXPECT_FALSE(cases[1].mistake.empty()) << bad;
    const std::vector<CaseResult> rows = runCases(cases);
    EXPECT_EQ(std::ranges::count(rows, "good", &CaseResult::id) % 2, 0);
    EXPECT_EQ(std::ranges::count(rows, true, &CaseResult::unread), 1);
    std::ostringstream told, skipped;
    EXPECT_EQ(printCases(rows, told), 1);
    EXPECT_EQ(printCases(rows, skipped, nullptr, true), 0);
    EXPECT_NE(skipped.str().find("cases that cannot be read, skipped: 1\n"), std::string::npos) << skipped.str();
  }
}

// Sizes are those of the shape alone; `axis` needs no other field. The page has every shape, and an example that runs.
TEST(Corpus, ThePageHasEveryShape) {
  std::ifstream in(LPC_SOURCE_DIR "/docs/cases.md");
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  for (const auto& [kind, curved] : curvedKinds<3>()) {
    const std::string name(shapeKindName(kind));
    EXPECT_NE(page.find("| `" + name + "` |"), std::string::npos) << name;
    std::string shape = "{\"type\": \"" + name + '"';
    for (const std::string_view size : curved.sizes) {
      EXPECT_NE(page.find('`' + std::string(size) + '`'), std::string::npos) << name << ' ' << size;
      shape += ", \"" + std::string(size) + "\": 2";
    }
    for (const int axis : {0, 1, 2}) {
      const auto cases =
          casesOf(R"({"id": "x", "dim": 3, "query": "mass properties", "poseA": {"t": [0, 0, 0]}, "shapeA": )" + shape +
                  ", \"axis\": \"" + "xyz"[axis] + "\"}}");
      const CaseShape<3>& a = std::get<CaseGeometry<3>>(cases[0].geometry).a;
      ASSERT_TRUE(a.shape) << a.refusal;
      EXPECT_NEAR((a.X_WS.q * Vec<3>::Unit(0))[axis], 1, 1e-6) << name;
    }
  }
  const std::size_t begin = page.find("```json cases.json\n"), end = page.find("\n```", begin);
  ASSERT_NE(begin, page.npos);
  std::ostringstream table;
  EXPECT_EQ(printCases(runCases(parseCases(page.substr(begin + 19, end - begin - 19), "cases.md")), table), 0)
      << table.str();
  EXPECT_EQ(table.str().find("refused nothing"), std::string::npos);
}

}  // namespace
}}  // namespace lpc::LPC_PRECISION
