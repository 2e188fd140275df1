// SPDX-License-Identifier: Zlib
// Broadphases of other libraries are compared with LPC's in sweeps, so they must answer the same query: all pairs of
// overlapping tight boxes.
#include <filesystem>

#include "framework/stage/registry.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace broadphase_witness_test { namespace {

using test::ask;
using test::Outcome;
using test::Workspace;

using test::kSingle;

TEST(BroadphaseWitness, FindsEveryPairOfMovingBoxes) {
  Workspace w;
  w.write("s.toml", std::string(R"(
summary = "s"
kind = "boxes"
[axes]
dimension = [2, 3]
distribution = ["uniform", "cluster", "director_2"]
n = [1, 30, 300]
frames = 20
precision = [)" + std::string(kSingle ? R"("f64", "f32")" : R"("f64")") +
                                R"(]
broadphase = ["*witness", "naive_sphere"]
)"));
  const Outcome out = w.lpc("sweep s.toml --store s.db --quiet");
  ASSERT_EQ(out.code, 0) << out.text;
  const auto count = [&](const std::string& where) {
    return ask(w.path("s.db"), "SELECT count(*) FROM trial WHERE canonical LIKE '%\"broadphase\":\"" + where);
  };
  for (const char* name : {"fcl_tree", "bullet_dbvt"}) {
    EXPECT_EQ(count(std::string(name) + "%' AND outcome='ok'"), kSingle ? "36" : "18") << out.text;
    EXPECT_EQ(count(std::string(name) + "%' AND outcome!='ok'"), "0") << out.text;
  }
}

// Boxes that are added and removed, of zero size, far away, identical, huge.
TEST(BroadphaseWitness, IsRightOnHardBoxes) {
  Workspace w;
  for (const char* precision : {"f64", "f32"}) {
    if (!kSingle && std::string(precision) == "f32") continue;
    const Outcome out = w.lpc(
        std::string("verify --stage broadphase --role witness --pairs 200 --store v.db --precision ") + precision);
    EXPECT_EQ(out.code, 0) << out.text;
    EXPECT_NE(out.text.find("LPC's own methods: none was tested"), std::string::npos) << out.text;
    for (const char* name : {"fcl_tree", "bullet_dbvt"}) EXPECT_NE(out.text.find(name), std::string::npos) << out.text;
  }
  EXPECT_EQ(ask(w.path("v.db"), "SELECT sum(asked - agree) FROM ledger WHERE axis='all'"), "0");
  EXPECT_EQ(ask(w.path("v.db"), "SELECT sum(asked) FROM ledger WHERE axis='all'"), kSingle ? "1600" : "800");
}

// Also in a world where bodies sleep and contacts are sorted: the same history to the last bit.
TEST(BroadphaseWitness, GivesTheSameHistory) {
  Workspace w;
  w.write("s.toml", R"(
summary = "s"
kind = "world"
[axes]
scene = "mixed_pile"
dimension = [2, 3]
n = 40
steps = 60
broadphase = ["naive", "*witness"]
)");
  const Outcome out = w.lpc("sweep s.toml --store s.db --quiet");
  ASSERT_EQ(out.code, 0) << out.text;
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM trial WHERE outcome='ok'"), "6");
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(DISTINCT hash) FROM trial"), "2") << "one history for each dimension";
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::broadphase_witness_test
