// SPDX-License-Identifier: Zlib
// Messages about wrong names.
#include "framework/math/names.h"

#include <gtest/gtest.h>

#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace names_test { namespace {

const std::vector<std::string> kNames = {"naive", "naive_sphere", "region_tree", "sort_and_sweep", "uniform_grid"};

TEST(Names, TyposAreRecognised) {
  for (const auto& [given, meant] :
       {std::pair("niave", "naive"), std::pair("naiv", "naive"), std::pair("Naive", "naive"),
        std::pair("naive-sphere", "naive_sphere"), std::pair("sort_and_swep", "sort_and_sweep"),
        std::pair("regoin_tree", "region_tree"), std::pair("grid", "uniform_grid"), std::pair("tree", "region_tree")}) {
    EXPECT_EQ(meantName(kNames, given), meant) << given;
  }
}

TEST(Names, PrefixesAreSuggestedBeforeInnerParts) {
  EXPECT_EQ(meantName({"bullet_gjk_epa", "gjk_epa", "gjk_old"}, "gjk"), "gjk_epa");
}

TEST(Names, OtherWordsAreNotSuggested) {
  for (const char* given : {"", "x", "bullet", "zzzzz", "an"}) EXPECT_EQ(meantName(kNames, given), "") << given;
  EXPECT_EQ(meantName(kNames, "naive"), "") << "the name is right";
  EXPECT_EQ(meantName({"n", "x"}, "m"), "") << "one letter is all of such a name";
}

TEST(Names, TheMessageHasSuggestionAndValidNames) {
  EXPECT_EQ(validNames({"f64", "f32"}, "f46"), "; did you mean 'f64'? valid: f64, f32");
  EXPECT_EQ(validNames({"f64", "f32"}, "double"), "; valid: f64, f32");
  EXPECT_EQ(validNames({}, "double"), "; valid: none");
}

TEST(Names, LongNamesAreNotTypos) {
  const std::string much(1000000, 'x');  // both names long: a table of lengths' product would exhaust memory
  EXPECT_EQ(meantName({"naive", much}, much + "y"), "");
  EXPECT_EQ(meantName({much, "naive"}, "niave"), "naive");
}

TEST(Names, AMessageIsOneLine) {
  EXPECT_EQ(oneLine("file.toml:3: 'naïve' is …; valid: 😀"), "file.toml:3: 'naïve' is …; valid: 😀");
  EXPECT_EQ(oneLine(std::string("a\nb\tc\r\x1b[0m\x7f\0z", 13)), "a\\nb\\tc\\x0d\\x1b[0m\\x7f\\x00z");
  // Invalid UTF-8: a stray byte, a truncated character, an overlong one, a surrogate, one out of range; and C1 controls
  // and separators.
  EXPECT_EQ(oneLine("\xff|\xc3|\xc0\x80|\xed\xa0\x80|\xf4\x90\x80\x80"),
            "\\xff|\\xc3|\\xc0\\x80|\\xed\\xa0\\x80|\\xf4\\x90\\x80\\x80");
  EXPECT_EQ(oneLine("\xc2\x85|\xe2\x80\xa8"), "\\xc2\\x85|\\xe2\\x80\\xa8");
  const std::string once =
      oneLine("t.toml:3: '" + std::string(1000000, 'x') + "' beside '" + std::string(900, 'y') + "'; valid: z");
  EXPECT_LT(once.size(), 1000u);
  for (const char* part : {"t.toml:3: 'xxx", " ... (999640 bytes) ... xxx", "xxx' beside 'yyy", "yyy'; valid: z"}) {
    EXPECT_NE(once.find(part), once.npos) << once;
  }
  EXPECT_EQ(oneLine(once), once);
  std::string letters;
  for (int i = 0; i < 5000; ++i) letters += "é";
  EXPECT_LT(oneLine(letters).size(), 1600u);
  EXPECT_EQ(oneLine(letters).find('\\'), std::string::npos) << "cut within a character";
}

TEST(Names, APartOfAStageIsShownInItsPlace) {
  EXPECT_EQ(placeInPipeline(*stageByName("solver"), "soft_step"), "");
  EXPECT_EQ(placeInPipeline(*stageByName("velocity"), "catto"),
            "velocity is a part of solver: solver=split_solver{velocity=catto}");
  EXPECT_EQ(placeInPipeline(*stageByName("pair_query"), "sat"),
            "pair_query is a part of contacts: contacts=deepest_point{query=sat}");
  EXPECT_EQ(placeInPipeline(*stageByName("engine"), "box2d"), "an engine replaces all stages: engine=box2d");
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::names_test
