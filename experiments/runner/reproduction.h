// SPDX-License-Identifier: Zlib
// Writes a kept case as a program with a witness's library alone, for that library's issue tracker.
#pragma once

#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The default cases of `lpc verify --repro` and `lpc corpus`: published inputs that broke libraries.
std::string keptCases();

struct Reproduction {
  std::string program;  // C++; returns 1 if the library's answer is outside the proved interval
  std::string told;     // one line: the witness's result for the case here
};

/// `which`: the id of a case in the file, or its index from 0. `witness`: with parameters, as
/// libccd_gjk{tolerance=1e-6}. `file`: the name in the compile command. Throws UserError if the case is not a pair, or
/// the witness does not support it.
Reproduction reproduce(const std::string& casesFile, const std::string& which, const std::string& witness,
                       const std::string& file);

}}  // namespace lpc::LPC_PRECISION
