// SPDX-License-Identifier: Zlib
// Commands on existing stores: merge, import-benchmark, report.
#include <fcntl.h>
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
#include "experiments/runner/catalogue.h"
#include "experiments/runner/child.h"
#include "experiments/runner/locations.h"
#include "experiments/runner/store.h"
#include "experiments/runner/worker_pool.h"
#include "framework/math/nesting.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

using nlohmann::json;

void addMerge(CommandLine& app, Session&) {
  CommandLine command = app.subcommand("merge", "Copies into one store the results that it lacks and others have");
  auto into = std::make_shared<std::string>();
  auto from = std::make_shared<std::vector<std::string>>();
  command.option("into", *into, "store to write, created if absent").required();
  command.option("from", *from, "stores to read").required();
  command.footer("Example: lpc merge results/all.db results/host1.db results/host2.db");
  command.callback([into, from] {
    for (const std::string& path : *from) {  // before anything is made
      const Store check(path, false);
      std::error_code absent;
      if (std::filesystem::equivalent(path, *into, absent))
        throw UserError(path + ": the store to write is also a store to read; valid: different stores");
    }
    std::error_code none;
    const bool fresh = !std::filesystem::exists(*into, none);
    try {
      Store store(*into, true);
      for (const std::string& path : *from) {
        std::printf("%s: %ld trials copied\n", path.c_str(), store.merge(path));
      }
    } catch (const UserError&) {  // of a damaged store: removes the new one
      std::error_code ignored;
      if (fresh) std::filesystem::remove(*into, ignored);
      throw;
    }
  });
}

// The fields that the report reads. Other entries, such as a fit of the complexity, may have any.
void checkBenchmark(const json& entry, const std::string& place) {
  const auto fail = [&](const std::string& what) { throw UserError(place + what); };
  if (!entry.is_object()) fail("it is not an object");
  const auto text = [&](const char* name) {
    if (entry.contains(name) && !entry.at(name).is_string()) fail(std::string("'") + name + "' is not a text");
    return entry.value(name, std::string());
  };
  constexpr std::size_t kLongest = 300;  // bytes of a name; a chart has room for it
  if (!entry.contains("name")) fail("'name' is missing");
  for (const char* name : {"name", "run_name"}) {
    if (text(name).size() > kLongest) fail(std::string("'") + name + "' has more than 300 bytes");
  }
  const std::string kind = text("run_type"), unit = text("time_unit");
  if (text("aggregate_name") != "median" && kind != "iteration" && !kind.empty()) return;
  if (entry.contains("error_occurred") && entry.at("error_occurred") == true) {
    text("error_message");
    return;
  }
  for (const char* clock : {"cpu_time", "real_time"}) {
    if (!entry.contains(clock)) fail(std::string("'") + clock + "' is missing");
    const json& time = entry.at(clock);
    if (!time.is_number() || !(time.get<double>() >= 0)) fail(std::string("'") + clock + "' is not a number >= 0");
  }
  if (!unit.empty() && unit != "ns" && unit != "us" && unit != "ms" && unit != "s") {
    fail("'time_unit' is '" + unit + "'; valid: ns, us, ms, s");
  }
}

json readBenchmarks(const std::string& file, const std::string& text) {
  const json j = json::parse(
      text,
      [&](int depth, json::parse_event_t, const json&) {
        if (depth > kMostNested) throw UserError(file + ": nested more than " + std::to_string(kMostNested) + " deep");
        return true;
      },
      false);
  if (j.is_discarded() || !j.is_object() || !j.contains("benchmarks") || !j["benchmarks"].is_array()) {
    throw UserError(file + ": not JSON of Google Benchmark: the list \"benchmarks\" is missing");
  }
  const json context = j.value("context", json::object());
  if (!context.is_object()) throw UserError(file + ": \"context\" is not an object");
  for (const json& load : context.value("load_avg", json::array())) {
    if (!load.is_number()) throw UserError(file + ": \"load_avg\" holds " + load.dump() + "; valid: numbers");
  }
  for (std::size_t i = 0; i < j["benchmarks"].size(); ++i) {
    checkBenchmark(j["benchmarks"][i], file + ": benchmark " + std::to_string(i) + ": ");
  }
  return j;
}

void addImport(CommandLine& app, Session&) {
  CommandLine command = app.subcommand("import-benchmark", "Imports JSON results of lpc-bench into a store");
  auto file = std::make_shared<std::string>(), path = std::make_shared<std::string>("results/lpc.db");
  command.option("file", *file, "file written by lpc-bench --benchmark_out=FILE --benchmark_out_format=json")
      .required();
  command.option("--store", *path, "SQLite file, created if absent").showDefault();
  command.footer("Example: lpc import-benchmark bench.json --store results/quick.db");
  command.callback([file, path] {
    const std::string text = readFile(*file);
    const json j = readBenchmarks(*file, text);
    Store store(*path, true);
    describeProgram(store);  // for a report of a store that holds nothing else
    store.addBenchmark(text);
    std::printf("%zu benchmarks imported into %s\n", j["benchmarks"].size(), path->c_str());
  });
}

[[noreturn]] void become(const std::vector<std::string>& arguments) {
  std::vector<char*> argv;
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  execvp(argv[0], argv.data());
  _exit(127);
}

// Runs a program to its end, and ends it with this process: an interrupt ends both.
int runProgram(const std::vector<std::string>& arguments, bool silent = false) {
  std::fflush(nullptr);
  const pid_t parent = getpid(), pid = fork();
  if (pid == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(127);  // the parent died before the line above
    if (const int none = silent ? open("/dev/null", O_WRONLY) : -1; none >= 0) dup2(none, 1), dup2(none, 2);
    become(arguments);
  }
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// A Python with the packages of the report: LPC_PYTHON, else the system's, else the first in PATH.
std::string findPython() {
  const char* given = std::getenv("LPC_PYTHON");
  std::vector<std::string> candidates = {"/usr/bin/python3", "python3"};
  if (given && *given) candidates = {given};
  for (const std::string& python : candidates) {
    const int end = runProgram({python, "-c", "import jinja2, matplotlib, numpy, pandas"}, true);
    if (end == 0) return python;
    if (end == 128 + SIGINT || end == 128 + SIGTERM) throw Interrupted();  // and no search for another
  }
  throw UserError(
      (given && *given ? "LPC_PYTHON=" + candidates[0] + " does not import" : std::string("no python3 imports")) +
      " jinja2, matplotlib, numpy and pandas; valid: LPC_PYTHON=FILE with one that does, or apt-get install "
      "python3-jinja2 python3-matplotlib python3-pandas");
}

void addReport(CommandLine& app, Session& session) {
  CommandLine command = app.subcommand("report", "Makes a web page with charts from a store");
  auto store = std::make_shared<std::string>(), out = std::make_shared<std::string>();
  auto taken = std::make_shared<bool>(false);
  command.option("store", *store, "SQLite file").required();
  command.option("--out", *out, "output folder; default: reports/out/<name of the store>");
  command.flag("--taken", *taken, "no page: prints the pipeline that `choose` selects and has not run as a whole yet");
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
