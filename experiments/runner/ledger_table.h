// SPDX-License-Identifier: Zlib
#pragma once

#include <iosfwd>

#include "oracles/verify/ledger.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Prints, per stage, dimension and precision: the verdicts of each method, the share of its faults by family, regime,
/// scale and offset, and a line per pair of kinds. Returns the number of our methods with a fault.
int printLedger(const Ledger& ledger, std::ostream& out);

}}  // namespace lpc::LPC_PRECISION
