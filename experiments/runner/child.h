// SPDX-License-Identifier: Zlib
#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

#include "framework/math/space.h"

struct pollfd;

namespace lpc { inline namespace LPC_PRECISION {

/// A program that reads all its input, writes all its output and ends. It dies with this process, and Ctrl-C on the
/// terminal does not reach it: the parent decides.
class Child {
 public:
  /// `core` >= 0 pins it to that processor. `showErrors` forwards its stderr to this program's. Throws UserError if it
  /// cannot be started. `poll` writes the input as the child reads it.
  Child(const std::string& program, std::string input, int core, bool showErrors);
  ~Child();  // kills it if it still runs
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Writes input and reads output as far as possible without blocking; true when the program has ended. A program that
  /// writes more than kMostOutput is killed.
  bool poll();
  /// Adds the descriptors for poll(2); false if it has closed its output and is about to end.
  bool addTo(std::vector<pollfd>& descriptors) const;
  /// Returns false if `stop` returned true before it ended.
  bool wait(bool (*stop)());
  void kill();
  /// Seconds since its start.
  double seconds() const;
  /// Resident memory (bytes), 0 after its end.
  std::size_t residentBytes() const;

  const std::string& output() const { return m_output; }
  /// The last line that it wrote to stderr.
  std::string lastError() const;
  int signal() const { return m_signal; }  // the signal that ended it, 0 for none
  int exitCode() const { return m_exit; }
  bool flooded() const { return m_flooded; }  // whether it was killed for too much output

  static constexpr std::size_t kMostOutput = 1 << 30;  // bytes

 private:
  void start(const std::string& program, int core, bool showErrors);
  void feed();
  void drain(int& descriptor, std::string& into);
  void takeOutput();

  pid_t m_pid = -1;
  int m_in = -1, m_out = -1, m_err = -1;
  int m_signal = 0, m_exit = 0;
  std::string m_input, m_output, m_errors;
  std::size_t m_given = 0;  // bytes of the input
  bool m_ended = false, m_flooded = false;
  std::chrono::steady_clock::time_point m_start;
};

}}  // namespace lpc::LPC_PRECISION
