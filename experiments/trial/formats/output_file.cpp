// SPDX-License-Identifier: Zlib
#include "experiments/trial/formats/output_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// The system's reason is still in errno: no system call comes between a failed write and this function.
[[noreturn]] void fail(const std::string& path) {
  throw CannotWrite(path + ": cannot be written: " + std::strerror(errno));
}

// Follows links one by one, but not beyond /proc: a stream that a process has open is not a place for another file.
std::filesystem::path endOfLinks(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  fs::path at = fs::absolute(path, ignored);
  for (int links = 0; links < 40; ++links) {
    at = fs::weakly_canonical(at.parent_path(), ignored) / at.filename();
    if (at.string().starts_with("/proc/") || !fs::is_symlink(at, ignored)) break;
    at = at.parent_path() / fs::read_symlink(at, ignored);
  }
  return at;
}

// Several outputs may write to one device.
bool areOneFile(const std::string& a, const std::string& b) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (a.empty() || b.empty() || fs::is_character_file(a, ignored)) return false;
  if (fs::exists(a, ignored) && fs::exists(b, ignored)) return fs::equivalent(a, b, ignored);
  const auto place = [&](const std::string& path) {
    return fs::weakly_canonical(fs::absolute(path, ignored), ignored);
  };
  return place(a) == place(b);
}

}  // namespace

std::string OutputFile::writtenAt(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored)) return path;
  if (endOfLinks(path).string().starts_with("/proc/")) return path;
  for (int i = 1;; ++i) {
    std::string beside = path + ".partial" + (i > 1 ? std::to_string(i) : "");
    if (!fs::exists(fs::symlink_status(beside, ignored))) return beside;
  }
}

OutputFile::OutputFile(std::string path) : m_path(std::move(path)) {
  std::FILE* made = nullptr;
  do {
    m_written = writtenAt(m_path);
    if (m_written == m_path) break;
    made = std::fopen(m_written.c_str(), "wbx");  // x: fails if another program has created it meanwhile
  } while (!made && errno == EEXIST);
  if (made) std::fclose(made);
  if (!made && m_written != m_path) fail(m_path);
  // In place, output is appended: /dev/stdout may be a file.
  m_stream.open(m_written, std::ios::binary | (m_written == m_path ? std::ios::app : std::ios::trunc));
  if (!m_stream) fail(m_path);
}

OutputFile::~OutputFile() {
  if (m_written != m_path) std::remove(m_written.c_str());
}

void OutputFile::check() {
  if (!m_stream.flush()) fail(m_path);
}

void OutputFile::finish() {
  check();
  m_stream.close();
  if (m_written != m_path && std::rename(m_written.c_str(), m_path.c_str()) != 0) fail(m_path);
  m_written = m_path;
}

bool isOwnStream(const std::string& path) {
  if (path.empty()) return false;
  std::error_code ignored;
  const std::filesystem::path end = endOfLinks(path);
  return end.parent_path() == std::filesystem::canonical("/proc/self/fd", ignored) && end.filename() != "2";
}

void keepApart(const NamedFiles& inputs, const NamedFiles& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const auto& [option, path] = outputs[i];
    for (const auto& [what, input] : inputs) {
      if (!areOneFile(path, input)) continue;
      throw UserError(option + " " + path + " would be written over " + what + " " + input + "; valid: another file");
    }
    for (std::size_t j = 0; j < outputs.size(); ++j) {
      const auto& [other, place] = outputs[j];
      if (i == j || path.empty() || place.empty()) continue;
      const std::string written = OutputFile::writtenAt(path);
      if (written != path && areOneFile(written, place)) {
        throw UserError(option + " " + path + " is written as " + written + " first, where " + other + " " + place +
                        " shall be; valid: another file");
      }
      if (j > i || !areOneFile(path, place)) continue;
      throw UserError(other + " " + place + " and " + option + " " + path + " are one file; valid: a file for each");
    }
  }
}

}}  // namespace lpc::LPC_PRECISION
