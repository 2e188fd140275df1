// SPDX-License-Identifier: Zlib
// The corpus of published hard cases, with every method that supports them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include "framework/math/check.h"
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
  // Both have the same number of lines: the file has a header, the table has counts by method and of our faults.
  std::istringstream lines(table.str()), rows(csv.str());
  const std::vector<std::string> have = linesOf(lines), inFile = linesOf(rows);
  ASSERT_GT(inFile.size(), 800u);
  EXPECT_EQ(inFile[0], "id,method,verdict,value,expected,error,reason");
  for (std::size_t i = 1; i < inFile.size(); ++i) {
    std::istringstream words(have[i - 1]);
    std::string id, method, verdict;
    words >> id >> method >> verdict;
    EXPECT_TRUE(inFile[i].starts_with(id + ',' + method + ',' + verdict + ','))
        << inFile[i] << " against " << have[i - 1];
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

CaseResult cubes(int mode) {
  static const Registrar<PairQuery, WrongWitness, 3> planted(__FILE__);  // after the table above is printed
  WrongWitness<3>::mode = mode;
  std::vector<Case> cases = readCases(kCorpus);
  std::erase_if(cases, [](const Case& c) { return c.id != "libccd-25-cubes"; });
  for (const CaseResult& row : runCases(cases)) {
    if (row.method == "planted_wrong") return row;
  }
  return {};
}

TEST(Corpus, SeesPlantedWrongMethods) {
  EXPECT_EQ(cubes(0).verdict, CaseVerdict::ok);
  EXPECT_EQ(cubes(1).verdict, CaseVerdict::wrong);
  EXPECT_EQ(cubes(2).verdict, CaseVerdict::wrong);
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
      {head + R"("shapeA": {"type": "box"}}]})", "'expected' is missing"},
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
  EXPECT_NE(complaint("/nowhere.json"), "");
}

}  // namespace
}}  // namespace lpc::LPC_PRECISION
