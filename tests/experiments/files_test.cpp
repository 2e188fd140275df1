// SPDX-License-Identifier: Zlib
// Files that a command reads and writes: no output overwrites an input, and no file makes a command wait.
#include <nlohmann/json.hpp>

#include "experiments/parse/toml_reader.h"
#include "tests/experiments/refused.h"

namespace lpc { inline namespace LPC_PRECISION { namespace files_test { namespace {

using test::filesIn;
using test::Outcome;
using test::refused;
using test::Workspace;

const std::string kScene =
    "name = \"t\"\nsummary = \"s\"\ndimensions = [2]\nsteps = 5\n[[body]]\n"
    "shapes = [{ kind = \"circle\", radius = 1 }]\n";

TEST(Files, NoOutputIsWrittenOverAnInput) {
  Workspace w;
  std::filesystem::create_directory(w.path("folder"));
  for (const char* name : {"r.toml", "r.svg", "r.partial"}) w.write(name, kScene);
  std::filesystem::create_symlink("r.toml", w.path("link"));
  std::filesystem::create_hard_link(w.path("r.toml"), w.path("other"));
  const char* valid = "valid: another file";
  for (const char* option : {"--record", "--profile"}) {
    for (const char* path : {"r.toml", "./folder/../r.toml", "link", "other"}) {
      refused(w, std::string("run r.toml ") + option + " " + path, {option, "overwrite the scene r.toml", valid});
    }
    refused(w, "run " + w.path("r.toml") + " " + option + " r.toml", {option, "overwrite the scene", valid});
    // An output is first written under another name, but not under this one.
    EXPECT_EQ(w.lpc(std::string("run r.partial ") + option + " r").code, 0);
  }
  refused(w, "run r.svg --film r.svg", {"--film r.svg", "overwrite the scene r.svg", valid});
  EXPECT_EQ(readFile(w.path("r.toml")), kScene);
  EXPECT_EQ(readFile(w.path("r.svg")), kScene);
  EXPECT_EQ(readFile(w.path("r.partial")), kScene);

  ASSERT_EQ(w.lpc("run r.toml --record a.svg").code, 0);
  refused(w, "replay a.svg --film ./a.svg", {"--film", "overwrite the recording a.svg", valid});
  refused(w, "replay r.toml --beside a.svg --film a.svg", {"--film", "overwrite the recording a.svg", valid});
  w.write("c.json", "{\"cases\": []}");
  refused(w, "verify --cases c.json --csv ./c.json", {"--csv", "overwrite the cases c.json", valid});
  refused(w, "verify --cases c.json --csv s.db --store s.db", {"--csv s.db", "--store s.db", "are one file"});
}

TEST(Files, TwoOutputsAreTwoFiles) {
  Workspace w;
  w.write("r.toml", kScene);
  w.write("x", "earlier");
  refused(w, "run r.toml --record x --profile x", {"--record x and --profile x are one file"});
  refused(w, "run r.toml --record y --profile ./y", {"--record y and --profile ./y are one file"});
  refused(w, "run r.toml --profile f.svg --film f.svg", {"--profile f.svg and --film f.svg are one file"});
  // Neither output is the temporary file of the other.
  const char* on = "is written as y.partial first, where";
  refused(w, "run r.toml --record y.partial --profile y", {"--profile y ", on, "--record y.partial"});
  refused(w, "run r.toml --record y --profile ./y.partial", {"--record y ", on, "--profile ./y.partial"});
  EXPECT_EQ(readFile(w.path("x")), "earlier");
  EXPECT_EQ(w.lpc("run r.toml --record /dev/null --profile /dev/null").code, 0) << "a device takes both";
  refused(w, "run r.toml --record /dev/stdout", {"/dev/stdout", "valid: a file"});
}

// A user's file with the name that an output's temporary file would have.
TEST(Files, UsersFilesAreNotTakenForTemporaryOnes) {
  Workspace w;
  w.write("r.toml", kScene);
  w.write("a.partial", "mine");
  ASSERT_EQ(w.shell("ln -s nowhere a.partial2").code, 0);
  ASSERT_EQ(w.lpc("run r.toml --record a --profile b").code, 0);
  EXPECT_TRUE(readFile(w.path("a")).starts_with("LPCREC"));
  EXPECT_EQ(readFile(w.path("a.partial")), "mine");
  const std::set<std::string> all = filesIn(w);
  EXPECT_EQ(all.size(), 5u) << "r.toml, a, b and two that were there";
  // Nor after a rejected run, nor after a run with a dead worker.
  refused(w, "run r.toml --record a --profile nowhere/b", {"nowhere/b: cannot be written"});
  const Outcome out = w.lpc("run r.toml --record a", "LPC_WORKERS=" + w.path("none"));
  EXPECT_NE(out.code, 0) << out.text;
  EXPECT_EQ(readFile(w.path("a.partial")), "mine");
  EXPECT_EQ(filesIn(w), all);
}

// A pipe without a writer, and an endless device.
TEST(Files, NoInputBlocks) {
  Workspace w;
  w.write("r.toml", kScene);
  w.write("bench.json", "");
  ASSERT_EQ(w.lpc("run r.toml --record a.rec").code, 0);
  ASSERT_EQ(w.shell("mkfifo pipe && mkdir folder").code, 0);
  for (const char* path : {"pipe", "folder", "/dev/zero", "bench.json"}) {
    const std::string name = path;
    refused(w, "replay " + name, {name + ": ", "not a recording"});
    refused(w, "replay a.rec --beside " + name, {name + ": ", "not a recording"});
    refused(w, "--plugin " + name + " list", {name + ": "});
    if (name != "bench.json") refused(w, "run " + name, {"'" + name + "'"});
    if (name != "pipe") refused(w, "import-benchmark --store s.db " + name, {name + ": "});
    if (name != "bench.json") refused(w, "needs r.toml --store " + name, {name + ": ", "not a regular file"});
    if (name != "bench.json") refused(w, "merge s.db " + name, {name + ": ", "not a regular file"});
  }
  refused(w, "replay absent.rec", {"absent.rec: cannot be read: No such file or directory"});
}

// Some services start programs with closed streams. A worker's files must not get the descriptor of a closed stream.
TEST(Files, ClosedStreamsAreNoFiles) {
  Workspace w;
  w.write("r.toml", kScene);
  EXPECT_EQ(w.lpc("run r.toml <&-").text, w.lpc("run r.toml </dev/null").text);
  const std::string cases = "verify --cases " LPC_SOURCE_DIR "/tests/regressions/found_cases.json";
  EXPECT_EQ(w.lpc(cases + " <&-").text, w.lpc(cases + " </dev/null").text);
  w.write("s.toml",
          "summary = \"s\"\nkind = \"boxes\"\n[axes]\ndimension = 2\ndistribution = \"uniform\"\nframes = 12\n"
          "n = [8, 16]\nbroadphase = \"naive\"\n");
  EXPECT_EQ(w.shell("(" LPC_BINARY_DIR "/bin/lpc sweep s.toml --store s.db <&- >&- 2>&-)").code, 2)
      << "standard output cannot be written";
  EXPECT_EQ(w.shell("(" LPC_BINARY_DIR "/bin/lpc sweep s.toml --store t.db 2>/dev/full)").code, 0);
  for (const char* store : {"s.db", "t.db"}) {
    EXPECT_EQ(test::ask(w.path(store), "SELECT count(*) FROM trial WHERE outcome = 'ok'"), "2") << store;
  }
  EXPECT_EQ(w.shell("(" LPC_BINARY_DIR "/bin/lpc run r.toml --json >&-)").text,
            "lpc: standard output cannot be written: Bad file descriptor\n");
}

std::string oneCase() {
  auto cases = nlohmann::json::parse(readFile(LPC_SOURCE_DIR "/tests/regressions/hard_cases.json"));
  cases["cases"] = nlohmann::json::array({cases["cases"][0]}), cases["count"] = 1;
  return cases.dump();
}

// A pipe is opened once: its reader gets the table and then end of file.
TEST(Files, APipeTakesATable) {
  Workspace w;
  w.write("c.json", oneCase());
  const Outcome file = w.lpc("verify --cases c.json --csv x.csv");
  ASSERT_EQ(file.code, 0) << file.text;
  const Outcome out = w.shell("mkfifo pipe && (cat pipe > got & timeout 60 " LPC_BINARY_DIR
                              "/bin/lpc verify --cases c.json --csv pipe && wait)");
  EXPECT_EQ(out.code, 0) << out.text;
  EXPECT_EQ(readFile(w.path("got")), readFile(w.path("x.csv")));
}

// Standard output is written but not replaced, also if it is redirected to a file.
TEST(Files, StandardOutputIsNotReplaced) {
  Workspace w;
  w.write("r.toml", kScene);
  w.write("c.json", oneCase());
  ASSERT_EQ(w.shell("ln -s /proc/self/fd/1 first && ln -s first link").code, 0);
  ASSERT_EQ(w.lpc("verify --cases c.json --csv x.csv").code, 0);
  for (const std::string path : {"link", "//proc/self/fd/1"}) {
    const Outcome out = w.shell(LPC_BINARY_DIR "/bin/lpc verify --cases c.json --csv " + path + " > out.txt");
    EXPECT_EQ(out.code, 0) << out.text;
    const std::string text = readFile(w.path("out.txt"));
    EXPECT_TRUE(text.ends_with("wrong answers of LPC's own methods: 0\n" + readFile(w.path("x.csv")))) << text;
    for (const char* option : {"--record ", "--profile "}) {
      refused(w, "run r.toml " + std::string(option) + path, {path + ": is a stream of this process", "valid: a file"});
    }
  }
  EXPECT_TRUE(std::filesystem::is_symlink(w.path("first")) && std::filesystem::is_symlink(w.path("link")));
  EXPECT_EQ(w.lpc("run r.toml --profile /dev/stderr").code, 0);
}

// Stores and requests to workers are UTF-8.
TEST(Files, NamesAreUtf8) {
  Workspace w;
  w.write("a\xff.toml", kScene);
  w.write("r.toml", kScene);
  for (const std::string arguments :
       {"run a\xff.toml", "run r.toml --record a\xff.rec", "sweep a\xff.toml", "sweep ensembles --store \xff.db",
        "list --name \xff", "--plugin \xff.so list", "merge \xff.db a.db", "verify --cases \xff.json", "\xff"}) {
    refused(w, arguments, {"lpc: the argument ", "not UTF-8"});
  }
  std::filesystem::create_directory(w.path("tmp\xff"));
  refused(w, "run r.toml --film r.svg", {"not UTF-8"}, "TMPDIR=" + w.path("tmp\xff"));
  w.write("bad.toml", "name = \"\xff\"\n");
  refused(w, "run bad.toml", {"bad.toml:1: "});
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::files_test
