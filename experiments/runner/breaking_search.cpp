// SPDX-License-Identifier: Zlib
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "experiments/runner/breaking.h"
#include "experiments/runner/store.h"
#include "experiments/runner/sweep_file.h"
#include "experiments/runner/worker_pool.h"
#include "experiments/trial/measure/metric.h"
#include "experiments/trial/trial.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;
using RunRound = std::function<bool(const PlannedSweep&)>;

// A value of a ladder before it becomes a rung.
struct Tried {
  std::optional<long> setting;       // if the sweep is calibrated; 0: none meets the budget
  std::optional<PlannedTrial> none;  // the reason in that case
  std::vector<PlannedTrial> trials;
  std::optional<Rung> rung;
};

struct Climb {
  const Ladder* ladder;
  std::map<double, Tried> tried;
  std::string unsupported;
  bool found = false;

  std::vector<Rung> rungs() const {
    std::vector<Rung> out;
    for (const auto& [value, t] : tried) {
      if (t.rung) out.push_back(*t.rung);
    }
    return out;
  }
};

class Breaker {
 public:
  Breaker(PlannedSweep& sweep, Store& store, const std::function<bool(const std::string&)>& done)
      : m_sweep(sweep), m_store(store), m_done(done) {
    for (const Ladder& ladder : sweep.ladders) {
      Climb& climb = m_climbs.emplace_back(Climb{&ladder, {}, ""});
      const auto [from, to] = std::minmax(ladder.question.from, ladder.question.to);
      const double easy = ladder.question.falling ? to : from;
      const PlannedTrial first = ladder.plan({easy, 1, calibrated() ? 1 : 0, false}).at(0);
      climb.unsupported = first.unsupported;
      if (!first.unsupported.empty()) climb.tried[easy].trials = {first};
    }
  }

  void search(const RunRound& run) {
    for (bool goOn = true; goOn;) {
      PlannedSweep round = m_sweep;
      round.trials.clear(), round.calibrated.clear(), round.ladders.clear();
      std::vector<std::pair<Climb*, double>> unset;
      for (Climb& climb : m_climbs) {
        if (InterruptGuard::interrupted()) return;  // planning a round takes time
        if (climb.unsupported.empty() && !climb.found) advance(climb, round.trials, unset);
      }
      if (!unset.empty()) {
        goOn = calibrateAt(unset, round, run);
      } else if (!round.trials.empty()) {
        goOn = run(round);
      } else {
        return refuseUnknown();
      }
    }
  }

  void addTrials() {
    std::set<std::string> planned;
    for (Climb& climb : m_climbs) {
      const Ladder& ladder = *climb.ladder;
      Broken broken = judge(ladder.question, climb.rungs());
      broken.axes = ladder.axes, broken.axes["question"] = ladder.question.title();
      broken.unsupported = climb.unsupported, broken.stopped = climb.unsupported.empty() && !climb.found;
      if (calibrated()) broken.axes["budget"] = ladder.budget;
      if (climb.tried.empty()) climb.tried[ladder.question.from];
      for (auto& [value, tried] : climb.tried) {
        // For a search that was stopped before it had its setting: a row without a result.
        if (tried.trials.empty()) tried.trials = ladder.plan({value, 1, calibrated() ? 1 : 0, false});
        for (const PlannedTrial& t : tried.trials) add(t, ladder, planned);
      }
      if (ladder.timed && broken.held && climb.found) {
        const Tried& held = climb.tried.at(broken.held->value);
        for (const PlannedTrial& t : ladder.plan({broken.held->value, 1, held.setting.value_or(0), true})) {
          add(t, ladder, planned);
        }
      }
      m_sweep.broken.push_back(std::move(broken));
    }
  }

 private:
  bool calibrated() const { return m_sweep.calibration.has_value(); }

  // Advances as far as the store's results allow. Missing trials go to `trials`, values without a setting to `unset`.
  void advance(Climb& climb, std::vector<PlannedTrial>& trials, std::vector<std::pair<Climb*, double>>& unset) {
    for (bool known = true; known;) {
      const std::vector<WantedRung> wanted = nextRungs(climb.ladder->question, climb.ladder->whole, climb.rungs());
      climb.found = wanted.empty();
      known = !climb.found;
      for (const auto& [value, seeds] : wanted) {
        Tried& tried = climb.tried[value];
        if (calibrated() && !tried.setting) {
          unset.emplace_back(&climb, value);
          known = false;
          continue;
        }
        if (static_cast<long>(tried.trials.size()) < seeds) addSeeds(*climb.ladder, value, seeds, tried);
        if (!tried.rung) tried.rung = measure(climb.ladder->question, value, tried.trials);
        if (tried.rung) continue;
        known = false;
        trials.insert(trials.end(), tried.trials.begin(), tried.trials.end());
      }
    }
  }

