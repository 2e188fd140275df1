// SPDX-License-Identifier: Zlib
// Names in messages: the valid names, and the name that a wrong one probably meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lpc {

/// Joins names as "a, b, c".
std::string joined(const std::vector<std::string>& names);

/// The first of `names` that `given` probably meant: a few letters differ, are missing or are swapped, or `given` is
/// part of it. Empty when there is none.
std::string meantName(const std::vector<std::string>& names, std::string_view given);

/// The end of a message about the unknown name `given`: "; valid: a, b, c", or "; did you mean 'b'? valid: a, b, c".
std::string validNames(const std::vector<std::string>& names, std::string_view given);

/// Makes a message one line that a terminal, a table and JSON accept. Escapes control characters and invalid UTF-8
/// (`\n`, `\x1b`), and cuts long text in the middle.
std::string oneLine(std::string_view message);

}  // namespace lpc
