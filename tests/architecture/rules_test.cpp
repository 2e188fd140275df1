// SPDX-License-Identifier: Zlib
// The rules of the house, read off the sources: who includes whom, how long a file is, what must not be used.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace {

namespace fs = std::filesystem;

struct Source {
  std::string path;  // relative to the project, with /
  std::vector<std::string> lines;
};

const std::vector<Source>& sources() {
  static const std::vector<Source> all = [] {
    std::vector<Source> out;
    const fs::path root = LPC_SOURCE_DIR;
    for (const char* folder : {"framework", "algorithms", "oracles", "experiments", "tests", "reports"}) {
      for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
        static const std::set<std::string> kinds = {".h", ".cpp", ".py", ".txt", ".toml"};
        if (!entry.is_regular_file() || !kinds.contains(entry.path().extension())) continue;
        Source s{fs::relative(entry.path(), root).generic_string(), {}};
        if (s.path.starts_with("reports/out/")) continue;
        std::ifstream in(entry.path());
        for (std::string line; std::getline(in, line);) s.lines.push_back(line);
        out.push_back(std::move(s));
      }
    }
    std::sort(out.begin(), out.end(), [](const Source& a, const Source& b) { return a.path < b.path; });
    return out;
  }();
  return all;
}

bool isCode(const Source& s) { return s.path.ends_with(".cpp") || s.path.ends_with(".h"); }
bool in(const Source& s, const std::string& folder) { return s.path.starts_with(folder + "/"); }

// Stage folders that may share kernel headers.
std::string group(const std::string& path) {
  static const std::regex stage("algorithms/([a-z_]+)/.*");
  std::smatch m;
  if (!std::regex_match(path, m, stage)) return "";
  static const std::vector<std::set<std::string>> groups = {{"broadphase"},
                                                            {"pair_query", "contacts", "cache"},
                                                            {"solver", "velocity", "position", "integrator"},
                                                            {"sleep"},
                                                            {"continuous"}};
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i].contains(m[1])) return "group " + std::to_string(i);
  }
  return "unknown group " + m[1].str();
}

// What is wrong with including `target` from `file`; empty when nothing is.
std::string includeFault(const std::string& file, const std::string& target) {
  const auto from = [&](const std::string& folder) { return file.starts_with(folder + "/"); };
  const auto to = [&](const std::string& folder) { return target.starts_with(folder + "/"); };
  const bool ours = to("framework") || to("algorithms") || to("oracles") || to("experiments") || to("tests");
  const bool source = file.ends_with(".cpp");
  if (target.ends_with(".cpp")) return "a .cpp is included by nobody";
  static const std::set<std::string> third = {"fcl/",       "ccd/",     "btBullet",  "BulletCollision/", "gtest/",
                                              "rapidcheck", "CLI/",     "nlohmann/", "SQLiteCpp/",       "toml++",
                                              "benchmark/", "muParser", "fmt/",      "libqhull",         "xxhash",
                                              "hwy/",       "toml.hpp", "gmp"};
  std::string library;
  for (const std::string& t : third) {
    if (target.starts_with(t)) library = t;
  }
  if (from("framework")) {
    if (ours && !to("framework")) return "framework includes only framework, the standard library and Eigen";
    const bool allowed = source && (library == "libqhull" || library == "xxhash");
    if (!library.empty() && !allowed)
      return "framework: third-party headers are Eigen, and in .cpp files Qhull and xxHash";
  }
  if (from("algorithms")) {
    if (ours && !to("framework") && !to("algorithms")) return "algorithms include only framework and their group";
    if (to("algorithms") && group(file) != group(target)) return "a kernel header of another group";
    if (!library.empty() && library != "hwy/") return "algorithms: the only third-party headers are Eigen and Highway";
  }
  if (from("oracles")) {
    if (ours && !to("framework") && !to("oracles")) return "oracles include only framework and third-party libraries";
    if (!library.empty() && !source) return "oracles: third-party headers only in .cpp files";
  }
  if (from("experiments") && to("algorithms")) return "experiments know algorithms only by name, through the registry";
  if (!from("tests") && to("tests")) return "only tests include tests";
  return "";
}

