// SPDX-License-Identifier: Zlib
#include "experiments/runner/store_check.h"

#include <filesystem>

#include "experiments/runner/store.h"
#include "experiments/runner/store_open.h"
#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

void checkExisting(const std::string& path) try {
  const Store ours(path, false);  // a valid store with our schema
  requireWritable(path);
  SQLite::Database db(databaseName(path), SQLite::OPEN_READWRITE);
  db.setBusyTimeout(30000);  // a sweep may be writing
  const std::string found = db.execAndGet("PRAGMA quick_check(1)").getString();
  if (found != "ok") throw UserError(path + ": a damaged store: " + found.substr(found.find_last_of('\n') + 1));
  const SQLite::Transaction writes(db, SQLite::TransactionBehavior::IMMEDIATE);  // rolled back at its end
} catch (const SQLite::Exception& e) {
  failStore(path, e);
}

}  // namespace

void checkStore(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const bool empty = fs::is_regular_file(path, ignored) &&
                     fs::file_size(path, ignored) == 0;  // the process was killed while creating it
  if (fs::exists(path, ignored) && !empty) return checkExisting(path);
  requireWritable(path);
}

}}  // namespace lpc::LPC_PRECISION
