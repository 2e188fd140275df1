// SPDX-License-Identifier: Zlib
// Runs cases in workers: kept failures in the precision in which each was found, where it may crash or hang again, and
// others in another precision than this build's.
#pragma once

#include <string>
#include <vector>

#include "oracles/verify/case_run.h"

namespace lpc { inline namespace LPC_PRECISION {

/// For every case of the file with a finding: the rows of its method, of the referee and of the other methods. For the
/// other cases, if `precision` is not empty: their rows in a worker of that precision. `cases` are those of the file.
/// Throws Interrupted.
std::vector<CaseResult> replayCases(const std::string& path, const std::vector<Case>& cases,
                                    const std::string& precision, const std::vector<std::string>& plugins);

}}  // namespace lpc::LPC_PRECISION
