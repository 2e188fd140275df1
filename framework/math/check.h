// SPDX-License-Identifier: Zlib
// A programming error stops the program where it happens. A user's error becomes one clear line at the boundary.
// Numerical outcomes are neither: they are statuses in the answers.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace lpc {

/// An error of the user: what was found, where, and what is valid. The `lpc` program prints it and exits with 2.
struct UserError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace lpc

/// On in Debug, in tests and wherever LPC_ENABLE_ASSERT is defined.
#if defined(LPC_ENABLE_ASSERT) || !defined(NDEBUG)
#define LPC_ASSERT(condition) \
  ((condition)                \
       ? void(0)              \
       : (std::fprintf(stderr, "%s:%d: assertion failed: %s\n", __FILE__, __LINE__, #condition), std::abort()))
#else
#define LPC_ASSERT(condition) void(0)
#endif
