// SPDX-License-Identifier: Zlib
// A series on the terminal.
#pragma once

#include <string>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The series in at most `width` columns. The height of a column is the largest of its steps, in eighths of a row, on a
/// scale from the smaller of 0 and the smallest value to the largest value; the part above its smallest step is light.
/// A column without values is blank. One string per row, from the top.
std::vector<std::string> barRows(const std::vector<double>& series, std::size_t width, std::size_t height);

/// One row, with its range beside it.
std::string sparkline(const std::string& name, const std::vector<double>& series, const std::string& unit);
/// Several rows with both axes.
std::string plot(const std::string& name, const std::vector<double>& series, const std::string& unit);

}}  // namespace lpc::LPC_PRECISION
