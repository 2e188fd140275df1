// SPDX-License-Identifier: Zlib
// Compares methods at equal cost or equal error. A sweep with `calibrate` has budgets in place of an axis for a setting
// such as the number of iterations, and searches each method's setting until it meets them.
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
  std::string
      equal;  // "cost": the largest setting within the budget; "error": the smallest setting with no larger error
  std::string metric;   // the metric compared with the budgets
  std::string place;    // position in the file: "sweep.toml:7"
  std::string setting;  // the searched axis: integers from 1
  long most = 1000;     // its largest value
  bool isTime = false;  // whether the metric needs timed trials
  /// Largest number of settings in a search, which doubles up to `most` and then halves the gap.
  int mostTried() const;
};

/// `calibrate = { equal = "cost", metric = "work_row_updates", setting = "iterations" }`. Throws UserError with file
/// and line.
Calibration readCalibration(const toml::table& table, const std::string& file);
/// `budgets = [...]`, in the metric's unit.
std::vector<double> readBudgets(TableReader& t);

/// A cell with an unknown setting.
struct CalibratedCell {
  nlohmann::json axes;  // without the setting; with the first of its seeds
  std::vector<double> budgets;
  std::function<std::vector<PlannedTrial>(long setting)> plan;  // its trials at a setting, for all seeds
  std::string keys = "";  // of its trials at a few settings: cells with equal keys are one
};

/// Adds a cell to the sweep. Plans it at its smallest and largest setting, between which the range of a parameter has
/// no gap, so that a mistake is reported before anything runs. If two groups share a cell, the existing one gets the
/// missing budgets.
void addCalibrated(PlannedSweep& sweep, CalibratedCell cell);

/// Searches the settings and adds the cells with the result to the sweep's trials: a cell's axes hold `budget` and the
/// setting. A budget that no setting meets is an unsupported trial, with the reason. The search runs ordinary trials in
/// the store, so a second search runs nothing: a setting found by times, which differ from run to run, is kept,
/// together with the measured cost. All seeds of a cell have one setting: that of the first seed, or for a time that of
/// the median over the first five. `run` runs missing trials and returns whether the search may continue; if not,
/// unfinished cells are planned without a result. `done` tells whether the store's row for a key counts: rows to be
/// repeated do not.
///
/// The search doubles the setting and then halves the gap, so it assumes that a larger setting costs more and is more
/// accurate. Where that is wrong, the result still meets the budget, and its neighbour (one more iteration for equal
/// cost, one less for equal error) does not.
void calibrate(PlannedSweep& sweep, Store& store, const std::function<bool(const PlannedSweep&)>& run,
               const std::function<bool(const std::string& key)>& done);

}}  // namespace lpc::LPC_PRECISION
