// SPDX-License-Identifier: Zlib
#include "oracles/guarded.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>

namespace lpc::inline LPC_PRECISION {
namespace {

struct Message {
  int index;
  PairAnswer<3> answer;
};

bool isFinite(const PairAnswer<3>& a) {
  return std::isfinite(a.distance) && a.normal.allFinite() && a.pA.allFinite() && a.pB.allFinite();
}

PairAnswer<3> failure() {
  PairAnswer<3> a;
  a.status = QueryStatus::failed;
  return a;
}

// In the child: answers from `first` on into the pipe. Its warnings and last words go nowhere.
[[noreturn]] void answerAll(int first, int count, int pipe, const std::function<PairAnswer<3>(int)>& ask) {
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) dup2(nowhere, 2), dup2(nowhere, 1);
  for (int i = first; i < count; ++i) {
    Message message{i, failure()};
    try {
      const PairAnswer<3> answer = ask(i);
      if (isFinite(answer)) message.answer = answer;
    } catch (...) {
    }
    char bytes[sizeof(Message)];
    std::memcpy(bytes, static_cast<const void*>(&message), sizeof message);
    if (write(pipe, bytes, sizeof bytes) != static_cast<ssize_t>(sizeof bytes)) _exit(1);
  }
  _exit(0);
}

// Reads one message, or fails after the time limit or when the child is gone. A message is shorter than what a pipe
// passes in one piece.
bool receive(int pipe, int milliseconds, Message& message) {
  pollfd wait{pipe, POLLIN, 0};
  if (poll(&wait, 1, milliseconds) <= 0) return false;
  char bytes[sizeof(Message)];
  std::size_t have = 0;
  while (have < sizeof bytes) {
    const ssize_t got = read(pipe, bytes + have, sizeof bytes - have);
    if (got <= 0) return false;
    have += static_cast<std::size_t>(got);
  }
  std::memcpy(static_cast<void*>(&message), bytes, sizeof bytes);
  return true;
}

}  // namespace

void askGuarded(int count, int milliseconds, const std::function<PairAnswer<3>(int)>& ask, PairAnswers<3>& answers) {
  for (int next = 0; next < count; ++next) {
    int ends[2];
    pid_t child = -1;
    std::fflush(nullptr);  // or the child would print again what is still in the buffers
    if (pipe(ends) == 0) {
      child = fork();
      if (child == 0) {
        close(ends[0]);
        answerAll(next, count, ends[1], ask);
      }
      close(ends[1]);
    }
    Message message{0, failure()};
    while (child > 0 && next < count && receive(ends[0], milliseconds, message)) answers.set(next++, message.answer);
    if (child > 0) {
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
      close(ends[0]);
    }
    if (next < count) answers.set(next, failure());
  }
}

}  // namespace lpc::inline LPC_PRECISION
