// SPDX-License-Identifier: Zlib
// Planning ends, and before it exceeds a machine's memory.
#include <csignal>

#include "experiments/runner/sweep_file.h"
#include "tests/experiments/refused.h"

namespace lpc { inline namespace LPC_PRECISION { namespace planning_test { namespace {

using test::expectParts;
using test::Outcome;
using test::Parts;
using test::Workspace;

std::string messageOf(const Workspace& w, const std::string& text) {
  try {
    planSweeps(w.write("s.toml", text), {});
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}

// `seed` with the numbers from 1 to n.
std::string seeds(int n) {
  std::string out = "seed = [";
  for (int i = 1; i <= n; ++i) out += std::to_string(i) + ", ";
  return out + "]\n";
}

const std::string kBoxes = "summary = \"s\"\nkind = \"boxes\"\n",
                  kAxes = "[axes]\ndimension = 2\ndistribution = \"uniform\"\nbroadphase = \"naive\"\nn = 8\n";

// Names are replaced in one pass: an inserted value is not examined again.
TEST(Planning, AnAxisThatNamesItself) {
  Workspace w;
  const auto world = [](const std::string& axes, const std::string& used = "$it") {
    return "summary = \"s\"\nkind = \"world\"\npipeline = \"solver=split_solver{velocity=catto{iterations=" + used +
           "}}\"\n[axes]\nscene = \"box_drop\"\n" + axes;
  };
  const std::pair<std::string, Parts> cases[] = {
      {world("it = \"$it\"\n"), {"s.toml:6: ", "'$it' becomes '$it'", "valid: a value without $"}},
      {world("it = \"4$it\"\n"), {"s.toml:6: ", "'$it' becomes '4$it'", "valid: a value without $"}},
      {world("it = \"$to\"\nto = \"$it\"\n"), {"s.toml:", "'$it' becomes '$to'", "valid: a value without $"}},
      {world("it = \"$to\"\nto = 4\n"), {"s.toml:", "'$it' becomes '$to'", "valid: a value without $"}},
      {world("it = 4\n", "$its$"), {"s.toml:3: ", "'$'", "names no axis", "valid: $it, $scene"}},
      {world("it = 4\n", "$to"), {"s.toml:3: ", "'$'", "names no axis", "valid: $it, $scene"}},
      {world("it = 4\nvelocity = \"$it\"\n", "4"), {"s.toml:", "'velocity' is unknown"}},
      {world("it = 4\n", "4"), {"s.toml:6: ", "'it' is unknown"}},
      {world("it = \"$it\"\n", "4"), {"s.toml:6: ", "'it' is unknown"}},
  };
  for (const auto& [text, parts] : cases) expectParts(messageOf(w, text), parts, text);

  // Names that begin with another name, a text with two names, and a stage's axis that names another axis.
  const auto plan = planSweeps(w.write("s.toml",
                                       "summary = \"s\"\nkind = \"world\"\n[axes]\nscene = \"box_drop\"\n"
                                       "n = 3\nnn = 5\nsolver = "
                                       "\"split_solver{velocity=catto{iterations=$nn$n}}\"\n"),
                               {});
  const std::string pipeline = plan.at(0).trials.at(0).canonical["pipeline"];
  EXPECT_NE(pipeline.find("iterations=53"), std::string::npos) << pipeline;
}

// Rejected before any cell is made, with the axes and their sizes.
TEST(Planning, TooManyTrials) {
  Workspace w;
  std::string squared = kAxes;
  for (const char* axis : {"a", "b", "c", "d", "e", "f", "g", "h"}) squared += axis + seeds(1000).substr(4);
  const std::pair<std::string, Parts> cases[] = {
      {kBoxes + "repeats = 9223372036854775807\n" + kAxes + "frames = [1, 2, 3]\n",
       {"s.toml:", "27670116110564327424 trials (repeats 9223372036854775808, frames 3)",
        "valid: up to 100000 in all"}},
      {kBoxes + squared, {"s.toml:", "1e+24 trials (a 1000, b 1000", "valid: up to 100000 in all"}},
      {kBoxes + kAxes + seeds(1000) + "frames = " + seeds(1000).substr(7), {"1e+06 trials (", "seed 1000", "frames"}},
      // Each group is small enough on its own.
      {kBoxes + kAxes + "[[group]]\naxes = { frames = [1, 2, 3] }\n[[group]]\nrepeats = 99998\n",
       {"s.toml:10: ", "99998 trials (repeats 99998) after 3 before it", "valid: up to 100000 in all"}},
      // An untimed trial beside the timed ones of a cell, and twice as many trials for a method that is timed twice as
      // often.
      {"timed = true\nuntimed = true\nrepeats = 50000\n" + kBoxes + kAxes + "frames = [1, 2]\n",
       {"s.toml:", "100002 trials (repeats 50000, frames 2, each cell once untimed)"}},
      {"timed = true\nrepeats = 20000\ntwice = \"naive\"\n" + kBoxes + kAxes + "frames = [1, 2, 3]\n",
       {"s.toml:", "120000 trials (repeats 20000, frames 3, 'naive' twice)"}},
      // One search may end in as many trials as it has budgets.
      {"summary = \"s\"\nkind = \"world\"\npipeline = \"solver=soft_step{substeps=$it}\"\nbudgets = [1, 2]\n"
       "repeats = 50001\ncalibrate = { equal = \"cost\", metric = \"work_row_updates\", setting = \"it\" }\n"
       "[axes]\nscene = \"box_drop\"\n",
       {"s.toml:", "100002 trials (repeats 50001, budgets 2)"}},
  };
  for (const auto& [text, parts] : cases) expectParts(messageOf(w, text), parts, text);
  // The limit also holds for the sweeps of a set together.
  w.write("a.toml", kBoxes + "repeats = 3\n" + kAxes);
  w.write("b.toml", kBoxes + "repeats = 99998\n" + kAxes);
  const std::string set = "summary = \"s\"\nsweeps = [\"" + w.path("a.toml") + "\", \"" + w.path("b.toml") + "\"]\n";
  expectParts(messageOf(w, set), {"b.toml:", "99998 trials", "after 3 before it"}, set);
}

// The values of an axis are examined once, not in every cell: 20,000 values took minutes.
TEST(Planning, LongAxes) {
  Workspace w;
  const auto plan = planSweeps(w.write("s.toml",
                                       "summary = \"s\"\nkind = \"world\"\n[axes]\nscene = \"box_drop\"\n"
                                       "cache = \"none\"\n" +
                                           seeds(1000)),
                               {});
  EXPECT_EQ(plan.at(0).trials.size(), 1000u);
}

TEST(Planning, IsStoppedAtOnce) {
  Workspace w;
  w.write("s.toml", kBoxes + kAxes + seeds(90000));
  const auto before = test::filesIn(w);
  const Outcome out =
      w.shell("timeout --preserve-status -k 20 0.3 " LPC_BINARY_DIR "/bin/lpc sweep s.toml --store s.db");
  EXPECT_TRUE(out.code == 130 || out.code == 128 + SIGTERM) << out.code << out.text;
  EXPECT_EQ(test::filesIn(w), before);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::planning_test
