// SPDX-License-Identifier: Zlib
// This build's histories against the pinned ones, and a planted last bit that must be located. run.cmake makes and
// compares the other builds.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/determinism/pinned.h"
#include "tests/determinism/trace.h"
#include "tests/planted_bugs/one_ulp.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace {

LPC_REGISTER(ContactGenerator, UlpContacts, 2, 3);
LPC_REGISTER(VelocityResolver, UlpVelocity, 2, 3);
LPC_REGISTER(PositionResolver, UlpPosition, 2, 3);

TEST(PinnedHashes, EqualThoseOfThisBuild) {
  EXPECT_EQ(hashLines(), pinnedLines(LPC_SOURCE_DIR "/tests/determinism/pinned_hashes.txt"))
      << "is the change meant? Then read the top of pinned_hashes.txt";
}

template <int D>
void locates(const std::string& scene) {
  PinnedScene<D> right;
  for (const PinnedScene<D>& s : pinnedScenes<D>()) {
    if (s.name == scene) right = s;
  }
  ASSERT_EQ(right.name, scene);
  right.steps = 30;
  right.pipeline = "solver=split_solver{velocity=catto}";
  std::stringstream trace;
  writeTrace(right, trace);
  EXPECT_FALSE(firstDifference(right, trace));

  struct Plant {
    const char *pipeline, *stage, *body;
  };
  const Plant plants[] = {{"contacts=ulp_contacts", "contacts", ""},
                          {"solver=split_solver{velocity=ulp_velocity}", "velocities", "3"},
                          {"solver=split_solver{position=ulp_position}", "positions", "3"}};
  for (const Plant& plant : plants) {
    PinnedScene<D> wrong = right;
    wrong.pipeline = plant.pipeline;
    trace.clear(), trace.seekg(0);
    const auto d = firstDifference(wrong, trace);
    ASSERT_TRUE(d) << plant.pipeline;
    EXPECT_EQ(d->step, kUlpCall) << d->text;
    EXPECT_EQ(d->stage, plant.stage) << d->text;
    if (*plant.body) {
      EXPECT_EQ(d->body, plant.body) << d->text;
    }
    EXPECT_NE(d->text.find(" here, "), std::string::npos) << "no bit patterns: " << d->text;
  }
}
TEST(FirstDifference, IsWhereAnUlpWasPlanted2) { locates<2>("pyramid_2d"); }
TEST(FirstDifference, IsWhereAnUlpWasPlanted3) { locates<3>("pyramid_3d"); }

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::test
