// SPDX-License-Identifier: Zlib
// One run of a property by RapidCheck, for check_property.cpp and for the tests of the search itself.
#pragma once

#include <rapidcheck.h>

#include <string>

#include "tests/check_property.h"
#include "tests/kept_failures.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

enum class Shrink { no, yes };

/// With `only`, that one input instead of drawn ones.
rc::detail::TestResult runProperty(const std::string& name, const Property& property, int cases,
                                   Shrink shrink = Shrink::yes, const rc::detail::Reproduce* only = nullptr);

/// Runs what was kept of an earlier failure and then `cases` drawn ones. Returns the shrunk counterexample as text,
/// which is kept under `id`; empty when the property holds.
std::string counterexample(const KeptFailures& kept, const std::string& id, const std::string& name,
                           const Property& property, int cases);

}}}  // namespace lpc::LPC_PRECISION::test
