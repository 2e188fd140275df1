// SPDX-License-Identifier: Zlib
// The search that finds counterexamples, keeps them and runs them first, and the list of planted bugs.
#include "tests/check_property.h"

#include <gtest/gtest-spi.h>

#include <array>
#include <map>

#include "tests/run_property.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace check_property_test { namespace {

std::string read(const std::filesystem::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Uses the case numbers and seeds of the source, whatever the environment sets.
class CheckProperty : public ::testing::Test {
 protected:
  static constexpr std::array<const char*, 2> kVariables = {"LPC_TEST_CASES", "LPC_TEST_SEED"};

  void SetUp() override {
    for (const char* name : kVariables) {
      if (const char* value = std::getenv(name)) m_asked[name] = value;
      unsetenv(name);
    }
  }
  void TearDown() override {
    for (const auto& [name, value] : m_asked) setenv(name.c_str(), value.c_str(), 1);
  }

 private:
  std::map<std::string, std::string> m_asked;
};

TEST_F(CheckProperty, SameSeedSameCases) {
  const auto draws = [] {
    std::vector<int> seen;
    runProperty(
        "seeds", [&] { seen.push_back(*rc::gen::arbitrary<int>()); }, 50);
    return seen;
  };
  EXPECT_EQ(draws(), draws());
}

TEST_F(CheckProperty, FailsWithTheCounterexample) {
  EXPECT_NONFATAL_FAILURE(check("all numbers are below 50", [] { RC_ASSERT(*rc::gen::arbitrary<int>() < 50); }),
                          "50 < 50");
  std::filesystem::remove_all(
      KeptFailures(LPC_BINARY_DIR "/failures").file(currentTest() + ": all numbers are below 50"));
  check("all squares are positive", [] {
    const int n = *rc::gen::arbitrary<int>();
    RC_ASSERT(double(n) * n >= 0);
  });
}

// A failing input, as shrunk, runs first next time; it is deleted once it passes.
TEST_F(CheckProperty, RunsKeptFailuresFirst) {
  const std::filesystem::path folder = ::testing::TempDir() + fileNameOf(currentTest());
  std::filesystem::remove_all(folder);
  const KeptFailures kept(folder);
  const std::string id = "an id / of any kind";
  std::vector<int> drawn;
  int limit = 50;
  const auto belowLimit = [&] {
    drawn.push_back(*rc::gen::inRange(0, 100));
    RC_ASSERT(drawn.back() < limit);
  };
  const auto run = [&] {
    drawn.clear();
    return counterexample(kept, id, "numbers are small", belowLimit, 100);
  };
  const std::string first = run();
  EXPECT_NE(first.find("50 < 50"), std::string::npos) << first;
  EXPECT_NE(first.find("kept in"), std::string::npos) << first;
  EXPECT_TRUE(std::filesystem::exists(kept.file(id)));
  const std::size_t steps = drawn.size();
  const std::string again = run();
  EXPECT_NE(again.find("kept from an earlier run"), std::string::npos) << again;
  EXPECT_EQ(drawn.back(), 50);
  EXPECT_LT(drawn.size(), steps);
  limit = 100;  // the bug is fixed
  EXPECT_EQ(run(), "");
  EXPECT_GT(drawn.size(), 100u);  // the kept input and a hundred drawn ones
  EXPECT_FALSE(std::filesystem::exists(kept.file(id)));
  EXPECT_EQ(run(), "");
  EXPECT_EQ(drawn.size(), 100u);

  limit = 50;
  run();
  replaceFile(kept.file(id), "reproduce=torn");
  EXPECT_NE(run().find("kept in"), std::string::npos) << "a torn file was not replaced";
  std::filesystem::remove_all(folder);
}

// A long message is kept in a file, which is deleted once the property passes.
TEST_F(CheckProperty, KeepsLongMessagesInAFile) {
  const std::filesystem::path folder = ::testing::TempDir() + fileNameOf(currentTest());
  std::filesystem::remove_all(folder);
  const KeptFailures kept(folder);
  std::string story;
  for (int i = 1; i <= 100; ++i) story += "line " + std::to_string(i) + "\n";
  const std::string told = kept.tell("a property", story);
  EXPECT_NE(told.find("line 40\n... 60 lines more in " + kept.told("a property").string()), std::string::npos) << told;
  EXPECT_EQ(told.find("line 41\n"), std::string::npos);
  EXPECT_EQ(read(kept.told("a property")), story);
  kept.drop("a property");
  EXPECT_FALSE(std::filesystem::exists(kept.told("a property")));
  kept.tell("a property", story);
  const std::string whole = story.substr(0, story.find("line 41\n"));
  EXPECT_EQ(kept.tell("a property", whole), whole) << "nothing is left over after the last line shown";
  EXPECT_FALSE(std::filesystem::exists(kept.told("a property"))) << "the longer story is of another failure";
}

TEST_F(CheckProperty, ListsPlantedBugs) {
  expectFalsified("all numbers are below 50", [] { RC_ASSERT(*rc::gen::arbitrary<int>() < 50); });
  int calls = 0;
  const auto thirdFails = [&] {
    if (++calls == 3) RC_FAIL("the third");
  };
  recordPlantedBug("by hand", 7, 9);
  expectFalsified("a third case", thirdFails, 3);
  const std::string list = read(std::filesystem::path(LPC_BINARY_DIR "/planted_bugs") / fileNameOf(currentTest()));
  EXPECT_NE(list.find(currentTest() + " | all numbers are below 50 | "), std::string::npos) << list;
  EXPECT_NE(list.find(" | by hand | 7 | 9\n"), std::string::npos) << list;
  EXPECT_NE(list.find(" | a third case | 3 | 3\n"), std::string::npos) << list;
  calls = 0;
  EXPECT_NONFATAL_FAILURE(expectFalsified("a third case of two", thirdFails, 2), "was not caught in 2 cases");
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::check_property_test
