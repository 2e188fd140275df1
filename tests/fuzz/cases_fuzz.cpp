// SPDX-License-Identifier: Zlib
// A file of cases is read or rejected. tests/fuzz/mutate.py passes its content to the methods.
#include "oracles/corpus/cases.h"
#include "tests/fuzz/target.h"

namespace lpc { inline namespace LPC_PRECISION {

void fuzz(std::string_view text) {
  const MemoryFile file(text);
  try {
    readCases(file.path());
  } catch (const UserError&) {
  }
}

}}  // namespace lpc::LPC_PRECISION
