// SPDX-License-Identifier: Zlib
#include "experiments/runner/calibration.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "experiments/runner/metric_name.h"
#include "experiments/runner/store.h"
#include "experiments/runner/sweep_file.h"
#include "experiments/runner/worker_pool.h"
#include "experiments/trial/measure/metric.h"
#include "experiments/trial/trial.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;

constexpr double kNever = std::numeric_limits<double>::infinity();
// Number of seeds that are timed to find a setting. One disturbed run does not decide a median of five.
constexpr std::size_t kSeedsTimed = 5;

// The entry of a metric of world trials.
std::optional<MetricInfo> infoOf(const std::string& name) {
  for (const DescribedMetric& m : describeMetrics()) {
    if (m.what == "metric" && m.kind == "world" && isMetric(m.info, name)) return m.info;
  }
  return std::nullopt;
}

bool isCost(const MetricInfo& info) { return info.smaller == "cheaper"; }

/// Searches the boundary: settings within the budget (cost), or too inaccurate for it (error), below; larger ones
/// above.
class Search {
 public:
  Search(const Calibration& what, double budget, long most) : m_what(what), m_budget(budget), m_most(most) {}

  bool open() const { return m_above == 0 ? m_below < m_most : m_above - m_below > 1; }
  long next() const {
    if (m_above > 0) return m_below + (m_above - m_below) / 2;
    return std::clamp(2 * m_below, 1L, m_most);
  }
  void tell(double value) {
    const bool within = value <= m_budget;
    (within == (m_what.equal == "cost") ? m_below : m_above) = next();
    m_last = value;
  }
  std::optional<long> found() const {
    if (m_what.equal == "cost") return m_below > 0 ? std::optional(m_below) : std::nullopt;
    return m_above > 0 ? std::optional(m_above) : std::nullopt;
  }
  /// Why nothing was found.
  std::string reason(const std::string& failure) const {
    const bool cost = m_what.equal == "cost";
    const bool has = m_what.most == 1 || m_most > 1;  // whether the method has the setting
    const std::string at = !has ? "it" : m_what.setting + "=" + std::to_string(cost ? 1 : m_most);
    const std::string does =
        !failure.empty() ? " ends in " + failure : (cost ? " costs " : ", the most, errs by ") + asText(m_last);
    return at + does + " (" + m_what.metric + "), the budget is " + asText(m_budget);
  }

 private:
  const Calibration& m_what;
  double m_budget;
  long m_most, m_below = 0, m_above = 0;  // the largest and the smallest known on either side; 0: none yet
  double m_last = 0;
};

/// The measurement of a cell at one setting.
struct Measured {
  double value = kNever;
  std::string failure;  // outcome and reason if these decide the value
};

class Calibrator {
 public:
  Calibrator(PlannedSweep& sweep, Store& store, const std::function<bool(const std::string&)>& done)
      : m_sweep(sweep), m_what(*sweep.calibration), m_info(*infoOf(m_what.metric)), m_store(store), m_done(done) {
    for (std::size_t c = 0; c < sweep.calibrated.size(); ++c) {
      const CalibratedCell& cell = sweep.calibrated[c];
      // A method without the setting has one value.
      const long most = at(c, 1).trials[0].key == at(c, std::min(2L, m_what.most)).trials[0].key ? 1 : m_what.most;
      for (const double budget : cell.budgets) m_asked.push_back({c, budget, Search(m_what, budget, most)});
    }
  }

  void search(const std::function<bool(const PlannedSweep&)>& run) {
    for (bool goOn = true; goOn;) {
      PlannedSweep round = m_sweep;
      round.trials.clear(), round.calibrated.clear();
      bool any = false;
      for (Asked& a : m_asked) {
        if (InterruptGuard::interrupted()) return;  // planning a round takes time
        while (a.search.open() && canRun(a)) {      // as far as the store's results allow
          At& here = at(a.cell, a.search.next());
          if (!here.measured && !(here.measured = measure(here.trials))) break;
          a.search.tell(here.measured->value), a.failure = here.measured->failure;
        }
        if (!a.search.open() || !canRun(a)) continue;
        any = true;
        for (const PlannedTrial* t : measuring(at(a.cell, a.search.next()).trials)) round.trials.push_back(*t);
      }
      if (!any) return refuseUnknown();
      goOn = run(round);
    }
  }

