// SPDX-License-Identifier: Zlib
// A planted bug: it lacks #include "framework/world/invariants.h". In a batch, an earlier file could provide it.
#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

const StateInvariants* planted() { return nullptr; }

}}  // namespace lpc::LPC_PRECISION
