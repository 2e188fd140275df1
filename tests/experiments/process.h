// SPDX-License-Identifier: Zlib
// `lpc` running in parallel with a test, which stops or kills it or its workers.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "experiments/parse/toml_reader.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

class Process {
 public:
  /// Runs `lpc ARGUMENTS` in the workspace; its output goes to the file "said" there.
  Process(const Workspace& workspace, const std::string& arguments) : m_said(workspace.path("said")) {
    const std::string command = "cd " + workspace.path("") + " && exec " LPC_BINARY_DIR "/bin/lpc " + arguments;
    m_pid = fork();
    if (m_pid == 0) {
      if (!std::freopen(m_said.c_str(), "w", stdout) || dup2(1, 2) < 0) _exit(127);
      execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
      _exit(127);
    }
  }
  ~Process() {
    signal(SIGKILL);
    wait();
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const { return m_pid; }
  std::string said() const { return readFile(m_said); }
  bool ended() {
    if (!m_ended) m_ended = waitpid(m_pid, &m_status, WNOHANG) == m_pid;
    return m_ended;
  }
  /// The exit code, or 128 plus the signal that ended it.
  int wait() {
    while (!m_ended) m_ended = waitpid(m_pid, &m_status, 0) == m_pid;
    return WIFEXITED(m_status) ? WEXITSTATUS(m_status) : 128 + WTERMSIG(m_status);
  }
  void signal(int number) {
    if (!ended()) ::kill(m_pid, number);
  }

  /// Its running workers and witnesses.
  std::vector<pid_t> workers() const {
    std::vector<pid_t> out;
    std::error_code gone;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", gone)) {
      const std::string name = entry.path().filename().string();
      if (name.find_first_not_of("0123456789") != name.npos) continue;
      std::ifstream in(entry.path() / "stat");
      std::string line;
      std::getline(in, line);  // "12 (lpc-worker-f64) S 7 ...": 7 is the parent
      const std::size_t after = line.rfind(") ");
      if (line.find(" (lpc-") == line.npos || after == line.npos) continue;
      if (std::atol(line.c_str() + after + 4) == m_pid) out.push_back(std::stoi(name));
    }
    return out;
  }
  /// Waits until the file exists and a worker runs; false if the process has ended. With a new store, workers that are
  /// only probed run before the store is made.
  bool isBusy(const std::string& file) {
    while (!ended()) {
      if (std::filesystem::exists(file) && !workers().empty()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

 private:
  std::string m_said;
  pid_t m_pid = -1;
  int m_status = 0;
  bool m_ended = false;
};

}}}  // namespace lpc::LPC_PRECISION::test
