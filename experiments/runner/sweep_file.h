// SPDX-License-Identifier: Zlib
// A sweep file (TOML, experiments/sweeps/*.toml): axes, the product of which is the set of cells.
// docs/reference_sweeps.md describes the format.
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
  std::string baseline;  // the value of an axis that is the baseline of reports; may be empty
  /// The role of each axis: "label" (of pipelines), "stage", "setting" (used as $name in a pipeline), "parameter" (of
  /// the scene), or "run".
  std::map<std::string, std::string> roles;
  /// Warnings for the user: the sweep is valid, but probably not intended.
  std::vector<std::string> notes;
  std::vector<std::string> charts;  // its charts of reports/charts; empty: all for which it has the data
  /// The arguments of `lpc` that planned it, without the store: a page prints them, so that its content can be
  /// reproduced.
  std::vector<std::string> command;
  double wallLimit = 120;  // s, per trial
  double memoryLimit = 4;  // GiB, per trial
  std::vector<PlannedTrial> trials;
  std::optional<Calibration> calibration;
  std::vector<CalibratedCell> calibrated;  // cells that `calibrate` turns into trials
  std::vector<Ladder> ladders;             // cells that `findBreaking` turns into trials
  std::vector<Broken> broken;              // its results, in their order
};

/// The sweeps of a file: itself, or those of a set (`sweeps = [...]`). Throws UserError with file and line, also for
/// mistakes in its scenes and pipelines. `only` keeps the cells with one of these labels, algorithms or scenes; a name
/// without a cell is a mistake. `with` adds methods, as "LABEL=PIPELINE", to the labelled axis of `[axes]` in each
/// sweep that has one. `set` holds "AXIS=VALUE": the single value of that axis in every sweep that has it.
std::vector<PlannedSweep> planSweeps(const std::string& nameOrPath, const std::vector<std::string>& only,
                                     const std::vector<std::string>& with = {},
                                     const std::vector<std::string>& set = {});

}}  // namespace lpc::LPC_PRECISION
