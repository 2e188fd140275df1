// SPDX-License-Identifier: Zlib
// A libFuzzer target of LPC: a function of bytes in a file that includes this header once. It returns if the bytes are
// accepted or rejected correctly. Otherwise it ends the program, as an assertion or a sanitizer does.
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

/// A file in memory for functions that read from a path.
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
  // libFuzzer's own limit measures wall-clock time, which a busy machine exceeds.
  lpc::demand(std::clock() - start < 10 * CLOCKS_PER_SEC, "it took more than 10 s of processor time");
  return 0;
}
