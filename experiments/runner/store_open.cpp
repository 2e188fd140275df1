// SPDX-License-Identifier: Zlib
#include "experiments/runner/store_open.h"

#include <sqlite3.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>
#include <vector>

#include "experiments/runner/store.h"
#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr const char* kNoName = "the name of the store is empty; valid: the name of a file";
constexpr const char* kSchemaVersion = "3";
constexpr const char* kTables = R"(
CREATE TABLE IF NOT EXISTS meta(key TEXT PRIMARY KEY, value TEXT);
CREATE TABLE IF NOT EXISTS machine(id INTEGER PRIMARY KEY, description TEXT UNIQUE);
CREATE TABLE IF NOT EXISTS sweep(name TEXT PRIMARY KEY, kind TEXT, summary TEXT, baseline TEXT, roles TEXT);
CREATE TABLE IF NOT EXISTS metrics(what TEXT, name TEXT, kind TEXT, title TEXT, unit TEXT, meaning TEXT, role TEXT,
  smaller TEXT, needs TEXT, PRIMARY KEY(what, name));
CREATE TABLE IF NOT EXISTS planned(sweep TEXT, key TEXT, axes TEXT, PRIMARY KEY(sweep, key));
CREATE TABLE IF NOT EXISTS trial(key TEXT PRIMARY KEY, kind TEXT, canonical TEXT, outcome TEXT, reason TEXT,
  step INTEGER, metrics TEXT, machine INTEGER, commit_id TEXT, started TEXT, wall REAL, timed INTEGER, hash TEXT);
CREATE TABLE IF NOT EXISTS series(key TEXT, name TEXT, data BLOB, PRIMARY KEY(key, name));
CREATE TABLE IF NOT EXISTS poses(key TEXT, step INTEGER, data BLOB, PRIMARY KEY(key, step));
CREATE TABLE IF NOT EXISTS benchmark(id INTEGER PRIMARY KEY, imported TEXT, data TEXT);
CREATE TABLE IF NOT EXISTS ledger(stage TEXT, precision TEXT, dimension INTEGER, kind_a TEXT, kind_b TEXT, axis TEXT,
  value TEXT, method TEXT, role TEXT, asked INTEGER, agree INTEGER, wrong INTEGER, tie INTEGER, undecided INTEGER,
  refused INTEGER, not_finite INTEGER, threw INTEGER, crashed INTEGER, hung INTEGER, wrong_side INTEGER, capped INTEGER,
  max_error REAL, histogram TEXT, ns REAL, worst TEXT,
  PRIMARY KEY(stage, precision, dimension, kind_a, kind_b, axis, value, method));
CREATE TABLE IF NOT EXISTS verified_block(key TEXT PRIMARY KEY, stage TEXT, precision TEXT, dimension INTEGER,
  method TEXT, code TEXT);
CREATE TABLE IF NOT EXISTS found_case(name TEXT PRIMARY KEY, vertices INTEGER, size REAL, data TEXT);
)";

// LPC_STORE_MAX_PAGES limits a store (pages of 4 KiB). At the limit it behaves like a full disk, which tests use.
void boundSize(SQLite::Database& db) {
  const char* pages = std::getenv("LPC_STORE_MAX_PAGES");
  if (!pages || !*pages) return;
  char* end = nullptr;
  const long n = std::strtol(pages, &end, 10);
  if (*end || n < 1) throw UserError(std::string("LPC_STORE_MAX_PAGES is '") + pages + "'; valid: 1 or more");
  db.exec("PRAGMA max_page_count=" + std::to_string(n));
}

// Creates all tables in an empty database, or none: on failure no empty file remains.
void make(const std::string& path) try {
  SQLite::Database db(databaseName(path), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  db.setBusyTimeout(30000);
  boundSize(db);
  const auto tables = [&] { return db.execAndGet("SELECT count(*) FROM sqlite_master").getInt(); };
  if (tables() > 0) return;
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);  // two programs may start at once
  if (tables() > 0) return;
  db.exec(kTables);
  db.exec(std::string("INSERT INTO meta VALUES ('schema_version', '") + kSchemaVersion + "')");
  transaction.commit();
} catch (...) {
  std::error_code ignored;
  if (std::filesystem::file_size(path, ignored) == 0) std::filesystem::remove(path, ignored);
  throw;
}

// Folders that are created are removed again if the store cannot be.
void makeWithFolders(const std::string& path) {
  namespace fs = std::filesystem;
  std::vector<fs::path> absent;  // the innermost first
  std::error_code error;
  for (fs::path at = fs::path(path).parent_path(); !at.empty() && !fs::exists(at, error); at = at.parent_path()) {
    absent.push_back(at);
  }
  error.clear();
  if (!absent.empty()) fs::create_directories(absent.front(), error);
  try {
    if (error) throw UserError(path + ": cannot be created: " + error.message());
    make(path);
  } catch (...) {
    for (const fs::path& folder : absent) fs::remove(folder, error);  // only empty ones
    throw;
  }
}

