// SPDX-License-Identifier: Zlib
#include "experiments/trial/measure/memory_counter.h"

#include <malloc.h>

#include <cstdlib>
#include <limits>
#include <new>

#ifdef LPC_SANITIZED

namespace lpc { inline namespace LPC_PRECISION {
MemoryCounter memoryCounter() { return nullptr; }
}}  // namespace lpc::LPC_PRECISION

#else

namespace {

// Until counting starts, an allocation costs malloc and a branch.
constinit thread_local bool memoryIsCounted = false;
constinit thread_local lpc::MemoryUse memoryCounted;

void* allocateCounted(void* memory) {
  if (!memory) throw std::bad_alloc();
  if (memoryIsCounted) {
    const auto bytes = static_cast<std::int64_t>(malloc_usable_size(memory));
    memoryCounted += {1, bytes, bytes};
  }
  return memory;
}

void freeCounted(void* memory) {
  if (memoryIsCounted && memory) memoryCounted.held -= static_cast<std::int64_t>(malloc_usable_size(memory));
  std::free(memory);
}

// As aligned_alloc requires.
std::size_t roundedUp(std::size_t size, std::align_val_t to) {
  const auto step = static_cast<std::size_t>(to);
  if (size > std::numeric_limits<std::size_t>::max() - (step - 1)) throw std::bad_alloc();
  return (size + step - 1) / step * step;
}

}  // namespace

// The forms that do not throw, and the array forms not defined here, call these.
void* operator new(std::size_t size) { return allocateCounted(std::malloc(size > 0 ? size : 1)); }
void* operator new(std::size_t size, std::align_val_t to) {
  return allocateCounted(std::aligned_alloc(static_cast<std::size_t>(to), roundedUp(size > 0 ? size : 1, to)));
}
void operator delete(void* memory) noexcept { freeCounted(memory); }
void operator delete(void* memory, std::size_t) noexcept { freeCounted(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { freeCounted(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { freeCounted(memory); }

namespace lpc { inline namespace LPC_PRECISION {

MemoryCounter memoryCounter() {
  memoryIsCounted = true;
  return [] { return memoryCounted; };
}

}}  // namespace lpc::LPC_PRECISION

#endif
