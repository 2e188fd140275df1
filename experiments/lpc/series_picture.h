// SPDX-License-Identifier: Zlib
// Series of a run as a picture.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A run as SVG: a panel each for energy, worst penetration and largest speed over time, for those that the run has
/// measured. `dt` in s. Values that are not finite leave a gap.
std::string seriesPicture(const std::string& title, const std::map<std::string, std::vector<double>>& series,
                          double dt);

}}  // namespace lpc::LPC_PRECISION
