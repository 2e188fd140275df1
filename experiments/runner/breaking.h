// SPDX-License-Identifier: Zlib
// Searches where a method breaks: a ladder of values of one parameter, each tried with a few seeds, first on a
// geometric grid, then between the first value that fails and the highest value below it that holds; at the resulting
// edge with many seeds.
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

/// A limit that a trial must keep besides its outcome: "joint_error_max<0.01". Throws UserError for other texts.
struct MetricLimit {
  explicit MetricLimit(const std::string& text);
  std::string text, metric;
  bool below = true;  // holds below the bound; otherwise above
  double bound = 0;
  bool holds(double value) const { return below ? value < bound : value > bound; }
};

/// "The largest `parameter` with which fewer than half of the seeds fail"; the smallest if falling.
struct BreakQuestion {
  std::string name;       // name in charts; empty: "largest n"
  std::string parameter;  // of the scene, dt, or $name in a pipeline
  double from = 0, to = 0;
  long seeds = 20;        // at the edge; elsewhere kFewestSeeds
  double perturb = 1e-3;  // m and rad: perturbation of the initial poses per seed, unless an axis sets it
  double step = 2;        // factor from value to value of the grid
  double ratio = 1.05;    // of neighbours, for values that need not be integers
  bool falling = false;
  std::optional<MetricLimit> limit;
  /// The breaking point by a closed form; 0: unknown. A method that holds beyond it is as wrong as one that breaks
  /// before.
  double truth = 0;
  std::string place;  // prefix of messages

  std::string title() const { return !name.empty() ? name : (falling ? "smallest " : "largest ") + parameter; }
  /// Throws UserError, with the position.
  [[noreturn]] void fail(const std::string& what) const;
  /// Throws UserError if the parameter is one that every search sets itself, such as the seed.
  void checkParameter() const;
  /// The same for invalid ends, seeds, ...
  void check() const;
  /// From `from`, each value `step` times the last, and `to`; rounded if only integers count.
  std::vector<double> grid(bool whole) const;
  /// Largest number of values, and of trials, in a search.
  int mostTried() const;
  int mostTrials() const;
  long fewSeeds() const;
};

/// Reads `[break]`, over the question's settings for all groups. Throws UserError with file and line.
BreakQuestion readBreak(const toml::table& table, const std::string& file, const std::optional<BreakQuestion>& base);

/// With fewer seeds, no share of failures is above or below a half at 95 % confidence.
inline constexpr long kFewestSeeds = 4;
/// The 95 % interval of a share by Wilson.
struct ShareInterval {
  double low, high;
};
ShareInterval wilson(long failed, long of);

struct Rung {
  double value = 0;
  long failed = 0, of = 0;  // seeds
  std::string failure;      // outcome and reason of the first failed seed
  bool refused = false;     // unsupported, or over the budget: more seeds give no information
  double cost = 0;          // multiply-adds per step: median of the seeds that held, or of all
  bool holds() const { return 2 * failed < of; }
};

/// The result of a search. "Before" is nearer to the end where all hold: below, or above if falling.
struct Broken {
  nlohmann::json axes;               // of the ladder
  std::string unsupported;           // the reason if nothing could be run
  bool stopped = false;              // before the search ended
  std::vector<Rung> rungs;           // in order of value
  std::optional<Rung> held, fell;    // the last value before the first that fails, and that value
  std::optional<double> half;        // where half of the seeds fail, interpolated between these two
  std::optional<double> low, high;   // its interval; none: open
  std::vector<double> passesBeyond;  // values that hold beyond one that fails
};
/// `rungs` in any order.
Broken judge(const BreakQuestion& question, std::vector<Rung> rungs);
/// A value with a number of seeds.
struct WantedRung {
  double value = 0;
  long seeds = 0;
};
/// What to try next; empty: finished. First the grid with few seeds, then halves of the bracket of the first failure,
/// until it is as narrow as wanted; then its ends, and undecided values, with all seeds, repeated if these move the
/// bracket.
std::vector<WantedRung> nextRungs(const BreakQuestion& question, bool whole, const std::vector<Rung>& known);

/// A cell with one searched parameter.
struct Ladder {
  BreakQuestion question;
  nlohmann::json axes;  // without the parameter and the seed
  double budget = 0;    // of a calibrated sweep
  struct Place {
    double value;
    long seed;
    long setting;  // if the sweep is calibrated
    bool timed;
  };
  std::function<std::vector<PlannedTrial>(const Place&)> plan;
  bool timed = false;     // whether values that hold are timed, too
  bool whole = false;     // found by addLadder
  std::string keys = "";  // at both ends: ladders with equal keys are one
};

/// A value as an axis has it.
nlohmann::json axisNumber(double value);

/// Adds a ladder to the sweep. Plans both ends, so that a mistake is reported before anything runs. A parameter that
/// refuses a fraction between them is searched in integers. Ladders with the same trials are one.
void addLadder(PlannedSweep& sweep, Ladder ladder);

/// Climbs all ladders of the sweep, adds their trials to it, and stores the results in `broken`. The trials are
/// ordinary ones in the store, so a second search runs nothing. `run` and `done` are as for `calibrate`. In a
/// calibrated sweep that function finds the setting of every rung by its first seed, so that methods break at equal
/// cost.
void findBreaking(PlannedSweep& sweep, Store& store, const std::function<bool(const PlannedSweep&)>& run,
                  const std::function<bool(const std::string& key)>& done);

}}  // namespace lpc::LPC_PRECISION
