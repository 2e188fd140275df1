// SPDX-License-Identifier: Zlib
// Starts workers with a request each, watches time and memory, and returns their results.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "experiments/runner/child.h"
#include "experiments/trial/request.h"

namespace lpc { inline namespace LPC_PRECISION {

struct WorkerLimits {
  double seconds = 120, bytes = 4294967296.0;
};

struct WorkerEnd {
  std::size_t job = 0;
  std::string outcome = "ok";  // or timeout, out_of_memory, crash (by a signal or an exception), unsupported
  std::string reason;
  std::string output;   // of a successful worker
  std::string started;  // UTC
  double load = 0;      // the machine's load average at the start; NaN if unknown
  double seconds = 0;
  int signal = 0;  // that ended it, unless this program sent it
};

class WorkerPool {
 public:
  /// `plugins` are paths; each worker gets those of its precision.
  explicit WorkerPool(const std::vector<std::string>& plugins);

  std::size_t running() const { return m_running.size(); }
  void start(std::size_t job, TrialRequest request, const WorkerLimits& limits, int core);
  /// A task of another kind. `core` >= 0 pins it to that processor. `job` is returned with its end.
  void start(std::size_t job, const std::string& precision, nlohmann::json request, const WorkerLimits& limits,
             int core);
  /// Waits briefly for output and returns the workers that have ended.
  std::vector<WorkerEnd> ended();
  void killAll() { m_running.clear(); }

 private:
  struct Running {
    std::size_t job;
    WorkerLimits limits;
    std::unique_ptr<Child> child;
    std::string started;
    double load;
    std::string killedFor, why;  // timeout or out_of_memory, if this program killed it
    double unwatched = 0;        // s during which the pool was not polled
  };
  void launch(std::size_t job, const std::string& program, const nlohmann::json& request, const WorkerLimits& limits,
              int core);
  void waitForOutput();
  void countStops();
  static void guard(Running& r);
  static WorkerEnd endOf(const Running& r);

  std::vector<std::pair<std::string, std::string>> m_plugins;  // precision, absolute path
  std::vector<Running> m_running;
  std::chrono::steady_clock::time_point m_watched;  // time of the last poll
};

/// Throws UserError if no worker for trials of this precision, or of engines, can be started.
void checkWorker(const std::string& precision, bool engine);

/// Sets a flag on Ctrl-C, SIGTERM and, without nohup, a closed terminal (SIGHUP), during its lifetime.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
  static bool interrupted();
};

/// Thrown to abandon the work under way. The program ends with exit code 130.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("stopped") {}
};

/// Processors that this process may use.
std::vector<int> processors();

/// As 3:07.
std::string clockText(double seconds);

}}  // namespace lpc::LPC_PRECISION
