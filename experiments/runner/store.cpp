// SPDX-License-Identifier: Zlib
#include "experiments/runner/store.h"

#include <sqlite3.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <map>
#include <set>

#include "experiments/runner/code_identity.h"
#include "experiments/runner/locations.h"
#include "experiments/runner/store_open.h"
#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;

// Newer than the schema version, which another table does not change: older programs ignore it.
constexpr const char* kFilmTable = "CREATE TABLE IF NOT EXISTS film(key TEXT PRIMARY KEY, data TEXT)";

// The store's numbers are little-endian float64, like this machine's.
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);
void bindNumbers(SQLite::Statement& s, int index, const std::vector<double>& data) {
  s.bind(index, data.data(), static_cast<int>(data.size() * sizeof(double)));
}

std::optional<std::string> one(SQLite::Statement& s) {
  if (!s.executeStep() || s.getColumn(0).isNull()) return std::nullopt;
  return s.getColumn(0).getString();
}

}  // namespace

void failStore(const std::string& path, const SQLite::Exception& e) {
  const bool foreign = e.getErrorCode() == SQLITE_NOTADB || e.getErrorCode() == SQLITE_CORRUPT;
  throw UserError(path + (foreign ? ": not a result store, or a damaged one: " : ": ") + e.what());
}

Store::Store(const std::string& path, bool create)
    : m_path(path), m_db(openStore(path, create)), m_commit(commitOfSources()) {}

void Store::claim() { m_lock.emplace(m_path); }

