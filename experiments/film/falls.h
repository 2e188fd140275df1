// SPDX-License-Identifier: Zlib
#pragma once

#include "experiments/runner/scheduler.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Draws how runs of a sweep fell (diverged, exploded, collapsed): of each scene, dimension and kind of fall the run
/// that fell last, six runs of a sweep at most, of at most 300 bodies. Only those are run again, with a recording, so
/// that no other trial pays for pictures; what is drawn already is not. The strip goes into the store, for reports
/// without this program. False when Ctrl-C stopped it.
bool filmFalls(const PlannedSweep& sweep, Store& store, const RunOptions& options);

}}  // namespace lpc::LPC_PRECISION