  static void addSeeds(const Ladder& ladder, double value, long seeds, Tried& tried) {
    tried.rung.reset();
    for (long seed = static_cast<long>(tried.trials.size()) + 1; seed <= seeds; ++seed) {
      if (InterruptGuard::interrupted()) throw Interrupted();
      if (!tried.none) {
        tried.trials.push_back(ladder.plan({value, seed, tried.setting.value_or(0), false}).at(0));
        continue;
      }
      PlannedTrial none = *tried.none;
      none.setSeed(static_cast<std::uint64_t>(seed));
      tried.trials.push_back(std::move(none));
    }
  }

  // The setting of a rung is that of its first seed.
  bool calibrateAt(const std::vector<std::pair<Climb*, double>>& unset, PlannedSweep round, const RunRound& run) {
    round.trials.clear();
    for (const auto& [climb, value] : unset) {
      round.calibrated.push_back(
          {climb->ladder->axes, {climb->ladder->budget}, [ladder = climb->ladder, at = value](long s) {
             return std::vector{ladder->plan({at, 1, s, false}).at(0)};
           }});
    }
    bool goOn = true;
    calibrate(
        round, m_store, [&](const PlannedSweep& part) { return goOn = run(part); }, m_done);
    if (!goOn || InterruptGuard::interrupted()) return false;
    for (std::size_t i = 0; i < unset.size(); ++i) {
      const PlannedTrial& t = round.trials.at(i);
      Tried& tried = unset[i].first->tried[unset[i].second];
      tried.setting = t.axes.value(m_sweep.calibration->setting, 1L);  // a method without the setting has one value
      if (!t.unsupported.empty()) tried.setting = 0, tried.none = t;
    }
    return true;
  }

  // Empty while a trial is not in the store.
  std::optional<Rung> measure(const BreakQuestion& q, double value, const std::vector<PlannedTrial>& trials) {
    Rung rung;
    rung.value = value, rung.of = static_cast<long>(trials.size());
    rung.refused = !trials.empty();
    std::vector<double> costs, all;
    for (const PlannedTrial& t : trials) {
      Store::Row row{"unsupported", t.unsupported, {}};
      if (t.unsupported.empty()) {
        const auto found = m_done(t.key) ? m_store.measured(t.key) : std::nullopt;
        if (!found) return std::nullopt;
        row = *found;
      }
      const std::string failure = failureOf(q, row);
      rung.failed += !failure.empty(), rung.refused = rung.refused && row.outcome == "unsupported";
      if (rung.failure.empty()) rung.failure = failure;
      const auto cost = row.metrics.find("work_multiply_adds");
      if (cost == row.metrics.end() || !std::isfinite(cost->second)) continue;
      all.push_back(cost->second);
      if (failure.empty()) costs.push_back(cost->second);
    }
    rung.cost = quantile(costs.empty() ? all : costs, 0.5);
    return rung;
  }

  // Empty: the trial holds.
  std::string failureOf(const BreakQuestion& q, const Store::Row& row) {
    if (row.outcome != "ok") return row.outcome + (row.reason.empty() ? "" : ": " + row.reason);
    if (!q.limit) return "";
    const auto it = row.metrics.find(q.limit->metric);
    if (it == row.metrics.end() || !std::isfinite(it->second)) {
      m_without.emplace(q.place, q.limit->metric);
      return "a trial without " + q.limit->metric;
    }
    m_with.emplace(q.place, q.limit->metric);
    return q.limit->holds(it->second) ? "" : fmt::format("{} is {:.4g}", q.limit->metric, it->second);
  }

  // A scene without the limited quantity would fail everywhere.
  void refuseUnknown() const {
    for (const auto& [place, metric] : m_without) {
      if (m_with.count({place, metric})) continue;
      throw UserError((place.empty() ? "" : place + ": ") + "'limit' is of '" + metric +
                      "', which no trial of the scene has; valid: a metric that it measures");
    }
  }

  // A row of a store has one key: a trial of two questions is marked in the second.
  void add(PlannedTrial t, const Ladder& ladder, std::set<std::string>& planned) {
    t.axes["question"] = ladder.question.title();
    if (calibrated()) t.axes["budget"] = ladder.budget;
    if (!planned.insert(t.key).second) {
      t.mark("question", t.axes);
      planned.insert(t.key);
    }
    m_sweep.trials.push_back(std::move(t));
  }

  PlannedSweep& m_sweep;
  Store& m_store;
  const std::function<bool(const std::string&)>& m_done;
  std::vector<Climb> m_climbs;
  std::set<std::pair<std::string, std::string>> m_with, m_without;  // position and metric of a limit
};

}  // namespace

void findBreaking(PlannedSweep& sweep, Store& store, const RunRound& run,
                  const std::function<bool(const std::string& key)>& done) {
  if (sweep.ladders.empty()) return;
  Breaker breaker(sweep, store, done);
  breaker.search(run);
  breaker.addTrials();
}

}}  // namespace lpc::LPC_PRECISION
