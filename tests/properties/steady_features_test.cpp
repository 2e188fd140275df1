// SPDX-License-Identifier: Zlib
// The verdicts of `lpc verify` on generators that change features of resting faces under a small motion.
#include <gtest/gtest.h>

#include "oracles/verify/case_run.h"
#include "oracles/verify/verify.h"
#include "tests/check_property.h"
#include "tests/planted_bugs/contact_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace steady_features_test { namespace {

constexpr std::string_view kPrecision = sizeof(Real) == 8 ? "f64" : "f32";

// The verdicts on pairs of resting faces, which are every eighth drawn pair.
template <int D>
LedgerEntry askResting(const Candidate<ContactGenerator<D>>& method, int count, ShapeKind kind = ShapeKind::box) {
  Verified out;
  for (int i = 0; i < count; ++i) {
    verifyContacts<D>(kind, kind, {.seed = 5, .first = 8 * i, .count = 1}, {&method, 1}, out);
  }
  LedgerEntry sum;
  for (const auto& [key, entry] : out.ledger) {
    if (key.axis == "family" && key.value == "resting_faces") sum.add(entry);
  }
  EXPECT_EQ(sum[Tally::asked], count);
  return sum;
}
template <class Bug, int D>
LedgerEntry askPlanted(int count) {
  return askResting<D>({"planted", {}, [] { return std::make_unique<Bug>(); }}, count);
}

// A fault that only few motions reveal must count as wrong wherever it shows, not as a tie.
TEST(SteadyFeatures, RareFaultsAreWrongWhereTheyShow) {
  const LedgerEntry flat = askPlanted<FeaturesByMillimetre<2>, 2>(2000),
                    spatial = askPlanted<FeaturesByMillimetre<3>, 3>(2000);
  EXPECT_GE(flat[Tally::wrong], sizeof(Real) == 8 ? 1 : 10);
  EXPECT_GE(spatial[Tally::wrong], sizeof(Real) == 8 ? 2 : 25);
  EXPECT_EQ(flat[Tally::tie] + spatial[Tally::tie], 0);
}

// Planted bug: the second call, which is that of the small motion, returns this many manifolds for one.
template <int kManifolds>
class SecondCall final : public ContactGenerator<3> {
 public:
  bool supports(ShapeKind, ShapeKind) const override { return true; }
  void generate(const ContactInput<3>& in, std::vector<Manifold<3>>& fresh, WorkDone& work) override {
    m_right->generate(in, fresh, work);
    if (++m_calls == 2) fresh.resize(kManifolds * fresh.size(), fresh.empty() ? Manifold<3>{} : fresh[0]);
  }

 private:
  std::unique_ptr<ContactGenerator<3>> m_right = createStage<ContactGenerator<3>>({"sat_clip", {}});
  int m_calls = 0;
};
TEST(SteadyFeatures, LostOrDoubledManifoldsAreWrong) {
  const LedgerEntry lost = askPlanted<SecondCall<0>, 3>(5), doubled = askPlanted<SecondCall<2>, 3>(5);
  EXPECT_EQ(lost[Tally::wrongSide], 5);
  EXPECT_EQ(doubled[Tally::wrong], 5);
}

// These cases are kept although no method was mended. A corner was at a threshold, or two choices of four points were
// equally good. They counted as wrong until the check also queried neighbouring places.
TEST(SteadyFeatures, ChangesInASinglePlaceAreTies) {
  int asked = 0;
  for (const Case& c : readCases(std::string(LPC_SOURCE_DIR) + "/tests/regressions/found_cases.json")) {
    if (c.finding->precision != kPrecision || c.finding->failure != "wrong_features") continue;
    EXPECT_EQ(askAgain(c, c.finding->method).end, Tally::tie) << c.id;
    ++asked;
  }
  EXPECT_EQ(asked, sizeof(Real) == 8 ? 0 : 4);
}

// Ties of our methods: one in two thousand at most, plus one. All other answers must be right.
TEST(SteadyFeatures, TiesOfOursAreRare) {
  long asked = 0, ties = 0;
  for (const char* name : {"sat_clip", "query_clip", "deepest_point"}) {
    const AlgorithmInfo& info = Registry::instance().find(StageKind::contacts, 3, name).info;
    const auto create = [name] { return createStage<ContactGenerator<3>>({name, {}}); };
    const LedgerEntry e = askResting<3>({name, info, create}, caseCount(800), ShapeKind::polytope);
    EXPECT_EQ(e.faults(), 0) << name;
    asked += e[Tally::asked], ties += e[Tally::tie];
  }
  std::cout << asked << " asked, " << ties << " ties\n";
  EXPECT_LE(ties, 1 + asked / 2000);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::steady_features_test
