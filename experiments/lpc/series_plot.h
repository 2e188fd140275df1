// SPDX-License-Identifier: Zlib
// A series on the terminal.
#pragma once

#include <string>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The series in at most `width` columns, each as high as the largest of its steps, in eighths of a row from the
/// smaller of 0 and the least value of all to the largest of all; light above the least of its steps; a blank where it
/// has none. One string per row, from the top.
std::vector<std::string> barRows(const std::vector<double>& series, std::size_t width, std::size_t height);

/// One row, and beside it from where to where it goes.
std::string sparkline(const std::string& name, const std::vector<double>& series, const std::string& unit);
/// Several rows with both axes.
std::string plot(const std::string& name, const std::vector<double>& series, const std::string& unit);

}}  // namespace lpc::LPC_PRECISION
