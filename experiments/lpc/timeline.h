// SPDX-License-Identifier: Zlib
// The phases of a step over a run, stacked on the terminal, with the names of the 2009 report (figures 7.1 and 7.2).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// From the series of a timed world trial. A run without steps gives a message.
std::string timeline(const std::map<std::string, std::vector<double>>& series);

}}  // namespace lpc::LPC_PRECISION
