// SPDX-License-Identifier: Zlib
// Where in a file a message belongs whose writer knows names, but no files.
#pragma once

#include <string>
#include <vector>

#include "experiments/parse/toml_reader.h"

namespace lpc::inline LPC_PRECISION {

/// Something that takes part in what went wrong.
struct WrittenText {
  std::string name, text;            // `broadphase`, "region_tree{margin=2}"
  const toml::node* node = nullptr;  // where it stands
};

/// The text that has most of the names which the message has in quotes, before what it says is valid; among equals the
/// one that is named itself, then the first. None where no text has any.
const toml::node* placeOfMessage(const std::string& message, const std::vector<WrittenText>& texts);

}  // namespace lpc::inline LPC_PRECISION
