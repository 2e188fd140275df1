// SPDX-License-Identifier: Zlib
// An interrupted command ends, leaves nothing half-written, and can be resumed. (Films: film_test.cpp.)
#include "tests/experiments/process.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace interrupt_test { namespace {

using test::ask;
using test::Process;
using test::Workspace;

TEST(Interrupt, EndsEveryCommand) {
  Workspace w;
  w.write("s.toml",
          "summary = \"s\"\nkind = \"boxes\"\nwall_limit = 1000\n[axes]\ndimension = 2\ndistribution = \"uniform\"\n"
          "frames = 12\nn = [8, 16, 24]\nbroadphase = [\"planted_hang\", \"naive\"]\n");
  const std::string sweep = "--plugin " LPC_BINARY_DIR "/lib/liblpc_planted.so sweep s.toml --store s.db";
  const std::pair<std::string, const char*> commands[] = {
      // each command, and the file that exists once it is at work
      {sweep, "s.db"},
      {"verify --minutes 100 --store v.db", "v.db"},
      {"verify --pairs 1000000 --store v.db", "v.db"},
      {"needs pyramid --param base=6 --seeds 50 --store n.db", "n.db"},
      {"run pyramid --steps 100000000 --record r.rec --profile p.csv", "r.rec.partial"},
      {"run pyramid --steps 100000000 --film f.svg", ""},
  };
  for (const auto& [command, file] : commands) {
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
      if (signal != SIGTERM && command != sweep && command.find("--film") == command.npos) continue;  // one handler
      if (*file) std::filesystem::remove(w.path(file));
      Process process(w, command);
      ASSERT_TRUE(process.isBusy(w.path(file))) << command << "\n" << process.said();
      process.signal(signal);
      EXPECT_EQ(process.wait(), 130) << command << "\n" << process.said();
      EXPECT_NE(process.said().find("stopped"), std::string::npos) << command << "\n" << process.said();
    }
  }
  for (const auto& entry : std::filesystem::directory_iterator(w.path(""))) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(name == "said" || name == "s.toml" || name.ends_with(".db")) << name;
  }
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM trial WHERE outcome != 'ok'"), "0");
  EXPECT_EQ(w.lpc(sweep + " --only naive --quiet").code, 0);
  EXPECT_EQ(ask(w.path("s.db"), "SELECT count(*) FROM trial"), "3");
}

TEST(Interrupt, NohupOutlivesTheTerminal) {
  Workspace w;
  const auto before = std::signal(SIGHUP, SIG_IGN);
  Process process(w, "run pyramid --steps 300 --record r.rec");
  std::signal(SIGHUP, before);
  process.isBusy(w.path("r.rec.partial"));
  process.signal(SIGHUP);
  EXPECT_EQ(process.wait(), 0) << process.said();
}

// Cases run in the program itself, which ends by the signal.
TEST(Interrupt, EndsCases) {
  Workspace w;
  Process process(w, "verify --cases " LPC_SOURCE_DIR "/tests/regressions/hard_cases.json --csv x.csv");
  ASSERT_TRUE(process.isBusy(w.path(""))) << "no witness was started";
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait(), 128 + SIGTERM);
  for (const auto& entry : std::filesystem::directory_iterator(w.path(""))) EXPECT_EQ(entry.path().filename(), "said");
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::interrupt_test