std::optional<std::string> Store::outcome(const std::string& key) try {
  SQLite::Statement s(m_db, "SELECT outcome FROM trial WHERE key=?");
  s.bind(1, key);
  return one(s);
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

std::optional<std::string> Store::hash(const std::string& key) try {
  SQLite::Statement s(m_db, "SELECT hash FROM trial WHERE key=? AND outcome='ok'");
  s.bind(1, key);
  return one(s);
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

std::optional<Store::Row> Store::measured(const std::string& key) try {
  SQLite::Statement s(m_db, "SELECT outcome, reason, metrics FROM trial WHERE key=?");
  s.bind(1, key);
  if (!s.executeStep()) return std::nullopt;
  Row row{s.getColumn(0).getString(), s.getColumn(1).getString(), {}};
  for (const auto& [name, value] : storedJson(s.getColumn(2).getString())) {
    if (value.is_number()) row.metrics[name] = value;
  }
  return row;
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

std::vector<double> Store::lastPoses(const std::string& key) try {
  SQLite::Statement s(m_db, "SELECT data FROM poses WHERE key=? ORDER BY step DESC LIMIT 1");
  s.bind(1, key);
  if (!s.executeStep()) return {};
  const auto blob = s.getColumn(0);
  std::vector<double> numbers(static_cast<std::size_t>(blob.getBytes()) / sizeof(double));
  if (!numbers.empty()) std::memcpy(numbers.data(), blob.getBlob(), numbers.size() * sizeof(double));
  return numbers;
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

StoredTrial Store::find(const std::string& keyBegin) try {
  const bool digits = keyBegin.find_first_not_of("0123456789abcdef") == keyBegin.npos;
  if (keyBegin.empty() || !digits) throw UserError("'" + keyBegin + "' is not a key; valid: digits 0 to 9 and a to f");
  SQLite::Statement s(m_db,
                      "SELECT key, outcome, reason, step, canonical FROM trial WHERE substr(key, 1, length(?1))=?1");
  s.bind(1, keyBegin);
  if (!s.executeStep()) throw UserError("no trial has the key '" + keyBegin + "' in " + m_path);
  StoredTrial out{s.getColumn(0).getString(), s.getColumn(1).getString(), s.getColumn(2).getString(),
                  s.getColumn(3).isNull() ? -1 : static_cast<long>(s.getColumn(3).getInt64()),
                  storedJson(s.getColumn(4).getString())};
  if (s.executeStep()) {
    throw UserError("'" + keyBegin + "' matches several keys; valid: more digits, such as " + out.key);
  }
  return out;
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

std::optional<double> Store::wall(const std::string& key) try {
  SQLite::Statement s(m_db, "SELECT wall FROM trial WHERE key=?");
  s.bind(1, key);
  if (!s.executeStep()) return std::nullopt;
  return s.getColumn(0).getDouble();
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

// Each requested part of a sweep has its command, once.
json Store::commandsOf(const PlannedSweep& sweep, bool replace) {
  json out = json::array();
  SQLite::Statement s(m_db, "SELECT roles FROM sweep WHERE name=?");
  s.bind(1, sweep.name);
  if (const auto roles = one(s); roles && !replace) {
    const json earlier = json(storedJson(*roles)).value("commands", json::array());
    if (earlier.is_array()) out = earlier;
  }
  if (!sweep.command.empty() && std::find(out.begin(), out.end(), json(sweep.command)) == out.end()) {
    out.push_back(sweep.command);
  }
  return out;
}

// Removes rows of an earlier search of the same cells that was stopped, or that found another setting.
void Store::forgetCells(const PlannedSweep& sweep) {
  std::vector<std::string> searched;
  if (sweep.calibration) searched.push_back(sweep.calibration->setting);
  for (const Ladder& ladder : sweep.ladders) {
    searched.insert(searched.end(), {ladder.question.parameter, "repeat", "seed", "timed"});
  }
  const auto cellOf = [&](json axes) {
    for (const std::string& name : searched) axes.erase(name);
    return axes.dump();
  };
  std::set<std::string> cells;
  for (const PlannedTrial& t : sweep.trials) cells.insert(cellOf(t.axes));
  forget(sweep, [&](const json& axes) { return cells.count(cellOf(axes)) > 0; });
}

void Store::forget(const PlannedSweep& sweep, const std::function<bool(const json& axes)>& is) {
  std::vector<std::string> keys;
  SQLite::Statement s(m_db, "SELECT key, axes FROM planned WHERE sweep=?");
  s.bind(1, sweep.name);
  while (s.executeStep()) {
    if (is(storedJson(s.getColumn(1).getString()))) keys.push_back(s.getColumn(0).getString());
  }
  SQLite::Statement clear(m_db, "DELETE FROM planned WHERE sweep=? AND key=?");
  for (const std::string& key : keys) {
    clear.bind(1, sweep.name), clear.bind(2, key);
    clear.exec();
    clear.reset();
  }
}

// A program version that did not mark methods without a setting planned their cells at its first value.
void Store::forgetFirstValues(const PlannedSweep& sweep) {
  const auto cellOf = [&](json axes) {
    for (const auto& [name, role] : sweep.roles) {
      if (role == "setting") axes.erase(name);
    }
    return axes.dump();
  };
  std::set<std::string> cells;
  for (const PlannedTrial& t : sweep.trials) {
    const bool lacks = std::any_of(sweep.roles.begin(), sweep.roles.end(), [&](const auto& axis) {
      return axis.second == "setting" && !t.axes.contains(axis.first);
    });
    if (lacks) cells.insert(cellOf(t.axes));
  }
  forget(sweep, [&](const json& axes) { return cells.count(cellOf(axes)) > 0; });
}

std::set<std::string> Store::changed(const PlannedSweep& sweep) {
  std::map<std::string, std::string> keyOf;  // by the axes of the cell
  for (const PlannedTrial& t : sweep.trials) keyOf[t.axes.dump()] = t.key;
  std::set<std::string> out;
  SQLite::Statement s(m_db, "SELECT key, axes FROM planned JOIN trial USING(key) WHERE sweep=?");
  s.bind(1, sweep.name);
  while (s.executeStep()) {
    const auto now = keyOf.find(s.getColumn(1).getString());
    if (now != keyOf.end() && now->second != s.getColumn(0).getString()) out.insert(now->second);
  }
  std::erase_if(out, [&](const std::string& key) { return outcome(key).has_value(); });
  return out;
}

void Store::plan(const PlannedSweep& sweep, bool replace) try {
  SQLite::Transaction transaction(m_db);
  if (replace) {
    SQLite::Statement clear(m_db, "DELETE FROM planned WHERE sweep=?");
    clear.bind(1, sweep.name);
    clear.exec();
  } else if (sweep.calibration || !sweep.ladders.empty()) {
    forgetCells(sweep);
  } else {
    forgetFirstValues(sweep);
  }
  const json commands = commandsOf(sweep, replace);
  SQLite::Statement about(m_db, "INSERT OR REPLACE INTO sweep VALUES (?, ?, ?, ?, ?)");
  about.bind(1, sweep.name), about.bind(2, sweep.kind), about.bind(3, sweep.summary), about.bind(4, sweep.baseline);
  json roles = sweep.roles;
  // Axes have text roles, which distinguishes these from an axis of the same name.
  if (!commands.empty()) roles["commands"] = commands;
  if (!sweep.charts.empty()) roles["report"] = sweep.charts;
  const auto isSetting = [](const auto& axis) { return axis.second == "setting"; };
  if (std::any_of(sweep.roles.begin(), sweep.roles.end(), isSetting)) {
    roles["settings_told"] = true;  // a method without a setting has no value on that axis
  }
  if (const auto& c = sweep.calibration) {
    roles["calibrate"] = {{"equal", c->equal}, {"metric", c->metric}, {"setting", c->setting}, {"most", c->most}};
  }
  for (const Ladder& ladder : sweep.ladders) {
    const BreakQuestion& q = ladder.question;
    roles["break"][q.title()] = {
        {"parameter", q.parameter}, {"falling", q.falling}, {"seeds", q.seeds},
        {"few", q.fewSeeds()},      {"truth", q.truth},     {"perturb", q.perturb},
        {"ratio", q.ratio},         {"grid", q.step},       {"limit", q.limit ? q.limit->text : ""}};
  }
  about.bind(5, roles.dump());
  about.exec();
  SQLite::Statement s(m_db, "INSERT OR REPLACE INTO planned VALUES (?, ?, ?)");
  for (const PlannedTrial& t : sweep.trials) {
    s.bind(1, sweep.name), s.bind(2, t.key), s.bind(3, t.axes.dump());
    s.exec();
    s.reset();
  }
  transaction.commit();
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

void Store::describe(const std::vector<DescribedMetric>& metrics) try {
  SQLite::Transaction transaction(m_db);
  SQLite::Statement s(m_db, "INSERT OR REPLACE INTO metrics VALUES (?,?,?,?,?,?,?,?,?)");
  for (const DescribedMetric& m : metrics) {
    int at = 0;
    for (const std::string_view text : {m.what, m.info.name, m.kind, m.info.title, m.info.unit, m.info.meaning,
                                        roleName(m.info.role), m.info.smaller, needName(m.info.need)}) {
      s.bind(++at, std::string(text));
    }
    s.exec();
    s.reset();
  }
  transaction.commit();
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

long Store::machineId() {
  if (m_machine) return m_machine;
  const std::string description = machineDescription();
  SQLite::Statement insert(m_db, "INSERT OR IGNORE INTO machine(description) VALUES (?)");
  insert.bind(1, description);
  insert.exec();
  SQLite::Statement s(m_db, "SELECT id FROM machine WHERE description=?");
  s.bind(1, description);
  s.executeStep();
  return m_machine = static_cast<long>(s.getColumn(0).getInt64());
}

void Store::put(const PlannedTrial& trial, const TrialResult& result, const std::string& started, double wall) try {
  SQLite::Transaction transaction(m_db);
  const long machine = machineId();
  for (const char* table : {"series", "poses"}) {
    SQLite::Statement clear(m_db, std::string("DELETE FROM ") + table + " WHERE key=?");
    clear.bind(1, trial.key);
    clear.exec();
  }
  SQLite::Statement s(m_db, "INSERT OR REPLACE INTO trial VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?)");
  s.bind(1, trial.key), s.bind(2, trial.canonical.at("kind").get<std::string>()), s.bind(3, trial.canonical.dump());
  s.bind(4, result.outcome), s.bind(5, result.reason);
  if (result.step >= 0) s.bind(6, static_cast<std::int64_t>(result.step));
  s.bind(7, json(result.metrics).dump()), s.bind(8, static_cast<std::int64_t>(machine)), s.bind(9, m_commit);
  s.bind(10, started), s.bind(11, wall), s.bind(12, trial.timed() ? 1 : 0);
  s.bind(13, result.hash);
  s.exec();
  for (const auto& [name, data] : result.series) {
    SQLite::Statement row(m_db, "INSERT INTO series VALUES (?,?,?)");
    row.bind(1, trial.key), row.bind(2, name), bindNumbers(row, 3, data);
    row.exec();
  }
  for (const auto& [step, data] : result.poses) {
    SQLite::Statement row(m_db, "INSERT INTO poses VALUES (?,?,?)");
    row.bind(1, trial.key), row.bind(2, static_cast<std::int64_t>(step)), bindNumbers(row, 3, data);
    row.exec();
  }
  transaction.commit();
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

bool Store::hasFilm(const std::string& key) try {
  if (!m_db.tableExists("film")) return false;
  SQLite::Statement s(m_db, "SELECT 1 FROM film WHERE key=?");
  s.bind(1, key);
  return s.executeStep();
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

void Store::putFilm(const std::string& key, const std::string& film) try {
  SQLite::Transaction transaction(m_db);
  m_db.exec(kFilmTable);
  SQLite::Statement s(m_db, "INSERT OR REPLACE INTO film VALUES (?,?)");
  s.bind(1, key), s.bind(2, film);
  s.exec();
  transaction.commit();
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

void Store::setMeta(const std::string& key, const std::string& value) try {
  SQLite::Statement s(m_db, "INSERT OR REPLACE INTO meta VALUES (?,?)");
  s.bind(1, key), s.bind(2, value);
  s.exec();
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

void Store::addBenchmark(const std::string& text) try {
  SQLite::Statement s(m_db, "INSERT INTO benchmark(imported, data) VALUES (?,?)");
  s.bind(1, timeStamp()), s.bind(2, text);
  s.exec();
} catch (const SQLite::Exception& e) {
  failStore(m_path, e);
}

long Store::merge(const std::string& path) try {
  { const Store check(path, false); }  // checks that it is a store
  SQLite::Statement attach(m_db, "ATTACH DATABASE ? AS other");
  attach.bind(1, readableName(path));
  attach.exec();
  SQLite::Transaction transaction(m_db);
  m_db.exec("INSERT OR IGNORE INTO machine(description) SELECT description FROM other.machine");
  for (const char* table : {"sweep", "metrics", "planned"}) {
    m_db.exec(std::string("INSERT OR IGNORE INTO ") + table + " SELECT * FROM other." + table);
  }
  for (const char* table : {"series", "poses"}) {
    m_db.exec(std::string("INSERT OR IGNORE INTO ") + table + " SELECT * FROM other." + table +
              " WHERE key NOT IN (SELECT key FROM main.trial)");
  }
  // Machine numbers are local to a store: machines are matched by description.
  const int trials = m_db.exec(
      "INSERT OR IGNORE INTO trial SELECT t.key, t.kind, t.canonical, t.outcome, t.reason, t.step, t.metrics, "
      "(SELECT m.id FROM main.machine m JOIN other.machine o ON m.description = o.description WHERE o.id = t.machine), "
      "t.commit_id, t.started, t.wall, t.timed, t.hash FROM other.trial t");
  m_db.exec(
      "INSERT INTO benchmark(imported, data) SELECT imported, data FROM other.benchmark o WHERE NOT EXISTS "
      "(SELECT 1 FROM main.benchmark b WHERE b.imported = o.imported AND b.data = o.data)");
  if (m_db.execAndGet("SELECT count(*) FROM other.sqlite_master WHERE name='film'").getInt() > 0) {
    m_db.exec(kFilmTable);
    m_db.exec("INSERT OR IGNORE INTO film SELECT * FROM other.film");
  }
  mergeLedger();
  transaction.commit();
  m_db.exec("DETACH DATABASE other");
  return trials;
} catch (const SQLite::Exception& e) {
  failStore(path + " into " + m_path, e);
}

std::string timeStamp() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}}  // namespace lpc::LPC_PRECISION