std::string includeTarget(const std::string& line) {
  static const std::regex include("^\\s*#\\s*include\\s+[<\"]([^>\"]+)[>\"].*");
  std::smatch m;
  return std::regex_match(line, m, include) ? m[1].str() : "";
}

// Words that would make a result depend on the machine, the compiler or the address of an object.
std::string denied(const std::string& line) {
  static const std::regex words(
      "\\b(MulAdd|MulSub|NegMulAdd|NegMul|SumOfLanes|ReduceSum|Approximate\\w*|std::fma|std::hypot|s?rand\\(\\)|"
      "std::\\w+_distribution|std::unordered_\\w+|random_device)|-ffast-math|-march");
  const std::string code = line.substr(0, line.find("//"));
  std::smatch m;
  return std::regex_search(code, m, words) ? m.str() : "";
}

TEST(Rules, FilesAreFound) { EXPECT_GT(sources().size(), 50u); }

TEST(Rules, Includes) {
  for (const Source& s : sources()) {
    if (!isCode(s)) continue;
    for (const std::string& line : s.lines) {
      const std::string target = includeTarget(line);
      const std::string fault = target.empty() ? "" : includeFault(s.path, target);
      EXPECT_EQ(fault, "") << s.path << " includes " << target;
    }
  }
}

TEST(Rules, IncludeRulesCatchBreaches) {
  EXPECT_NE(includeFault("framework/world.cpp", "algorithms/broadphase/naive.cpp"), "");
  EXPECT_NE(includeFault("framework/shape.h", "libqhull_r/qhull_ra.h"), "");
  EXPECT_EQ(includeFault("framework/polytope.cpp", "libqhull_r/qhull_ra.h"), "");
  EXPECT_NE(includeFault("algorithms/velocity/catto.cpp", "algorithms/pair_query/gjk_simplex3.h"), "");
  EXPECT_EQ(includeFault("algorithms/velocity/catto.cpp", "algorithms/solver/contact_rows.h"), "");
  EXPECT_NE(includeFault("algorithms/velocity/catto.cpp", "fcl/fcl.h"), "");
  EXPECT_NE(includeFault("oracles/jury.h", "fcl/fcl.h"), "");
  EXPECT_NE(includeFault("experiments/lpc/run.cpp", "algorithms/solver/contact_rows.h"), "");
  EXPECT_NE(includeFault("experiments/lpc/run.cpp", "tests/generators.h"), "");
}

TEST(Rules, FileLength) {
  for (const Source& s : sources()) EXPECT_LE(s.lines.size(), 500u) << s.path << " is a room too full: split it";
}

TEST(Rules, DenyList) {
  for (const Source& s : sources()) {
    if (!isCode(s) || (!in(s, "framework") && !in(s, "algorithms"))) continue;
    for (std::size_t i = 0; i < s.lines.size(); ++i) {
      EXPECT_EQ(denied(s.lines[i]), "") << s.path << ":" << i + 1;
    }
  }
  EXPECT_NE(denied("x = std::fma(a, b, c);"), "");
  EXPECT_NE(denied("std::uniform_real_distribution<double> d;"), "");
  EXPECT_EQ(denied("// never std::fma"), "");
}

TEST(Rules, EverySourceStartsWithItsLicence) {
  for (const Source& s : sources()) {
    if (!isCode(s) || s.path.starts_with("tests/embedding/")) continue;
    ASSERT_FALSE(s.lines.empty()) << s.path;
    EXPECT_EQ(s.lines[0], "// SPDX-License-Identifier: Zlib") << s.path;
  }
}

TEST(Rules, NoVagueNames) {
  static const std::regex vague("(.*/)?[a-z_]*(utils?|helpers?|common|misc|manager)[a-z_]*\\.(h|cpp|py)");
  for (const Source& s : sources()) EXPECT_FALSE(std::regex_match(s.path, vague)) << s.path;
}

TEST(Rules, NothingUnfinished) {
  const std::string words[] = {std::string("TO") + "DO", std::string("FIX") + "ME", std::string("XX") + "X:"};
  for (const Source& s : sources()) {
    for (std::size_t i = 0; i < s.lines.size(); ++i) {
      for (const std::string& w : words) {
        EXPECT_EQ(s.lines[i].find(w), std::string::npos) << s.path << ":" << i + 1;
      }
    }
  }
}

}  // namespace
