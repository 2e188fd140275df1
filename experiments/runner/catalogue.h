// SPDX-License-Identifier: Zlib
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "experiments/runner/store.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// All registered algorithms, one entry per name: stage, its group, name, summary, paper, complexity, guarantee, role,
/// dimensions, params, failures. What `lpc list --json` prints.
nlohmann::json describeAlgorithms();
/// Of one algorithm or entry: name, type, unit, meaning, default, range (two numbers or null), choices.
nlohmann::json describeParams(const std::vector<ParamInfo>& params);

/// All metrics and series that trials measure: what (metric, series), kind of trial, name, title, unit, meaning, role,
/// smaller, needs.
nlohmann::json describeMeasures();

/// Writes both into the store, so that a report knows whom and what it shows.
void describeProgram(Store& store);

/// `page` with the names of all competitors in a table, in place of what stands between its lines "<!-- registry -->"
/// and
/// "<!-- end -->". Throws UserError when it lacks them.
std::string withNames(const std::string& page);

std::string_view roleName(AlgorithmRole role);

}}  // namespace lpc::LPC_PRECISION
