// SPDX-License-Identifier: Zlib
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <optional>
#include <string>
#include <vector>

#include "experiments/runner/trial_plan.h"
#include "experiments/trial/trial.h"

namespace lpc::inline LPC_PRECISION {

/// The result store: one SQLite file. A finished trial is one transaction, so whatever is killed whenever, nothing that
/// was finished is lost and nothing half-written is found. Tables and metric names: docs/manual.md.
class Store {
 public:
  /// Opens it; makes it when `create`. Throws UserError for a file that is no store or has another schema.
  Store(const std::string& path, bool create);

  /// The outcome of a trial, if it was run.
  std::optional<std::string> outcome(const std::string& key);
  /// The final hash of a trial that ended with `ok`.
  std::optional<std::string> hash(const std::string& key);
  /// Seconds that the trial took.
  std::optional<double> wall(const std::string& key);
  /// Replaces what the sweep planned before, or adds to it (a part of a sweep was asked for).
  void plan(const std::string& sweep, const std::vector<PlannedTrial>& trials, bool replace);
  void put(const PlannedTrial& trial, const TrialResult& result, const std::string& started, double wall);
  void setMeta(const std::string& key, const std::string& value);
  void addBenchmark(const std::string& json);
  /// Takes over all trials, plans and benchmarks of another store that this one lacks. Returns the number of trials.
  long merge(const std::string& path);

 private:
  long machineId();

  SQLite::Database m_db;
  long m_machine = 0;
  std::string m_commit;
};

/// Now, UTC, as 2026-11-21T04:05:06Z.
std::string timeStamp();

}  // namespace lpc::inline LPC_PRECISION
