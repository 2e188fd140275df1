// SPDX-License-Identifier: Zlib
// A user mistake: exit code 2, a one-line message, and no files.
#pragma once

#include <algorithm>
#include <set>
#include <vector>

#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

using Parts = std::vector<std::string>;

inline void expectParts(const std::string& message, const Parts& parts, const std::string& input) {
  for (const std::string& part : parts) {
    EXPECT_NE(message.find(part), std::string::npos) << "input: " << input << "\nmessage: " << message;
  }
}

inline std::set<std::string> filesIn(const Workspace& w) {
  std::set<std::string> out;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(w.path(""))) out.insert(entry.path());
  return out;
}

/// Runs `lpc` and requires a one-line error that contains these parts.
inline void refused(const Workspace& w, const std::string& arguments, const Parts& parts,
                    const std::string& environment = "") {
  const auto before = filesIn(w);
  const Outcome out = w.lpc(arguments, environment);
  EXPECT_EQ(out.code, 2) << arguments << "\n" << out.text;
  EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << arguments << "\n" << out.text;
  expectParts(out.text, parts, arguments);
  EXPECT_EQ(filesIn(w), before) << arguments << " left something behind";
}

}}}  // namespace lpc::LPC_PRECISION::test
