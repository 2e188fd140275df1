// SPDX-License-Identifier: Zlib
// One RapidCheck run of a property, for check_property.cpp and for the tests of the search itself.
#pragma once

#include <rapidcheck.h>

#include <string>

#include "tests/check_property.h"
#include "tests/kept_failures.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

enum class Shrink { no, yes };

/// With `only`, runs that input instead of drawn ones.
rc::detail::TestResult runProperty(const std::string& name, const Property& property, int cases,
                                   Shrink shrink = Shrink::yes, const rc::detail::Reproduce* only = nullptr);

/// Runs the kept input of an earlier failure, then `cases` drawn ones. Returns the shrunk counterexample as text and
/// keeps it under `id`; returns an empty string if the property holds.
std::string counterexample(const KeptFailures& kept, const std::string& id, const std::string& name,
                           const Property& property, int cases);

}}}  // namespace lpc::LPC_PRECISION::test
