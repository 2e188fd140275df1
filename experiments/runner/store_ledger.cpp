// SPDX-License-Identifier: Zlib
// The ledger of verifications in the store.
#include "experiments/runner/catalogue.h"
#include "experiments/runner/store.h"
#include "oracles/verify/verdict.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;

constexpr const char* kKeyNames = "stage, precision, dimension, kind_a, kind_b, axis, value, method";
constexpr int kKeys = 8;

std::string tallyColumns() {
  std::string out;
  for (const std::string_view name : kTallyNames) out += ", " + std::string(name);
  return out;
}
std::string columns() {
  return std::string(kKeyNames) + ", role" + tallyColumns() + ", max_error, histogram, ns, worst";
}

void bindKey(SQLite::Statement& s, const LedgerKey& k) {
  s.bind(1, k.stage), s.bind(2, k.precision), s.bind(3, k.dimension), s.bind(4, k.kindA), s.bind(5, k.kindB);
  s.bind(6, k.axis), s.bind(7, k.value), s.bind(8, k.method);
}

void bindMethod(SQLite::Statement& s, const LedgerMethod& m) {
  s.bind(1, m.stage), s.bind(2, m.precision), s.bind(3, m.dimension), s.bind(4, m.method);
}

// From a row of `columns()`.
LedgerEntry entryOf(SQLite::Statement& s) {
  LedgerEntry e;
  const std::string role = s.getColumn(kKeys).getString();
  for (const AlgorithmRole r :
       {AlgorithmRole::competitor, AlgorithmRole::witness, AlgorithmRole::referee, AlgorithmRole::engine}) {
    if (roleName(r) == role) e.role = r;
  }
  int at = kKeys + 1;
  for (long& count : e.tallies) count = static_cast<long>(s.getColumn(at++).getInt64());
  e.maxError = s.getColumn(at++).getDouble();
  e.histogram = storedJson<std::map<std::string, long>>(s.getColumn(at++).getString());
  e.nanoseconds = s.getColumn(at++).getDouble();
  e.worst = s.getColumn(at).getString();
  return e;
}

void putEntry(SQLite::Statement& s, const LedgerKey& key, const LedgerEntry& e) {
  bindKey(s, key);
  int at = kKeys + 1;
  s.bind(at++, std::string(roleName(e.role)));
  for (const long count : e.tallies) s.bind(at++, static_cast<std::int64_t>(count));
  s.bind(at++, e.maxError), s.bind(at++, json(e.histogram).dump()), s.bind(at++, e.nanoseconds), s.bind(at, e.worst);
  s.exec();
  s.reset();
}

// A file name: gjk_epa-wrong_distance-3d-f64, without braces and similar characters.
std::string nameOf(const std::string& method, const std::string& what, int dimension, const std::string& precision) {
  std::string name = method + "-" + what + "-" + std::to_string(dimension) + "d-" + precision;
  for (char& letter : name) {
    if (!std::isalnum(static_cast<unsigned char>(letter)) && letter != '-') letter = '_';
  }
  return name;
}

}  // namespace

