// SPDX-License-Identifier: Zlib
// Where in a file a message belongs whose writer knows names, but no files.
#pragma once

#include <string>
#include <vector>

#include "experiments/parse/toml_reader.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Something that takes part in what went wrong.
struct WrittenText {
  std::string name, text;            // `broadphase`, "region_tree{margin=2}"
  const toml::node* node = nullptr;  // where it stands
  std::string given;                 // "--set 'n=50'" of one that the command line has instead
};

/// Throws UserError with the message and the place of the text that has most of the names which the message has in
/// quotes, before what it says is valid; among equals of the one that is named itself, then of the first. Where no text
/// has any, it is what the command line gives and the message names, or else `otherwise`.
[[noreturn]] void failWhereWritten(const std::string& file, const std::string& message,
                                   const std::vector<WrittenText>& texts, const toml::node& otherwise);

}}  // namespace lpc::LPC_PRECISION
