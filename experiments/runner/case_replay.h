// SPDX-License-Identifier: Zlib
// Replays kept failures: each in a worker of the precision in which it was found, where it may crash or hang again.
#pragma once

#include <string>
#include <vector>

#include "oracles/verify/case_run.h"

namespace lpc { inline namespace LPC_PRECISION {

/// For every case of the file with a finding: the rows of its method, of the referee and of the other methods. `cases`
/// are those of the file. Throws Interrupted.
std::vector<CaseResult> replayFound(const std::string& path, const std::vector<Case>& cases,
                                    const std::vector<std::string>& plugins);

}}  // namespace lpc::LPC_PRECISION
