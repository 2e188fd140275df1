// SPDX-License-Identifier: Zlib
// Commands on existing stores: merge, import-benchmark, report.
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "experiments/lpc/command.h"
#include "experiments/parse/toml_reader.h"
#include "experiments/runner/locations.h"
#include "experiments/runner/store.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

void addMerge(CommandLine& app, Session&) {
  CommandLine command = app.subcommand("merge", "Takes over into one store what others have and it lacks");
  auto into = std::make_shared<std::string>();
  auto from = std::make_shared<std::vector<std::string>>();
  command.option("into", *into, "store, made if absent").required();
  command.option("from", *from, "stores to read").required();
  command.footer("Example: lpc merge results/all.db results/host1.db results/host2.db");
  command.callback([into, from] {
    for (const std::string& path : *from) {  // before anything is made
      const Store check(path, false);
      std::error_code absent;
      if (std::filesystem::equivalent(path, *into, absent)) throw UserError(path + ": a store is merged into itself");
    }
    const bool fresh = !std::filesystem::exists(*into);
    try {
      Store store(*into, true);
      for (const std::string& path : *from) {
        std::printf("%s: %ld trials taken over\n", path.c_str(), store.merge(path));
      }
    } catch (const UserError&) {  // of a damaged store: removes the new one
      std::error_code ignored;
      if (fresh) std::filesystem::remove(*into, ignored);
      throw;
    }
  });
}

void addImport(CommandLine& app, Session&) {
  CommandLine command = app.subcommand("import-benchmark", "Puts the JSON of lpc-bench into a store");
  auto file = std::make_shared<std::string>(), path = std::make_shared<std::string>("results/lpc.db");
  command.option("file", *file, "what lpc-bench --benchmark_out=FILE --benchmark_out_format=json wrote").required();
  command.option("--store", *path, "SQLite file, made if absent").showDefault();
  command.footer("Example: lpc import-benchmark bench.json --store results/quick.db");
  command.callback([file, path] {
    const std::string text = readFile(*file);
    const nlohmann::json j = nlohmann::json::parse(text, nullptr, false);
    if (j.is_discarded() || !j.is_object() || !j.contains("benchmarks") || !j["benchmarks"].is_array()) {
      throw UserError(*file + ": not the JSON of Google Benchmark: it has no list \"benchmarks\"");
    }
    Store(*path, true).addBenchmark(text);
    std::printf("%zu benchmarks imported into %s\n", j["benchmarks"].size(), path->c_str());
  });
}

// A Python with the packages of the report: LPC_PYTHON, else the system's, else the first in PATH.
std::string findPython() {
  const char* given = std::getenv("LPC_PYTHON");
  std::vector<std::string> candidates = {"/usr/bin/python3", "python3"};
  if (given && *given) candidates = {given};
  for (const std::string& python : candidates) {
    const std::string command = "'" + python + "' -c 'import jinja2, matplotlib, numpy, pandas' >/dev/null 2>&1";
    if (std::system(command.c_str()) == 0) return python;
  }
  throw UserError(
      (given && *given ? "LPC_PYTHON=" + candidates[0] + " does not import" : std::string("no python3 imports")) +
      " jinja2, matplotlib, numpy and pandas; valid: LPC_PYTHON=FILE with one that does, or apt-get install "
      "python3-jinja2 python3-matplotlib python3-pandas");
}

int runProgram(const std::vector<std::string>& arguments) {
  std::vector<char*> argv;
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  std::fflush(nullptr);
  const pid_t parent = getpid(), pid = fork();
  if (pid == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);     // it ends with this process
    if (getppid() != parent) _exit(127);  // the parent died before the line above
    execvp(argv[0], argv.data());
    _exit(127);
  }
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

void addReport(CommandLine& app, Session& session) {
  CommandLine command = app.subcommand("report", "Makes charts and a web page of a store");
  auto store = std::make_shared<std::string>(), out = std::make_shared<std::string>();
  auto taken = std::make_shared<bool>(false);
  command.option("store", *store, "SQLite file").required();
  command.option("--out", *out, "folder; default: reports/out/<name of the store>");
  command.flag("--taken", *taken, "no page: prints the pipeline that choose takes and has not yet run as a whole");
  command.footer("Example: lpc report results/quick.db");
  command.callback([store, out, taken, &session] {
    namespace fs = std::filesystem;
    const fs::path home = homeDirectory();
    if (*taken) {
      session.exitCode =
          runProgram({findPython(), (home / "reports" / "make.py").string(), "--store", *store, "--taken"});
      return;
    }
    const fs::path folder = out->empty() ? home / "reports" / "out" / fs::path(*store).stem() : fs::path(*out);
    session.exitCode = runProgram(
        {findPython(), (home / "reports" / "make.py").string(), "--store", *store, "--out", folder.string()});
  });
}

static const CommandRegistrar mergeRegistrar("merge", addMerge);
static const CommandRegistrar importRegistrar("import-benchmark", addImport);
static const CommandRegistrar reportRegistrar("report", addReport);

}  // namespace
}}  // namespace lpc::LPC_PRECISION
