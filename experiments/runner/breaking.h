// SPDX-License-Identifier: Zlib
// Where a method breaks: a ladder of values of one parameter, each tried with a few seeds, first in a geometric grid,
// then between the highest value below the first that fails and that one; at the edge so found with many.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/parse/toml_reader.h"
#include "experiments/runner/trial_plan.h"

namespace lpc { inline namespace LPC_PRECISION {

class Store;
struct PlannedSweep;

/// What a trial must keep beside its outcome: "joint_error_max<0.01". Throws UserError for what is no such text.
struct MetricLimit {
  explicit MetricLimit(const std::string& text);
  std::string text, metric;
  bool below = true;  // it holds below the bound; else above
  double bound = 0;
  bool holds(double value) const { return below ? value < bound : value > bound; }
};

/// "The largest `parameter` with which fewer than half of the seeds fail"; the smallest, when falling.
struct BreakQuestion {
  std::string name;       // by which charts call it; empty: "largest n"
  std::string parameter;  // of the scene, dt, or $name in a pipeline
  double from = 0, to = 0;
  long seeds = 20;        // at the edge; elsewhere kFewestSeeds
  double perturb = 1e-3;  // m and rad: how far a seed starts bodies from their places, unless an axis says so
  double step = 2;        // from value to value of the grid, a factor
  double ratio = 1.05;    // of neighbours, where values need not be whole
  bool falling = false;
  std::optional<MetricLimit> limit;
  /// Where it breaks by a closed form; 0: none is known. A method that holds beyond is as wrong as one that breaks
  /// before.
  double truth = 0;
  std::string place;  // what messages begin with

  std::string title() const { return !name.empty() ? name : (falling ? "smallest " : "largest ") + parameter; }
  /// Throws UserError, with the place.
  [[noreturn]] void fail(const std::string& what) const;
  /// Throws UserError for what every search says itself of its trials, such as the seed.
  void checkParameter() const;
  /// The same for ends, seeds, ... that cannot be.
  void check() const;
  /// From `from` on each `step` times the last, and `to`; rounded where only whole numbers count.
  std::vector<double> grid(bool whole) const;
  /// How many values, and trials, a search tries at most.
  int mostTried() const;
  int mostTrials() const;
  long fewSeeds() const;
};

/// `[break]`, over what is known of the question (what holds for all groups). Throws UserError with file and line.
BreakQuestion readBreak(const toml::table& table, const std::string& file, const std::optional<BreakQuestion>& base);

/// With fewer no share of failing seeds is surely, with 95 %, on one side of a half.
inline constexpr long kFewestSeeds = 4;
/// The 95 % interval of a share by Wilson.
struct ShareInterval {
  double low, high;
};
ShareInterval wilson(long failed, long of);

struct Rung {
  double value = 0;
  long failed = 0, of = 0;  // seeds
  std::string failure;      // outcome and reason of the first that failed
  bool refused = false;     // unsupported, or over the budget: more seeds tell no more
  double cost = 0;          // multiply-adds per step: median of the seeds that held, or of all
  bool holds() const { return 2 * failed < of; }
};

/// What a search found. "Before" is nearer to the end where all hold: below, or above when falling.
struct Broken {
  nlohmann::json axes;               // of the ladder
  std::string unsupported;           // a reason where nothing could be run
  bool stopped = false;              // before it had ended
  std::vector<Rung> rungs;           // in order of value
  std::optional<Rung> held, fell;    // the last before the first that fails, and that one
  std::optional<double> half;        // where half of the seeds fail, between these two by their shares
  std::optional<double> low, high;   // its interval, by those of the shares; none: open
  std::vector<double> passesBeyond;  // hold beyond one that fails
};
/// `rungs` in any order.
Broken judge(const BreakQuestion& question, std::vector<Rung> rungs);
/// So many seeds of a value.
struct WantedRung {
  double value = 0;
  long seeds = 0;
};
/// What to try next; nothing: found. First the grid with few seeds, then halves of the bracket of the first that fails,
/// until it is as narrow as asked; then its ends, and what is on neither side for sure, with all seeds, and so on where
/// these have moved it.
std::vector<WantedRung> nextRungs(const BreakQuestion& question, bool whole, const std::vector<Rung>& known);

/// A cell whose parameter is searched.
struct Ladder {
  BreakQuestion question;
  nlohmann::json axes;  // but for the parameter and the seed
  double budget = 0;    // of a sweep that is calibrated
  struct Place {
    double value;
    long seed;
    long setting;  // where the sweep is calibrated
    bool timed;
  };
  std::function<std::vector<PlannedTrial>(const Place&)> plan;
  bool timed = false;     // what holds is timed, too
  bool whole = false;     // found by addLadder
  std::string keys = "";  // at both ends: ladders that have the same are one
};

/// A value as an axis has it.
nlohmann::json axisNumber(double value);

/// Adds a ladder to the sweep's. Both ends are planned, so that a mistake is told before anything runs; a parameter
/// that refuses a fraction between them is searched in whole numbers. Ladders with the same trials are one.
void addLadder(PlannedSweep& sweep, Ladder ladder);

/// Climbs all ladders of the sweep, adds their trials to it, and tells in `broken` what was found. What is run are
/// ordinary trials in the store, so that a second search runs nothing. `run` and `done` are as for `calibrate`, which
/// finds the setting of every rung, by its first seed, where the sweep is calibrated: methods then break at equal cost.
void findBreaking(PlannedSweep& sweep, Store& store, const std::function<bool(const PlannedSweep&)>& run,
                  const std::function<bool(const std::string& key)>& done);

}}  // namespace lpc::LPC_PRECISION
