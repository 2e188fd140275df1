// SPDX-License-Identifier: Zlib
#include "experiments/film/temporary_recording.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "experiments/trial/formats/output_file.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

[[noreturn]] void fail(const std::string& why) {
  const char* place = std::getenv("TMPDIR");
  throw CannotWrite("TMPDIR=" + std::string(place ? place : "/tmp") +
                    ": the recording for the film cannot be written: " + why);
}

}  // namespace

TemporaryRecording::TemporaryRecording() {
  std::error_code error;
  const std::filesystem::path place = std::filesystem::temp_directory_path(error);
  if (error) fail(error.message());
  std::string folder = (place / "lpc_film_XXXXXX").string();
  if (!mkdtemp(folder.data())) fail(std::strerror(errno));
  m_folder = folder;
}

TemporaryRecording::~TemporaryRecording() {
  std::error_code ignored;
  std::filesystem::remove_all(m_folder, ignored);
}

}}  // namespace lpc::LPC_PRECISION
