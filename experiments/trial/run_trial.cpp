// SPDX-License-Identifier: Zlib
// Apart from trial.cpp: a worker with engines takes in no judge of pairs.
#include <nlohmann/json.hpp>

#include "experiments/trial/plugin.h"
#include "experiments/trial/trial.h"
#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {

using nlohmann::json;

TrialResult runTrial(const json& request) {
  for (const auto& path : request.value("plugins", std::vector<std::string>{})) loadPlugin(path);
  const std::string kind = request.at("trial").at("kind");
  if (kind == "world") return runWorldTrial(request);
  if (kind == "boxes") return runBoxesTrial(request);
  if (kind == "problems") return runProblemsTrial(request);
  if (kind == "pairs") {
#ifdef LPC_HAS_ORACLES
    return runPairsTrial(request);
#else
    TrialResult out;
    out.fail("unsupported", "this build has no referee (LPC_BUILD_ORACLES=OFF)", 0);
    return out;
#endif
  }
  throw UserError("unknown trial kind '" + kind + "'; valid: world, boxes, pairs, problems");
}

}}  // namespace lpc::LPC_PRECISION
