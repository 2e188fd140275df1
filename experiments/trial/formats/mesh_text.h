// SPDX-License-Identifier: Zlib
// Words and numbers of mesh files that are texts.
#pragma once

#include <charconv>
#include <cmath>
#include <string_view>

#include "experiments/trial/formats/mesh_formats.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The words of a text, line by line. A line that ends with a backslash continues in the next one.
class MeshLines {
 public:
  explicit MeshLines(std::string_view text) : m_rest(text) {}
  bool next() {
    if (m_rest.empty()) return false;
    const std::size_t end = std::min(m_rest.find('\n'), m_rest.size());
    m_line = m_rest.substr(0, end), m_rest.remove_prefix(std::min(end + 1, m_rest.size()));
    ++number;
    return true;
  }
  /// The next word of the line; empty at the end of the line.
  std::string_view word() {
    constexpr std::string_view kBlank = " \t\r\v\f";
    while (true) {
      m_line.remove_prefix(std::min(m_line.find_first_not_of(kBlank), m_line.size()));
      std::string_view found = m_line.substr(0, m_line.find_first_of(kBlank));
      m_line.remove_prefix(found.size());
      if (!found.ends_with('\\') || m_line.find_first_not_of(kBlank) != m_line.npos) return found;
      found.remove_suffix(1);
      if (!next() || !found.empty()) return found;
    }
  }
  /// The text after the current line.
  std::string_view rest() const { return m_rest; }
  long number = 0;

 private:
  std::string_view m_rest, m_line;
};

/// Whether a number that is out of range is too close to 0.
inline bool isTiny(std::string_view word) { return word.find("e-") != word.npos || word.find("E-") != word.npos; }

/// A coordinate. A number closer to 0 than any float is read as 0.
inline float meshCoordinate(std::string_view word, const std::string& path, long line) {
  const std::string shown(word.substr(0, 40));
  if (word.starts_with('+')) word.remove_prefix(1);
  float value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool read = error != std::errc::invalid_argument && end == word.data() + word.size();
  if (!read) refuseMesh(path, line, "'" + shown + "' is not a coordinate; valid: a number");
  if (error == std::errc::result_out_of_range && isTiny(word)) return 0;
  if (error == std::errc() && std::isfinite(value)) return value;
  refuseMesh(path, line, "the coordinate " + shown + "; valid: finite, as a number of 32 bits");
}

/// The numbers of the rest of the line.
inline std::vector<float> meshPoint(MeshLines& lines, const std::string& path) {
  std::vector<float> out;
  for (std::string_view word = lines.word(); !word.empty() && !word.starts_with('#'); word = lines.word()) {
    out.push_back(meshCoordinate(word, path, lines.number));
  }
  return out;
}
[[noreturn]] inline void refusePoint(std::size_t numbers, const std::string& path, long line) {
  refuseMesh(path, line, "a point of " + std::to_string(numbers) + " numbers; valid: 3");
}

}}  // namespace lpc::LPC_PRECISION
