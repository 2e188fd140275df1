// SPDX-License-Identifier: Zlib
// External libraries behind VelocityResolver, each in its own process: see witness.h.
#pragma once

#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
class WitnessResolver : public VelocityResolver<D> {
 public:
  /// Processor time of the last solve (ns): our time to build the matrix plus the time inside the library, without
  /// communication. The clock of one thread cannot measure it.
  virtual double nanoseconds() const = 0;
};

}}  // namespace lpc::LPC_PRECISION
