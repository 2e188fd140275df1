// SPDX-License-Identifier: Zlib
#include "experiments/runner/child.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <utility>

#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {

// Bytes read from a child process at a time: one that writes without end must not block the others.
constexpr std::size_t kAtOnce = 16 << 20;

Child::Child(const std::string& program, std::string input, int core, bool showErrors)
    : m_input(std::move(input)), m_start(std::chrono::steady_clock::now()) {
  start(program, core, showErrors);
  feed();
}

void Child::start(const std::string& program, int core, bool showErrors) {
  int in[2] = {-1, -1}, out[2] = {-1, -1}, err[2] = {-1, -1}, fault[2] = {-1, -1};
  const auto refuse = [&](const char* valid) {
    const std::string why = std::strerror(errno);
    for (const int descriptor : {in[0], in[1], out[0], out[1], err[0], err[1], fault[0], fault[1]}) {
      if (descriptor >= 0) close(descriptor);
    }
    throw UserError(program + ": cannot be started: " + why + "; valid: " + valid);
  };
  // A socket, because it can be used without SIGPIPE. exec closes `fault`, which otherwise reports why it failed.
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, in) || pipe2(out, O_CLOEXEC) || pipe2(err, O_CLOEXEC) ||
      pipe2(fault, O_CLOEXEC)) {
    refuse("fewer --jobs, or more open files (ulimit -n)");
  }
  std::fflush(nullptr);
  const pid_t parent = getpid();
  m_pid = fork();
  if (m_pid < 0) refuse("fewer --jobs, or more processes (ulimit -u)");
  if (m_pid == 0) {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);  // the parent died before the line above
    if (core >= 0) {
      cpu_set_t set;
      CPU_ZERO(&set);
      CPU_SET(static_cast<unsigned>(core), &set);
      sched_setaffinity(0, sizeof set, &set);
    }
    dup2(in[0], 0), dup2(out[1], 1);
    if (!showErrors) dup2(err[1], 2);
    for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) ::signal(signal, SIG_DFL);  // exec keeps ignored signals
    execl(program.c_str(), program.c_str(), static_cast<char*>(nullptr));
    const int why = errno;
    while (write(fault[1], &why, sizeof why) < 0 && errno == EINTR) continue;
    _exit(127);
  }
  close(in[0]), close(out[1]), close(err[1]), close(fault[1]);
  m_in = in[1], m_out = out[0], m_err = err[0];
  for (int descriptor : {m_out, m_err}) fcntl(descriptor, F_SETFL, O_NONBLOCK);
  int why = 0;
  ssize_t told = 0;
  while ((told = read(fault[0], &why, sizeof why)) < 0 && errno == EINTR) continue;
  close(fault[0]);
  if (told <= 0) return;
  waitpid(m_pid, nullptr, 0);
  for (int descriptor : {m_in, m_out, m_err}) close(descriptor);
  throw UserError(program + ": cannot be started: " + std::strerror(why) +
                  "; valid: a program of the build, in the folder that LPC_WORKERS names where it is set");
}

Child::~Child() {
  if (!m_ended) {
    kill();
    waitpid(m_pid, nullptr, 0);
  }
  for (int descriptor : {m_in, m_out, m_err}) {
    if (descriptor >= 0) close(descriptor);
  }
}

void Child::feed() {
  while (m_in >= 0) {
    const ssize_t n = send(m_in, m_input.data() + m_given, m_input.size() - m_given, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
    if (n > 0) m_given += static_cast<std::size_t>(n);
    if (n > 0 && m_given < m_input.size()) continue;
    close(m_in);  // all input is written, or it reads no more; poll() will report how it ended
    m_in = -1, m_input = {};
  }
}

void Child::drain(int& descriptor, std::string& into) {
  char buffer[65536];
  for (std::size_t taken = 0; descriptor >= 0 && taken < kAtOnce;) {
    const ssize_t n = read(descriptor, buffer, sizeof buffer);
    if (n > 0) {
      taken += static_cast<std::size_t>(n);
      m_flooded = m_flooded || into.size() + static_cast<std::size_t>(n) > kMostOutput;
      if (!m_flooded) into.append(buffer, static_cast<std::size_t>(n));
    } else if (n == 0) {
      close(descriptor);
      descriptor = -1;
    } else if (errno != EINTR) {
      return;
    }
  }
}

void Child::takeOutput() {
  drain(m_out, m_output);
  drain(m_err, m_errors);
  if (m_errors.size() > 65536) m_errors.erase(0, m_errors.size() - 4096);
}

bool Child::poll() {
  if (m_ended) return true;
  feed();
  takeOutput();
  if (m_flooded) kill();
  int status = 0;
  if (waitpid(m_pid, &status, WNOHANG) != m_pid) return false;
  takeOutput();
  m_ended = true;
  if (WIFSIGNALED(status)) m_signal = WTERMSIG(status);
  if (WIFEXITED(status)) m_exit = WEXITSTATUS(status);
  return true;
}

bool Child::addTo(std::vector<pollfd>& descriptors) const {
  if (m_in >= 0) descriptors.push_back({m_in, POLLOUT, 0});
  if (m_out >= 0) descriptors.push_back({m_out, POLLIN, 0});
  return m_out >= 0;
}

bool Child::wait(bool (*stop)()) {
  while (!poll()) {
    if (stop()) return false;
    std::vector<pollfd> descriptors;
    addTo(descriptors);
    ::poll(descriptors.data(), descriptors.size(), 20);
  }
  return true;
}

// With all processes that it has started: it leads a group.
void Child::kill() { ::kill(-m_pid, SIGKILL); }

double Child::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - m_start).count();
}

std::size_t Child::residentBytes() const {
  unsigned long pages = 0, resident = 0;
  if (FILE* f = std::fopen(("/proc/" + std::to_string(m_pid) + "/statm").c_str(), "r")) {
    if (std::fscanf(f, "%lu %lu", &pages, &resident) != 2) resident = 0;
    std::fclose(f);
  }
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::string Child::lastError() const {
  std::size_t end = m_errors.find_last_not_of("\n ");
  if (end == std::string::npos) return "";
  const std::size_t begin = m_errors.rfind('\n', end);
  return m_errors.substr(begin == std::string::npos ? 0 : begin + 1,
                         end - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

}}  // namespace lpc::LPC_PRECISION
