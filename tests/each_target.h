// SPDX-License-Identifier: Zlib
// Runs kernels that Highway compiles for several instruction sets under each set that this processor has.
#pragma once

#include <hwy/targets.h>

#include <cstdint>
#include <functional>

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Calls f(target) with the processor's best target, then with each lesser one, then with the best again.
inline void forEachTarget(const std::function<void(std::int64_t)>& f) {
  const std::int64_t all = hwy::SupportedTargets();
  for (std::int64_t rest = all; rest != 0; rest &= rest - 1) {
    hwy::GetChosenTarget().Update(rest & -rest);
    f(rest & -rest);
  }
  hwy::GetChosenTarget().Update(all);
}

}}}  // namespace lpc::LPC_PRECISION::test
