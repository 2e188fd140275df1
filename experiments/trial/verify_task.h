// SPDX-License-Identifier: Zlib
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// {"verify": {"stage", "dimension", "kind_a", "kind_b", "seed", "first", "count", "methods": [...], "ended": tally,
/// "relations": true}, "plugins": [...]} -> the results (see ledger_json.h). "ended" is present if a worker with the
/// same request did not return: the failure is recorded and no method runs. Exists if the oracles were built.
nlohmann::json runVerifyTask(const nlohmann::json& request);

/// {"cases": {"file": path, "questions": [[number of a case with a finding, method], or [number of another case, ""],
/// ...]}, "plugins": [...]} -> their rows (see ledger_json.h).
nlohmann::json runCasesTask(const nlohmann::json& request);

}}  // namespace lpc::LPC_PRECISION
