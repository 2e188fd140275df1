// SPDX-License-Identifier: Zlib
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "framework/registry.h"

namespace lpc::inline LPC_PRECISION {

/// All registered algorithms, one entry per name: stage, name, summary, paper, complexity, guarantee, role, dimensions,
/// params, failures. What `lpc list --json` prints and what every store carries, so that a report knows whom it shows.
nlohmann::json describeAlgorithms();
/// Of one algorithm or entry: name, type, unit, meaning, default, range (two numbers or null), choices.
nlohmann::json describeParams(const std::vector<ParamInfo>& params);

/// `page` with the names of all competitors in a table, in place of what stands between its lines "<!-- registry -->"
/// and
/// "<!-- end -->". Throws UserError when it lacks them.
std::string withNames(const std::string& page);

std::string_view roleName(Role role);

}  // namespace lpc::inline LPC_PRECISION
