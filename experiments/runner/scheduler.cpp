// SPDX-License-Identifier: Zlib
#include "experiments/runner/scheduler.h"

#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <set>

#include "experiments/runner/child.h"
#include "experiments/runner/locations.h"
#include "experiments/trial/plugin.h"
#include "framework/check.h"
#include "framework/random.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

volatile std::sig_atomic_t interrupted = 0;
void interrupt(int) { interrupted = 1; }

/// Ctrl-C sets a flag while this lives.
class InterruptGuard {
 public:
  InterruptGuard() {
    interrupted = 0;
    struct sigaction action {};
    action.sa_handler = interrupt;
    for (int i = 0; i < 2; ++i) sigaction(kSignals[i], &action, &m_old[i]);
  }
  ~InterruptGuard() {
    for (int i = 0; i < 2; ++i) sigaction(kSignals[i], &m_old[i], nullptr);
  }

 private:
  static constexpr int kSignals[2] = {SIGINT, SIGTERM};
  struct sigaction m_old[2];
};

struct Job {
  const PlannedTrial* trial;
  double wallLimit, memoryLimit;  // s, bytes
};

struct Running {
  Job job;
  std::unique_ptr<Child> child;
  std::string started;
  std::string killedFor;  // timeout or out_of_memory, when we did it
  std::string why;
};

/// Processors that this process may use.
std::vector<int> processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<int> out;
  if (sched_getaffinity(0, sizeof set, &set) == 0) {
    for (int i = 0; i < CPU_SETSIZE; ++i) {
      if (CPU_ISSET(static_cast<unsigned>(i), &set)) out.push_back(i);
    }
  }
  return out;
}

std::string clockText(double seconds) {
  const auto s = static_cast<long>(seconds + 0.5);
  return fmt::format("{}:{:02}", s / 60, s % 60);
}

class Scheduler {
 public:
  Scheduler(Store& store, const RunOptions& options)
      : m_store(store), m_options(options), m_tty(isatty(STDERR_FILENO) == 1), m_start(Clock::now()) {
    for (const std::string& path : options.plugins) {
      m_plugins.emplace_back(pluginPrecision(path), std::filesystem::absolute(path).string());
    }
  }

  RunSummary run(const std::vector<PlannedSweep>& sweeps) {
    std::vector<Job> untimed, timed;
    for (const PlannedSweep& sweep : sweeps) {
      for (const PlannedTrial& t : sweep.trials) {
        ++m_summary.planned;
        if (!m_seen.insert(t.key).second) continue;  // shared by two sweeps
        if (done(t.key)) {
          ++m_summary.skipped;
          continue;
        }
        if (!t.unsupported.empty()) {
          TrialResult result;
          result.fail("unsupported", t.unsupported, 0);
          finish(t, result, timeStamp(), 0);
          continue;
        }
        (t.timed() ? timed : untimed).push_back({&t, sweep.wallLimit, sweep.memoryLimit * 1073741824.0});
      }
    }
    shuffle(timed);
    const std::vector<int> cores = processors();
    const int jobs = m_options.jobs > 0 ? m_options.jobs : std::max(1, static_cast<int>(cores.size()));
    phase("untimed", untimed, jobs, -1);
    // The last processor: the first ones serve most interrupts.
    phase("timed", timed, 1, cores.size() > 1 ? cores.back() : -1);
    m_summary.stopped = interrupted != 0;
    return m_summary;
  }

 private:
  bool done(const std::string& key) {
    const auto outcome = m_store.outcome(key);
    if (!outcome) return false;
    return !(m_options.retry && (*outcome == "timeout" || *outcome == "crash" || *outcome == "out_of_memory"));
  }

  static void shuffle(std::vector<Job>& jobs) {
    Random random(2009);
    for (std::size_t i = jobs.size(); i > 1; --i) std::swap(jobs[i - 1], jobs[random.below(i)]);
  }

  void phase(const char* name, const std::vector<Job>& jobs, int parallel, int core) {
    m_phase = name, m_total = jobs.size(), m_finished = 0, m_phaseStart = Clock::now();
    std::size_t next = 0;
    while (!interrupted && (next < jobs.size() || !m_running.empty())) {
      while (next < jobs.size() && m_running.size() < static_cast<std::size_t>(parallel)) start(jobs[next++], core);
      waitForOutput();
      for (std::size_t i = 0; i < m_running.size();) {
        if (m_running[i].child->poll()) {
          collect(m_running[i]);
          m_running.erase(m_running.begin() + static_cast<std::ptrdiff_t>(i));
        } else {
          guard(m_running[i++]);
        }
      }
      progress(false);
    }
    m_running.clear();  // kills what still runs: Ctrl-C
    if (m_total > 0) progress(true);
  }

