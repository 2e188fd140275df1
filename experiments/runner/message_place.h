// SPDX-License-Identifier: Zlib
// Finds file:line for an error message.
#pragma once

#include <string>
#include <vector>

#include "experiments/parse/toml_reader.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A text of the file that may have caused the error.
struct WrittenText {
  std::string name, text;            // `broadphase`, "region_tree{margin=2}"
  const toml::node* node = nullptr;  // its position
  std::string given;                 // "--set 'n=50'" if the command line gave it
};

/// Throws UserError with the message and the position of its most likely cause: the text that contains most of the
/// names quoted in the message before its list of valid values; among equals the text with a quoted name of its own,
/// then the first. If no text contains any, the position is the command-line option that the message names, or else
/// `otherwise`.
[[noreturn]] void failWhereWritten(const std::string& file, const std::string& message,
                                   const std::vector<WrittenText>& texts, const toml::node& otherwise);

}}  // namespace lpc::LPC_PRECISION
