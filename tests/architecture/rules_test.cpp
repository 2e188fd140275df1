// SPDX-License-Identifier: Zlib
// The rules of the project, checked on the sources: allowed includes, length of files, forbidden words.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "framework/stage/stages.h"

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

// Prefixes of what files under a folder may include, beside the standard library. A row "folder/." holds for the files
// directly in the folder. Rows add up.
struct Allowance {
  std::string folder;
  std::vector<std::string> everywhere, inSources;
};
const std::vector<std::string> kPosix = {"dlfcn.h", "fcntl.h",     "poll.h", "sched.h",
                                         "sys/",    "semaphore.h", "time.h", "unistd.h"};
// glibc's information about an allocated block: a program may count its memory.
const std::vector<std::string> kAllocator = {"malloc.h"};
const std::vector<Allowance> kAllowances = {
    {"framework/", {"Eigen/", "framework/math/"}, {}},
    {"framework/math/", {}, {}},
    {"framework/shape/", {"framework/shape/"}, {"libqhull_r/"}},
    // Contracts name the records that they get, and the kind of a joint or a force is a contract.
    {"framework/stage/", {"framework/shape/", "framework/stage/", "framework/problem/"}, {}},
    {"framework/problem/", {"framework/shape/", "framework/stage/", "framework/problem/"}, {}},
    {"framework/world/",
     {"framework/shape/", "framework/stage/", "framework/problem/", "framework/world/"},
     {"xxhash.h"}},
    {"framework/scene/", {"framework/world/", "framework/scene/"}, {}},
    {"framework/draw/", {"framework/shape/", "framework/stage/", "framework/problem/", "framework/world/"}, {}},
    {"framework/draw/", {"framework/draw/"}, {}},
    // Methods do not know the world. Beside these prefixes they may include the kernel headers of their own group.
    {"algorithms/",
     {"framework/math/", "framework/shape/", "framework/stage/", "framework/problem/", "Eigen/", "hwy/"},
     {}},
    {"oracles/", {"framework/", "Eigen/"}, {}},
    {"oracles/referee/", {"oracles/referee/"}, {"gmpxx.h"}},
    {"oracles/corpus/", {"oracles/referee/", "oracles/corpus/"}, {"nlohmann/"}},
    {"oracles/witnesses/", {"oracles/referee/", "oracles/witnesses/"}, kPosix},
    {"oracles/witnesses/", {}, {"fcl/", "ccd/", "BulletCollision/", "ode/", "box2d/", "chipmunk/", "siconos/"}},
    {"oracles/verify/", {"oracles/referee/", "oracles/corpus/", "oracles/witnesses/", "oracles/verify/"}, {}},
    {"oracles/engines/", {"oracles/engines/"}, {"BulletDynamics/", "BulletCollision/", "LinearMath/", "box2d/"}},
    {"experiments/", {"framework/", "Eigen/"}, {}},
    {"experiments/parse/", {"experiments/parse/"}, {}},
    {"experiments/trial/formats/", {"oracles/", "experiments/parse/", "experiments/trial/formats/"}, {}},
    {"experiments/trial/scene/", {"experiments/parse/", "experiments/trial/formats/", "experiments/trial/scene/"}, {}},
    {"experiments/trial/measure/", {"experiments/trial/scene/", "experiments/trial/measure/"}, {}},
    {"experiments/trial/.", {"oracles/", "experiments/parse/", "experiments/trial/"}, {}},
    {"experiments/runner/", {"oracles/", "experiments/parse/", "experiments/trial/", "experiments/runner/"}, {}},
    {"experiments/film/", {"experiments/trial/", "experiments/runner/", "experiments/film/"}, {}},
    {"experiments/lpc/", {"oracles/", "experiments/parse/", "experiments/trial/", "experiments/runner/"}, {}},
    {"experiments/lpc/", {"experiments/film/", "experiments/lpc/"}, {}},
    {"experiments/sandbox/", {"experiments/parse/", "experiments/trial/", "experiments/runner/"}, {}},
    {"experiments/sandbox/", {"experiments/film/", "experiments/sandbox/"}, {}},
    {"experiments/bench/", {"oracles/", "experiments/trial/", "experiments/bench/"}, {}},
    {"experiments/view/", {"experiments/sandbox/", "lpc/"}, {}},
    {"experiments/dominoes/", {"lpc/"}, {}},
    {"experiments/heritage/", {}, {}},
    {"experiments/", {"CLI/", "SQLiteCpp/", "nlohmann/", "toml++/", "sys/types.h"}, kPosix},
    {"experiments/", {}, {"fmt/", "muParser.h", "png.h", "sqlite3.h", "xxhash.h", "content_hashes.inc"}},
    {"experiments/", {}, {"assimp/", "fclib.h", "hdf5.h", "hdf5_hl.h"}},
    {"experiments/trial/measure/", {}, kAllocator},
    {"experiments/sandbox/", {"SDL2/"}, {"backends/imgui", "epoxy/", "imgui.h", "imgui_stdlib.h", "link.h"}},
    {"experiments/bench/", {"benchmark/"}, {"BulletCollision/", "BulletDynamics/", "LinearMath/"}},
    {"experiments/bench/", {}, {"box2d/", "chipmunk/", "ode/"}},
    {"tests/", {""}, {}},
};

