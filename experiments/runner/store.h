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

/// Whose ledger it is.
struct LedgerMethod {
  std::string stage, precision;
  int dimension = 3;
  std::string method;
};

/// A block of inputs that one method was asked. `code` is all that its answers and verdicts depend on.
struct VerifiedBlock {
  std::string key;
  LedgerMethod method;
  std::string code;
};

/// A trial that was run, as it is kept.
struct StoredTrial {
  std::string key, outcome, reason;
  long step = -1;  // at which it fell
  nlohmann::json canonical;
};

/// The result store: one SQLite file. A finished trial is one transaction, so whatever is killed whenever, nothing that
/// was finished is lost and nothing half-written is found. Tables and metric names: docs/manual.md.
class Store {
 public:
  /// Opens it; makes it when `create`. Throws UserError for a file that is no store or has another schema.
  Store(const std::string& path, bool create);
  /// For whoever runs what it lacks: alone, until this is gone. Throws UserError while another process does.
  void claim();

  /// The outcome of a trial, if it was run.
  std::optional<std::string> outcome(const std::string& key);
  /// The final hash of a trial that ended with `ok`.
  std::optional<std::string> hash(const std::string& key);
  /// What a trial that was run ended with.
  struct Row {
    std::string outcome, reason;
    std::map<std::string, double> metrics;  // that are numbers
  };
  std::optional<Row> measured(const std::string& key);
  /// The last poses of a trial, by body as docs/manual.md says; none: it kept none.
  std::vector<double> lastPoses(const std::string& key);
  /// The only trial whose key begins so. Throws UserError where there is none, or another.
  StoredTrial find(const std::string& keyBegin);
  /// Seconds that the trial took.
  std::optional<double> wall(const std::string& key);
  /// Keys of trials that run again: of cells that the sweep had before, with another key since scene, code, compiler or
  /// options have changed, and without a result yet.
  std::set<std::string> changed(const PlannedSweep& sweep);
  /// Replaces what the sweep planned before, or adds to it (a part of a sweep was asked for).
  void plan(const PlannedSweep& sweep, bool replace);
  void put(const PlannedTrial& trial, const TrialResult& result, const std::string& started, double wall);
  /// The strip of a run that fell (experiments/film/falls.h), which reports draw.
  bool hasFilm(const std::string& key);
  void putFilm(const std::string& key, const std::string& film);
  void setMeta(const std::string& key, const std::string& value);
  /// What metrics and series are; replaces what the store holds of the same names.
  void describe(const std::vector<DescribedMetric>& metrics);
  /// What Google Benchmark wrote, as JSON.
  void addBenchmark(const std::string& text);
  /// Has this block of a verification been booked for this method?
  bool isVerified(const std::string& key);
  /// Books what was verified together with the blocks that it is of; all of it, or nothing when another process has
  /// booked one of the blocks meanwhile.
  void addVerified(const std::vector<VerifiedBlock>& blocks, const Verified& verified);
  /// Drops what the ledger holds of the method with other code than `code`: its numbers would add up to nobody's.
  void keepOnlyCode(const LedgerMethod& method, const std::string& code);
  Ledger ledger();
  /// The simplest pairs on which methods failed, by file name without extension.
  std::map<std::string, std::string> foundCases();
  /// The pair with the largest error of each method that was wrong, in the same way.
  std::map<std::string, std::string> worstCases();
  /// Takes over all trials, plans, benchmarks and ledgers of methods of another store that this one lacks. Returns the
  /// number of trials.
  long merge(const std::string& path);

 private:
  long machineId();
  nlohmann::json commandsOf(const PlannedSweep& sweep, bool replace);
  void forget(const PlannedSweep& sweep, const std::function<bool(const nlohmann::json& axes)>& is);
  void forgetCells(const PlannedSweep& sweep);        // that are planned anew
  void forgetFirstValues(const PlannedSweep& sweep);  // of settings, for which they stood in older stores
  void mergeLedger();                                 // from the attached store `other`

  std::optional<StoreLock> m_lock;  // goes after the database
  SQLite::Database m_db;
  long m_machine = 0;
  std::string m_commit;
};

/// Tells a user what SQLite cannot do.
[[noreturn]] void failStore(const std::string& path, const SQLite::Exception& e);

/// The JSON of a text in a store, which is one of these unless the file is damaged: then it throws as SQLite does.
template <class T = nlohmann::json::object_t>
T storedJson(const std::string& text) try {
  return nlohmann::json::parse(text).get<T>();
} catch (const nlohmann::json::exception&) {
  throw SQLite::Exception("a text in it is no JSON of ours", 11);  // SQLITE_CORRUPT
}

/// Now, UTC, as 2026-11-21T04:05:06Z.
std::string timeStamp();

}}  // namespace lpc::LPC_PRECISION
