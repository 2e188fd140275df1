// SPDX-License-Identifier: Zlib
#include "experiments/parse/toml_reader.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <utility>

#include "framework/math/names.h"
#include "framework/math/nesting.h"

namespace lpc { inline namespace LPC_PRECISION {

namespace {

// One past the string that begins at `at`. The parser reports an unterminated string.
std::size_t endOfString(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const bool escapes = quote == '"';
  const std::string three(3, quote);
  const bool many = text.substr(at, 3) == three;
  for (std::size_t i = at + (many ? 3 : 1); i < text.size(); ++i) {
    if (escapes && text[i] == '\\') {
      ++i;
    } else if (many && text.substr(i, 3) == three) {
      for (i += 3; i < text.size() && text[i] == quote;) ++i;  // it may end in quotes of its own
      return i;
    } else if (!many && (text[i] == quote || text[i] == '\n')) {
      return i + (text[i] == quote);
    }
  }
  return text.size();
}

// The parser nests as deeply as dotted keys and brackets do, and destroys its result recursively, so the depth is
// checked first. Text after a syntax error may be misread here, but then the parser reports that error.
void checkNesting(std::string_view text, const std::string& file) {
  std::vector<int> dots = {0};  // in the current key: of the file, and of every open bracket
  int depth = 0;                // the sum of these and of the brackets
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '#') i = std::min(text.find('\n', i), text.size()) - 1;
    if (c == '"' || c == '\'') i = endOfString(text, i) - 1;
    if (c == '.') ++depth, ++dots.back();
    if (c == '[' || c == '{') ++depth, dots.push_back(0);
    if (c == ',' || (c == '\n' && dots.size() == 1)) depth -= std::exchange(dots.back(), 0);
    if ((c == ']' || c == '}') && dots.size() > 1) depth -= 1 + dots.back(), dots.pop_back();
    if (depth > kMostNested) {
      const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(i), '\n');
      throw UserError(file + ":" + std::to_string(line) + ": nested more than " + std::to_string(kMostNested) +
                      " deep");
    }
  }
}

}  // namespace

std::string placeOf(std::string_view file, const toml::node& node) {
  // A scene's script is a separate file, and a node knows its file.
  const std::string from = node.source().path ? *node.source().path : std::string(file);
  return from + ":" + std::to_string(node.source().begin.line);
}

void failAt(std::string_view file, const toml::node& node, const std::string& what) {
  // Made one line at once: what() of an error ends at a zero byte in a quoted text.
  throw PlacedError(oneLine(placeOf(file, node) + ": " + what));
}

std::string describe(const toml::node& node) {
  if (const auto s = node.value<std::string>(); s && node.is_string()) return "the string '" + *s + "'";
  if (node.is_integer()) return "the number " + std::to_string(*node.value<std::int64_t>());
  if (node.is_floating_point()) return "the number " + asText(*node.value<double>());
  if (node.is_boolean()) return *node.value<bool>() ? "true" : "false";
  if (node.is_array()) return "a list";
  if (node.is_table()) return "a table";
  return "a date or time";
}

std::string asText(double number) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

toml::table parseToml(std::string_view text, const std::string& file) {
  checkNesting(text, file);
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& e) {
    throw UserError(oneLine(file + ":" + std::to_string(e.source().begin.line) + ": " + std::string(e.description())));
  }
}

