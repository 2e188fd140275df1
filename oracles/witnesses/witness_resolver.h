// SPDX-License-Identifier: Zlib
// Other people's code behind VelocityResolver, in a process of its own: see witness.h.
#pragma once

#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
class WitnessResolver : public VelocityResolver<D> {
 public:
  /// Processor time of the last solve (ns), which no clock of one thread sees: ours, which makes the matrix, and that
  /// inside the library, without the way to its process and back.
  virtual double nanoseconds() const = 0;
};

}}  // namespace lpc::LPC_PRECISION