// Why `file` may not include `target`; empty if it may.
std::string includeFault(const std::string& file, const std::string& target) {
  if (target.ends_with(".cpp")) return "a .cpp is included by nobody";
  if (file.starts_with("algorithms/")) {
    const lpc::StageInfo *from = lpc::stageOfPath(file), *to = lpc::stageOfPath(target);
    if (!from) return "its folder is no stage's: framework/stage/stages.h has the list";
    if (to) return to->group == from->group ? "" : "a kernel header of another group";
  }
  if (target.find_first_of("/.") == target.npos) return "";  // <vector>: the standard library
  std::string valid = "the standard library";
  for (const Allowance& row : kAllowances) {
    const bool itself = row.folder.ends_with("/.");
    if (itself ? fs::path(file).parent_path() / "." != row.folder : !file.starts_with(row.folder)) continue;
    auto allowed = row.everywhere;
    if (file.ends_with(".cpp")) allowed.insert(allowed.end(), row.inSources.begin(), row.inSources.end());
    for (const std::string& beginning : allowed) {
      if (target.starts_with(beginning)) return "";
      valid += ", " + beginning;
    }
  }
  return "it may include: " + valid;
}

std::string includeTarget(const std::string& line) {
  static const std::regex include("^\\s*#\\s*include\\s+[<\"]([^>\"]+)[>\"].*");
  std::smatch m;
  return std::regex_match(line, m, include) ? m[1].str() : "";
}

