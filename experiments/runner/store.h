// SPDX-License-Identifier: Zlib
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "experiments/runner/store_lock.h"
#include "experiments/runner/sweep_file.h"
#include "experiments/trial/measure/metric.h"
#include "experiments/trial/trial.h"
#include "oracles/verify/ledger.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The method of a ledger.
struct LedgerMethod {
  std::string stage, precision;
  int dimension = 3;
  std::string method;
};

/// A block of inputs verified for one method. `code` identifies everything on which its answers and verdicts depend.
struct VerifiedBlock {
  std::string key;
  LedgerMethod method;
  std::string code;
};

/// A finished trial as stored.
struct StoredTrial {
  std::string key, outcome, reason;
  long step = -1;  // of the failure
  nlohmann::json canonical;
};

/// The result store: one SQLite file. A finished trial is one transaction, so a killed process loses no finished trial
/// and leaves nothing half-written. docs/reference_results.md describes tables and metric names.
class Store {
 public:
  /// Opens it, or creates it if `create`; without `create` only to read, also from a read-only medium. Throws UserError
  /// if the file is not a store or has another schema.
  Store(const std::string& path, bool create);
  /// Locks the store for a runner until destruction. Throws UserError if another process has the lock.
  void claim();

  /// The outcome of a trial, if it has run.
  std::optional<std::string> outcome(const std::string& key);
  /// The final hash of a trial with outcome `ok`.
  std::optional<std::string> hash(const std::string& key);
  /// The result of a finished trial.
  struct Row {
    std::string outcome, reason;
    std::map<std::string, double> metrics;  // that are numbers
  };
  std::optional<Row> measured(const std::string& key);
  /// The last poses of a trial, by body as docs/reference_results.md describes; empty if not kept.
  std::vector<double> lastPoses(const std::string& key);
  /// The only trial with a key that begins so. Throws UserError if there is none, or more than one.
  StoredTrial find(const std::string& keyBegin);
  /// Duration of the trial, s.
  std::optional<double> wall(const std::string& key);
  /// Keys of trials to be repeated: of cells that the sweep already had under another key, because scene, code,
  /// compiler or options have changed, and without a result yet.
  std::set<std::string> changed(const PlannedSweep& sweep);
  /// Replaces the sweep's former plan, or extends it (if a part of a sweep was requested).
  void plan(const PlannedSweep& sweep, bool replace);
  void put(const PlannedTrial& trial, const TrialResult& result, const std::string& started, double wall);
  /// The film strip of a failed run (experiments/film/falls.h), for reports.
  bool hasFilm(const std::string& key);
  void putFilm(const std::string& key, const std::string& film);
  void setMeta(const std::string& key, const std::string& value);
  /// Descriptions of metrics and series; replaces those with the same names.
  void describe(const std::vector<DescribedMetric>& metrics);
  /// Output of Google Benchmark, as JSON.
  void addBenchmark(const std::string& text);
  /// Whether this block of a verification is recorded for this method.
  bool isVerified(const std::string& key);
  /// Records a verification together with its blocks: all of it, or nothing if another process has recorded one of the
  /// blocks meanwhile.
  void addVerified(const std::vector<VerifiedBlock>& blocks, const Verified& verified);
  /// Drops the ledger of the method with other code than `code`: a sum over two versions would describe neither.
  void keepOnlyCode(const LedgerMethod& method, const std::string& code);
  Ledger ledger();
  /// The simplest failing pairs of methods, by file name without extension.
  std::map<std::string, std::string> foundCases();
  /// The pair with the largest error of each wrong method, in the same form.
  std::map<std::string, std::string> worstCases();
  /// Copies all missing trials, plans, benchmarks and ledgers of methods from another store. Returns the number of
  /// trials.
  long merge(const std::string& path);

 private:
  long machineId();
  nlohmann::json commandsOf(const PlannedSweep& sweep, bool replace);
  void forget(const PlannedSweep& sweep, const std::function<bool(const nlohmann::json& axes)>& is);
  void forgetCells(const PlannedSweep& sweep);        // that are planned anew
  void forgetFirstValues(const PlannedSweep& sweep);  // of settings, which older stores planned in their place
  void mergeLedger();                                 // from the attached store `other`

  std::string m_path;
  std::optional<StoreLock> m_lock;  // destroyed after the database
  SQLite::Database m_db;
  long m_machine = 0;
  std::string m_commit;
};

/// Reports an SQLite error to the user.
[[noreturn]] void failStore(const std::string& path, const SQLite::Exception& e);

/// Parses JSON stored in a text column. Throws like SQLite if the file is damaged.
template <class T = nlohmann::json::object_t>
T storedJson(const std::string& text) try {
  return nlohmann::json::parse(text).get<T>();
} catch (const nlohmann::json::exception&) {
  throw SQLite::Exception("a stored text is not valid JSON", 11);  // SQLITE_CORRUPT
}

/// The present time, UTC, as 2026-11-21T04:05:06Z.
std::string timeStamp();

}}  // namespace lpc::LPC_PRECISION
