// SPDX-License-Identifier: Zlib
#pragma once

#include "oracles/verify/case_run.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Runs a case of a time of impact through the referee and every registered method. The value is the time (s), infinite
/// without impact; the referee's reason has its interval. The error is the separation at that time, relative to s: a
/// method is judged by the referee, the file's expected time by the referee's interval.
template <int D>
void runImpact(const Case& c, const CaseGeometry<D>& g, std::vector<CaseResult>& rows);

}}  // namespace lpc::LPC_PRECISION
