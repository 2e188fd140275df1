// SPDX-License-Identifier: Zlib
#include "experiments/runner/scheduler.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <set>

#include "experiments/runner/worker_pool.h"
#include "framework/math/random.h"
#include "framework/stage/registry.h"
#include "oracles/referee/pair_truth.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

struct TrialJob {
  const PlannedTrial* trial;
  WorkerLimits limits;
  double turn = 0;  // for a timed trial: the share of its cell's repeats that precede it
};

// The kind of pair query of a trial. Wrong answers of libraries and of approximate methods are not faults of ours.
std::string askedOf(const TrialRequest& request, bool sidesAreRight) {
  const auto* drawn = std::get_if<PairsRequest>(&request.trial);
  const auto* stream = std::get_if<StreamRequest>(&request.trial);
  if (!drawn && !stream) return "of other stages";
  const Spec spec = Spec::parse(drawn ? drawn->pairQuery : stream->pairQuery);
  const auto& all = Registry::instance().all();
  const auto at = all.find({StageKind::pairQuery, request.base().dimension, spec.name});
  if (at == all.end()) return "of plugins";
  if (at->second.info.role != AlgorithmRole::competitor) return "of libraries";
  // All answers are judged at one tolerance. A method run with a looser one promised the right side, but not such an
  // accurate distance.
  const double judged = pairTolerance(request.base().precision == "f32");
  for (const ParamInfo& p : at->second.params) {
    const Spec* const asked = p.role == ParamRole::tolerance ? spec.find(p.name) : nullptr;
    if (asked && std::stod(asked->name) > judged && sidesAreRight) return "at a looser tolerance";
  }
  return at->second.info.guarantee == Guarantee::exact ? "of exact ones of ours" : "of approximate ones of ours";
}

class Scheduler {
 public:
  Scheduler(Store& store, const RunOptions& options)
      : m_store(store), m_options(options), m_pool(options.plugins), m_tty(isatty(STDERR_FILENO) == 1) {}

  RunSummary run(const std::vector<PlannedSweep>& sweeps) {
    std::vector<TrialJob> untimed, timed;
    for (const PlannedSweep& sweep : sweeps) {
      m_summary.planned += static_cast<long>(sweep.trials.size());
      for (const PlannedTrial& t : sweep.trials) {
        if (InterruptGuard::interrupted()) break;
        const bool isDone = done(t.key);
        if (!m_seen.insert(t.key).second) {
          ++m_summary.shared;
          continue;
        }
        if (isDone) {
          ++m_summary.skipped;
          continue;
        }
        if (!t.unsupported.empty()) {
          TrialResult result;
          result.fail("unsupported", t.unsupported, 0);
          finish(t, result, timeStamp(), 0);
          continue;
        }
        (t.timed() ? timed : untimed).push_back({&t, {sweep.wallLimit, sweep.memoryLimit * 1073741824.0}});
      }
    }
    interleave(timed);
    const std::vector<int> cores = processors();
    const int jobs = m_options.jobs > 0 ? m_options.jobs : std::max(1, static_cast<int>(cores.size()));
    phase("untimed", untimed, jobs, -1);
    // The last processor: the first ones serve most interrupts.
    phase("timed", timed, 1, cores.size() > 1 ? cores.back() : -1);
    m_summary.stopped = InterruptGuard::interrupted();
    return m_summary;
  }

  // A trial to be repeated is repeated once.
  bool done(const std::string& key) {
    const auto outcome = m_store.outcome(key);
    if (!outcome) return false;
    const bool again = *outcome == "timeout" || *outcome == "crash" || *outcome == "out_of_memory";
    return !(m_options.retry && again && !m_seen.count(key));
  }

 private:
  // In rounds: every cell once before any cell again, and each round in another order, so that a slow phase of the
  // machine affects all cells alike. A cell with twice the repeats is in each round twice.
  static void interleave(std::vector<TrialJob>& jobs) {
    Random random(2009);
    for (std::size_t i = jobs.size(); i > 1; --i) std::swap(jobs[i - 1], jobs[random.below(i)]);
    const auto ofCell = [](const TrialJob& job) {
      json cell = job.trial->canonical;
      cell.erase("repeat");
      return cell.dump();
    };
    std::map<std::string, double> last;
    for (const TrialJob& job : jobs) {
      if (InterruptGuard::interrupted()) return;  // with 100,000 it takes seconds
      double& most = last[ofCell(job)];
      most = std::max(most, static_cast<double>(job.trial->asked().repeat));
    }
    for (TrialJob& job : jobs) job.turn = static_cast<double>(job.trial->asked().repeat) / (last.at(ofCell(job)) + 1);
    std::stable_sort(jobs.begin(), jobs.end(), [](const TrialJob& a, const TrialJob& b) { return a.turn < b.turn; });
  }

