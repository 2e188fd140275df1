// SPDX-License-Identifier: Zlib
// A sweep file (TOML, experiments/sweeps/*.toml): axes, whose product is the cells. docs/manual.md describes the
// format.
#pragma once

#include <string>
#include <vector>

#include "experiments/runner/trial_plan.h"

namespace lpc::inline LPC_PRECISION {

struct PlannedSweep {
  std::string name;
  double wallLimit = 120;  // s, per trial
  double memoryLimit = 4;  // GiB, per trial
  std::vector<PlannedTrial> trials;
};

/// The sweeps of a file: itself, or those of a set (`sweeps = [...]`). Throws UserError with file and line, also for
/// mistakes in the scenes and pipelines that it names. `only` keeps the cells in which one of these labels, algorithms
/// or scenes takes part; `--only` of something that nobody has is a mistake.
std::vector<PlannedSweep> planSweeps(const std::string& nameOrPath, const std::vector<std::string>& only);

}  // namespace lpc::inline LPC_PRECISION
