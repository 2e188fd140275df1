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

#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>

#include "tests/assertion.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Draws what it needs (tests/draw.h) and fails by RC_ASSERT. Of one type, so that RapidCheck is compiled once, in
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

/// The ordinary number of cases of a property that says none.
inline constexpr int kCases = 100;

/// The number of cases to run where the source says `cases`.
int caseCount(int cases);

/// One stream of random numbers per property name, so that adding a property changes no other.
std::uint64_t seedOf(const std::string& name);

/// As ctest lists it: f64.Suite.Name.
std::string currentTest();

/// Fails the running test with the shrunk counterexample when the property does not hold.
void check(const std::string& name, const Property& property, int cases = kCases);

/// Puts "test | planted bug | the case that caught it | cases allowed" into the list that tests/run prints.
void recordPlantedBug(const std::string& bug, int took, int allowed);

/// Fails the running test unless a counterexample is found: for planted bugs. `cases` is what the property itself runs.
/// Never fewer than it says: the search ends at the first one, so there is nothing to save.
void expectFalsified(const std::string& bug, const Property& property, int cases = kCases);

}}}  // namespace lpc::LPC_PRECISION::test