  void phase(const char* name, const std::vector<TrialJob>& jobs, int parallel, int core) {
    m_phase = name, m_total = jobs.size(), m_finished = 0, m_phaseStart = Clock::now();
    std::size_t next = 0;
    while (!InterruptGuard::interrupted() && (next < jobs.size() || m_pool.running() > 0)) {
      for (; next < jobs.size() && m_pool.running() < static_cast<std::size_t>(parallel); ++next) {
        const PlannedTrial& t = *jobs[next].trial;
        m_pool.start(next, t.request, jobs[next].limits, core);
      }
      for (const WorkerEnd& end : m_pool.ended()) collect(*jobs[end.job].trial, end);
      progress(false);
    }
    m_pool.killAll();  // Ctrl-C
    if (m_total > 0) progress(true);
  }

  void collect(const PlannedTrial& trial, const WorkerEnd& end) {
    TrialResult result;
    if (end.outcome == "ok") {
      try {
        result = resultFromJson(json::parse(end.output));
      } catch (const json::exception&) {
        result = {};
        result.fail("crash", "the worker's result cannot be read", -1);
      }
    } else {
      result.fail(end.outcome, end.reason, -1);
    }
    if (trial.timed()) result.metrics[std::string(kLoad.info.name)] = end.load;
    checkRepeats(trial, result);
    finish(trial, result, end.started, end.seconds);
    ++m_finished;
  }

  // Repeats of a trial must end in the same state; otherwise something is not deterministic.
  void checkRepeats(const PlannedTrial& trial, TrialResult& result) {
    if (result.outcome != "ok" || result.hash.empty()) return;
    json twin = trial.canonical;
    const int repeat = trial.asked().repeat;
    for (bool timed : {false, true}) {
      for (int other = 0; other <= (timed == trial.timed() ? repeat - 1 : 0); ++other) {
        twin["timed"] = timed, twin["repeat"] = other;
        const auto hash = m_store.hash(trialKey(twin));
        if (hash && !hash->empty() && *hash != result.hash) {
          result.fail("nondeterministic",
                      fmt::format("final hash {}, but {} in the {} repeat {}", result.hash, *hash,
                                  timed ? "timed" : "untimed", other),
                      -1);
          return;
        }
      }
    }
  }

  void finish(const PlannedTrial& trial, const TrialResult& result, const std::string& started, double wall) {
    m_store.put(trial, result, started, wall);
    ++m_summary.run, ++m_summary.outcomes[result.outcome];
    if (result.outcome == "wrong") {
      const auto sides = result.metrics.find("wrong_boolean");
      ++m_summary.wrong[askedOf(trial.request, sides == result.metrics.end() || sides->second == 0)];
    }
    if (result.outcome != "ok" && result.outcome != "unsupported") ++m_summary.bad;
  }

  void progress(bool last) {
    if (m_options.quiet) return;
    const auto now = Clock::now();
    const double since = std::chrono::duration<double>(now - m_shown).count();
    if (!last && since < (m_tty ? 0.25 : 10)) return;
    m_shown = now;
    const double spent = std::chrono::duration<double>(now - m_phaseStart).count();
    std::string left = "?";
    if (m_finished > 0)
      left = clockText(spent / static_cast<double>(m_finished) * static_cast<double>(m_total - m_finished));
    std::fputs(fmt::format("{}{}: {} of {} trials, {} not ok, {} skipped as done, {} gone, {} left in this phase{}",
                           m_tty ? "\r" : "", m_phase, m_finished, m_total, m_summary.bad, m_summary.skipped,
                           clockText(spent), left, m_tty && !last ? "   " : "\n")
                   .c_str(),
               stderr);
    std::fflush(stderr);
  }

  Store& m_store;
  const RunOptions& m_options;
  WorkerPool m_pool;
  bool m_tty;
  Clock::time_point m_phaseStart{}, m_shown{};
  const char* m_phase = "";
  std::size_t m_total = 0, m_finished = 0;
  std::set<std::string> m_seen;
  RunSummary m_summary;
};

}  // namespace

void checkWorkers(const std::vector<PlannedSweep>& sweeps) {
  std::set<std::pair<std::string, bool>> workers;
  const auto add = [&](const PlannedTrial& t) {
    if (t.unsupported.empty()) workers.emplace(t.asked().precision, t.request.ofEngine());
  };
  for (const PlannedSweep& sweep : sweeps) {
    for (const PlannedTrial& t : sweep.trials) add(t);
    for (const CalibratedCell& cell : sweep.calibrated) {
      for (const PlannedTrial& t : cell.plan(1)) add(t);
    }
    for (const Ladder& ladder : sweep.ladders) {
      for (const PlannedTrial& t : ladder.plan({ladder.question.from, 1, sweep.calibration ? 1 : 0, false})) add(t);
    }
  }
  for (const auto& [precision, engine] : workers) checkWorker(precision, engine);
}

RunSummary runSweeps(std::vector<PlannedSweep>& sweeps, Store& store, const RunOptions& options) {
  const InterruptGuard interrupts;
  Scheduler scheduler(store, options);
  const auto run = [&](const PlannedSweep& round) { return !scheduler.run({round}).stopped; };
  for (PlannedSweep& sweep : sweeps) {
    const auto done = [&](const std::string& key) { return scheduler.done(key); };
    calibrate(sweep, store, run, done);
    findBreaking(sweep, store, run, done);
    store.plan(sweep, !options.partial);
  }
  return scheduler.run(sweeps);
}

}}  // namespace lpc::LPC_PRECISION
