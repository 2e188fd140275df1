// SPDX-License-Identifier: Zlib
#include "experiments/runner/child.h"

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <exception>
#include <nlohmann/json.hpp>

#include "experiments/runner/worker_pool.h"
#include "framework/math/check.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace child_test { namespace {

using test::Workspace;

const std::string kLong(10'000'000, 'x');  // more than any pipe holds

constexpr int kTries = 100'000;  // at least 1 ms each: a test that would hang fails

bool never() { return false; }

std::string script(const Workspace& w, const std::string& text) {
  const std::string path = w.write("program", "#!/bin/sh\n" + text + "\n");
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

TEST(Child, ReadsAndWritesAtTheSameTime) {
  Child cat("/bin/cat", kLong, -1, false);
  ASSERT_TRUE(cat.wait(never));
  EXPECT_EQ(cat.exitCode(), 0);
  EXPECT_TRUE(cat.output() == kLong);
}

// A child that ends without reading, or never reads, does not block this program.
TEST(Child, MayEndWithoutReading) {
  Workspace w;
  Child deaf(script(w, "exec 0<&-; exit 3"), kLong, -1, false);
  ASSERT_TRUE(deaf.wait(never));
  EXPECT_EQ(deaf.exitCode(), 3);
  EXPECT_EQ(deaf.signal(), 0);
  Child asleep(script(w, "exec sleep 1000"), kLong, -1, false);
  EXPECT_FALSE(asleep.wait([] { return true; }));
}

// A child would inherit ignored signals through exec and could not be stopped.
TEST(Child, IgnoresNoSignals) {
  Workspace w;
  constexpr std::array<int, 3> kSignals = {SIGINT, SIGTERM, SIGPIPE};
  std::array<void (*)(int), 3> before{};
  for (std::size_t i = 0; i < 3; ++i) before[i] = std::signal(kSignals[i], SIG_IGN);
  Child child(script(w, "exec grep SigIgn /proc/self/status"), "", -1, false);
  for (std::size_t i = 0; i < 3; ++i) std::signal(kSignals[i], before[i]);
  ASSERT_TRUE(child.wait(never));
  ASSERT_TRUE(child.output().starts_with("SigIgn:")) << child.output();
  const unsigned long ignored = std::stoul(child.output().substr(7), nullptr, 16);
  for (const int signal : kSignals) EXPECT_EQ(ignored >> (signal - 1) & 1, 0u) << signal;
}

TEST(Child, ThatCannotStartIsTheUsersMistake) {
  Workspace w;
  const std::string text = w.write("text", "no program");
  const auto message = [](const std::string& program) -> std::string {
    try {
      Child(program, kLong, -1, false);
    } catch (const UserError& e) {
      return e.what();
    }
    return "none";
  };
  EXPECT_TRUE(message(text).starts_with(text + ": cannot be started: Permission denied; valid: ")) << message(text);
  std::filesystem::permissions(text, std::filesystem::perms::owner_all);
  EXPECT_TRUE(message(text).starts_with(text + ": cannot be started: Exec format error; valid: ")) << message(text);
  EXPECT_NE(message(w.path("")).find("Permission denied"), std::string::npos);
  EXPECT_NE(message("/no/program").find("No such file"), std::string::npos);
}

// Too many children: each takes four descriptors, and a failed start leaves none open.
TEST(Child, ThatFindsNoDescriptorIsTheUsersMistake) {
  Workspace w;
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  const auto open = [] { return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {}); };
  const auto first = open();
  std::string message = "none yet";
  rlim_t most = 3;
  for (; !message.empty() && most < 200; ++most) {
    const rlimit few{most, before.rlim_max};
    setrlimit(RLIMIT_NOFILE, &few);
    std::exception_ptr thrown;  // examined after the limit is lifted: the sanitizer needs descriptors
    try {
      Child child("/bin/true", "", -1, false);
    } catch (const UserError&) {
      thrown = std::current_exception();
    }
    setrlimit(RLIMIT_NOFILE, &before);
    EXPECT_EQ(open(), first) << most;
    message.clear();
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const UserError& e) {
      message = e.what();
    }
    const std::string wanted =
        "/bin/true: cannot be started: Too many open files; valid: fewer --jobs, or more open files";
    EXPECT_TRUE(message.empty() || message == wanted + " (ulimit -n)") << message;
  }
  EXPECT_GT(most, 4u);
  w.write("s.toml",
          "summary = \"s\"\nkind = \"boxes\"\n[axes]\ndimension = 2\ndistribution = \"uniform\"\nframes = 12\n"
          "n = [8, 9, 10, 11, 12, 13, 14, 15]\nbroadphase = \"naive\"\n");
  const test::Outcome out =
      w.shell("ulimit -n 20; " LPC_BINARY_DIR "/bin/lpc sweep s.toml --store s.db --quiet --jobs 8");
  EXPECT_EQ(out.code, 2) << out.text;
  EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
  EXPECT_NE(out.text.find("valid: fewer --jobs"), out.text.npos) << out.text;
}

// Time in which this program itself was stopped (Ctrl-Z) does not count against a worker.
TEST(Child, IsNotLateWhileItsParentIsStopped) {
  Workspace w;
  const std::string program = script(w, "head -c 1000000 /dev/zero");
  std::filesystem::rename(program, w.path("lpc-worker-f64"));
  setenv("LPC_WORKERS", w.path("").c_str(), 1);
  WorkerPool pool({});
  pool.start(0, "f64", {}, {.seconds = 1}, -1);
  usleep(1'500'000);
  std::vector<WorkerEnd> ends;
  while (ends.empty()) ends = pool.ended();
  EXPECT_EQ(ends[0].outcome, "ok") << ends[0].reason;
  EXPECT_EQ(ends[0].output.size(), 1'000'000u);
}

// Its own child processes end with it.
TEST(Child, EndsWithItsChildren) {
  Workspace w;
  std::string sleeper;
  {
    Child shell(script(w, "sleep 1000 & echo $!; wait"), "", -1, false);
    for (int i = 0; i < kTries && shell.output().empty() && !shell.poll(); ++i) usleep(1000);
    sleeper = shell.output().substr(0, shell.output().find('\n'));
  }
  ASSERT_FALSE(sleeper.empty());
  const auto runs = [&] {
    std::ifstream in("/proc/" + sleeper + "/stat");
    std::string line;
    return std::getline(in, line) && line.find(") Z ") == line.npos;  // may stay a zombie without a parent
  };
  for (int i = 0; i < kTries && runs(); ++i) usleep(1000);
  EXPECT_FALSE(runs());
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::child_test
