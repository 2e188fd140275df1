// SPDX-License-Identifier: Zlib
// Counts allocations of the program that links this file, by its own `operator new`.
#pragma once

#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Starts counting in this thread and returns the function that reads the counts (`Profiler::countMemory`). Sizes are
/// those of malloc's blocks. Null with sanitizers, which bring their own allocator. Direct calls of malloc, as in C
/// libraries, are not seen.
using MemoryCounter = MemoryUse (*)();
MemoryCounter memoryCounter();

}}  // namespace lpc::LPC_PRECISION
