// SPDX-License-Identifier: Zlib
// What a libFuzzer target is here: a function of bytes, in a file that includes this once. It returns when the bytes
// are taken or refused as they should be, and stops the program otherwise, as an assertion and a sanitizer do.
//
// Run by hand, for hours: docs/verification.md.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <string_view>

#include "framework/math/check.h"
#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

void fuzz(std::string_view input);

inline void demand(bool holds, const char* otherwise) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: %s\n", otherwise);
  std::abort();
}

/// A file in memory, for what reads by a path.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : m_descriptor(memfd_create("input", 0)) {
    demand(write(m_descriptor, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()), "no memory file");
  }
  ~MemoryFile() { close(m_descriptor); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(m_descriptor); }

 private:
  int m_descriptor;
};

}}  // namespace lpc::LPC_PRECISION

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::clock_t start = std::clock();
  lpc::fuzz({reinterpret_cast<const char*>(data), size});
  // libFuzzer's own limit is by the clock on the wall, which a busy machine reaches.
  lpc::demand(std::clock() - start < 10 * CLOCKS_PER_SEC, "it took more than 10 s of processor time");
  return 0;
}