bool Store::isVerified(const std::string& key) try {
  SQLite::Statement s(m_db, "SELECT 1 FROM verified_block WHERE key=?");
  s.bind(1, key);
  return s.executeStep();
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

void Store::addVerified(const std::vector<VerifiedBlock>& blocks, const Verified& verified) try {
  SQLite::Transaction transaction(m_db, SQLite::TransactionBehavior::IMMEDIATE);
  SQLite::Statement mark(m_db, "INSERT OR IGNORE INTO verified_block VALUES (?, ?, ?, ?, ?, ?)");
  for (const VerifiedBlock& b : blocks) {
    mark.bind(1, b.key), mark.bind(2, b.method.stage), mark.bind(3, b.method.precision);
    mark.bind(4, b.method.dimension), mark.bind(5, b.method.method), mark.bind(6, b.code);
    if (mark.exec() == 0) return;  // rolls back
    mark.reset();
  }
  SQLite::Statement get(m_db, "SELECT " + columns() +
                                  " FROM ledger WHERE stage=? AND precision=? AND dimension=? AND kind_a=? AND "
                                  "kind_b=? AND axis=? AND value=? AND method=?");
  std::string marks;
  for (std::size_t i = 0; i < kKeys + 1 + kTallies + 4; ++i) marks += i ? ", ?" : "?";
  SQLite::Statement set(m_db, "INSERT OR REPLACE INTO ledger(" + columns() + ") VALUES (" + marks + ")");
  for (const auto& [key, entry] : verified.ledger) {
    bindKey(get, key);
    LedgerEntry sum;
    if (get.executeStep()) sum = entryOf(get);
    get.reset();
    sum.add(entry);
    putEntry(set, key, sum);
  }
  SQLite::Statement keep(m_db,
                         "INSERT INTO found_case VALUES (?1, ?2, ?3, ?4) ON CONFLICT(name) DO UPDATE SET vertices=?2, "
                         "size=?3, data=?4 WHERE ?2 < vertices OR (?2 = vertices AND ?3 < size)");
  const LedgerMethod& of = blocks.front().method;
  for (const auto& [name, c] : verified.found) {
    keep.bind(1, nameOf(c.method, c.failure, of.dimension, of.precision)), keep.bind(2, c.vertices),
        keep.bind(3, c.size);
    keep.bind(4, c.text);
    keep.exec();
    keep.reset();
  }
  transaction.commit();
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

void Store::keepOnlyCode(const LedgerMethod& method, const std::string& code) try {
  SQLite::Transaction transaction(m_db, SQLite::TransactionBehavior::IMMEDIATE);
  constexpr const char* kSame = " WHERE stage=? AND precision=? AND dimension=? AND method=?";
  SQLite::Statement other(m_db, std::string("SELECT 1 FROM verified_block") + kSame + " AND code<>? LIMIT 1");
  bindMethod(other, method), other.bind(5, code);
  if (!other.executeStep()) return;
  other.reset();
  for (const char* table : {"ledger", "verified_block"}) {
    SQLite::Statement drop(m_db, std::string("DELETE FROM ") + table + kSame);
    bindMethod(drop, method);
    drop.exec();
  }
  SQLite::Statement forget(m_db,
                           "DELETE FROM found_case WHERE json_extract(data, '$.found.stage')=? AND "
                           "json_extract(data, '$.found.precision')=? AND json_extract(data, '$.dim')=? AND "
                           "json_extract(data, '$.found.method')=?");
  bindMethod(forget, method);
  forget.exec();
  transaction.commit();
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

Ledger Store::ledger() try {
  Ledger out;
  SQLite::Statement s(m_db, "SELECT " + columns() + " FROM ledger");
  while (s.executeStep()) {
    const LedgerKey key{.stage = s.getColumn(0).getString(),
                        .precision = s.getColumn(1).getString(),
                        .dimension = s.getColumn(2).getInt(),
                        .kindA = s.getColumn(3).getString(),
                        .kindB = s.getColumn(4).getString(),
                        .axis = s.getColumn(5).getString(),
                        .value = s.getColumn(6).getString(),
                        .method = s.getColumn(7).getString()};
    out[key] = entryOf(s);
  }
  return out;
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

std::map<std::string, std::string> Store::foundCases() try {
  std::map<std::string, std::string> out;
  SQLite::Statement s(m_db, "SELECT name, data FROM found_case");
  while (s.executeStep()) out[s.getColumn(0).getString()] = s.getColumn(1).getString();
  return out;
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

std::map<std::string, std::string> Store::worstCases() try {
  std::map<std::string, std::string> out;
  // SQLite takes the other columns from the row with the maximum.
  SQLite::Statement s(
      m_db,
      "SELECT method, dimension, precision, worst, max(max_error) FROM ledger WHERE axis='all' AND wrong > 0 "
      "AND worst <> '' AND worst NOT LIKE '%" +
          std::string(kNoFailure) + "%' GROUP BY stage, method, dimension, precision");
  while (s.executeStep()) {
    out[nameOf(s.getColumn(0).getString(), "worst", s.getColumn(1).getInt(), s.getColumn(2).getString())] =
        s.getColumn(3).getString();
  }
  return out;
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

// Sums over blocks cannot be separated again: a method's ledger is copied whole or not at all.
void Store::mergeLedger() {
  m_db.exec(
      "CREATE TEMP TABLE taken AS SELECT DISTINCT stage, precision, dimension, method FROM other.verified_block EXCEPT "
      "SELECT stage, precision, dimension, method FROM main.verified_block");
  for (const char* table : {"ledger", "verified_block"}) {
    m_db.exec(std::string("INSERT INTO main.") + table + " SELECT o.* FROM other." + table +
              " o JOIN taken USING(stage, precision, dimension, method)");
  }
  m_db.exec("DROP TABLE taken");
  m_db.exec(
      "INSERT INTO found_case SELECT * FROM other.found_case WHERE true ON CONFLICT(name) DO UPDATE SET "
      "vertices=excluded.vertices, size=excluded.size, data=excluded.data WHERE excluded.vertices < vertices OR "
      "(excluded.vertices = vertices AND excluded.size < size)");
}

}}  // namespace lpc::LPC_PRECISION
