// SPDX-License-Identifier: Zlib
#pragma once

#include <string>
#include <vector>

#include "experiments/runner/store.h"
#include "experiments/runner/sweep_file.h"

namespace lpc::inline LPC_PRECISION {

struct RunOptions {
  int jobs = 0;                      // untimed trials at once; 0: one per core
  bool retry = false;                // run again what ended in timeout, crash or out_of_memory
  bool partial = false;              // a part of the sweeps was asked for: plans are added to, not replaced
  bool quiet = false;                // no progress
  std::vector<std::string> plugins;  // paths, for the workers
};

struct RunSummary {
  long planned = 0, skipped = 0, run = 0, bad = 0;  // bad: outcomes other than ok and unsupported, of those run now
  bool stopped = false;                             // by Ctrl-C
};

/// Runs what the store lacks: first all untimed trials, one worker per core, then timed ones, one at a time on a core
/// of its own, in a shuffled order that is the same every time. Each trial is in the store when it has finished. Ctrl-C
/// kills the workers and returns. Sweeps that are calibrated are so first, and get their trials by it.
RunSummary runSweeps(std::vector<PlannedSweep>& sweeps, Store& store, const RunOptions& options);

}  // namespace lpc::inline LPC_PRECISION
