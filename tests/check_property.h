// SPDX-License-Identifier: Zlib
// Properties under GoogleTest with fixed seeds:
//
//   lpc::test::check("support points are extreme", [] { ... RC_ASSERT(...); });
//   lpc::test::expectFalsified("a climber that stops early", [] { ... });   // a check that cannot fail is no check
//
// LPC_TEST_CASES scales the number of cases, in percent; LPC_TEST_SEED, a number, replaces the fixed seed. An input
// that fails is kept in the build folder and run first next time; planted bugs that were caught are listed there.
#pragma once

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>

#include "tests/kept_failures.h"

namespace lpc::inline LPC_PRECISION::test {

/// The ordinary number of cases of a property that says none.
inline constexpr int kCases = 100;

/// The number of cases to run where the source says `cases`.
inline int caseCount(int cases) {
  const char* percent = std::getenv("LPC_TEST_CASES");
  const double factor = percent ? std::atof(percent) / 100 : 1;
  return std::max(1, static_cast<int>(cases * factor));
}

/// One stream of random numbers per property name, so that adding a property changes no other.
inline std::uint64_t seedOf(const std::string& name) {
  const char* fresh = std::getenv("LPC_TEST_SEED");
  return hashOf(name, 0xcbf29ce484222325u + (fresh ? std::strtoull(fresh, nullptr, 10) : 0u));
}

/// As ctest lists it: f64.Suite.Name.
inline std::string currentTest() {
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  return std::string(sizeof(LPC_REAL) == 8 ? "f64." : "f32.") + info->test_suite_name() + "." + info->name();
}

/// Says nothing: what failed is said by GoogleTest, and a planted bug that is found is no failure.
class SilentListener final : public rc::detail::TestListener {
 public:
  void onTestCaseFinished(const rc::detail::CaseDescription&) override {}
  void onShrinkTried(const rc::detail::CaseDescription&, bool) override {}
  void onTestFinished(const rc::detail::TestMetadata&, const rc::detail::TestResult&) override {}
};

enum class Shrink { no, yes };

/// With `only`, that one input instead of drawn ones.
template <class Testable>
rc::detail::TestResult runProperty(const std::string& name, const Testable& property, int cases,
                                   Shrink shrink = Shrink::yes, const rc::detail::Reproduce* only = nullptr) {
  rc::detail::TestMetadata metadata;
  metadata.id = name, metadata.description = name;
  rc::detail::TestParams params;
  params.seed = seedOf(name);
  params.maxSuccess = cases;
  params.disableShrinking = shrink == Shrink::no;
  SilentListener silent;
  decltype(rc::detail::Configuration::reproduce) inputs;
  if (only) inputs[name] = *only;
  return rc::detail::checkTestable(property, metadata, params, silent, inputs);
}

/// Runs what was kept of an earlier failure and then `cases` drawn ones. Returns the shrunk counterexample as text,
/// which is kept under `id`; empty when the property holds.
template <class Testable>
std::string counterexample(const KeptFailures& kept, const std::string& id, const std::string& name,
                           const Testable& property, int cases) {
  std::ostringstream message;
  if (const auto input = kept.find(id)) {
    const auto result = runProperty(name, property, cases, Shrink::yes, &*input);
    if (result.template is<rc::detail::FailureResult>()) {
      rc::detail::printResultMessage(result, message);
      message << "\nkept from an earlier run in " << kept.file(id).string();
      return message.str();
    }
  }
  kept.drop(id);
  const auto result = runProperty(name, property, cases);
  if (result.template is<rc::detail::SuccessResult>()) return "";
  rc::detail::printResultMessage(result, message);
  if (result.template is<rc::detail::FailureResult>()) {
    kept.keep(id, result.template get<rc::detail::FailureResult>().reproduce);
    message << "\nkept in " << kept.file(id).string();
  }
  return message.str();
}

/// Fails the running test with the shrunk counterexample when the property does not hold.
template <class Testable>
void check(const std::string& name, const Testable& property, int cases = kCases) {
  static std::map<std::string, int> uses;  // one name may serve both dimensions
  std::string id = currentTest() + ": " + name;
  if (const int use = ++uses[id]; use > 1) id += " (" + std::to_string(use) + ")";
  const std::string fault =
      counterexample(KeptFailures(LPC_BINARY_DIR "/failures"), id, name, property, caseCount(cases));
  if (fault.empty()) return;
  const char* seed = std::getenv("LPC_TEST_SEED");
  ADD_FAILURE() << "property: " << name << "\n"
                << fault << "\nreplay: LPC_TEST_CASES=" << 100 * caseCount(cases) / cases
                << (seed ? std::string(" LPC_TEST_SEED=") + seed : "") << " ctest --test-dir " << LPC_BINARY_DIR
                << " -R '^" << currentTest() << "$'";
}

/// Puts "test | planted bug | the case that caught it | cases allowed" into the list that tests/run prints.
inline void recordPlantedBug(const std::string& bug, int took, int allowed) {
  static std::map<std::string, std::string> lists;  // by test
  std::ostringstream line;
  line << currentTest() << " | " << bug << " | " << took << " | " << allowed << '\n';
  std::string& list = lists[currentTest()];
  list += line.str();
  replaceFile(std::filesystem::path(LPC_BINARY_DIR "/planted_bugs") / fileNameOf(currentTest()), list);
}

/// Fails the running test unless a counterexample is found: for planted bugs. `cases` is what the property itself runs.
/// Never fewer than it says: the search ends at the first one, so there is nothing to save.
template <class Testable>
void expectFalsified(const std::string& bug, const Testable& property, int cases = kCases) {
  const int allowed = std::max(cases, caseCount(cases));
  const auto result = runProperty(bug, property, allowed, Shrink::no);
  if (result.template is<rc::detail::FailureResult>()) {
    recordPlantedBug(bug, result.template get<rc::detail::FailureResult>().numSuccess + 1, allowed);
    return;
  }
  std::ostringstream message;
  rc::detail::printResultMessage(result, message);
  ADD_FAILURE() << "the planted bug was not caught in " << allowed << " cases: " << bug << "\n" << message.str();
}

}  // namespace lpc::inline LPC_PRECISION::test
