// SPDX-License-Identifier: Zlib
#pragma once

#include <ctime>

namespace lpc {

/// Processor time of this thread (ns), which other processes do not affect.
inline double threadNanoseconds() {
  std::timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

}  // namespace lpc