  void start(const Job& job, int core) {
    json request = {{"trial", job.trial->canonical}, {"scene_file", job.trial->sceneFile}};
    const std::string precision = job.trial->canonical.at("precision");
    for (const auto& [built, path] : m_plugins) {
      if (built == precision) request["plugins"].push_back(path);
    }
    m_running.push_back(
        {job, std::make_unique<Child>(workerPath(precision), request.dump(), core, false), timeStamp(), "", ""});
  }

  void waitForOutput() {
    std::vector<pollfd> descriptors;
    for (const Running& r : m_running) {
      if (r.child->outputDescriptor() >= 0) descriptors.push_back({r.child->outputDescriptor(), POLLIN, 0});
    }
    // A worker that has closed its output is about to end: look again soon.
    const bool ending = descriptors.size() < m_running.size();
    ::poll(descriptors.data(), descriptors.size(), ending ? 1 : 50);
  }

  void guard(Running& r) {
    if (!r.killedFor.empty()) return;
    if (r.child->seconds() > r.job.wallLimit) {
      r.killedFor = "timeout", r.why = fmt::format("no result within {:g} s", r.job.wallLimit);
    } else if (const double bytes = static_cast<double>(r.child->residentBytes()); bytes > r.job.memoryLimit) {
      r.killedFor = "out_of_memory";
      r.why = fmt::format("{:.2f} GiB, over {:.2f} GiB", bytes / 1073741824.0, r.job.memoryLimit / 1073741824.0);
    }
    if (!r.killedFor.empty()) r.child->kill();
  }

  void collect(Running& r) {
    TrialResult result;
    const Child& c = *r.child;
    if (!r.killedFor.empty()) {
      result.fail(r.killedFor, r.why, -1);
    } else if (c.signal()) {
      const std::string last = c.lastError();
      result.fail("crash",
                  fmt::format("signal {} ({}){}{}", c.signal(), strsignal(c.signal()), last.empty() ? "" : ": ", last),
                  -1);
    } else if (c.exitCode() == 2) {
      result.fail("unsupported", c.lastError(), -1);
    } else if (c.exitCode() != 0) {
      const std::string last = c.lastError();
      const bool memory = last.find("bad_alloc") != std::string::npos;
      result.fail(memory ? "out_of_memory" : "crash", fmt::format("exit code {}: {}", c.exitCode(), last), -1);
    } else {
      try {
        result = resultFromJson(json::parse(c.output()));
      } catch (const json::exception&) {
        result = {};
        result.fail("crash", "the worker's result cannot be read", -1);
      }
    }
    checkRepeats(*r.job.trial, result);
    finish(*r.job.trial, result, r.started, c.seconds());
    ++m_finished;
  }

  // The same trial, another repeat: the same final state, or something is not deterministic.
  void checkRepeats(const PlannedTrial& trial, TrialResult& result) {
    if (result.outcome != "ok" || result.hash.empty()) return;
    json twin = trial.canonical;
    const int repeat = twin.at("repeat");
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
    ++m_summary.run;
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
    fmt::print(stderr, "{}{}: {} of {} trials, {} not ok, {} skipped as done, {} gone, {} left in this phase{}",
               m_tty ? "\r" : "", m_phase, m_finished, m_total, m_summary.bad, m_summary.skipped, clockText(spent),
               left, m_tty && !last ? "   " : "\n");
    std::fflush(stderr);
  }

  Store& m_store;
  const RunOptions& m_options;
  std::vector<std::pair<std::string, std::string>> m_plugins;  // precision, path
  bool m_tty;
  Clock::time_point m_start, m_phaseStart{}, m_shown{};
  const char* m_phase = "";
  std::size_t m_total = 0, m_finished = 0;
  std::set<std::string> m_seen;
  std::vector<Running> m_running;
  RunSummary m_summary;
};

}  // namespace

RunSummary runSweeps(const std::vector<PlannedSweep>& sweeps, Store& store, const RunOptions& options) {
  for (const PlannedSweep& sweep : sweeps) store.plan(sweep.name, sweep.trials, !options.partial);
  const InterruptGuard interrupts;
  return Scheduler(store, options).run(sweeps);
}

}  // namespace lpc::inline LPC_PRECISION
