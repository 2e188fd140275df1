// SPDX-License-Identifier: Zlib
#pragma once

#include <filesystem>
#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A place for a recording that only a film is made of, in a folder of its own, which goes with all that is in it: a
/// worker that was stopped leaves what it had not finished.
class TemporaryRecording {
 public:
  /// Throws UserError where temporary files cannot be.
  TemporaryRecording();
  ~TemporaryRecording();
  TemporaryRecording(const TemporaryRecording&) = delete;
  TemporaryRecording& operator=(const TemporaryRecording&) = delete;

  std::string path() const { return (m_folder / "film.rec").string(); }

 private:
  std::filesystem::path m_folder;
};

}}  // namespace lpc::LPC_PRECISION
