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
    for (const auto& path : request.value("plugins", std::vector<std::string>{})) lpc::loadPlugin(path);
    return lpc::toJson(lpc::runWorldTrial(request));
  });
}
