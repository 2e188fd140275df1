// SPDX-License-Identifier: Zlib
// A sweep file (TOML, experiments/sweeps/*.toml): axes, whose product is the cells. docs/manual.md describes the
// format.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/runner/breaking.h"
#include "experiments/runner/calibration.h"

namespace lpc { inline namespace LPC_PRECISION {

struct PlannedSweep {
  std::string name, kind, summary;
  std::string baseline;  // the value of an axis with which reports compare the others; may be empty
  /// What each axis is to the sweep: "label" (of pipelines), "stage", "setting" (used as $name in a pipeline),
  /// "parameter" (of the scene), or "run".
  std::map<std::string, std::string> roles;
  /// What whoever plans it should hear: it is right, but hardly what was meant.
  std::vector<std::string> notes;
  std::vector<std::string> charts;  // what it is for: charts of reports/charts; empty: whatever it has the data for
  /// What `lpc` was told to plan it, but for the store: a page prints it, so that what is shown can be made again.
  std::vector<std::string> command;
  double wallLimit = 120;  // s, per trial
  double memoryLimit = 4;  // GiB, per trial
  std::vector<PlannedTrial> trials;
  std::optional<Calibration> calibration;
  std::vector<CalibratedCell> calibrated;  // cells that `calibrate` turns into trials
  std::vector<Ladder> ladders;             // cells that `findBreaking` turns into trials
  std::vector<Broken> broken;              // what it has found, in their order
};

/// The sweeps of a file: itself, or those of a set (`sweeps = [...]`). Throws UserError with file and line, also for
/// mistakes in the scenes and pipelines that it names. `only` keeps the cells in which one of these labels, algorithms
/// or scenes takes part; `--only` of something that nobody has is a mistake. `with` holds methods that the files lack,
/// as "LABEL=PIPELINE": they join the labelled axis of `[axes]` in each sweep that has one. `set` holds "AXIS=VALUE":
/// the one value of that axis wherever a sweep has it.
std::vector<PlannedSweep> planSweeps(const std::string& nameOrPath, const std::vector<std::string>& only,
                                     const std::vector<std::string>& with = {},
                                     const std::vector<std::string>& set = {});

}}  // namespace lpc::LPC_PRECISION
