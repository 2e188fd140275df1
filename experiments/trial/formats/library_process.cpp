// SPDX-License-Identifier: Zlib
#include "experiments/trial/formats/library_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <exception>

#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr unsigned kMostSeconds = 60;
constexpr int kTold = 3;  // exit code of a child process that reports an error

[[noreturn]] void serve(int to, const std::function<std::string()>& work) {
  const int nowhere = open("/dev/null", O_RDWR);
  for (int fd = 0; fd < 3; ++fd) dup2(nowhere, fd);
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  std::signal(SIGALRM, SIG_DFL), std::signal(SIGABRT, SIG_DFL), std::signal(SIGSEGV, SIG_DFL);
  alarm(kMostSeconds);
  std::string told;
  int code = 0;
  try {
    told = work();
  } catch (const std::exception& e) {
    told = e.what(), code = kTold;
  }
  for (std::size_t at = 0; at < told.size();) {
    const ssize_t n = write(to, told.data() + at, told.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) _exit(1);
    at += static_cast<std::size_t>(n);
  }
  _exit(code);
}

}  // namespace

std::string inItsProcess(const std::string& library, const std::string& path,
                         const std::function<std::string()>& work) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw UserError(path + ": no pipe to read it through; valid: more open files");
  const pid_t parent = getpid(), child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);  // the parent died before the line above
    serve(ends[1], work);
  }
  close(ends[1]);
  std::string told;
  char buffer[4096];
  while (child > 0) {
    const ssize_t n = read(ends[0], buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    told.append(buffer, static_cast<std::size_t>(n));
  }
  close(ends[0]);
  int status = -1;
  while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0) return told;
  const bool said = child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == kTold;
  throw UserError(path + ": " + (said ? told : library + " fails on it"));
}

}}  // namespace lpc::LPC_PRECISION
