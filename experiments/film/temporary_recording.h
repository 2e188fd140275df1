// SPDX-License-Identifier: Zlib
#pragma once

#include <filesystem>
#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A path for a temporary recording that only a film needs, in a folder of its own. The folder is removed with its
/// content, which includes unfinished files of a stopped worker.
class TemporaryRecording {
 public:
  /// Throws UserError if temporary files cannot be made.
  TemporaryRecording();
  ~TemporaryRecording();
  TemporaryRecording(const TemporaryRecording&) = delete;
  TemporaryRecording& operator=(const TemporaryRecording&) = delete;

  std::string path() const { return (m_folder / "film.rec").string(); }

 private:
  std::filesystem::path m_folder;
};

}}  // namespace lpc::LPC_PRECISION
