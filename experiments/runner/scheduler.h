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
  bool retry = false;                // run again what ended in timeout, crash or out_of_memory
  bool partial = false;              // a part of the sweeps was asked for: plans are added to, not replaced
  bool quiet = false;                // no progress
  std::vector<std::string> plugins;  // paths, for the workers
};

struct RunSummary {
  // Of the trials that were planned, also by searches of settings: planned = shared + skipped + run + left.
  long planned = 0, skipped = 0, run = 0;
  long shared = 0;                       // asked for by two cells; each runs once
  std::map<std::string, long> outcomes;  // of those run now
  std::map<std::string, long> wrong;     // of those that are wrong: by kinds of pair queries
  long bad = 0;                          // outcomes other than ok and unsupported, of those run now
  bool stopped = false;                  // by Ctrl-C
  long left() const { return planned - shared - skipped - run; }
};

/// Throws UserError where a worker of these sweeps cannot be started.
void checkWorkers(const std::vector<PlannedSweep>& sweeps);

/// Runs what the store lacks: first all untimed trials, one worker per core, then timed ones, one at a time on a core
/// of its own, in a shuffled order that is the same every time. Each trial is in the store when it has finished. Ctrl-C
/// kills the workers and returns. Sweeps that are calibrated, or ask for breaking points, are searched first, and get
/// their trials by it.
RunSummary runSweeps(std::vector<PlannedSweep>& sweeps, Store& store, const RunOptions& options);

}}  // namespace lpc::LPC_PRECISION
