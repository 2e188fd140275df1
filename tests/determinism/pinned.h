// SPDX-License-Identifier: Zlib
// Compares the pinned hashes to those of this build.
#pragma once

#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/determinism/scenes.h"

#define LPC_TEXT_OF_(x) #x
#define LPC_TEXT_OF(x) LPC_TEXT_OF_(x)

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// "heap_2d f64 0123456789abcdef", for each scene.
inline std::vector<std::string> hashLines() {
  std::vector<std::string> lines;
  const auto add = [&](const std::string& name, std::uint64_t hash) {
    char digits[20];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash));
    lines.push_back(name + " " LPC_TEXT_OF(LPC_PRECISION) " " + digits);
  };
  for (const auto& scene : pinnedScenes<2>()) add(scene.name, historyHash(scene));
  for (const auto& scene : pinnedScenes<3>()) add(scene.name, historyHash(scene));
  return lines;
}

/// The lines of a file of pinned hashes for this precision.
inline std::vector<std::string> pinnedLines(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw UserError(path + ": cannot be read");
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with('#') && line.find(" " LPC_TEXT_OF(LPC_PRECISION) " ") != std::string::npos) {
      lines.push_back(line);
    }
  }
  return lines;
}

}}}  // namespace lpc::LPC_PRECISION::test
