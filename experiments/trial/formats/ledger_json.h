// SPDX-License-Identifier: Zlib
// Results of a worker's verification, on their way to the program that keeps the ledger.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "oracles/verify/case_run.h"
#include "oracles/verify/ledger.h"

namespace lpc { inline namespace LPC_PRECISION {

nlohmann::json toJson(const Verified& verified);
Verified verifiedFromJson(const nlohmann::json& json);

nlohmann::json caseRowsToJson(const std::vector<CaseResult>& rows);
std::vector<CaseResult> caseRowsFromJson(const nlohmann::json& json);

}}  // namespace lpc::LPC_PRECISION
