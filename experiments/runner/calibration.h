// SPDX-License-Identifier: Zlib
// Methods are compared where they cost the same, or err the same: a sweep with `calibrate` has no axis for a setting
// such as the number of iterations, but budgets, and each method's setting is searched until it meets them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/parse/toml_reader.h"
#include "experiments/runner/trial_plan.h"

namespace lpc { inline namespace LPC_PRECISION {

class Store;
struct PlannedSweep;

struct Calibration {
  std::string equal;    // "cost": the largest setting within the budget; "error": the smallest that errs no more
  std::string metric;   // that is compared with the budgets
  std::string place;    // where the file names it: "sweep.toml:7"
  std::string setting;  // the axis that is searched: whole numbers from 1
  long most = 1000;     // its largest value
  bool isTime = false;  // the metric is of timed trials
  /// How many settings a search tries at most: it doubles up to `most` and then halves the gap.
  int mostTried() const;
};

/// `calibrate = { equal = "cost", metric = "work_row_updates", setting = "iterations" }`. Throws UserError with file
/// and line.
Calibration readCalibration(const toml::table& table, const std::string& file);
/// `budgets = [...]`, in the metric's unit.
std::vector<double> readBudgets(TableReader& t);

/// A cell whose setting is not known yet.
struct CalibratedCell {
  nlohmann::json axes;  // but for the setting; of its seeds the first
  std::vector<double> budgets;
  std::function<std::vector<PlannedTrial>(long setting)> plan;  // its trials at a setting, of all seeds
  std::string keys = "";  // of its trials at a few settings: cells that have the same are one
};

/// Adds a cell to the sweep's. It is planned at its least and its largest setting, between which the range of a
/// parameter has no hole, so that a mistake is told before anything runs. One that is there already, since two groups
/// meet in it, gets the budgets that it lacks.
void addCalibrated(PlannedSweep& sweep, CalibratedCell cell);

/// Searches the settings and adds the cells at what was found to the sweep's trials: a cell's axes hold `budget` and
/// the setting. A budget that no setting meets is a trial that is unsupported, with the reason. What the search runs
/// are ordinary trials in the store, so that a second search runs nothing: a setting that was found by times, which
/// differ from run to run, stays the setting, beside the cost that was measured. All seeds of a cell have one setting:
/// that of the first, by a time that of the median over the first five. `run` runs what the store lacks and returns
/// whether it may go on; where it may not, cells that are not found yet are planned and have no result. `done` tells of
/// a key whether the store's row counts: one that shall be run again does not.
///
/// The search doubles the setting and then halves the gap, so it takes a larger setting for dearer and for more exact.
/// Where that does not hold, what is found still meets the budget, and its neighbour (one more iteration for equal
/// cost, one less for equal error) does not.
void calibrate(PlannedSweep& sweep, Store& store, const std::function<bool(const PlannedSweep&)>& run,
               const std::function<bool(const std::string& key)>& done);

}}  // namespace lpc::LPC_PRECISION
