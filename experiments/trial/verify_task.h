// SPDX-License-Identifier: Zlib
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// {"verify": {"stage", "dimension", "kind_a", "kind_b", "seed", "first", "count", "methods": [...], "ended": tally,
///  "relations": true}, "plugins": [...]} -> what came out (see ledger_json.h). "ended" is there when a worker that was
///  asked the same did not come back: it is booked and nobody is asked. Exists where the oracles were built.
nlohmann::json runVerifyTask(const nlohmann::json& request);

/// {"cases": {"file": path, "questions": [[number of a case with a finding, method], ...]}, "plugins": [...]} -> one
/// row each (see ledger_json.h).
nlohmann::json runCasesTask(const nlohmann::json& request);

}}  // namespace lpc::LPC_PRECISION
