// SPDX-License-Identifier: Zlib
// Keeps the referee out of the engine worker.
#include "experiments/trial/plugin.h"
#include "experiments/trial/trial.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

TrialResult run(const WorldRequest&, const TrialRequest& request) { return runWorldTrial(request); }
TrialResult run(const BoxesRequest& asked, const TrialRequest&) { return runBoxesTrial(asked); }
TrialResult run(const ProblemRequest& asked, const TrialRequest& request) {
  return runProblemsTrial(asked, request.sceneFile);
}
#ifdef LPC_HAS_ORACLES
TrialResult run(const PairsRequest& asked, const TrialRequest&) { return runPairsTrial(asked); }
TrialResult run(const StreamRequest& asked, const TrialRequest& request) {
  return runStreamTrial(asked, request.sceneFile);
}
#else
TrialResult run(const TrialBase&, const TrialRequest&) {
  TrialResult out;
  out.fail("unsupported", "this build has no referee (LPC_BUILD_ORACLES=OFF)", 0);
  return out;
}
#endif

}  // namespace

TrialResult runTrial(const TrialRequest& request) {
  for (const std::string& path : request.plugins) loadPlugin(path);
  return std::visit([&](const auto& asked) { return run(asked, request); }, request.trial);
}

}}  // namespace lpc::LPC_PRECISION
