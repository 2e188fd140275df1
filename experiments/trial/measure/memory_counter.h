// SPDX-License-Identifier: Zlib
// Allocations of the program that this is linked into, counted by an `operator new` of its own.
#pragma once

#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Begins to count in this thread and gives what tells (`Profiler::countMemory`). Sizes are those of malloc's blocks.
/// Null where the sanitizers bring the allocator. What calls malloc itself, as C libraries do, is not seen.
using MemoryCounter = MemoryUse (*)();
MemoryCounter memoryCounter();

}}  // namespace lpc::LPC_PRECISION
