// SPDX-License-Identifier: Zlib
// Keys and mouse as a file, for tests, for pictures and for reproducing bugs: one order per line.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// docs/sandbox.md has a table of them; `kKinds` (input_script.cpp) has their numbers of words.
struct InputOrder {
  int line;
  std::string name;
  std::vector<std::string> words;
};

class InputScript {
 public:
  /// Throws UserError with file and line for an invalid order.
  explicit InputScript(const std::string& path);

  const InputOrder* next() const { return m_next < m_orders.size() ? &m_orders[m_next] : nullptr; }
  void done() { ++m_next, m_waited = 0; }
  /// Counts: true after this many pictures since the order became the next.
  bool waited(long pictures) { return ++m_waited > pictures; }
  /// True if a key is pressed while it is already down.
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
