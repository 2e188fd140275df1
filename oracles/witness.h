// SPDX-License-Identifier: Zlib
// Other people's code behind PairQuery. It runs in a process of its own, because on known inputs it throws, aborts on
// its own assertions, faults or never returns.
#pragma once

#include <cstdint>
#include <span>

#include "framework/stage_narrowphase.h"

namespace lpc::inline LPC_PRECISION {

/// How one call of a witness ended. All but `answered` come with QueryStatus::failed.
enum class Ending : std::uint8_t { answered, notFinite, threw, crashed, hung };
std::string_view endingName(Ending ending);

template <int D>
class Witness : public PairQuery<D> {
 public:
  /// Of the last batch, one per pair.
  virtual std::span<const Ending> endings() const = 0;
  /// Time inside the library for the last batch, without the way to its process and back (ns).
  virtual std::int64_t nanoseconds() const = 0;
};

}  // namespace lpc::inline LPC_PRECISION
