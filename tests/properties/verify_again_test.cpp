// SPDX-License-Identifier: Zlib
// How often `lpc verify` repeats the queries that it keeps.
#include <gtest/gtest.h>

#include "oracles/verify/verify.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace verify_again_test { namespace {

// Always wrong; counts its queries.
template <int D>
class Counting final : public PairQuery<D> {
 public:
  static inline int asked = 0;
  using Params = NoParams;
  explicit Counting(const Params&) {}
  static AlgorithmInfo info() {
    return {.name = "planted_counting", .summary = "", .paper = "", .complexity = "", .role = AlgorithmRole::witness};
  }
  bool supports(ShapeKind, ShapeKind) const override { return true; }
  void query(std::span<const PairView<D>>, QueryNeed, std::span<PairAnswer<D>> answers, std::span<PairMemory>,
             WorkDone&) override {
    PairAnswer<D> answer;
    answer.status = QueryStatus::converged, answer.distance = 1e6, answer.normal = Vec<D>::Unit(0);
    std::fill(answers.begin(), answers.end(), answer);
    ++asked;
  }
};

// For a single pair, the simplest failure and that of the largest error are the same text.
TEST(Verify, KeptFailuresAreRepeatedOnce) {
  static const Registrar<PairQuery, Counting, 2> registrar(__FILE__);
  const Verified verified = verify({.dimension = 2,
                                    .kindA = ShapeKind::box,
                                    .kindB = ShapeKind::box,
                                    .range = {.seed = 1, .first = 0, .count = 1},
                                    .methods = {"planted_counting"}});
  ASSERT_EQ(verified.found.size(), 1u);
  const std::string& text = verified.found.begin()->second.text;
  int worst = 0;
  for (const auto& [key, entry] : verified.ledger) worst += entry.worst == text;
  EXPECT_EQ(worst, 1);
  EXPECT_EQ(Counting<2>::asked, 3) << "to warm up, for its answer, and alone";
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::verify_again_test
