// SPDX-License-Identifier: Zlib
// Pairs that `lpc verify` found, with the bits that a method was asked: it was wrong, is mended, and stays right. Each
// build takes the cases of its own precision.
#include <gtest/gtest.h>

#include "oracles/cases.h"
#include "oracles/verify.h"

namespace lpc::inline LPC_PRECISION {
namespace {

constexpr std::string_view kPrecision = sizeof(Real) == 8 ? "f64" : "f32";

std::vector<Case> foundCases() {
  std::vector<Case> cases = readCases(std::string(LPC_SOURCE_DIR) + "/tests/regressions/found_cases.json");
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

TEST(FoundCases, MendedOnesStayRight) {
  const std::vector<Case> cases = foundCases();
  EXPECT_GE(cases.size(), 2u);
  for (const Case& c : cases) EXPECT_EQ(ask(c, c.finding->method).failure, "") << c.id;
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
