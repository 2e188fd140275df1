// SPDX-License-Identifier: Zlib
// `lpc run --memory`: each stage's allocations are in its own row, the same every time.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace memory_test { namespace {

using nlohmann::json;
using test::Outcome;
using test::Workspace;

const std::string kStack = "run vertical_stack --dimension 2 --param n=4 --steps 120 --memory";

#ifdef LPC_SANITIZED

TEST(Memory, IsNotCountedUnderSanitizers) {
  Workspace w;
  const Outcome out = w.lpc(kStack);
  EXPECT_EQ(out.code, 2) << out.text;
  EXPECT_TRUE(out.text.starts_with("lpc: --memory: this build has sanitizers")) << out.text;
  EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
}

#else

std::map<std::string, json> rowsOf(const json& result) {
  std::map<std::string, json> out;
  for (const json& row : result.at("memory")) out[row.at("scope")] = row;
  return out;
}

long sumOf(const std::map<std::string, json>& rows, const char* what) {
  long sum = 0;
  for (const auto& [scope, row] : rows) sum += row.at(what).get<long>();
  return sum;
}

json ran(const Workspace& w, const std::string& arguments) {
  const Outcome out = w.lpc(arguments + " --json");
  EXPECT_EQ(out.code, 0) << out.text;
  return json::parse(out.text);
}

// Planted: a broadphase that allocates 4096 more bytes after each step. No other row may contain them.
TEST(Memory, GrowingMemoryIsReported) {
  Workspace w;
  const std::string plugin = "--plugin " LPC_BINARY_DIR "/lib/liblpc_planted.so ";
  const json with = ran(w, plugin + kStack + " --pipeline broadphase=planted_hoard");
  const json without = ran(w, plugin + kStack + " --pipeline broadphase=naive");
  EXPECT_EQ(with["hash"], without["hash"]) << "they live the same life";
  auto hoards = rowsOf(with), not_ = rowsOf(without);
  ASSERT_TRUE(hoards.count("broadphase") && hoards.count("solver.iterate")) << with["memory"];
  const json broadphase = hoards["broadphase"];
  for (const char* what : {"held", "allocated"}) {
    const long more = broadphase[what].get<long>() - not_["broadphase"][what].get<long>();
    EXPECT_GE(more, 120 * 4096) << what;
    EXPECT_LE(more, 120 * 4096 * 11 / 10) << what;
  }
  EXPECT_GE(broadphase["allocations"].get<long>() - not_["broadphase"]["allocations"].get<long>(), 120);
  EXPECT_EQ(broadphase["last_step"], 120);
  EXPECT_LT(not_["broadphase"]["last_step"].get<long>(), 120) << "a stage that is warm allocates no more";
  hoards.erase("broadphase"), not_.erase("broadphase");
  hoards.erase("scene"), not_.erase("scene");  // the objects themselves differ in size
  ASSERT_EQ(hoards.size(), not_.size());
  for (const auto& [scope, row] : hoards) {
    const json& other = not_[scope];
    EXPECT_EQ(row["allocations"], other["allocations"]) << scope;
    EXPECT_EQ(row["last_step"], other["last_step"]) << scope;
    for (const char* what : {"held", "allocated"}) {  // malloc may give 16 bytes more if a block is not worth splitting
      EXPECT_LE(std::abs(row[what].get<long>() - other[what].get<long>()), 16 * row["allocations"].get<long>())
          << scope;
    }
  }
}

// Equal every time, and measuring changes nothing; the rows add up to their columns in the profile.
TEST(Memory, IsTheSameEachTimeAndAddsUp) {
  Workspace w;
  const json first = ran(w, kStack + " --profile p.csv"), second = ran(w, kStack + " --profile p.csv");
  EXPECT_EQ(first["memory"], second["memory"]);
  const json without = ran(w, kStack.substr(0, kStack.rfind(' ')));
  EXPECT_EQ(first["hash"], without["hash"]);
  EXPECT_FALSE(without.contains("memory"));
  auto rows = rowsOf(first);
  EXPECT_GT(rows["scene"]["held"].get<long>(), 4 * 100) << "four bodies, and their world";
  EXPECT_EQ(rows["scene"]["last_step"], 0) << "nobody comes later";
  EXPECT_GT(rows["contacts"]["held"].get<long>(), 0);
  rows.erase("scene");

  std::istringstream csv(readFile(w.path("p.csv")));
  std::map<std::string, long> sums;
  std::vector<std::string> columns;
  for (std::string line; std::getline(csv, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream cells(line);
    std::size_t k = 0;
    const bool header = columns.empty();
    for (std::string cell; std::getline(cells, cell, ','); ++k) {
      if (header) columns.push_back(cell);
      for (const std::string what : {"held", "allocated", "allocations"}) {
        if (!header && columns.at(k).starts_with(what + "_")) sums[what] += std::stol(cell);
      }
    }
  }
  ASSERT_EQ(sums.size(), 3u);
  for (const auto& [what, sum] : sums) EXPECT_EQ(sum, sumOf(rows, what.c_str())) << what;
}

// Bodies that a script adds count as the scene's.
TEST(Memory, LaterBodiesCountAsTheScenes) {
  Workspace w;
  auto rows = rowsOf(ran(w, "run director_1 --param rain_until=100 --param every=30 --memory"));
  EXPECT_EQ(rows["scene"]["last_step"], 100) << "the firework";
}

TEST(Memory, IsATableOfStagesAndTheirPhases) {
  Workspace w;
  const Outcome out = w.lpc(kStack + " --precision f64");
  ASSERT_EQ(out.code, 0) << out.text;
  const std::size_t from = out.text.find("\nmemory  ");
  ASSERT_NE(from, std::string::npos) << out.text;
  std::istringstream table(out.text.substr(from + 1));
  std::string line;
  std::getline(table, line);
  EXPECT_NE(line.find("held B"), std::string::npos);
  std::vector<std::string> scopes;
  long held = 0, allocated = 0, allocations = 0;
  for (std::string scope; std::getline(table, line);) {
    std::istringstream cells(line);
    long h = 0, bytes = 0, n = 0;
    double each = 0;
    ASSERT_TRUE(cells >> scope >> h >> bytes >> n >> each) << line;
    EXPECT_NEAR(each, static_cast<double>(n) / 120, 1e-3 * static_cast<double>(n)) << line;
    if (scope == "together") {
      EXPECT_EQ(h, held);
      EXPECT_EQ(bytes, allocated);
      EXPECT_EQ(n, allocations);
    }
    held += h, allocated += bytes, allocations += n;
    scopes.push_back(scope);
  }
  ASSERT_EQ(scopes.back(), "together") << out.text;
  const auto at = [&](const char* scope) { return std::find(scopes.begin(), scopes.end(), scope) - scopes.begin(); };
  EXPECT_EQ(at("scene"), 0);
  EXPECT_LT(at("broadphase"), at("solver"));
  EXPECT_LT(at("solver"), at("solver.integrate")) << "a phase stands below its stage";
  EXPECT_LT(at("solver.integrate"), at("elsewhere"));
}

TEST(Memory, AnEngineHasItsOwn) {
  Workspace w;
  const Outcome out = w.lpc("run vertical_stack --pipeline engine=box2d --memory");
  EXPECT_EQ(out.code, 2) << out.text;
  EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
  EXPECT_NE(out.text.find("--memory"), std::string::npos) << out.text;
}

#endif

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::memory_test
