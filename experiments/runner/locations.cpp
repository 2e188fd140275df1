// SPDX-License-Identifier: Zlib
#include "experiments/runner/locations.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "framework/math/check.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {

namespace fs = std::filesystem;

namespace {

bool allDigits(const std::string& text) { return !text.empty() && text.find_first_not_of("0123456789") == text.npos; }

}  // namespace

std::string homeDirectory() {
  const char* home = std::getenv("LPC_HOME");
  return home && *home ? home : LPC_SOURCE_DIR;
}

std::vector<std::string> listToml(const std::string& folder) {
  std::vector<std::string> out;
  const fs::path directory = fs::path(homeDirectory()) / "experiments" / folder;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory, error)) {
    if (entry.path().extension() == ".toml") out.push_back(entry.path().string());
  }
  if (error) throw UserError(directory.string() + ": cannot be read; set LPC_HOME to the directory with experiments/");
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<std::string> chartsOfSweeps() {
  std::vector<std::string> out;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(fs::path(homeDirectory()) / "reports" / "charts", none)) {
    if (entry.path().extension() != ".py") continue;
    std::ifstream in(entry.path());
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    for (const std::string above : {"\n@of_sweeps(\"", "\n@of_asked(\""}) {
      for (std::size_t at = text.find(above); at != text.npos; at = text.find(above, at)) {
        at += above.size();
        out.push_back(text.substr(at, text.find('"', at) - at));
      }
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::string findToml(const std::string& folder, const std::string& nameOrPath) {
  std::error_code ignored;
  if (fs::is_regular_file(nameOrPath, ignored)) return nameOrPath;
  std::vector<std::string> names, numbers;
  const std::string numbered = folder == "scenes" ? "preset_" : "director_";
  for (const std::string& path : listToml(folder)) {
    const std::string name = fs::path(path).stem().string();
    if (name == nameOrPath) return path;
    names.push_back(name);
    if (folder == "sweeps" || !name.starts_with(numbered)) continue;
    numbers.push_back(name.substr(numbered.size()));
    if (numbers.back() == nameOrPath) return path;
  }
  if (!numbers.empty() && allDigits(nameOrPath)) {
    const auto before = [](const auto& a, const auto& b) { return std::pair(a.size(), a) < std::pair(b.size(), b); };
    std::sort(numbers.begin(), numbers.end(), before);  // 2 precedes 10
    throw UserError("there is no " + numbered + nameOrPath + validNames(numbers, ""));
  }
  throw UserError("there is no file '" + nameOrPath + "' and nothing of that name in experiments/" + folder +
                  validNames(names, nameOrPath));
}

std::string findProblems(const std::string& nameOrPath) {
  std::error_code ignored;
  if (fs::is_regular_file(nameOrPath, ignored)) return nameOrPath;
  const fs::path folder = fs::path(homeDirectory()) / "experiments" / "problems";
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension() != ".json") continue;
    if (entry.path().stem() == nameOrPath) return entry.path().string();
    names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  throw UserError("there is no file '" + nameOrPath + "' and nothing of that name in experiments/problems" +
                  validNames(names, nameOrPath));
}

std::string workerPath(const std::string& precision, bool engine) {
  if (precision != "f64" && precision != "f32") {
    throw UserError("unknown precision '" + precision + "'; valid: f64, f32");
  }
  const fs::path program = fs::read_symlink("/proc/self/exe");
  const char* given = std::getenv("LPC_WORKERS");  // tests run a build's workers from a program of their own
  const fs::path path = (given && *given ? fs::path(given) : program.parent_path()) /
                        ((engine ? "lpc-engine-worker-" : "lpc-worker-") + precision);
  if (!fs::exists(path)) {
    const std::string target = precision == "f64" ? "lpc" : "lpc-f32";
    throw UserError(path.string() + " does not exist; build it: cmake --build " +
                    path.parent_path().parent_path().string() + " --target " + target +
                    (engine ? " (configured with -DLPC_BUILD_ORACLES=ON)" : ""));
  }
  return path.string();
}

std::string commitOfSources() {
  const std::string git = "git -C '" + homeDirectory() + "' ";
  const auto first = [](const std::string& command) {
    std::string line;
    if (FILE* pipe = popen((command + " 2>/dev/null").c_str(), "r")) {
      std::array<char, 256> buffer{};
      if (std::fgets(buffer.data(), buffer.size(), pipe)) line = buffer.data();
      pclose(pipe);
    }
    while (!line.empty() && line.back() == '\n') line.pop_back();
    return line;
  };
  const std::string commit = first(git + "rev-parse HEAD");
  return commit.empty() || first(git + "status --porcelain --untracked-files=no").empty() ? commit : commit + "+";
}

}}  // namespace lpc::LPC_PRECISION
