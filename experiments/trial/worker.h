// SPDX-License-Identifier: Zlib
#pragma once

#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "framework/math/check.h"
#include "framework/math/names.h"

namespace lpc {

/// A worker's main: reads a request as JSON from stdin, writes the result of `run` as JSON to stdout. Returns the exit
/// code.
template <class Run>
int answerOnce(const Run& run) {
  try {
    const std::string text{std::istreambuf_iterator<char>(std::cin), {}};
    std::cout << run(nlohmann::json::parse(text)).dump() << std::flush;
    return std::cout ? 0 : 1;
  } catch (const UserError& e) {
    std::cerr << "lpc: " << oneLine(e.what()) << "\n";
    return 2;
  } catch (const std::exception& e) {
    std::cerr << "error: " << oneLine(e.what()) << "\n";
    return 1;
  }
}

}  // namespace lpc
