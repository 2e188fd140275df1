// SPDX-License-Identifier: Zlib
// Failing inputs of properties, one file each. They run first next time and are deleted once they pass.
#pragma once

#include <rapidcheck.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// FNV-1a; `start` is the offset basis or a value derived from it.
inline std::uint64_t hashOf(const std::string& text, std::uint64_t start = 0xcbf29ce484222325u) {
  for (const char c : text) start = (start ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return start;
}

/// A readable file name that differs for different texts.
inline std::string fileNameOf(const std::string& text) {
  std::ostringstream name;
  for (const char c : text.substr(0, 100)) name << (std::isalnum(static_cast<unsigned char>(c)) || c == '.' ? c : '_');
  name << '_' << std::hex << hashOf(text);
  return name.str();
}

/// Writes atomically: a reader never sees half a file.
inline void replaceFile(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  const std::filesystem::path draft = path.string() + ".part";
  std::ofstream(draft) << text;
  std::filesystem::rename(draft, path);
}

class KeptFailures {
 public:
  explicit KeptFailures(std::filesystem::path folder) : m_folder(std::move(folder)) {}

  std::filesystem::path file(const std::string& property) const { return m_folder / fileNameOf(property); }

  /// Empty if there is none, or if it cannot be read.
  std::optional<rc::detail::Reproduce> find(const std::string& property) const {
    std::ifstream in(file(property));
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    try {
      const auto kept = rc::detail::configFromString(text).reproduce;
      const auto it = kept.find(property);
      if (it != kept.end()) return it->second;
    } catch (const std::exception&) {  // truncated, or from another version of RapidCheck
    }
    return std::nullopt;
  }
  void keep(const std::string& property, const rc::detail::Reproduce& input) const {
    rc::detail::Configuration text;
    text.reproduce[property] = input;
    replaceFile(file(property), rc::detail::configToMinimalString(text));
  }
  void drop(const std::string& property) const {
    std::filesystem::remove(file(property));
    std::filesystem::remove(told(property));
  }

  /// File with the full text of the failure.
  std::filesystem::path told(const std::string& property) const { return file(property).string() + ".txt"; }
  /// `text`, or its first lines if it is long; then a file keeps the full text.
  std::string tell(const std::string& property, const std::string& text) const {
    constexpr int kLines = 40;
    std::size_t end = 0;
    for (int line = 0; line < kLines && end != text.npos; ++line) end = text.find('\n', end + (line > 0));
    if (end == text.npos || end + 1 == text.size()) {
      std::filesystem::remove(told(property));  // from an earlier, longer text
      return text;
    }
    replaceFile(told(property), text);
    const auto rest = text.begin() + static_cast<std::ptrdiff_t>(end) + 1;
    const auto more = std::count(rest, text.end(), '\n') + (text.back() != '\n');
    return text.substr(0, end) + "\n... " + std::to_string(more) + " lines more in " + told(property).string();
  }

 private:
  std::filesystem::path m_folder;
};

}}}  // namespace lpc::LPC_PRECISION::test
