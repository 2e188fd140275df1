// SPDX-License-Identifier: Zlib
#pragma once

#include "oracles/verify/case_run.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Runs a case of a time of impact through the referee and every registered method. The value is the time (s), infinite
/// without impact. The error is the path of B's fastest point during the error in time, relative to s.
template <int D>
void runImpact(const Case& c, const CaseGeometry<D>& g, std::vector<CaseResult>& rows);

}}  // namespace lpc::LPC_PRECISION
