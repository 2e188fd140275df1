// SPDX-License-Identifier: Zlib
#include "experiments/runner/plugin_probe.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <map>
#include <tuple>

#include "experiments/runner/code_identity.h"
#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr int kSeconds = 10;
constexpr rlim_t kBytes = rlim_t{8} << 30;
constexpr char kEnded = 'e', kMistake = 'm', kThrew = 't';  // first letter of what the child tells

int toParent = -1;

[[noreturn]] void tell(char kind, const std::string& text) {
  const std::string told = kind + text;
  for (std::size_t at = 0; at < told.size();) {
    const ssize_t n = ::write(toParent, told.data() + at, told.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    at += static_cast<std::size_t>(n);
  }
  _exit(0);
}

// Also the handler of std::terminate: nothing can catch an exception of a library's initialiser.
[[noreturn]] void tellException() {
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
  } catch (const UserError& e) {
    tell(kMistake, e.what());
  } catch (const std::exception& e) {
    tell(kThrew, std::string("it throws '") + e.what() + "'");
  } catch (...) {
    tell(kThrew, "it throws an object that is no std::exception");
  }
  std::signal(SIGABRT, SIG_DFL);
  std::abort();
}

[[noreturn]] void serve(const std::function<void()>& work) {
  const int nowhere = open("/dev/null", O_RDWR);
  for (int fd = 0; fd < 3; ++fd) dup2(nowhere, fd);
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
#if !defined(LPC_SANITIZED)  // a sanitizer reserves terabytes of addresses
  const rlimit bytes{kBytes, kBytes};
  setrlimit(RLIMIT_AS, &bytes);
#endif
  for (const int s : {SIGINT, SIGTERM, SIGALRM, SIGABRT, SIGSEGV, SIGFPE}) std::signal(s, SIG_DFL);
  std::set_terminate(tellException);
  try {
    work();
  } catch (...) {
    tellException();
  }
  tell(kEnded, "");
}

// What the child tells until it ends, or until the time is over.
std::string listen(int from, bool& late) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::seconds(kSeconds);
  std::string told;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd at{from, POLLIN, 0};
    const int ready = left > 0 ? poll(&at, 1, static_cast<int>(left)) : 0;
    if (ready < 0 && errno == EINTR) continue;
    late = ready == 0;
    if (ready <= 0) return told;
    char buffer[4096];
    const ssize_t n = ::read(from, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return told;
    told.append(buffer, static_cast<std::size_t>(n));
  }
}

}  // namespace

std::optional<std::string> failureInChild(const std::function<void()>& work) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw UserError("cannot create a pipe; valid: more open files (ulimit -n)");
  std::fflush(nullptr);
  const pid_t parent = getpid(), child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);  // the parent died before the line above
    // serve() redirects 0, 1 and 2, which may be the pipe's.
    toParent = ends[1] < 3 ? fcntl(ends[1], F_DUPFD_CLOEXEC, 3) : ends[1];
    serve(work);
  }
  close(ends[1]);
  bool late = false;
  const std::string told = child > 0 ? listen(ends[0], late) : "";
  close(ends[0]);
  if (child < 0) throw UserError("cannot start a process; valid: more processes (ulimit -u)");
  if (late) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (!told.empty() && told[0] == kEnded) return {};
  if (!told.empty() && told[0] == kMistake) throw UserError(told.substr(1));
  if (!told.empty()) return told.substr(1);
  if (late) return "it does not end within " + std::to_string(kSeconds) + " s";
  if (WIFSIGNALED(status)) return "it dies of signal " + std::to_string(WTERMSIG(status));
  return "it exits with code " + std::to_string(WEXITSTATUS(status));
}

namespace {

std::string failureText(const Registered& entry, const std::string& failure) {
  return std::string(stageName(entry.stage)) + " " + entry.info.name + " cannot be created: " + failure;
}

// What checkConstructor() has found, "" for nothing. A sweep plans thousands of cells.
std::map<std::tuple<StageKind, int, std::string>, std::string>& checkedConstructors() {
  static std::map<std::tuple<StageKind, int, std::string>, std::string> checked;
  return checked;
}

}  // namespace

void checkConstructor(const Registered& entry, const Spec& spec) {
  if (!anyPlugin()) return void(entry.create(spec));
  const std::tuple key(entry.stage, entry.dimension, spec.text());
  if (checkedConstructors().count(key)) return;
  const auto failure = failureInChild([&] { entry.create(spec); });
  checkedConstructors()[key] = failure ? failureText(entry, *failure) : "";
}

void requireCheckedConstructors() {
  for (const auto& [key, failure] : checkedConstructors()) {
    if (!failure.empty()) throw UserError(failure);
  }
}

void requireConstructor(const Registered& entry, const std::function<void()>& use) {
  if (anyPlugin()) {
    if (const auto failure = failureInChild(use)) throw UserError(failureText(entry, *failure));
  }
  use();
}

}}  // namespace lpc::LPC_PRECISION
