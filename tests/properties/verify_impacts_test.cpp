// SPDX-License-Identifier: Zlib
// `lpc verify --stage time_of_impact`: methods on drawn motions of every kind of shape. Late, blind and early methods
// must be found.
#include <gtest/gtest.h>

#include "oracles/verify/verify.h"
#include "tests/expect_caught.h"
#include "tests/planted_bugs/time_of_impact_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace verify_impacts_test { namespace {

using namespace test::wrong_casts;

template <int D>
using Method = Candidate<TimeOfImpact<D>>;

template <int D>
Verified asked(const std::vector<Method<D>>& methods, int count) {
  Verified out;
  for (int a = 0; a < kShapeKinds; ++a) {
    for (int b = a; b < kShapeKinds; ++b) {
      const auto kindA = static_cast<ShapeKind>(a), kindB = static_cast<ShapeKind>(b);
      if (!kindExists(kindA, D) || !kindExists(kindB, D)) continue;
      verifyImpacts<D>(kindA, kindB, {.seed = 1, .first = 0, .count = count}, methods, out);
    }
  }
  return out;
}
LedgerEntry sumOf(const Verified& v, const std::string& method, const std::string& axis = "all",
                  const std::string& value = "") {
  LedgerEntry sum;
  for (const auto& [key, entry] : v.ledger) {
    if (key.method == method && key.axis == axis && (value.empty() || key.value == value)) sum.add(entry);
  }
  return sum;
}

// No method is late or blind, for any kinds; errors are within the band; every family and speed is drawn.
template <int D>
void oursAreRight() {
  std::vector<Method<D>> methods;
  for (const Registered* r : Registry::instance().list(StageKind::timeOfImpact, D)) {
    const Spec spec{r->info.name, {}};
    if (r->info.role == AlgorithmRole::competitor) {
      methods.push_back({r->info.name, r->info, [spec] { return createStage<TimeOfImpact<D>>(spec); }});
    }
  }
  ASSERT_GE(methods.size(), 2u);
  const Verified v = asked<D>(methods, 12);
  for (const Method<D>& m : methods) {
    const LedgerEntry row = sumOf(v, m.name);
    EXPECT_GT(row[Tally::asked], D == 3 ? 300 : 200) << m.name;
    EXPECT_EQ(row.faults(), 0) << m.name;
    EXPECT_LE(20 * row[Tally::undecided], row[Tally::asked]) << m.name;
    EXPECT_LE(row.maxError, sizeof(Real) == 8 ? 1e-9 : 1e-4) << m.name;
    long hits = 0;
    for (const auto& [decade, count] : row.histogram) hits += count;
    EXPECT_GT(4 * hits, row[Tally::asked]) << m.name << ": most motions meet nothing";
    for (const char* family : {"straight", "turning", "carried along"}) {
      EXPECT_GT(sumOf(v, m.name, "family", family)[Tally::asked], 0) << family;
    }
    EXPECT_GT(sumOf(v, m.name, "regime", "100 to 1000 sizes/s")[Tally::asked], 0);
  }
}
TEST(VerifyImpacts, OursAreRight2) { oursAreRight<2>(); }
TEST(VerifyImpacts, OursAreRight3) { oursAreRight<3>(); }

template <template <int> class Twin>
void isFound(const std::string& name) {
  const std::vector<Method<2>> methods = {{"planted", {}, [] { return std::make_unique<Twin<2>>(); }}};
  test::expectCaught("VerifyImpacts " + name, sumOf(asked<2>(methods, 6), "planted")[Tally::wrong] == 0);
}
TEST(VerifyImpacts, PlantedBugsAreFound) {
  isFound<LooksAtTheEnds>("who looks at the ends");
  const std::vector<Method<2>> blind = {{"blind", {}, [] { return std::make_unique<LooksAtTheEnds<2>>(); }}};
  EXPECT_GT(sumOf(asked<2>(blind, 6), "blind")[Tally::wrongSide], 0) << "who misses an impact is on the wrong side";
  isFound<WaitsForOverlap>("who waits for overlap");
  isFound<SpeedWithoutSign>("speed without sign");
  isFound<ForgetsTheFirst>("who forgets the first's motion");
  isFound<ForgetsTurning>("who forgets turning");
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::verify_impacts_test
