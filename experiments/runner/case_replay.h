// SPDX-License-Identifier: Zlib
// Kept failures, asked again: each in a worker of the precision in which it was found, where it may crash or hang once
// more.
#pragma once

#include <string>
#include <vector>

#include "oracles/verify/case_run.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Of every case of the file that has a finding, the row of its method, of the referee and of the other methods.
/// `cases` are those of the file. Throws Interrupted.
std::vector<CaseResult> replayFound(const std::string& path, const std::vector<Case>& cases,
                                    const std::vector<std::string>& plugins);

}}  // namespace lpc::LPC_PRECISION
