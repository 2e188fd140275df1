// SPDX-License-Identifier: Zlib
// Properties under GoogleTest with fixed seeds:
//
//   lpc::test::check("support points are extreme", [] { ... RC_ASSERT(...); });
//   lpc::test::expectFalsified("... of a wrong twin", [] { ... });   // a check that cannot fail is no check
//
// LPC_TEST_CASES scales the number of cases, in percent; LPC_TEST_SEED, a number, replaces the fixed seed.
#pragma once

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

namespace lpc::inline LPC_PRECISION::test {

/// The number of cases to run where the source says `cases`.
inline int caseCount(int cases) {
  const char* percent = std::getenv("LPC_TEST_CASES");
  const double factor = percent ? std::atof(percent) / 100 : 1;
  return std::max(1, static_cast<int>(cases * factor));
}

/// One stream of random numbers per property name, so that adding a property changes no other.
inline std::uint64_t seedOf(const std::string& name) {
  const char* fresh = std::getenv("LPC_TEST_SEED");
  std::uint64_t h = 0xcbf29ce484222325u + (fresh ? std::strtoull(fresh, nullptr, 10) : 0u);
  for (const char c : name) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return h;
}

/// Says nothing: what failed is said by GoogleTest, and a planted bug that is found is no failure.
class SilentListener final : public rc::detail::TestListener {
 public:
  void onTestCaseFinished(const rc::detail::CaseDescription&) override {}
  void onShrinkTried(const rc::detail::CaseDescription&, bool) override {}
  void onTestFinished(const rc::detail::TestMetadata&, const rc::detail::TestResult&) override {}
};

template <class Testable>
rc::detail::TestResult runProperty(const std::string& name, Testable&& property, int cases) {
  rc::detail::TestMetadata metadata;
  metadata.id = name, metadata.description = name;
  rc::detail::TestParams params;
  params.seed = seedOf(name);
  params.maxSuccess = cases;
  SilentListener silent;
  return rc::detail::checkTestable(std::forward<Testable>(property), metadata, params, silent);
}

/// Fails the running test with the shrunk counterexample when the property does not hold.
template <class Testable>
void check(const std::string& name, Testable&& property, int cases = 100) {
  const auto result = runProperty(name, std::forward<Testable>(property), caseCount(cases));
  if (result.template is<rc::detail::SuccessResult>()) return;
  std::ostringstream message;
  rc::detail::printResultMessage(result, message);
  const char* seed = std::getenv("LPC_TEST_SEED");
  ADD_FAILURE() << "property: " << name << "\n"
                << message.str() << "\nreplay: LPC_TEST_CASES=" << 100 * caseCount(cases) / cases
                << (seed ? std::string(" LPC_TEST_SEED=") + seed : "") << " and this test alone";
}

/// Fails the running test unless a counterexample is found: for planted bugs. Never with fewer cases than it says: the
/// search ends at the first one, so there is nothing to save.
template <class Testable>
void expectFalsified(const std::string& name, Testable&& property, int cases = 1000) {
  const auto result = runProperty(name, std::forward<Testable>(property), std::max(cases, caseCount(cases)));
  if (result.template is<rc::detail::FailureResult>()) return;
  std::ostringstream message;
  rc::detail::printResultMessage(result, message);
  ADD_FAILURE() << "the planted bug was not caught by: " << name << "\n" << message.str();
}

}  // namespace lpc::inline LPC_PRECISION::test
