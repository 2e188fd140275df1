// SPDX-License-Identifier: Zlib
#include "oracles/verify.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "framework/stage_narrowphase.h"
#include "oracles/cases.h"
#include "oracles/hard_pairs.h"
#include "tests/check_property.h"

namespace lpc::inline LPC_PRECISION {
namespace {

VerifyOptions options(int dimension, std::vector<std::string> methods, int pairs) {
  VerifyOptions o;
  o.dimension = dimension, o.methods = std::move(methods), o.pairs = test::caseCount(pairs);
  return o;
}
std::vector<std::string> ours(int dimension) {
  std::vector<std::string> names;
  for (const Registered* r : Registry::instance().list(StageKind::pairQuery, dimension)) {
    if (r->info.role == Role::competitor) names.push_back(r->info.name);
  }
  return names;
}

TEST(Verify, OurMethodsAreRight) {
  for (const int d : {2, 3}) {
    for (const double scale : {1e-3, 1.0, 1e3}) {
      VerifyOptions o = options(d, ours(d), 60);
      o.scale = scale;
      std::ostringstream table;
      EXPECT_EQ(printVerification(verifyPairs(o), table), 0) << table.str();
    }
  }
}

// Nobody may be right by construction: a method that is stopped early, and one that is wrong by design, are found out.
TEST(Verify, SeesWrongMethods) {
  std::ostringstream table;
  EXPECT_GT(printVerification(verifyPairs(options(3, {"gjk_epa{iterations=1,faces=8}"}, 60)), table), 0);
  int disagreements = 0;
  for (const VerifyRow& r : verifyPairs(options(3, {"libccd_mpr"}, 60))) disagreements += r.disagreements;
  EXPECT_GT(disagreements, 0);
}

TEST(Verify, EveryTwoKindsAreAsked) {
  std::set<std::pair<ShapeKind, ShapeKind>> kinds;
  for (const VerifyRow& r : verifyPairs(options(2, {"sat"}, 5))) {
    EXPECT_EQ(r.asked, test::caseCount(5));
    EXPECT_EQ(r.undecided, 0);
    kinds.insert({r.a, r.b});
  }
  EXPECT_EQ(kinds.size(), 15u);
}

TEST(Verify, PairsAreTheSameWhereverTheyAreDrawn) {
  const auto one = hardPair<3>(ShapeKind::box, ShapeKind::polytope, 1, 3, 17);
  hardPair<3>(ShapeKind::box, ShapeKind::polytope, 1, 3, 18);
  const auto again = hardPair<3>(ShapeKind::box, ShapeKind::polytope, 1, 3, 17);
  EXPECT_EQ(one.X_AB.p, again.X_AB.p);
  EXPECT_EQ(one.family, again.family);
  std::set<std::string_view> families;
  for (int i = 0; i < 200; ++i) families.insert(hardPair<3>(ShapeKind::box, ShapeKind::box, 1, 3, i).family);
  EXPECT_EQ(families.size(), 8u);
}

// The worst case that is printed is a case that can be read: pasted into a file it shows the same error.
TEST(Verify, WorstCasesCanBePasted) {
  std::string objects;
  for (const VerifyRow& r : verifyPairs(options(3, {"libccd_mpr"}, 30))) {
    if (r.worst.empty()) continue;
    objects += (objects.empty() ? "" : ",\n") + r.worst;
    objects.insert(objects.rfind("{\"dim\"") + 1,
                   "\"id\": \"pasted-" + std::to_string(objects.size()) + "\", \"source\": \"lpc verify\", ");
  }
  ASSERT_FALSE(objects.empty());
  const std::string path = ::testing::TempDir() + "pasted_cases.json";
  std::ofstream(path) << "{\"schema\": {}, \"cases\": [" << objects << "]}";
  const auto cases = readCases(path);
  int wrong = 0;
  for (const CaseResult& r : runCases(cases)) {
    EXPECT_FALSE(isOurFault(r)) << r.id << " " << r.method << " " << r.reason;
    wrong += r.method == "libccd_mpr" && r.verdict == CaseVerdict::wrong;
  }
  EXPECT_GT(wrong, 0);
}

TEST(Verify, WrongDimensionIsTheUsersMistake) { EXPECT_THROW(verifyPairs(options(4, {}, 1)), UserError); }

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
