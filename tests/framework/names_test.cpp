// SPDX-License-Identifier: Zlib
// What a message says of a wrong name.
#include "framework/names.h"

#include <gtest/gtest.h>

#include "framework/registry.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

const std::vector<std::string> kNames = {"naive", "naive_sphere", "region_tree", "sort_and_sweep", "uniform_grid"};

TEST(Names, ASlipOfThePenIsUnderstood) {
  for (const auto& [given, meant] :
       {std::pair("niave", "naive"), std::pair("naiv", "naive"), std::pair("Naive", "naive"),
        std::pair("naive-sphere", "naive_sphere"), std::pair("sort_and_swep", "sort_and_sweep"),
        std::pair("regoin_tree", "region_tree"), std::pair("grid", "uniform_grid"), std::pair("tree", "region_tree")}) {
    EXPECT_EQ(meantName(kNames, given), meant) << given;
  }
}

TEST(Names, WhatBeginsSoIsMeantBeforeWhatHoldsIt) {
  EXPECT_EQ(meantName({"bullet_gjk_epa", "gjk_epa", "gjk_old"}, "gjk"), "gjk_epa");
}

TEST(Names, AnotherWordIsNotTakenForOne) {
  for (const char* given : {"", "x", "bullet", "zzzzz", "an"}) EXPECT_EQ(meantName(kNames, given), "") << given;
  EXPECT_EQ(meantName(kNames, "naive"), "") << "the name is right";
  EXPECT_EQ(meantName({"n", "x"}, "m"), "") << "one letter is all of such a name";
}

TEST(Names, TheMessageHasBoth) {
  EXPECT_EQ(validNames({"f64", "f32"}, "f46"), "; did you mean 'f64'? valid: f64, f32");
  EXPECT_EQ(validNames({"f64", "f32"}, "double"), "; valid: f64, f32");
  EXPECT_EQ(validNames({}, "double"), "; valid: none");
}

TEST(Names, APartOfAStageIsPutInItsPlace) {
  EXPECT_EQ(placeInPipeline(*stageByName("solver"), "soft_step"), "");
  EXPECT_EQ(placeInPipeline(*stageByName("velocity"), "catto"),
            "velocity is a part of solver: solver=split_solver{velocity=catto}");
  EXPECT_EQ(placeInPipeline(*stageByName("pair_query"), "sat"),
            "pair_query is a part of contacts: contacts=deepest_point{query=sat}");
  EXPECT_EQ(placeInPipeline(*stageByName("engine"), "box2d"),
            "an engine stands alone, in place of all stages: engine=box2d");
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
