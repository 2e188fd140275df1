// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <cmath>

namespace lpc { inline namespace LPC_PRECISION {

/// The larger of two errors. NaN is the largest and stays: std::max(x, NaN) is x, so a test of the result of std::max
/// would accept NaN.
inline double worse(double a, double b) { return std::isnan(b) ? b : std::max(a, b); }

}}  // namespace lpc::LPC_PRECISION
