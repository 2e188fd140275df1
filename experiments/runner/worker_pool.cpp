// SPDX-License-Identifier: Zlib
#include "experiments/runner/worker_pool.h"

#include <fmt/format.h>
#include <poll.h>
#include <sched.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "experiments/runner/locations.h"
#include "experiments/runner/store.h"
#include "experiments/trial/plugin.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

volatile std::sig_atomic_t interruptFlag = 0;
void interrupt(int) { interruptFlag = 1; }

constexpr std::array<int, 3> kSignals = {SIGINT, SIGTERM, SIGHUP};
std::array<struct sigaction, kSignals.size()> oldActions;

// Of the last minute; the worker about to start is not included.
double loadAverage() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : std::numeric_limits<double>::quiet_NaN();
}

std::string memoryText(double bytes, double most) {
  return fmt::format("{:.2f} GiB, over {:.2f} GiB", bytes / 1073741824.0, most / 1073741824.0);
}

}  // namespace

WorkerPool::WorkerPool(const std::vector<std::string>& plugins) {
  for (const std::string& path : plugins) {
    m_plugins.emplace_back(pluginPrecision(path), std::filesystem::absolute(path).string());
  }
}

void WorkerPool::start(std::size_t job, TrialRequest request, const WorkerLimits& limits, int core) {
  const std::string precision = request.base().precision;
  for (const auto& [built, path] : m_plugins) {
    if (built == precision) request.plugins.push_back(path);
  }
  launch(job, workerPath(precision, request.ofEngine()), toJson(request), limits, core);
}

void WorkerPool::start(std::size_t job, const std::string& precision, nlohmann::json request,
                       const WorkerLimits& limits, int core) {
  for (const auto& [built, path] : m_plugins) {
    if (built == precision) request["plugins"].push_back(path);
  }
  launch(job, workerPath(precision, false), request, limits, core);
}

void WorkerPool::launch(std::size_t job, const std::string& program, const nlohmann::json& request,
                        const WorkerLimits& limits, int core) {
  auto child = std::make_unique<Child>(program, request.dump(), core, false);
  if (m_running.empty()) m_watched = std::chrono::steady_clock::now();
  m_running.push_back({job, limits, std::move(child), timeStamp(), loadAverage(), "", ""});
}

std::vector<WorkerEnd> WorkerPool::ended() {
  waitForOutput();
  countStops();
  std::vector<WorkerEnd> out;
  for (std::size_t i = 0; i < m_running.size();) {
    if (m_running[i].child->poll()) {
      out.push_back(endOf(m_running[i]));
      m_running.erase(m_running.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      guard(m_running[i++]);
    }
  }
  return out;
}

void WorkerPool::waitForOutput() {
  std::vector<pollfd> descriptors;
  bool ending = false;  // look again soon
  for (const Running& r : m_running) ending = !r.child->addTo(descriptors) || ending;
  ::poll(descriptors.data(), descriptors.size(), ending ? 1 : 50);
}

// This program itself was stopped (Ctrl-Z): a worker with more output than a pipe holds has waited.
void WorkerPool::countStops() {
  const auto now = std::chrono::steady_clock::now();
  const double since = std::chrono::duration<double>(now - std::exchange(m_watched, now)).count();
  for (Running& r : m_running) r.unwatched += since > 1 ? since : 0;
}

void WorkerPool::guard(Running& r) {
  if (!r.killedFor.empty()) return;
  if (r.child->seconds() - r.unwatched > r.limits.seconds) {
    r.killedFor = "timeout", r.why = fmt::format("no result within {:g} s", r.limits.seconds);
  } else if (const double bytes = static_cast<double>(r.child->residentBytes()); bytes > r.limits.bytes) {
    r.killedFor = "out_of_memory", r.why = memoryText(bytes, r.limits.bytes);
  } else if (const double told = static_cast<double>(r.child->output().size()); told > r.limits.bytes) {
    r.killedFor = "out_of_memory", r.why = "its output has " + memoryText(told, r.limits.bytes);
  }
  if (!r.killedFor.empty()) r.child->kill();
}

WorkerEnd WorkerPool::endOf(const Running& r) {
  const Child& c = *r.child;
  const std::string last = c.lastError();
  WorkerEnd end{
      .job = r.job, .reason = last, .output = {}, .started = r.started, .load = r.load, .seconds = c.seconds()};
  if (!r.killedFor.empty()) {
    end.outcome = r.killedFor, end.reason = r.why;
  } else if (c.flooded()) {
    end.outcome = "out_of_memory", end.reason = "its output has no end";
  } else if (c.signal()) {
    end.outcome = "crash", end.signal = c.signal();
    end.reason = fmt::format("signal {} ({}){}{}", c.signal(), strsignal(c.signal()), last.empty() ? "" : ": ", last);
  } else if (c.exitCode() == 2) {
    end.outcome = "unsupported";
  } else if (c.exitCode() != 0) {
    end.outcome = last.find("bad_alloc") != std::string::npos ? "out_of_memory" : "crash";
    end.reason = fmt::format("exit code {}{}{}", c.exitCode(), last.empty() ? "" : ": ", last);
  } else {
    end.output = c.output();
  }
  return end;
}

void checkWorker(const std::string& precision, bool engine) {
  const Child started(workerPath(precision, engine), "", -1, false);  // and killed
}

InterruptGuard::InterruptGuard() {
  interruptFlag = 0;
  struct sigaction action {};
  action.sa_handler = interrupt;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], nullptr, &oldActions[i]);
    const bool kept = kSignals[i] == SIGHUP && oldActions[i].sa_handler == SIG_IGN;  // by nohup
    if (!kept) sigaction(kSignals[i], &action, nullptr);
  }
}

InterruptGuard::~InterruptGuard() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &oldActions[i], nullptr);
}

bool InterruptGuard::interrupted() { return interruptFlag != 0; }

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

}}  // namespace lpc::LPC_PRECISION
