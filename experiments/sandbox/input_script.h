// SPDX-License-Identifier: Zlib
// Keys and mouse as a file, for tests, for pictures and for showing again what was found: one order a line.
#pragma once

#include <string>
#include <vector>

#include "framework/space.h"

namespace lpc::inline LPC_PRECISION {

/// key NAME | down NAME | up NAME        a key of the keyboard, as SDL names it: p, F1, Return, Left Ctrl
/// at X Y [Z] | pixel X Y | on NAME      moves the mouse to a point of the world (m), of the window, or to a menu or
/// slider press left|right|middle | release     mouse buttons wheel N                               notches, away from
/// the user type TEXT                             into what has the keyboard wait N pictures until N steps shot
/// FILE.png | state FILE.json       the window, and what the world says drop FILE                             as if it
/// were dropped on the window quit
struct InputOrder {
  int line;
  std::string name;
  std::vector<std::string> words;
};

class InputScript {
 public:
  /// Throws UserError with file and line for what is no such order.
  explicit InputScript(const std::string& path);

  const InputOrder* next() const { return m_next < m_orders.size() ? &m_orders[m_next] : nullptr; }
  void done() { ++m_next, m_waited = 0; }
  /// Counts: true when so many pictures have come since the order was the next.
  bool waited(long pictures) { return ++m_waited > pictures; }
  [[noreturn]] void fail(const std::string& why) const;  // at the line of the next order

 private:
  std::string m_path;
  std::vector<InputOrder> m_orders;
  std::size_t m_next = 0;
  long m_waited = 0;
};

}  // namespace lpc::inline LPC_PRECISION
