// SPDX-License-Identifier: Zlib
#include "tests/check_property.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <sstream>

#include "tests/run_property.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

int caseCount(int cases) {
  const char* percent = std::getenv("LPC_TEST_CASES");
  const double factor = percent ? std::atof(percent) / 100 : 1;
  return std::max(1, static_cast<int>(cases * factor));
}

std::uint64_t seedOf(const std::string& name) {
  const char* fresh = std::getenv("LPC_TEST_SEED");
  return hashOf(name, 0xcbf29ce484222325u + (fresh ? std::strtoull(fresh, nullptr, 10) : 0u));
}

std::string currentTest() {
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  return std::string(sizeof(LPC_REAL) == 8 ? "f64." : "f32.") + info->test_suite_name() + "." + info->name();
}

/// Prints nothing: GoogleTest reports failures, and a caught planted bug is no failure.
class SilentListener final : public rc::detail::TestListener {
 public:
  void onTestCaseFinished(const rc::detail::CaseDescription&) override {}
  void onShrinkTried(const rc::detail::CaseDescription&, bool) override {}
  void onTestFinished(const rc::detail::TestMetadata&, const rc::detail::TestResult&) override {}
};

rc::detail::TestResult runProperty(const std::string& name, const Property& property, int cases, Shrink shrink,
                                   const rc::detail::Reproduce* only) {
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

std::string counterexample(const KeptFailures& kept, const std::string& id, const std::string& name,
                           const Property& property, int cases) {
  std::ostringstream message;
  if (const auto input = kept.find(id)) {
    const auto result = runProperty(name, property, cases, Shrink::yes, &*input);
    if (result.is<rc::detail::FailureResult>()) {
      rc::detail::printResultMessage(result, message);
      return kept.tell(id, message.str()) + "\nkept from an earlier run in " + kept.file(id).string();
    }
  }
  kept.drop(id);
  const auto result = runProperty(name, property, cases);
  if (result.is<rc::detail::SuccessResult>()) return "";
  rc::detail::printResultMessage(result, message);
  if (result.is<rc::detail::FailureResult>()) {
    kept.keep(id, result.get<rc::detail::FailureResult>().reproduce);
    return kept.tell(id, message.str()) + "\nkept in " + kept.file(id).string();
  }
  return message.str();
}

void check(const std::string& name, const Property& property, int cases) {
  static std::map<std::string, int> uses;  // a name may be used in both dimensions
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

void recordPlantedBug(const std::string& bug, int took, int allowed) {
  static std::map<std::string, std::string> lists;  // by test
  std::ostringstream line;
  line << currentTest() << " | " << bug << " | " << took << " | " << allowed << '\n';
  std::string& list = lists[currentTest()];
  list += line.str();
  replaceFile(std::filesystem::path(LPC_BINARY_DIR "/planted_bugs") / fileNameOf(currentTest()), list);
}

void expectFalsified(const std::string& bug, const Property& property, int cases) {
  const int allowed = std::max(cases, caseCount(cases));
  const auto result = runProperty(bug, property, allowed, Shrink::no);
  if (result.is<rc::detail::FailureResult>()) {
    recordPlantedBug(bug, result.get<rc::detail::FailureResult>().numSuccess + 1, allowed);
    return;
  }
  std::ostringstream message;
  rc::detail::printResultMessage(result, message);
  ADD_FAILURE() << "the planted bug was not caught in " << allowed << " cases: " << bug << "\n" << message.str();
}

void failCase(const char* file, int line, const char* assertion, const std::string& values) {
  throw rc::detail::CaseResult(rc::detail::CaseResult::Type::Failure,
                               rc::detail::makeExpressionMessage(file, line, assertion, values));
}

}}}  // namespace lpc::LPC_PRECISION::test
