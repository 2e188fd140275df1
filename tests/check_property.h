// SPDX-License-Identifier: Zlib
// Properties under GoogleTest with fixed seeds:
//
//   lpc::test::check("support points are extreme", [] { ... RC_ASSERT(...); });
//   lpc::test::expectFalsified("a climber that stops early", [] { ... });   // a check that cannot fail is no check
//
// LPC_TEST_CASES scales the number of cases, in percent. LPC_TEST_SEED, a number, replaces the fixed seed. A failing
// input is kept in the build folder and runs first next time. Caught planted bugs are listed there.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>

#include "tests/assertion.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Draws its input (tests/draw.h) and fails by RC_ASSERT. A single type, so that RapidCheck is compiled once, in
/// check_property.cpp, and not for each property.
class Property {
 public:
  template <class Body>
  Property(Body body) : m_body(std::move(body)) {
    static_assert(std::is_void_v<std::invoke_result_t<Body>>, "what a property returns is lost: use RC_ASSERT");
  }
  void operator()() const { m_body(); }

 private:
  std::function<void()> m_body;
};

/// Number of cases of a property that names none.
inline constexpr int kCases = 100;

/// The number of cases to run for `cases` in the source.
int caseCount(int cases);

/// One random stream per property name: a new property changes no other.
std::uint64_t seedOf(const std::string& name);

/// The running test as ctest lists it: f64.Suite.Name.
std::string currentTest();

/// Fails the running test with the shrunk counterexample if the property does not hold.
void check(const std::string& name, const Property& property, int cases = kCases);

/// Appends "test | planted bug | the case that caught it | cases allowed" to the list that tests/run prints.
void recordPlantedBug(const std::string& bug, int took, int allowed);

/// For planted bugs: fails the running test unless a counterexample is found. `cases` is the number that the property
/// itself runs. LPC_TEST_CASES may raise it but not lower it: the search ends at the first counterexample, so fewer
/// cases save nothing.
void expectFalsified(const std::string& bug, const Property& property, int cases = kCases);

}}}  // namespace lpc::LPC_PRECISION::test
