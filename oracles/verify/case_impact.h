// SPDX-License-Identifier: Zlib
#pragma once

#include "oracles/verify/case_run.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A case of a time of impact through the referee and every method that is registered. Its value is the time (s), that
/// of who never meet is infinite; its error is the way that B's fastest point goes in the time that it is off, over s.
template <int D>
void runImpact(const Case& c, const CaseGeometry<D>& g, std::vector<CaseResult>& rows);

}}  // namespace lpc::LPC_PRECISION