std::string readFile(const std::string& path) {
  constexpr std::size_t kMost = 1u << 27;  // bytes; /dev/zero has no end
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  std::string out;
  std::vector<char> part(1u << 16);
  while (in && out.size() <= kMost) {
    in.read(part.data(), static_cast<std::streamsize>(part.size()));
    out.append(part.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (out.size() > kMost) throw UserError(path + ": is larger than " + std::to_string(kMost >> 20) + " MiB");
  if (!in.eof() || in.bad()) throw UserError(path + ": cannot be read: " + std::strerror(errno));  // bad: a folder
  return out;
}

std::vector<std::pair<std::string, const toml::node*>> inFileOrder(const toml::table& table) {
  std::vector<std::pair<std::string, const toml::node*>> out;
  for (const auto& [key, node] : table) out.emplace_back(std::string(key.str()), &node);
  const auto place = [](const auto& entry) {
    const auto& at = entry.second->source().begin;
    return std::pair(at.line, at.column);
  };
  std::stable_sort(out.begin(), out.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
  return out;
}

const toml::node* TableReader::find(const std::string& key) {
  m_asked.insert(key);
  return m_table.get(key);
}

const toml::node& TableReader::require(const std::string& key) {
  const toml::node* n = find(key);
  if (!n) fail("'" + key + "' is missing in " + m_what);
  return *n;
}

std::string TableReader::string(const std::string& key, const std::string& fallback) {
  const toml::node* n = find(key);
  if (!n) return fallback;
  if (!n->is_string()) fail(*n, "'" + key + "' is " + describe(*n) + "; valid: a string");
  return *n->value<std::string>();
}

std::string TableReader::requireString(const std::string& key) {
  require(key);
  return string(key, "");
}

double TableReader::number(const std::string& key, double fallback) {
  const toml::node* n = find(key);
  if (!n) return fallback;
  const auto value = n->is_number() ? n->value<double>() : std::nullopt;
  if (!value || !std::isfinite(*value)) fail(*n, "'" + key + "' is " + describe(*n) + "; valid: a finite number");
  return *value;
}

long TableReader::integer(const std::string& key, long fallback) {
  const toml::node* n = find(key);
  if (!n) return fallback;
  if (!n->is_integer()) fail(*n, "'" + key + "' is " + describe(*n) + "; valid: a whole number");
  return static_cast<long>(*n->value<std::int64_t>());
}

bool TableReader::flag(const std::string& key, bool fallback) {
  const toml::node* n = find(key);
  if (!n) return fallback;
  if (!n->is_boolean()) fail(*n, "'" + key + "' is " + describe(*n) + "; valid: true, false");
  return *n->value<bool>();
}

std::vector<std::string> TableReader::strings(const std::string& key) {
  std::vector<std::string> out;
  if (const toml::array* list = array(key)) {
    for (const toml::node& n : *list) {
      if (!n.is_string()) fail(n, "'" + key + "' holds " + describe(n) + "; valid: strings");
      out.push_back(*n.value<std::string>());
    }
  }
  return out;
}

const toml::table* TableReader::table(const std::string& key) {
  const toml::node* n = find(key);
  if (n && !n->is_table()) fail(*n, "'" + key + "' is " + describe(*n) + "; valid: a table");
  return n ? n->as_table() : nullptr;
}

const toml::array* TableReader::array(const std::string& key) {
  const toml::node* n = find(key);
  if (n && !n->is_array()) fail(*n, "'" + key + "' is " + describe(*n) + "; valid: a list");
  return n ? n->as_array() : nullptr;
}

std::vector<const toml::table*> TableReader::blocks(const std::string& key) {
  std::vector<const toml::table*> out;
  const toml::node* n = find(key);
  if (!n) return out;
  if (n->is_table()) return {n->as_table()};
  if (!n->is_array()) fail(*n, "'" + key + "' is " + describe(*n) + "; valid: [[" + key + "]] blocks");
  for (const toml::node& item : *n->as_array()) {
    if (!item.is_table()) fail(item, "'" + key + "' holds " + describe(item) + "; valid: tables");
    out.push_back(item.as_table());
  }
  return out;
}

void TableReader::finish() const {
  for (const auto& [key, node] : inFileOrder(m_table)) {
    if (m_asked.count(key)) continue;
    fail(*node, "unknown key '" + key + "' in " + m_what + validNames({m_asked.begin(), m_asked.end()}, key));
  }
}

}}  // namespace lpc::LPC_PRECISION
