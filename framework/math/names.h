// SPDX-License-Identifier: Zlib
// Names in messages: what is valid, and what a wrong one was likely meant to be.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lpc {

/// "a, b, c".
std::string joined(const std::vector<std::string>& names);

/// The first of `names` that is a slip of the pen away from `given`: a few letters other, missing or swapped, or
/// `given` a part of it. Empty when none is.
std::string meantName(const std::vector<std::string>& names, std::string_view given);

/// What ends a message about the unknown name `given`: "; valid: a, b, c", or "; did you mean 'b'? valid: a, b, c".
std::string validNames(const std::vector<std::string>& names, std::string_view given);

/// A message as one line that a terminal, a table and JSON can take, whatever it quotes: control characters and bytes
/// that are no UTF-8 are written out (`\n`, `\x1b`), and what is too long for a reader is cut in its middle.
std::string oneLine(std::string_view message);

}  // namespace lpc
