// SPDX-License-Identifier: Zlib
#include "experiments/runner/child.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "framework/check.h"

namespace lpc::inline LPC_PRECISION {

Child::Child(const std::string& program, const std::string& input, int core, bool showErrors)
    : m_start(std::chrono::steady_clock::now()) {
  int in[2], out[2], err[2];
  if (pipe2(in, O_CLOEXEC) || pipe2(out, O_CLOEXEC) || pipe2(err, O_CLOEXEC)) {
    throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  }
  std::fflush(nullptr);
  const pid_t parent = getpid();
  m_pid = fork();
  if (m_pid < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (m_pid == 0) {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);  // it died before the line above
    if (core >= 0) {
      cpu_set_t set;
      CPU_ZERO(&set);
      CPU_SET(static_cast<unsigned>(core), &set);
      sched_setaffinity(0, sizeof set, &set);
    }
    dup2(in[0], 0), dup2(out[1], 1);
    if (!showErrors) dup2(err[1], 2);
    ::signal(SIGINT, SIG_DFL);
    execl(program.c_str(), program.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  close(in[0]), close(out[1]), close(err[1]);
  m_out = out[0], m_err = err[0];
  for (int descriptor : {m_out, m_err}) fcntl(descriptor, F_SETFL, O_NONBLOCK);
  std::size_t sent = 0;
  while (sent < input.size()) {  // a worker reads all of it before it writes
    const ssize_t n = write(in[1], input.data() + sent, input.size() - sent);
    if (n <= 0 && errno != EINTR) break;  // it ended already; poll() will say how
    if (n > 0) sent += static_cast<std::size_t>(n);
  }
  close(in[1]);
}

Child::~Child() {
  if (!m_ended) {
    kill();
    waitpid(m_pid, nullptr, 0);
  }
  if (m_out >= 0) close(m_out);
  if (m_err >= 0) close(m_err);
}

void Child::drain(int& descriptor, std::string& into) {
  char buffer[65536];
  while (descriptor >= 0) {
    const ssize_t n = read(descriptor, buffer, sizeof buffer);
    if (n > 0) {
      into.append(buffer, static_cast<std::size_t>(n));
    } else if (n == 0) {
      close(descriptor);
      descriptor = -1;
    } else if (errno != EINTR) {
      return;
    }
  }
}

bool Child::poll() {
  if (m_ended) return true;
  drain(m_out, m_output);
  drain(m_err, m_errors);
  if (m_errors.size() > 65536) m_errors.erase(0, m_errors.size() - 4096);
  int status = 0;
  if (waitpid(m_pid, &status, WNOHANG) != m_pid) return false;
  drain(m_out, m_output);
  drain(m_err, m_errors);
  m_ended = true;
  if (WIFSIGNALED(status)) m_signal = WTERMSIG(status);
  if (WIFEXITED(status)) m_exit = WEXITSTATUS(status);
  return true;
}

bool Child::wait(bool (*stop)()) {
  while (!poll()) {
    if (stop()) return false;
    pollfd p{m_out, POLLIN, 0};
    ::poll(&p, m_out >= 0 ? 1 : 0, 20);
  }
  return true;
}

void Child::kill() { ::kill(m_pid, SIGKILL); }

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

}  // namespace lpc::inline LPC_PRECISION
