// SPDX-License-Identifier: Zlib
// Faults of wrong runners, as edits of a correct store.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <string>

namespace lpc::test {

struct StoreTwin {
  const char *name, *sql;
};

inline constexpr StoreTwin kStoreTwins[] = {
    {"a metric that drops zeros",
     "UPDATE trial SET metrics = (SELECT json_group_object(key, value) FROM json_each(metrics) WHERE value != 0) "
     "WHERE key = (SELECT t.key FROM trial t, json_each(t.metrics) m WHERE m.value = 0 LIMIT 1)"},
    {"a resume that repeats a cell",
     "UPDATE trial SET started = started || '!' WHERE key = (SELECT max(key) FROM trial)"},
    {"a resume that forgets a cell", "DELETE FROM trial WHERE key = (SELECT max(key) FROM trial)"},
    {"a row without its seed",
     "UPDATE trial SET canonical = json_remove(canonical, '$.seed') WHERE key = (SELECT max(key) FROM trial)"},
    {"a row without its code",
     "UPDATE trial SET canonical = json_remove(canonical, '$.code') WHERE key = (SELECT max(key) FROM trial)"},
    {"a row without its machine", "UPDATE trial SET machine = 99 WHERE key = (SELECT max(key) FROM trial)"},
    {"a repeat that measures something else",
     "UPDATE trial SET metrics = json_set(metrics, '$.pairs_mean', 1 + json_extract(metrics, '$.pairs_mean')) "
     "WHERE key = (SELECT max(key) FROM trial WHERE json_extract(canonical, '$.repeat') > 0)"},
    {"a result in the wrong cell",
     "UPDATE trial SET metrics = (SELECT metrics FROM trial t WHERE t.metrics != trial.metrics LIMIT 1) "
     "WHERE key = (SELECT max(key) FROM trial)"}};

inline void damage(const std::string& store, const StoreTwin& twin) {
  SQLite::Database(store, SQLite::OPEN_READWRITE).exec(twin.sql);
}

}  // namespace lpc::test
