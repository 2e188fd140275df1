// SPDX-License-Identifier: Zlib
// `lpc corpus` writes a file of cases that LPC reads back, and a runner that counts wrong answers.
#include "experiments/runner/pair_corpus.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "experiments/parse/toml_reader.h"
#include "oracles/corpus/cases.h"
#include "oracles/verify/verify.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_corpus_test { namespace {

using nlohmann::json;
using test::Outcome;
using test::Workspace;

// Distance between the file's interval and the referee's answer for the pair read back (in units of s); below 0 they
// overlap.
template <int D>
double apart(const CaseGeometry<D>& g, const json& expected) {
  const HardPair<D> pair = g.pair();
  const PairTruth<D> known = pairTruth(PairView<D>{pair.a.view(), pair.b.view(), pair.X_AB});
  const double lo = expected["interval"][0], hi = expected["interval"][1];
  EXPECT_LE(lo, hi);
  EXPECT_NEAR(expected["size"].get<double>(), known.s, 1e-9 * known.s);
  return std::max(lo - known.answer.hi, known.answer.lo - hi) / known.s;
}

TEST(PairCorpus, IsAFileOfCasesThatTheRefereeConfirms) {
  const PairCorpus made = pairCorpus({.cases = std::string(LPC_SOURCE_DIR) + "/tests/regressions/hard_cases.json",
                                      .dimensions = {2, 3},
                                      .seed = 3,
                                      .pairs = 1});
  const json file = json::parse(made.text);
  const std::vector<Case> cases = parseCases(made.text, "pairs.json");
  ASSERT_EQ(cases.size(), static_cast<std::size_t>(made.kept + made.drawn));
  EXPECT_GE(made.kept, 75);
  EXPECT_GE(made.drawn, 40);
  EXPECT_FALSE(file["schema"]["interval"].empty());
  double farthest = -1;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const json& expected = file["cases"][i]["expected"];
    const double off = std::visit([&](const auto& g) { return apart(g, expected); }, cases[i].geometry);
    EXPECT_LE(off, 1e-14) << cases[i].id;  // reading normalises the rotation
    farthest = std::max(farthest, off);
  }
  json planted = file["cases"][0]["expected"];
  for (json& bound : planted["interval"]) bound = bound.get<double>() + 1e-9;
  test::expectCaught("an interval of another pair",
                     std::visit([&](const auto& g) { return apart(g, planted); }, cases[0].geometry) <= 1e-14);
}

// The runner with its function filled in.
Outcome runWith(const Workspace& w, const std::string& body) {
  std::string text = readFile(w.path("corpus/run.py"));
  const std::size_t at = text.find("    return None\n");
  EXPECT_NE(at, text.npos);
  w.write("corpus/mine.py", text.replace(at, std::string("    return None\n").size(), body));
  return w.shell("python3 -B corpus/mine.py corpus/pairs.json");
}
int counted(const Outcome& out, const std::string& what) {
  const std::size_t at = out.text.find(" " + what), from = out.text.rfind(' ', at - 1);
  const std::size_t line = out.text.rfind('\n', at);
  return at == out.text.npos ? -1
                             : std::atoi(out.text.c_str() + std::max(from + 1, line == out.text.npos ? 0 : line + 1));
}

constexpr const char* kSpheres =
    "    a, b = pair[\"shapeA\"], pair[\"shapeB\"]\n"
    "    if a[\"type\"] != \"sphere\" or b[\"type\"] != \"sphere\":\n"
    "        return None\n"
    "    gap = math.dist(pair[\"poseA\"][\"t\"], pair[\"poseB\"][\"t\"]) - a[\"radius\"] - b[\"radius\"]\n"
    "    return ";

TEST(PairCorpus, TheRunnerCountsWrongAnswers) {
  Workspace w;
  const Outcome made = w.lpc("corpus --export corpus --pairs 2 --seed 5");
  ASSERT_EQ(made.code, 0) << made.text;
  const auto file = json::parse(readFile(w.path("corpus/pairs.json")));
  const int all = file["count"];
  int spheres = 0, overlapping = 0;
  for (const json& c : file["cases"]) {
    spheres += c["shapeA"]["type"] == "sphere" && c["shapeB"]["type"] == "sphere";
    overlapping += c["expected"]["interval"][1] < -1e-5 * c["expected"]["size"].get<double>();
  }
  EXPECT_GE(spheres, 5);
  EXPECT_GT(overlapping, 10);

  const Outcome empty = w.shell("python3 -B corpus/run.py");  // unchanged: no case supported, none wrong
  EXPECT_EQ(empty.code, 0) << empty.text;
  EXPECT_EQ(counted(empty, "pairs, "), all) << empty.text;
  EXPECT_EQ(counted(empty, "skipped"), all) << empty.text;

  const Outcome right = runWith(w, std::string(kSpheres) + "gap\n");
  EXPECT_EQ(right.code, 0) << right.text;
  EXPECT_EQ(counted(right, "skipped"), all - spheres) << right.text;
  EXPECT_EQ(counted(right, "wrong"), 0) << right.text;

  // What the runner must count.
  const auto isPassed = [&](const std::string& body) { return runWith(w, body).code == 0; };
  test::expectCaught("spheres that are a thousandth too large",
                     isPassed(std::string(kSpheres) + "gap - 0.001 * a[\"radius\"]\n"));
  test::expectCaught("a library without a number", isPassed(std::string(kSpheres) + "math.nan\n"));
  test::expectCaught("a library that throws", isPassed("    raise ValueError(\"planted\")\n"));
  const Outcome side = runWith(w, "    return math.inf\n");  // always apart
  EXPECT_GE(counted(side, "wrong"), overlapping) << side.text;
  EXPECT_LT(counted(side, "wrong"), all) << side.text;
}

TEST(PairCorpus, AFilledInRunnerStaysAndMistakesWriteNothing) {
  Workspace w;
  const std::pair<std::string, std::string> wrong[] = {
      {"", "--export"},
      {"--export c --dimension 4", "valid: 2, 3"},
      {"--export c --pairs -1", "'-1'"},
      {"--export c --cases nowhere.json", "nowhere.json"},
      {"--export ''", "--export"},
  };
  for (const auto& [arguments, part] : wrong) {
    const Outcome out = w.lpc("corpus " + arguments);
    EXPECT_EQ(out.code, 2) << arguments << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
    EXPECT_NE(out.text.find(part), std::string::npos) << out.text;
  }
  EXPECT_TRUE(std::filesystem::is_empty(w.path(""))) << "something was written";
  w.write("file", "");
  EXPECT_EQ(w.lpc("corpus --export file --pairs 0").code, 2);

  ASSERT_EQ(w.lpc("corpus --export c --pairs 0 --dimension 2").code, 0);
  w.write("c/run.py", "# mine\n");
  const Outcome again = w.lpc("corpus --export c --pairs 0 --dimension 2");
  EXPECT_EQ(again.code, 0) << again.text;
  EXPECT_NE(again.text.find("exists and is kept"), std::string::npos) << again.text;
  EXPECT_EQ(readFile(w.path("c/run.py")), "# mine\n");
  const std::filesystem::directory_iterator all(w.path("c"));
  EXPECT_EQ(std::distance(begin(all), end(all)), 2);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::pair_corpus_test
