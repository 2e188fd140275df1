// SPDX-License-Identifier: Zlib
#pragma once

#include "experiments/runner/scheduler.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Draws how runs of a sweep failed (diverged, exploded, collapsed): for each scene, dimension and kind of failure the
/// run that failed last; at most six runs of a sweep, with at most 300 bodies. Only these are run again with a
/// recording, so that other trials do not pay for pictures; existing pictures are kept. The strip goes into the store,
/// for reports without this program. Returns false if Ctrl-C stopped it.
bool filmFalls(const PlannedSweep& sweep, Store& store, const RunOptions& options);

}}  // namespace lpc::LPC_PRECISION
