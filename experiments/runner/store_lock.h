// SPDX-License-Identifier: Zlib
#pragma once

#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Excludes other runners from a store, but not readers. It locks the file itself, and ends with the process in any
/// case. Closing it also ends all locks that SQLite has on the file, so it must outlive the database.
class StoreLock {
 public:
  /// Throws UserError that names the process with the lock.
  explicit StoreLock(const std::string& path);
  ~StoreLock();
  StoreLock(const StoreLock&) = delete;
  StoreLock& operator=(const StoreLock&) = delete;

 private:
  int m_file;
};

}}  // namespace lpc::LPC_PRECISION
