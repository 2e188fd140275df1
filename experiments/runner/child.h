// SPDX-License-Identifier: Zlib
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>

#include "framework/space.h"

namespace lpc::inline LPC_PRECISION {

/// A program that reads all its input, writes all its output and ends. It dies with this process, and a Ctrl-C on the
/// terminal does not reach it: the parent decides.
class Child {
 public:
  /// `core` >= 0 pins it to that processor. `showErrors`: its stderr goes to this program's.
  Child(const std::string& program, const std::string& input, int core, bool showErrors);
  ~Child();  // kills it when it still runs
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Takes what it has written since; true when it has ended.
  bool poll();
  /// False when `stop` says so before it has ended.
  bool wait(bool (*stop)());
  void kill();
  /// Seconds since its start.
  double seconds() const;
  /// Memory that it holds now (bytes), 0 when it has ended.
  std::size_t residentBytes() const;

  const std::string& output() const { return m_output; }
  /// The last line that it wrote to stderr.
  std::string lastError() const;
  int signal() const { return m_signal; }  // that ended it, 0 for none
  int exitCode() const { return m_exit; }
  int outputDescriptor() const { return m_out; }

 private:
  void drain(int& descriptor, std::string& into);

  pid_t m_pid = -1;
  int m_out = -1, m_err = -1;
  int m_signal = 0, m_exit = 0;
  std::string m_output, m_errors;
  bool m_ended = false;
  std::chrono::steady_clock::time_point m_start;
};

}  // namespace lpc::inline LPC_PRECISION
