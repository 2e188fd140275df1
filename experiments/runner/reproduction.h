// SPDX-License-Identifier: Zlib
// A kept case as a program against the library of a witness alone, ready for that library's issue tracker.
#pragma once

#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The cases that `lpc verify --repro` and `lpc corpus` take when none are named: published inputs that broke
/// libraries.
std::string keptCases();

struct Reproduction {
  std::string program;  // C++; returns 1 where the library's answer is outside the proved interval
  std::string told;     // one line: what the witness makes of the case here
};

/// `which`: the id of a case of the file, or its number, from 0. `witness`: with parameters, as
/// libccd_gjk{tolerance=1e-6}. `file`: as the line that compiles it shall call it. Throws UserError where the case is
/// no pair, or the witness does not take it.
Reproduction reproduce(const std::string& casesFile, const std::string& which, const std::string& witness,
                       const std::string& file);

}}  // namespace lpc::LPC_PRECISION
