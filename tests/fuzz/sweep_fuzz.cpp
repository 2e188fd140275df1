// SPDX-License-Identifier: Zlib
// The text of a sweep is rejected, or its trials are planned.
#include "experiments/runner/sweep_file.h"
#include "tests/fuzz/target.h"

namespace lpc { inline namespace LPC_PRECISION {

void fuzz(std::string_view text) {
  const MemoryFile file(text);
  try {
    planSweeps(file.path(), {});
  } catch (const UserError&) {
  }
}

}}  // namespace lpc::LPC_PRECISION