  void addCells() {
    for (const Asked& a : m_asked) {
      json mark = {{"metric", m_what.metric}, {"budget", a.budget}};
      const bool ended = !a.search.open() || !canRun(a);
      const auto found = ended ? a.search.found() : std::nullopt;
      std::string reason;
      if (!found && ended && canRun(a)) reason = a.search.reason(a.failure);
      if (!found && !ended) mark["reason"] = "the search was stopped";
      if (!reason.empty()) mark["reason"] = reason;
      for (PlannedTrial t : at(a.cell, found.value_or(1)).trials) {
        // Two budgets may have one answer; each is a cell of its own.
        t.mark("calibrated", mark);
        t.axes["budget"] = a.budget;
        if (!found) t.axes.erase(m_what.setting);
        if (t.unsupported.empty()) t.unsupported = reason;
        m_sweep.trials.push_back(std::move(t));
      }
    }
  }

 private:
  struct At {
    std::vector<PlannedTrial> trials;
    std::optional<Measured> measured;
  };
  struct Asked {
    std::size_t cell;
    double budget;
    Search search;
    std::string failure = "";
  };

  At& at(std::size_t cell, long setting) {
    const auto [it, added] = m_at.try_emplace({cell, setting});
    if (added) {
      if (InterruptGuard::interrupted()) throw Interrupted();
      it->second.trials = m_sweep.calibrated[cell].plan(setting);
    }
    return it->second;
  }
  // The timed phases of a step are known once one has run.
  void refuseUnknown() const {
    if (m_known || m_others.empty()) return;
    throw UserError(m_what.place + ": no trial of the sweep has the metric '" + m_what.metric + "'" +
                    validNames({m_others.begin(), m_others.end()}, m_what.metric));
  }
  bool canRun(const Asked& a) { return at(a.cell, 1).trials[0].unsupported.empty(); }

  // The trials with the metric: times are measured in all repeats of the first seeds, everything else once.
  std::vector<const PlannedTrial*> measuring(const std::vector<PlannedTrial>& trials) const {
    std::vector<const PlannedTrial*> out;
    std::set<json> seeds;
    for (const PlannedTrial& t : trials) {
      if (m_what.isTime) {
        seeds.insert(t.axes.value("seed", json()));
        if (seeds.size() > kSeedsTimed) break;
      }
      if (m_what.isTime ? t.timed() : out.empty()) out.push_back(&t);
    }
    return out;
  }

  // Empty while a trial is not in the store.
  std::optional<Measured> measure(const std::vector<PlannedTrial>& trials) {
    std::vector<double> values;
    for (const PlannedTrial* t : measuring(trials)) {
      const auto row = m_done(t->key) ? m_store.measured(t->key) : std::nullopt;
      if (!row) return std::nullopt;
      const auto it = row->metrics.find(m_what.metric);
      const bool has = it != row->metrics.end() && std::isfinite(it->second);
      m_known = m_known || has;
      for (const auto& [name, value] : row->metrics) {
        if (m_info.name.ends_with('*') && isMetric(m_info, name)) m_others.insert(name);
      }
      // A fallen tower still has a valid cost, but its error says nothing about the method.
      if (!has || (m_what.equal == "error" && row->outcome != "ok")) {
        return Measured{kNever,
                        row->outcome == "ok" ? "a trial without the metric" : row->outcome + ": " + row->reason};
      }
      values.push_back(it->second);
    }
    return Measured{quantile(values, 0.5), ""};
  }

  PlannedSweep& m_sweep;
  const Calibration m_what;
  const MetricInfo m_info;
  Store& m_store;
  const std::function<bool(const std::string&)>& m_done;
  std::map<std::pair<std::size_t, long>, At> m_at;
  std::vector<Asked> m_asked;
  bool m_known = false;            // whether some trial has the metric
  std::set<std::string> m_others;  // names for which its star stands
};

}  // namespace

