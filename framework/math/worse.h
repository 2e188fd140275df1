// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <cmath>

namespace lpc { inline namespace LPC_PRECISION {

/// The larger of two errors. NaN is the worst, and stays: std::max(x, NaN) is x, and who judges by it calls NaN right.
inline double worse(double a, double b) { return std::isnan(b) ? b : std::max(a, b); }

}}  // namespace lpc::LPC_PRECISION
