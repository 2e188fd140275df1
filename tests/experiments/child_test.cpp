// SPDX-License-Identifier: Zlib
#include "experiments/runner/child.h"

#include <array>
#include <csignal>

#include "framework/check.h"
#include "tests/experiments/workspace.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using test::Workspace;

const std::string kLong(10'000'000, 'x');  // more than any pipe holds

bool never() { return false; }

std::string script(const Workspace& w, const std::string& text) {
  const std::string path = w.write("program", "#!/bin/sh\n" + text + "\n");
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

TEST(Child, IsGivenAndTakenFromAtOnce) {
  Child cat("/bin/cat", kLong, -1, false);
  ASSERT_TRUE(cat.wait(never));
  EXPECT_EQ(cat.exitCode(), 0);
  EXPECT_TRUE(cat.output() == kLong);
}

// One that ends without reading, or reads nothing for ever, costs this program nothing.
TEST(Child, NeedNotRead) {
  Workspace w;
  Child deaf(script(w, "exec 0<&-; exit 3"), kLong, -1, false);
  ASSERT_TRUE(deaf.wait(never));
  EXPECT_EQ(deaf.exitCode(), 3);
  EXPECT_EQ(deaf.signal(), 0);
  Child asleep(script(w, "exec sleep 1000"), kLong, -1, false);
  EXPECT_FALSE(asleep.wait([] { return true; }));
}

// What this program ignores, exec would have it ignore, too: it could not be stopped.
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

// It takes with it what it has started.
TEST(Child, EndsWithItsOwn) {
  Workspace w;
  std::string sleeper;
  {
    Child shell(script(w, "sleep 1000 & echo $!; wait"), "", -1, false);
    while (shell.output().empty() && !shell.poll()) usleep(1000);
    sleeper = shell.output().substr(0, shell.output().find('\n'));
  }
  ASSERT_FALSE(sleeper.empty());
  const auto runs = [&] {
    std::ifstream in("/proc/" + sleeper + "/stat");
    std::string line;
    return std::getline(in, line) && line.find(") Z ") == line.npos;  // whose parent is gone may stay a zombie
  };
  while (runs()) usleep(1000);
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
