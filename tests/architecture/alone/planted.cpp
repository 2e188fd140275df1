// SPDX-License-Identifier: Zlib
// A planted bug: it lacks #include "framework/invariants.h". In a batch, a file before it could have that line.
#include "framework/shape.h"

namespace lpc::inline LPC_PRECISION {

const StateInvariants* planted() { return nullptr; }

}  // namespace lpc::inline LPC_PRECISION
