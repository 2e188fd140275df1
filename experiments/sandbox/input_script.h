// SPDX-License-Identifier: Zlib
// Keys and mouse as a file, for tests, for pictures and for showing again what was found: one order a line.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// docs/sandbox.md has a table of them, `kKinds` (input_script.cpp) how many words each has.
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
  /// True of a key that is pressed while it is down.
  bool holdKey(int key, bool down) {
    if (down) return !m_down.insert(key).second;
    m_down.erase(key);
    return false;
  }
  [[noreturn]] void fail(const std::string& why) const;  // at the line of the next order

 private:
  std::string m_path;
  std::vector<InputOrder> m_orders;
  std::size_t m_next = 0;
  long m_waited = 0;
  std::set<int> m_down;  // keys
};

}}  // namespace lpc::LPC_PRECISION
