// SPDX-License-Identifier: Zlib
// Reads TOML and reports every mistake in one line: file:line, what was found, what is valid.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/math/check.h"
#include "framework/math/space.h"

#define TOML_HEADER_ONLY 0
#include <toml++/toml.h>

namespace lpc { inline namespace LPC_PRECISION {

/// An error with its position.
struct PlacedError : UserError {
  using UserError::UserError;
};
/// "scene.toml:12"
std::string placeOf(std::string_view file, const toml::node& node);
/// "scene.toml:12: what". Throws PlacedError.
[[noreturn]] void failAt(std::string_view file, const toml::node& node, const std::string& what);
/// "a list", "the number 3", ... for messages.
std::string describe(const toml::node& node);
/// The shortest text that reads back as this number.
std::string asText(double number);
/// Throws UserError with the position of a syntax error.
toml::table parseToml(std::string_view text, const std::string& file);
/// The bytes of a file; throws UserError if it cannot be read.
std::string readFile(const std::string& path);
/// A table's entries in file order, which TOML itself does not keep.
std::vector<std::pair<std::string, const toml::node*>> inFileOrder(const toml::table& table);

/// A table read by key; `finish` rejects the keys that were not read.
class TableReader {
 public:
  TableReader(const toml::table& table, std::string file, std::string what)
      : m_table(table), m_file(std::move(file)), m_what(std::move(what)) {}

  const toml::node* find(const std::string& key);
  const toml::node& require(const std::string& key);
  std::string string(const std::string& key, const std::string& fallback);
  std::string requireString(const std::string& key);
  double number(const std::string& key, double fallback);
  long integer(const std::string& key, long fallback);
  bool flag(const std::string& key, bool fallback);
  std::vector<std::string> strings(const std::string& key);
  const toml::table* table(const std::string& key);
  const toml::array* array(const std::string& key);
  /// [[key]] blocks, in file order; a single [key] counts as one.
  std::vector<const toml::table*> blocks(const std::string& key);

  [[noreturn]] void fail(const toml::node& node, const std::string& what) const { failAt(m_file, node, what); }
  [[noreturn]] void fail(const std::string& what) const { failAt(m_file, m_table, what); }
  void finish() const;
  const std::string& file() const { return m_file; }
  const toml::table& raw() const { return m_table; }

 private:
  const toml::table& m_table;
  std::string m_file, m_what;
  std::set<std::string> m_asked;
};

}}  // namespace lpc::LPC_PRECISION