int Calibration::mostTried() const {
  const auto digits = static_cast<int>(std::bit_width(static_cast<unsigned long>(most)));
  const bool power = std::has_single_bit(static_cast<unsigned long>(most));
  return digits + !power + std::max(0, digits - 1 - power);
}

Calibration readCalibration(const toml::table& table, const std::string& file) {
  TableReader t(table, file, "'calibrate'");
  Calibration out;
  out.equal = t.requireString("equal");
  if (out.equal != "cost" && out.equal != "error") {
    t.fail(*t.find("equal"), "'equal' is '" + out.equal + "'; valid: cost, error");
  }
  out.metric = t.requireString("metric");
  const bool cost = out.equal == "cost";
  const auto info = infoOf(out.metric);
  if (!info || info->smaller.empty() || isCost(*info) != cost) {
    std::vector<std::string> valid;
    for (const DescribedMetric& m : describeMetrics()) {
      if (m.what != "metric" || m.kind != "world" || m.info.smaller.empty() || isCost(m.info) != cost) continue;
      for (const std::string& name : namesOf(m.info)) {
        if (std::find(valid.begin(), valid.end(), name) == valid.end()) valid.push_back(name);
      }
    }
    t.fail(*t.find("metric"), "'" + out.metric + "' is no metric of " + out.equal + validNames(valid, out.metric));
  }
  out.place = file + ":" + std::to_string(t.find("metric")->source().begin.line);
  out.isTime = info->need == TrialNeed::timing;
  out.setting = t.requireString("setting");
  for (const std::string_view taken : {"budget", "kind", "precision", "repeat", "scene", "script", "timed"}) {
    if (out.setting == taken) t.fail(*t.find("setting"), "'setting' is '" + out.setting + "'; valid: another name");
  }
  out.most = t.integer("most", out.most);
  if (out.most < 1 || out.most > 1000000) {
    t.fail(*t.find("most"), "'most' is " + std::to_string(out.most) + "; valid: 1 to 1000000");
  }
  t.finish();
  return out;
}

std::vector<double> readBudgets(TableReader& t) {
  std::vector<double> out;
  const toml::array* list = t.array("budgets");
  if (!list) return out;
  for (const toml::node& n : *list) {
    const double value = n.value<double>().value_or(0);
    if (!n.is_number() || !(value > 0) || !std::isfinite(value)) {
      t.fail(n, "'budgets' holds " + describe(n) + "; valid: numbers above 0");
    }
    if (std::find(out.begin(), out.end(), value) != out.end()) {
      t.fail(n, "'budgets' holds " + asText(value) + " twice");
    }
    out.push_back(value);
  }
  if (out.empty()) t.fail(*list, "'budgets' is empty; valid: numbers above 0");
  return out;
}

void addCalibrated(PlannedSweep& sweep, CalibratedCell cell) {
  const auto add = [&](long setting) {
    for (const PlannedTrial& t : cell.plan(setting)) cell.keys += t.key;
  };
  const long most = sweep.calibration->most;
  add(1), add(std::min(2L, most));
  try {
    add(most);
  } catch (const UserError& e) {
    throw UserError(std::string(e.what()) + "; 'calibrate' goes up to most = " + std::to_string(most));
  }
  const auto same = std::find_if(sweep.calibrated.begin(), sweep.calibrated.end(),
                                 [&](const CalibratedCell& other) { return other.keys == cell.keys; });
  if (same == sweep.calibrated.end()) return sweep.calibrated.push_back(std::move(cell));
  for (const double budget : cell.budgets) {
    if (std::find(same->budgets.begin(), same->budgets.end(), budget) == same->budgets.end()) {
      same->budgets.push_back(budget);
    }
  }
}

void calibrate(PlannedSweep& sweep, Store& store, const std::function<bool(const PlannedSweep&)>& run,
               const std::function<bool(const std::string& key)>& done) {
  if (sweep.calibrated.empty()) return;
  Calibrator calibrator(sweep, store, done);
  calibrator.search(run);
  calibrator.addCells();
}

}}  // namespace lpc::LPC_PRECISION
