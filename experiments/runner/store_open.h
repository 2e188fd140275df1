// SPDX-License-Identifier: Zlib
// Opens and creates the file of a result store.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Opens the store, or creates it if `create`; without `create` only to read, also from a read-only medium. Throws
/// UserError if the file is not a store or has another schema.
SQLite::Database openStore(const std::string& path, bool create);

/// The file's name for SQLite, which takes names such as `file:x.db` and `:memory:` for something else.
std::string databaseName(const std::string& path);
/// The name by which SQLite reads the file, with SQLITE_OPEN_URI: another one on a read-only medium. Throws UserError,
/// SQLite::Exception.
std::string readableName(const std::string& path);
/// Throws UserError if no store of this name can be written or created. Creates nothing.
void requireWritable(const std::string& path);

}}  // namespace lpc::LPC_PRECISION
