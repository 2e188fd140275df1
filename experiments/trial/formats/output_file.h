// SPDX-License-Identifier: Zlib
#pragma once

#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "framework/math/check.h"
#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The message names the file and the reason: no such folder, no space left on device, ...
struct CannotWrite : UserError {
  using UserError::UserError;
};

/// A file that exists whole or not at all: written as NAME.partial and renamed by `finish`; as NAME.partial2 if that
/// name is taken. An existing path that is not a regular file (a device, a pipe, /dev/stdout) is written in place.
class OutputFile {
 public:
  /// Throws CannotWrite at once, not after hours of running.
  explicit OutputFile(std::string path);
  /// Removes an unfinished file.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ostream& stream() { return m_stream; }
  /// Throws CannotWrite if anything could not be written so far.
  void check();
  void finish();
  /// Where the next file for this path is written.
  static std::string writtenAt(const std::string& path);

 private:
  std::string m_path, m_written;  // final path, path while writing
  std::ofstream m_stream;
};

/// Whether the path leads to the input or output of this program (/dev/stdout, or a link to it), which differs in a
/// worker; a worker may share stderr.
bool isOwnStream(const std::string& path);

/// Files with their option for messages: {"--record", "a.rec"}. The path is empty if the option was not given.
using NamedFiles = std::vector<std::pair<std::string, std::string>>;
/// Throws UserError if an output would overwrite an input or another output, also through a link or another spelling.
void keepApart(const NamedFiles& inputs, const NamedFiles& outputs);

}}  // namespace lpc::LPC_PRECISION
