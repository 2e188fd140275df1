// SPDX-License-Identifier: Zlib
// Trials of pairs: there is one truth and one error, in trials and in ledgers.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "experiments/runner/code_identity.h"
#include "experiments/runner/trial_plan.h"
#include "experiments/trial/trial.h"
#include "oracles/verify.h"

namespace lpc::inline LPC_PRECISION::pairs_trial_test {
namespace {

// Wrong by a part of the size, now and then along a wrong normal, and sometimes silent.
template <int D>
class Careless final : public PairQuery<D> {
 public:
  using Params = NoParams;
  static inline std::vector<double> errors;  // of what it was asked last, as `lpc verify` tells them
  static inline int refused = 0, wrong = 0, wrongSides = 0;
  static inline bool retelling = false;

  Careless() = default;
  explicit Careless(const Params&) {}
  static AlgorithmInfo info() { return {.name = "planted_careless", .summary = "", .paper = "", .complexity = "1"}; }
  bool supports(ShapeKind a, ShapeKind b) const override { return a == ShapeKind::capsule && b == ShapeKind::box; }

  void query(std::span<const PairView<D>> pairs, QueryNeed, std::span<PairAnswer<D>> answers, std::span<PairMemory>,
             WorkDone&) override {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const PairView<D>& pair = pairs[i];
      PairAnswer<D> answer;
      answer.status = number(pair) % 5 == 0 ? QueryStatus::refused : QueryStatus::converged;
      answer.distance = pair.X_AB.p.norm() - Real(0.5);
      answer.normal = Vec<D>::Unit(number(pair) % D);
      answers[i] = answer;
      if (!retelling) tell(pair);
    }
  }

 private:
  static int number(const PairView<D>& pair) { return static_cast<int>(std::abs(pair.X_AB.p[0]) * 1000); }
  void tell(const PairView<D>& pair) {
    HardPair<D> same{.a = Shape<D>::capsule(pair.a.half[0], pair.a.radius), .b = Shape<D>::box(pair.b.half)};
    same.X_AB = pair.X_AB;
    retelling = true;
    const Verdict verdict = verifyPair<D>(
        same, Candidate<PairQuery<D>>{"planted_careless", info(), [] { return std::make_unique<Careless>(); }});
    retelling = false;
    if (verdict.error) errors.push_back(*verdict.error);
    refused += verdict.end == Tally::refused, wrong += verdict.end == Tally::wrong, wrongSides += verdict.wrongSide;
  }
};

template <int D>
void sameError() {
  static const Registrar<PairQuery, Careless, D> planted(__FILE__);
  Careless<D>::errors.clear();
  const TrialResult r = runTrial({{"trial",
                                   {{"kind", "pairs"},
                                    {"dimension", D},
                                    {"kind_a", "capsule"},
                                    {"kind_b", "box"},
                                    {"n", 240},
                                    {"seed", 3},
                                    {"pair_query", "planted_careless"}}}});
  const std::vector<double>& told = Careless<D>::errors;
  ASSERT_GT(told.size(), 100u);
  EXPECT_EQ(r.metrics.at("asked"), 240);
  EXPECT_EQ(r.metrics.at("refused"), 240 - static_cast<double>(told.size()));
  EXPECT_EQ(r.metrics.at("max_error"), *std::max_element(told.begin(), told.end()));
  EXPECT_EQ(r.metrics.at("median_error"), quantile(told, 0.5));
  EXPECT_EQ(r.metrics.at("refused"), Careless<D>::refused);
  EXPECT_EQ(r.metrics.at("wrong_boolean"), Careless<D>::wrongSides);
  EXPECT_EQ(r.metrics.at("wrong"), Careless<D>::wrong);
  EXPECT_GT(Careless<D>::wrong, Careless<D>::wrongSides) << "wrong by the distance alone counts";
  EXPECT_GT(Careless<D>::wrongSides, 0);
  EXPECT_EQ(r.outcome, "wrong");
}
TEST(PairsTrial, AnErrorIsThatOfTheLedger) { sameError<2>(), sameError<3>(); }

TEST(PairsTrial, TheRefereesCodeIsPartOfTheKeyOfPairsAlone) {
  Planner planner;
  const nlohmann::json pairs =
      planner
          .pairs({{"dimension", 3}, {"kind_a", "box"}, {"kind_b", "box"}, {"pair_query", "sat"}, {"precision", "f64"}})
          .canonical;
  const nlohmann::json boxes =
      planner.boxes({{"dimension", 3}, {"n", 8}, {"distribution", "uniform"}, {"broadphase", "naive"}}).canonical;
  EXPECT_EQ(pairs.at("code").at("oracles"), oraclesHash());
  EXPECT_FALSE(boxes.at("code").contains("oracles"));
}

// What judges is in the key of every trial of pairs; an adapter, changed or new, is not.
TEST(PairsTrial, AnAdapterIsNoneOfTheRefereesCode) {
  const auto hash = [](std::string_view referee, std::string_view adapter) {
    return judgesHash(std::array<SourceHash, 2>{{{"oracles/referee.h", referee}, {"oracles/fcl.cpp", adapter}}});
  };
  EXPECT_EQ(hash("same", "before"), hash("same", "after"));
  EXPECT_EQ(hash("same", "before"), judgesHash(std::array<SourceHash, 1>{{{"oracles/referee.h", "same"}}}));
  EXPECT_NE(hash("before", "same"), hash("after", "same"));
}

// An adapter that calls other people's code has the version of that in the keys of its own trials.
TEST(PairsTrial, ALibrarysVersionIsPartOfTheKeyOfItsWitness) {
  const std::regex foreign("#include <[^>]+/"), version("[A-Za-z0-9]+ [0-9.]+(, [A-Za-z0-9]+ [0-9.]+)*");
  for (const int dimension : {2, 3}) {
    int witnesses = 0;
    for (const Registered* r : Registry::instance().list(StageKind::pairQuery, dimension)) {
      std::ifstream in(r->file);
      const std::string source{std::istreambuf_iterator<char>(in), {}};
      ASSERT_FALSE(source.empty()) << r->file;
      const nlohmann::json code = codeHashes(StageKind::pairQuery, Spec{r->info.name, {}}, dimension);
      EXPECT_TRUE(code.contains("pair_query/" + r->info.name));
      EXPECT_EQ(code.contains("library"), r->info.role == AlgorithmRole::witness && std::regex_search(source, foreign))
          << code;
      if (!code.contains("library")) continue;
      EXPECT_TRUE(std::regex_match(code.at("library").get<std::string>(), version)) << code;
      ++witnesses;
    }
    EXPECT_GE(witnesses, dimension == 3 ? 7 : 5);
  }
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::pairs_trial_test
