// SPDX-License-Identifier: Zlib
// Pairs that `lpc verify` found, with the bits that a method was asked: those of known_faults.json must still fail,
// those that were mended (found_cases.json) must pass. Each build takes the cases of its own precision.
#include <gtest/gtest.h>

#include <set>

#include "oracles/cases.h"
#include "oracles/verify.h"

namespace lpc::inline LPC_PRECISION {
namespace {

constexpr std::string_view kPrecision = sizeof(Real) == 8 ? "f64" : "f32";

std::vector<Case> foundCases(const std::string& file) {
  std::vector<Case> cases = readCases(std::string(LPC_SOURCE_DIR) + "/tests/regressions/" + file);
  std::erase_if(cases, [](const Case& c) { return !c.finding || c.finding->precision != kPrecision; });
  return cases;
}

template <class StageOf>
Candidate<StageOf> registered(const std::string& name) {
  return {name, Registry::instance().find(StageOf::kStage, StageOf::kDimension, name).info,
          [name] { return createStage<StageOf>(Spec::parse(name)); }};
}

template <int D>
Verdict ask(const CaseGeometry<D>& g, StageKind stage, const std::string& method) {
  return stage == StageKind::contacts ? verifyPair(g.pair(), registered<ContactGenerator<D>>(method))
                                      : verifyPair(g.pair(), registered<PairQuery<D>>(method));
}
Verdict ask(const Case& c, const std::string& method) {
  return std::visit([&](const auto& g) { return ask(g, c.finding->stage, method); }, c.geometry);
}

TEST(KnownFaults, EachStillFails) {
  const std::vector<Case> cases = foundCases("known_faults.json");
  for (const Case& c : cases) {
    const Verdict verdict = ask(c, c.finding->method);
    EXPECT_EQ(verdict.failure, c.finding->failure) << c.id << ": when it is mended, it moves to found_cases.json";
    EXPECT_NEAR(verdict.error.value_or(0), c.finding->error, 0.01 * c.finding->error) << c.id;
  }
}

// The check knows right from wrong: on each of these pairs another method of the stage is right.
TEST(KnownFaults, AnotherMethodIsRight) {
  for (const Case& c : foundCases("known_faults.json")) {
    const bool contacts = c.finding->stage == StageKind::contacts;
    const std::set<std::string> others = contacts ? std::set<std::string>{"deepest_point", "query_clip", "sat_clip"}
                                                  : std::set<std::string>{"gjk_epa", "sat"};
    int right = 0;
    for (const std::string& method : others) right += ask(c, method).failure.empty();
    EXPECT_GE(right, 1) << c.id;
  }
}

TEST(KnownFaults, MendedOnesStayRight) {
  const std::vector<Case> cases = foundCases("found_cases.json");
  EXPECT_GE(cases.size(), 2u);
  for (const Case& c : cases) EXPECT_EQ(ask(c, c.finding->method).failure, "") << c.id;
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