void prepare(const std::string& path, bool create) {
  namespace fs = std::filesystem;
  if (path.empty()) throw UserError(kNoName);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::none) throw UserError(path + ": cannot be opened: " + error.message());
  const bool exists = fs::exists(status);
  if (exists && !fs::is_regular_file(status)) throw UserError(path + ": not a result store: it is not a regular file");
  if (!create && !exists) throw UserError(path + ": this store does not exist");
  if (!create) return;
  requireWritable(path);
  if (exists) {
    make(path);
  } else {
    makeWithFolders(path);
  }
}

// Rejects stores that lack a table or a column, before writing.
void requireWhole(SQLite::Database& db, const std::string& path) {
  const auto columns = [](SQLite::Database& of) {
    SQLite::Statement s(of,
                        "SELECT t.name, c.name FROM sqlite_master t, pragma_table_info(t.name) c WHERE t.type='table'");
    std::set<std::pair<std::string, std::string>> out;
    while (s.executeStep()) out.emplace(s.getColumn(0).getString(), s.getColumn(1).getString());
    return out;
  };
  SQLite::Database ours(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  ours.exec(kTables);
  const auto found = columns(db);
  for (const auto& [table, column] : columns(ours)) {
    if (found.contains({table, column})) continue;
    throw UserError(path + ": not a result store, or a damaged one: it has no column '" + column + "' in table '" +
                    table + "'");
  }
}

}  // namespace

std::string databaseName(const std::string& path) {
  return path.starts_with("file:") || path.starts_with(':') ? "./" + path : path;
}

void requireWritable(const std::string& path) {
  namespace fs = std::filesystem;
  if (path.empty()) throw UserError(kNoName);
  std::error_code ignored;
  if (fs::exists(path, ignored)) {
    if (access(path.c_str(), W_OK) != 0) throw UserError(path + ": cannot be written: " + std::strerror(errno));
    return;
  }
  constexpr const char* kBeside = "-journal";  // the longest ending of SQLite's other files
  const auto fail = [&](const std::string& why) { throw UserError(path + ": cannot be created: " + why); };
  const fs::path name(path);
  if (!name.has_filename()) fail("it has no file name");
  if ((name.filename().string() + kBeside).size() > NAME_MAX) fail(std::strerror(ENAMETOOLONG));
  for (const fs::path& part : name) {
    if (part.string().size() > NAME_MAX) fail(std::strerror(ENAMETOOLONG));
  }
  fs::path folder = fs::absolute(name).parent_path();
  while (!fs::exists(folder, ignored) && folder.has_relative_path()) folder = folder.parent_path();
  if (!fs::is_directory(folder, ignored)) fail(std::strerror(ENOTDIR));
  if (access(folder.c_str(), W_OK | X_OK) != 0) fail(std::strerror(errno));
}

// WAL needs a file beside the store, which a read-only medium cannot have. There the store does not change either.
std::string readableName(const std::string& path) {
  const std::string name = databaseName(path);
  try {
    SQLite::Database db(name, SQLite::OPEN_READWRITE);
    db.setBusyTimeout(30000);
    db.execAndGet("SELECT count(*) FROM sqlite_master");
    return name;
  } catch (const SQLite::Exception& e) {
    std::error_code none;
    const bool pending = std::filesystem::file_size(name + "-wal", none) > 0 && !none;
    if (e.getErrorCode() != SQLITE_CANTOPEN && e.getErrorCode() != SQLITE_READONLY) throw;
    if (pending) throw UserError(path + ": has changes in its file -wal and cannot be written; valid: a copy of both");
  }
  std::string uri = "file://";
  for (const char c : std::filesystem::absolute(name).string()) {
    constexpr const char* kDigits = "0123456789ABCDEF";
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || std::strchr("/._-", c)) {
      uri += c;
    } else {
      uri += {'%', kDigits[byte / 16], kDigits[byte % 16]};
    }
  }
  return uri + "?immutable=1";
}

SQLite::Database openStore(const std::string& path, bool create) try {
  prepare(path, create);
  SQLite::Database db(create ? databaseName(path) : readableName(path), SQLite::OPEN_READWRITE | SQLite::OPEN_URI);
  db.setBusyTimeout(30000);
  // Nothing is written before the file is known to be a store.
  if (!db.tableExists("meta")) throw UserError(path + ": not a result store: it has no table 'meta'");
  std::string found = "none";
  if (SQLite::Statement version(db, "SELECT value FROM meta WHERE key='schema_version'");
      version.executeStep() && !version.getColumn(0).isNull()) {
    found = version.getColumn(0).getString();
  }
  if (found != kSchemaVersion) {
    throw UserError(path + ": the store has schema " + found + ", this program reads schema " + kSchemaVersion);
  }
  requireWhole(db, path);
  if (!create) return db;
  db.exec("PRAGMA journal_mode=WAL");
  db.exec("PRAGMA synchronous=NORMAL");  // with WAL a killed process loses nothing; only a machine failure may
  boundSize(db);
  return db;
} catch (const SQLite::Exception& e) {
  failStore(path, e);
}

}}  // namespace lpc::LPC_PRECISION
