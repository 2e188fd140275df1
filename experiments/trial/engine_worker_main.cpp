// SPDX-License-Identifier: Zlib
// lpc-engine-worker-<precision>: one trial of kind "world" with an engine as JSON on stdin, its result as JSON on
// stdout.
#include <cstdio>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "experiments/trial/plugin.h"
#include "experiments/trial/trial.h"
#include "framework/check.h"
#include "framework/names.h"

int main() {
  try {
    const std::string text{std::istreambuf_iterator<char>(std::cin), {}};
    const nlohmann::json request = nlohmann::json::parse(text);
    for (const auto& path : request.value("plugins", std::vector<std::string>{})) lpc::loadPlugin(path);
    std::cout << lpc::toJson(lpc::runWorldTrial(request)).dump() << std::flush;
    return std::cout ? 0 : 1;
  } catch (const lpc::UserError& e) {
    std::cerr << "lpc: " << lpc::oneLine(e.what()) << "\n";
    return 2;
  } catch (const std::exception& e) {
    std::cerr << "error: " << lpc::oneLine(e.what()) << "\n";
    return 1;
  }
}
