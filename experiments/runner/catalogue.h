// SPDX-License-Identifier: Zlib
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "experiments/runner/store.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// All registered algorithms, one entry per name: stage, its group, name, summary, paper, complexity, guarantee, role,
/// dimensions, params, failures. `lpc list --json` prints this.
nlohmann::json describeAlgorithms();
/// Of one algorithm or entry: name, type, unit, meaning, default, range (two numbers or null), choices.
nlohmann::json describeParams(const std::vector<ParamInfo>& params);

/// All metrics and series of trials: what (metric, series), kind of trial, name, title, unit, meaning, role, smaller,
/// needs.
nlohmann::json describeMeasures();

/// Writes both into the store, for the report.
void describeProgram(Store& store);

/// Returns `page` with the names of all competitors in a table between its lines "<!-- registry -->" and "<!-- end
/// -->". Throws UserError if it lacks these lines.
std::string withNames(const std::string& page);

std::string_view roleName(AlgorithmRole role);

}}  // namespace lpc::LPC_PRECISION
