// SPDX-License-Identifier: Zlib
#pragma once

namespace lpc {

/// Largest nesting depth of user input: specs in specs, lists in lists, parentheses in parentheses. Ten are enough in
/// practice. Readers recurse at each level, and 30,000 levels overflow a stack.
inline constexpr int kMostNested = 64;

}  // namespace lpc
