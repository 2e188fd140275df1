// SPDX-License-Identifier: Zlib
#pragma once

namespace lpc {

/// How deep what a user writes may be nested: specs in specs, lists in lists, parentheses in parentheses. Nobody needs
/// ten; readers call themselves for each level, and 30,000 are the end of a stack.
inline constexpr int kMostNested = 64;

}  // namespace lpc
