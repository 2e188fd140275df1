// SPDX-License-Identifier: Zlib
#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiments/runner/store.h"
#include "experiments/runner/sweep_file.h"

namespace lpc { inline namespace LPC_PRECISION {

struct RunOptions {
  int jobs = 0;                      // untimed trials at once; 0: one per core
  bool retry = false;                // repeat trials that ended in timeout, crash or out_of_memory
  bool partial = false;              // only a part of the sweeps was requested: plans are extended, not replaced
  bool quiet = false;                // no progress output
  std::vector<std::string> plugins;  // paths, for the workers
};

struct RunSummary {
  // Number of planned trials, including those of searches: planned = shared + skipped + run + left.
  long planned = 0, skipped = 0, run = 0;
  long shared = 0;                       // in two cells; each runs once
  std::map<std::string, long> outcomes;  // of the trials run now
  std::map<std::string, long> wrong;     // number of wrong trials by kind of pair query
  long bad = 0;                          // outcomes other than ok and unsupported, of the trials run now
  bool stopped = false;                  // by Ctrl-C
  long left() const { return planned - shared - skipped - run; }
};

/// Throws UserError if a worker of these sweeps cannot be started.
void checkWorkers(const std::vector<PlannedSweep>& sweeps);

/// Runs the trials missing in the store: first all untimed ones, one worker per core, then timed ones, one at a time on
/// a core of its own, in a fixed shuffled order. Each trial is stored when it finishes. Ctrl-C kills the workers and
/// returns. Calibrated sweeps and searches of breaking points run first, and add their trials.
RunSummary runSweeps(std::vector<PlannedSweep>& sweeps, Store& store, const RunOptions& options);

}}  // namespace lpc::LPC_PRECISION
