// SPDX-License-Identifier: Zlib
// lpc-worker-<precision>: one trial (or, with oracles, one task of a verification) as JSON on stdin, its result as JSON
// on stdout.
#include <cstdio>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "experiments/trial/trial.h"
#include "framework/check.h"
#include "framework/names.h"
#ifdef LPC_HAS_ORACLES
#include "experiments/trial/verify_task.h"
#endif

namespace {

nlohmann::json run(const nlohmann::json& request) {
#ifdef LPC_HAS_ORACLES
  if (request.contains("verify")) return lpc::runVerifyTask(request);
  if (request.contains("cases")) return lpc::runCasesTask(request);
#endif
  return lpc::toJson(lpc::runTrial(request));
}

}  // namespace

int main() {
  try {
    const std::string text{std::istreambuf_iterator<char>(std::cin), {}};
    std::cout << run(nlohmann::json::parse(text)).dump() << std::flush;
    return std::cout ? 0 : 1;
  } catch (const lpc::UserError& e) {
    std::cerr << "lpc: " << lpc::oneLine(e.what()) << "\n";
    return 2;
  } catch (const std::exception& e) {
    std::cerr << "error: " << lpc::oneLine(e.what()) << "\n";
    return 1;
  }
}
