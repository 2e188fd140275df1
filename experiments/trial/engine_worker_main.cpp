// SPDX-License-Identifier: Zlib
// lpc-engine-worker-<precision>: one trial of kind "world" with an engine as JSON on stdin, its result as JSON on
// stdout.
#include <string>
#include <vector>

#include "experiments/trial/plugin.h"
#include "experiments/trial/trial.h"
#include "experiments/trial/worker.h"

int main() {
  return lpc::answerOnce([](const nlohmann::json& request) {
    const lpc::TrialRequest asked = lpc::requestFromJson(request);
    for (const std::string& path : asked.plugins) lpc::loadPlugin(path);
    return lpc::toJson(lpc::runWorldTrial(asked));
  });
}
