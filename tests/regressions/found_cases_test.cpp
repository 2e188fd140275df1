// SPDX-License-Identifier: Zlib
// Pairs that `lpc verify` found, with the bits that a method was asked: it was wrong, is mended, and stays right. Each
// build takes the cases of its own precision.
#include <gtest/gtest.h>

#include "oracles/cases.h"

namespace lpc::inline LPC_PRECISION {
namespace {

constexpr std::string_view kPrecision = sizeof(Real) == 8 ? "f64" : "f32";

std::vector<Case> foundCases() {
  std::vector<Case> cases = readCases(std::string(LPC_SOURCE_DIR) + "/tests/regressions/found_cases.json");
  std::erase_if(cases, [](const Case& c) { return !c.finding || c.finding->precision != kPrecision; });
  return cases;
}

TEST(FoundCases, MendedOnesStayRight) {
  const std::vector<Case> cases = foundCases();
  EXPECT_GE(cases.size(), 2u);
  for (const Case& c : cases) EXPECT_EQ(askAgain(c, c.finding->method).failure, "") << c.id;
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
