// SPDX-License-Identifier: Zlib
#pragma once

#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "framework/math/check.h"
#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Names the file and says why: no such folder, no space left on device, ...
struct CannotWrite : UserError {
  using UserError::UserError;
};

/// A file that is there whole or not at all: written beside its place as NAME.partial and renamed by `finish`; as
/// NAME.partial2 where that name is taken. What exists and is no regular file (a device, a pipe, /dev/stdout) is
/// written in place.
class OutputFile {
 public:
  /// Throws CannotWrite at once, not after hours of running.
  explicit OutputFile(std::string path);
  /// Removes what was not finished.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ostream& stream() { return m_stream; }
  /// Throws CannotWrite when something so far could not be written.
  void check();
  void finish();
  /// Where the next one of this path is written.
  static std::string writtenAt(const std::string& path);

 private:
  std::string m_path, m_written;  // where it shall be, where it is written
  std::ofstream m_stream;
};

/// Whether the path leads to what this program reads or answers (/dev/stdout, a link to it), which is another one for a
/// worker; its stderr may be the same.
bool isOwnStream(const std::string& path);

/// Files as a message names them: {"--record", "a.rec"}. Those that were not named have an empty path.
using NamedFiles = std::vector<std::pair<std::string, std::string>>;
/// Throws UserError where an output would be written over an input or over another output, also when a link or another
/// spelling leads there.
void keepApart(const NamedFiles& inputs, const NamedFiles& outputs);

}}  // namespace lpc::LPC_PRECISION