// Columns of a line in UTF-8: bytes that begin a character.
std::size_t columns(const std::string& line) {
  return static_cast<std::size_t>(
      std::count_if(line.begin(), line.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

// A word that would make a result depend on the machine, the compiler or an address.
std::string denied(const std::string& line) {
  static const std::regex words(
      "\\b(MulAdd|MulSub|NegMulAdd|NegMul|SumOfLanes|ReduceSum|Approximate\\w*|std::fma|std::hypot|s?rand\\(\\)|"
      "std::\\w+_distribution|std::unordered_\\w+|random_device)|-ffast-math|-march");
  const std::string code = line.substr(0, line.find("//"));
  std::smatch m;
  return std::regex_search(code, m, words) ? m.str() : "";
}

// Kernels with named and explained tolerances, in the group's own file.
bool namesItsTolerances(const Source& s) {
  static const std::set<std::string> files = {"framework/shape/compound.cpp", "framework/shape/polytope.cpp",
                                              "framework/world/saved_state.cpp", "framework/shape/support_gap.h",
                                              "framework/shape/shape_query.cpp"};
  if (!isCode(s) || s.path.ends_with("tolerances.h")) return false;
  return in(s, "algorithms/pair_query") || in(s, "algorithms/contacts") || files.contains(s.path);
}

// A bare tolerance: a number that is small or close to an integer, a multiple of a rounding, or a cap on iterations. A
// half is geometry, and the range of a parameter is no tolerance.
std::string bareTolerance(const std::string& line) {
  static const std::regex words(
      "[0-9.]+[eE][-+]?[0-9]+|\\.(?![05]0*f?\\b)[0-9]+f?\\b|"
      "[0-9]\\)? *\\* *kEpsilon|kEpsilon *\\* *[0-9]|epsilon\\(\\)|"
      "\\bconst(expr)? \\w+ k(Most|Max)\\w*(Steps|Rounds|Iterations)\\b");
  const std::string code = line.substr(0, line.find("//"));
  static const std::regex parameter("^ *v\\.(real|integer)\\(.*");
  std::smatch m;
  return !std::regex_match(code, parameter) && std::regex_search(code, m, words) ? m.str() : "";
}

// What is missing in the comment above a constant of a tolerances.h: unit, meaning or danger. One comment may serve
// several constants.
std::vector<std::string> unexplained(const std::vector<std::string>& lines) {
  static const std::regex constant("inline const(?:expr)? [\\w:]+ (k[A-Z]\\w*).*");
  std::vector<std::string> faults;
  std::string comment;
  bool complete = false;
  for (const std::string& line : lines) {
    std::smatch m;
    if (line.starts_with("///")) {
      if (complete) comment.clear();
      comment += line, complete = false;
    } else if (std::regex_match(line, m, constant)) {
      complete = true;
      for (const char* part : {"(", "arger", "maller"}) {
        if (comment.find(part) == comment.npos) faults.push_back(m[1].str() + " lacks " + part);
      }
    } else if (line.empty()) {
      comment.clear();
    } else if (line.find(" k") != line.npos && line.starts_with("inline")) {
      faults.push_back(line);  // a form that this rule cannot parse
    }
  }
  return faults;
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

// A sweep is planned in double precision, and writes every parameter into trials of single precision, too. They would
// get the wrong default if it depended on the precision. Such a parameter has a value that means "by precision".
TEST(Rules, NoDefaultDependsOnThePrecision) {
  const std::regex member(" +(Real|int|double) .*= .*(sizeof\\(Real\\)|kDouble).*");
  EXPECT_TRUE(std::regex_match("    Real cfm = sizeof(Real) == 8 ? Real(1e-7) : Real(1e-3);", member));
  for (const Source& s : sources()) {
    if (!s.path.starts_with("algorithms/")) continue;
    for (const std::string& line : s.lines) EXPECT_FALSE(std::regex_match(line, member)) << s.path << ": " << line;
  }
}

TEST(Rules, IncludeRulesCatchBreaches) {
  const std::pair<const char*, const char*> breaches[] = {
      {"framework/world/world.cpp", "algorithms/broadphase/naive.cpp"},
      {"tests/framework/world_test.cpp", "algorithms/broadphase/naive.cpp"},
      {"framework/world/world.cpp", "algorithms/solver/rows/contact_rows.h"},
      {"framework/shape/shape.h", "libqhull_r/qhull_ra.h"},
      {"framework/stage/spec.cpp", "oracles/verify/verify.h"},
      {"framework/stage/spec.cpp", "fmt/format.h"},
      {"framework/stage/spec.cpp", "unistd.h"},
      {"framework/stage/spec.cpp", "boost/container/flat_map.hpp"},  // in no list
      {"framework/stage/spec.cpp", "spec.h"},                        // paths start at the root
      {"framework/math/space.h", "framework/shape/shape.h"},
      {"framework/shape/shape.cpp", "framework/problem/body.h"},
      {"framework/stage/stage_solver.h", "framework/world/world.h"},
      {"framework/problem/contact.h", "framework/world/simulation.h"},
      {"framework/world/world.h", "framework/draw/debug_draw.h"},
      {"framework/scene/director.h", "framework/draw/debug_draw.h"},
      {"framework/draw/debug_draw.h", "framework/scene/director.h"},
      {"framework/new_room/x.h", "framework/world/world.h"},
      {"algorithms/velocity/catto.cpp", "framework/world/world.h"},
      {"algorithms/velocity/catto.cpp", "algorithms/pair_query/gjk/gjk_simplex3.h"},
      {"algorithms/sleep/none.cpp", "algorithms/solver/rows/contact_rows.h"},
      {"algorithms/velocity/catto.cpp", "algorithms/rows.h"},
      {"algorithms/velocity/catto.cpp", "fcl/fcl.h"},
      {"algorithms/velocity/catto.cpp", "experiments/trial/trial.h"},
      {"algorithms/no_stage/x.cpp", "framework/world/world.h"},
      {"oracles/witnesses/witness.h", "fcl/fcl.h"},
      {"oracles/witnesses/fcl.cpp", "algorithms/pair_query/core/touching.h"},
      {"oracles/witnesses/fcl.cpp", "experiments/trial/trial.h"},
      {"oracles/witnesses/witness.h", "box2d/box2d.h"},
      {"oracles/referee/referee.h", "oracles/witnesses/witness.h"},  // the referee does not depend on witnesses
      {"oracles/corpus/cases.cpp", "oracles/verify/verify.h"},
      {"oracles/witnesses/fcl.cpp", "oracles/corpus/hard_pairs.h"},
      {"oracles/engines/box2d.cpp", "oracles/witnesses/witness.h"},
      {"oracles/verify/verify.cpp", "fcl/fcl.h"},
      {"oracles/witnesses/fcl.cpp", "boost/container/flat_map.hpp"},
      {"experiments/lpc/run.cpp", "algorithms/solver/rows/contact_rows.h"},
      {"experiments/trial/formats/mesh_file.h", "experiments/trial/trial.h"},
      {"experiments/trial/measure/edge.cpp", "experiments/trial/trial.h"},
      {"experiments/trial/trial.h", "experiments/runner/store.h"},
      {"experiments/runner/store.cpp", "experiments/film/film.h"},
      {"experiments/film/film.h", "experiments/sandbox/view.h"},
      {"experiments/lpc/run.cpp", "tests/generators.h"},
      {"experiments/lpc/run.cpp", "fcl/fcl.h"},
      {"experiments/bench/main.cpp", "fcl/fcl.h"},
      {"experiments/runner/store.h", "fmt/format.h"},
      {"experiments/lpc/run.cpp", "SDL2/SDL.h"},
      {"experiments/sandbox/window.h", "imgui.h"}};
  for (const auto& [file, target] : breaches) EXPECT_NE(includeFault(file, target), "") << file << " -> " << target;
  EXPECT_EQ(includeFault("framework/shape/polytope.cpp", "libqhull_r/qhull_ra.h"), "");
  EXPECT_EQ(includeFault("algorithms/velocity/catto.cpp", "algorithms/solver/rows/contact_rows.h"), "");
  EXPECT_EQ(includeFault("algorithms/contacts/query_clip.cpp", "algorithms/pair_query/core/touching.h"), "");
}

// A source outside these folders would be in no list of CMake, and would not be compiled.
TEST(Rules, EverySourceIsInAFolderWithARule) {
  const auto stands = [](const std::string& file) {
    return std::any_of(kAllowances.begin(), kAllowances.end(), [&](const Allowance& row) {
      const std::string folder = row.folder.ends_with("/.") ? row.folder.substr(0, row.folder.size() - 1) : row.folder;
      const bool whole = std::count(folder.begin(), folder.end(), '/') > 1;
      return whole && fs::path(file).parent_path() / "" == folder;
    });
  };
  int read = 0;
  for (const Source& s : sources()) {
    if (!isCode(s) || (!in(s, "framework") && !in(s, "oracles") && !in(s, "experiments"))) continue;
    ++read;
    EXPECT_TRUE(stands(s.path)) << s.path;
  }
  EXPECT_GT(read, 300);
  EXPECT_TRUE(stands("framework/math/space.h"));
  for (const char* breach : {"framework/x.cpp", "oracles/x.cpp", "experiments/x.cpp", "experiments/trial/new/x.cpp"}) {
    EXPECT_FALSE(stands(breach)) << breach;
  }
}

TEST(Rules, AlgorithmFoldersAreThoseOfStages) {
  std::set<std::string> folders, names;
  for (const auto& entry : fs::directory_iterator(LPC_SOURCE_DIR "/algorithms")) {
    if (entry.is_directory()) folders.insert(entry.path().filename().string());
  }
  for (const lpc::StageInfo& stage : lpc::kStages) {
    if (lpc::isOurs(stage)) names.emplace(stage.name);
  }
  EXPECT_EQ(folders, names);
}

TEST(Rules, FileLength) {
  for (const Source& s : sources()) EXPECT_LE(s.lines.size(), 500u) << s.path << " is a room too full: split it";
}

// clang-format keeps lines of C++ short; Python has no such tool here.
TEST(Rules, PythonLinesAreShort) {
  EXPECT_EQ(columns(std::string(130, 'x')), 130u);
  EXPECT_EQ(columns("\xE2\x80\x93 \xC2\xB5s"), 4u);  // a dash and a micro sign are one column each
  int read = 0;
  for (const Source& s : sources()) {
    if (!s.path.ends_with(".py")) continue;
    ++read;
    for (std::size_t i = 0; i < s.lines.size(); ++i) {
      EXPECT_LE(columns(s.lines[i]), 130u) << s.path << ":" << i + 1 << " is too long";
    }
  }
  EXPECT_GT(read, 30);
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

TEST(Rules, TolerancesHaveNames) {
  int read = 0;
  for (const Source& s : sources()) {
    if (!namesItsTolerances(s)) continue;
    ++read;
    for (std::size_t i = 0; i < s.lines.size(); ++i) {
      EXPECT_EQ(bareTolerance(s.lines[i]), "") << s.path << ":" << i + 1 << " belongs into the group's tolerances.h";
    }
  }
  EXPECT_GT(read, 30);
  for (const char* breach : {"if (gap < 1e-9) return;", "x > Real(1.5E-8)", "a < Real(0.98)", "a < .98f",
                             "gain > Real(1.02) * best", "const Real tie = 4 * kEpsilon * scale;",
                             "Real(16) * kEpsilon", "kEpsilon * 8", "constexpr int kMostSteps = 64;",
                             "std::numeric_limits<Real>::epsilon() * length", "constexpr Real kNear = Real(1e-6);"}) {
    EXPECT_NE(bareTolerance(breach), "") << breach;
  }
  for (const char* fine :
       {"center = lo + Real(0.5) * (hi - lo);", "// below 1e-9 m it is noise", "x = 2 * kHalf;",
        "v.real(\"tolerance\", tolerance, kEpsilon, Real(0.1), \"1\",", "for (double x : {1.0, 2.0})",
        "const Real flat = kFlat * pair.scale;", "answer.pA = base.p0;"}) {
    EXPECT_EQ(bareTolerance(fine), "") << fine;
  }
}

TEST(Rules, TolerancesHaveMeanings) {
  int read = 0;
  for (const Source& s : sources()) {
    if (!isCode(s) || !s.path.ends_with("tolerances.h")) continue;
    ++read;
    EXPECT_EQ(unexplained(s.lines), std::vector<std::string>()) << s.path;
  }
  EXPECT_GE(read, 4);
  const std::string whole = "/// Lengths below it are noise (m). Larger: blunt. Smaller: noise.";
  const std::string first = "inline constexpr Real kFirst = Real(1e-9);", second = "inline const Real kSecond = 1;";
  EXPECT_TRUE(unexplained({whole, first, second, "", whole, second}).empty());
  EXPECT_EQ(unexplained({whole, first, "", second}).size(), 3u);
  EXPECT_EQ(unexplained({whole, first, "/// (m)", second}).size(), 2u);
  EXPECT_EQ(unexplained({"/// Larger: blunt. Smaller: noise.", first}).size(), 1u);
  EXPECT_EQ(unexplained({whole, "inline static Real kThird = 1;"}).size(), 1u);
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
