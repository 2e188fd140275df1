// SPDX-License-Identifier: Zlib
// Every path of this project that a page or a comment names must exist.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = LPC_SOURCE_DIR;

// Made by commands, so absent from a fresh checkout.
bool isMade(const std::string& path) { return path.starts_with("reports/out") || path.starts_with("docs/html"); }

// File names of the project, without folders.
const std::set<std::string>& names() {
  static const std::set<std::string> all = [] {
    std::set<std::string> out;
    for (const char* folder : {"framework", "algorithms", "oracles", "experiments", "tests", "reports", "docs"}) {
      for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
        out.insert(entry.path().filename().string());
      }
    }
    return out;
  }();
  return all;
}

// Files that a page tells its reader to create: "```cpp algorithms/velocity/mine.cpp".
const std::set<std::string>& written() {
  static const std::set<std::string> all = [] {
    std::set<std::string> out;
    for (const auto& entry : fs::directory_iterator(kRoot / "docs")) {
      std::ifstream in(entry.path());
      for (std::string line; std::getline(in, line);) {
        if (line.starts_with("```cpp ")) out.insert(line.substr(7));
      }
    }
    return out;
  }();
  return all;
}

// The paths of a text that do not exist: "tests/no_such_test.cpp", or for a source without a folder, "no_such.h".
std::vector<std::string> missing(const std::string& text) {
  static const std::regex path(
      "(^|[^A-Za-z0-9_./>-])(((?:framework|algorithms|oracles|experiments|tests|reports|docs)/[A-Za-z0-9_./"
      "-]*[A-Za-z0-9_])"
      "|([a-z0-9_]+\\.(?:h|cpp|cmake)))(?![A-Za-z0-9_*/<])");
  std::vector<std::string> out;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), path); it != std::sregex_iterator(); ++it) {
    const std::string rooted = (*it)[3], name = (*it)[4];
    if (!rooted.empty() && !isMade(rooted) && !fs::exists(kRoot / rooted) && !written().contains(rooted)) {
      out.push_back(rooted);
    }
    if (!name.empty() && !names().contains(name)) out.push_back(name);
  }
  return out;
}

// The prose of a file: a page without its examples (they may name the reader's own files), or a source's comments.
std::string wordsOf(const std::string& line, const std::string& kind, bool& inExample) {
  if (kind == ".md") {
    const bool fence = line.find("```") != line.npos;
    if (fence) inExample = !inExample;
    return inExample || fence ? "" : line;
  }
  const bool code = kind == ".h" || kind == ".cpp";
  const std::size_t at = line.find(code ? "//" : "#");
  return at == line.npos ? "" : line.substr(at);
}

TEST(Paths, EveryNamedPathExists) {
  std::vector<fs::path> files = {kRoot / "README.md", kRoot / "CHANGELOG.md", kRoot / "CMakeLists.txt"};
  for (const char* folder : {"framework", "algorithms", "oracles", "experiments", "tests", "reports", "docs"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) files.push_back(entry.path());
  }
  static const std::set<std::string> kinds = {".md", ".h", ".cpp", ".py", ".txt", ".cmake", ".toml"};
  int named = 0;
  for (const fs::path& file : files) {
    const std::string shown = fs::relative(file, kRoot).generic_string(), kind = file.extension().string();
    if (!kinds.contains(kind) || isMade(shown) || shown.starts_with("tests/growth/")) continue;
    if (file.filename() == "paths_test.cpp") continue;  // contains made-up paths
    std::ifstream in(file);
    bool inExample = false;
    int number = 0;
    for (std::string line; std::getline(in, line);) {
      ++number;
      const std::string words = wordsOf(line, kind, inExample);
      named += words.find('/') != words.npos;
      for (const std::string& path : missing(words)) ADD_FAILURE() << shown << ":" << number << " names " << path;
    }
  }
  EXPECT_GT(named, 100) << "the files are not read";
}

TEST(Paths, AMissingPathIsFound) {
  using Paths = std::vector<std::string>;
  EXPECT_EQ(missing("see `tests/framework/no_such_test.cpp`."), Paths{"tests/framework/no_such_test.cpp"});
  EXPECT_EQ(missing("(framework/world/world.h, no_such.h)"), Paths{"no_such.h"});
  EXPECT_EQ(missing("framework/world/world.h, tests/run, docs/*.md, experiments/scenes/ and world_step.cpp"), Paths{});
  bool inExample = false;
  EXPECT_EQ(wordsOf("int a;  // framework/x.h", ".cpp", inExample), "// framework/x.h");
  EXPECT_EQ(wordsOf("#include \"framework/x.h\"", ".cpp", inExample), "");
  const std::string page[] = {"a/b", "```", "docs/x.md", "```", "c/d"};
  std::string words;
  for (const std::string& line : page) words += wordsOf(line, ".md", inExample);
  EXPECT_EQ(words, "a/bc/d");
}

}  // namespace
