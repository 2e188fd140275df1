// SPDX-License-Identifier: Zlib
#pragma once

#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Keeps other runners off a store, and readers not. It is a lock of the file itself, which goes with the process,
/// however that ends. Where it ends, so do all locks that SQLite has on the file: it outlives the database.
class StoreLock {
 public:
  /// Throws UserError that names who has it.
  explicit StoreLock(const std::string& path);
  ~StoreLock();
  StoreLock(const StoreLock&) = delete;
  StoreLock& operator=(const StoreLock&) = delete;

 private:
  int m_file;
};

}}  // namespace lpc::LPC_PRECISION
