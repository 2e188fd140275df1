// SPDX-License-Identifier: Zlib
// lpc-sandbox: started by `lpc sandbox`, with its task as JSON.
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "experiments/sandbox/app.h"
#include "experiments/trial/plugin.h"
#include "framework/math/check.h"
#include "framework/math/names.h"

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw lpc::UserError("lpc-sandbox is started by `lpc sandbox`");
    const lpc::Opening opening = lpc::openingFromJson(nlohmann::json::parse(argv[1]));
    for (const std::string& path : opening.plugins) lpc::loadPlugin(path);
    std::optional<lpc::InputScript> script;
    if (!opening.input.empty()) script.emplace(opening.input);
    lpc::Window window("LPC sandbox", 1280, 800);
    if (script) window.limitFrames(0), window.holdMouse({0, 0});
    lpc::show(window, opening, script ? &*script : nullptr);
    return 0;
  } catch (const lpc::UserError& e) {
    std::cerr << "lpc: " << lpc::oneLine(e.what()) << "\n";
    return 2;
  } catch (const std::exception& e) {
    std::cerr << "lpc: " << lpc::oneLine(e.what()) << "\n";
    return 1;
  }
}
