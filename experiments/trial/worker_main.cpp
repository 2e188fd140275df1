// SPDX-License-Identifier: Zlib
// lpc-worker-<precision>: one trial (or, with oracles, one task of a verification) as JSON on stdin, its result as JSON
// on stdout.
#include "experiments/trial/trial.h"
#include "experiments/trial/worker.h"
#ifdef LPC_HAS_ORACLES
#include "experiments/trial/verify_task.h"
#endif

namespace {

nlohmann::json run(const nlohmann::json& request) {
#ifdef LPC_HAS_ORACLES
  if (request.contains("verify")) return lpc::runVerifyTask(request);
  if (request.contains("cases")) return lpc::runCasesTask(request);
#endif
  return lpc::toJson(lpc::runTrial(lpc::requestFromJson(request)));
}

}  // namespace

int main() { return lpc::answerOnce(run); }
