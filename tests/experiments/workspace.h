// SPDX-License-Identifier: Zlib
// A separate folder for each test, and programs that run in it.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "experiments/runner/store.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

struct Outcome {
  int code = -1;
  std::string text;  // stdout and stderr
};

class Workspace {
 public:
  Workspace() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    m_path =
        std::filesystem::temp_directory_path() / ("lpc_" + std::string(info->name()) + "_" + std::to_string(getpid()));
    std::filesystem::remove_all(m_path);
    std::filesystem::create_directories(m_path);
    setenv("LPC_WORKERS", LPC_BINARY_DIR "/bin", 1);
  }
  ~Workspace() { std::filesystem::remove_all(m_path); }

  std::string path(const std::string& name) const { return (m_path / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
  /// Runs `lpc ARGUMENTS` in the folder, with variables such as "A=1 B=2" in its environment.
  Outcome lpc(const std::string& arguments, const std::string& environment = "") const {
    return shell(environment + " " LPC_BINARY_DIR "/bin/lpc " + arguments);
  }
  Outcome shell(const std::string& command) const {
    Outcome out;
    FILE* pipe = popen(("cd " + m_path.string() + " && " + command + " 2>&1").c_str(), "r");
    char buffer[4096];
    for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.text.append(buffer, n);
    const int status = pclose(pipe);
    out.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return out;
  }

 private:
  std::filesystem::path m_path;
};

/// Everything in a store that does not depend on when and how fast it ran.
inline std::string timeless(const std::string& store) {
  SQLite::Database db(store, SQLite::OPEN_READONLY);
  std::string out;
  const auto dump = [&](const char* query) {
    SQLite::Statement s(db, query);
    while (s.executeStep()) {
      for (int i = 0; i < s.getColumnCount(); ++i) {
        const auto c = s.getColumn(i);
        out += c.isNull() ? std::string("NULL")
                          : std::string(static_cast<const char*>(c.getBlob()), static_cast<std::size_t>(c.getBytes()));
        out += '|';
      }
      out += '\n';
    }
  };
  dump("SELECT sweep, key, axes FROM planned ORDER BY sweep, key");
  dump("SELECT key, kind, canonical, outcome, reason, step, metrics, timed, hash FROM trial ORDER BY key");
  dump("SELECT key, name, data FROM series ORDER BY key, name");
  dump("SELECT key, step, data FROM poses ORDER BY key, step");
  return out;
}

/// Whether this build has f32, from its configuration: if the worker is missing, its tests fail and are not skipped.
inline const bool kSingle = readFile(LPC_BINARY_DIR "/precisions.txt").find("f32") != std::string::npos;

/// The first column of the first row of a query.
inline std::string ask(const std::string& store, const std::string& query) {
  SQLite::Database db(store, SQLite::OPEN_READONLY);
  SQLite::Statement s(db, query);
  return s.executeStep() && !s.getColumn(0).isNull() ? s.getColumn(0).getString() : "";
}

}}}  // namespace lpc::LPC_PRECISION::test
