// SPDX-License-Identifier: Zlib
#include "experiments/runner/store_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// A runner killed while starting a worker leaves a forked copy that holds the lock until it notices.
constexpr int kTries = 30;
constexpr useconds_t kPause = 10'000;  // µs

// From kernel lines such as "1: FLOCK  ADVISORY  WRITE 1234 fe:00:5678 0 EOF".
std::string holderOf(int file) {
  struct stat about {};
  if (fstat(file, &about) != 0) return "";
  const std::string place = fmt::format("{:02x}:{:02x}:{}", major(about.st_dev), minor(about.st_dev), about.st_ino);
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number, kind, way, access, process, where;
    words >> number >> kind >> way >> access >> process >> where;
    if (kind == "FLOCK" && where == place) return " (process " + process + ")";
  }
  return "";
}

}  // namespace

StoreLock::StoreLock(const std::string& path) : m_file(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (m_file < 0) throw UserError(path + ": cannot be locked: " + std::strerror(errno));
  for (int tries = 1; flock(m_file, LOCK_EX | LOCK_NB) != 0; ++tries) {
    const int why = errno;
    if (why == EWOULDBLOCK && tries < kTries) {
      usleep(kPause);
      continue;
    }
    const std::string holder = holderOf(m_file);
    close(m_file);
    if (why != EWOULDBLOCK) throw UserError(path + ": cannot be locked: " + std::strerror(why));
    throw UserError(path + ": another lpc" + holder + " is running trials into it; valid: another --store, or wait");
  }
}

StoreLock::~StoreLock() { close(m_file); }

}}  // namespace lpc::LPC_PRECISION
