// SPDX-License-Identifier: Zlib
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>

#include "experiments/lpc/command.h"
#include "experiments/runner/pair_corpus.h"
#include "experiments/runner/reproduction.h"
#include "experiments/trial/formats/output_file.h"
#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

namespace fs = std::filesystem;

struct CorpusArguments {
  PairCorpusOptions options;
  std::string folder;
};

void writeWhole(const fs::path& path, const std::string& text) {
  OutputFile file(path.string());
  file.stream() << text, file.finish();
}

void exportCorpus(CorpusArguments& a) {
  for (const int d : a.options.dimensions) {
    if (d != 2 && d != 3) throw UserError("the dimension is " + std::to_string(d) + "; valid: 2, 3");
  }
  if (a.options.cases.empty()) a.options.cases = keptCases();
  if (a.folder.empty()) throw UserError("--export names no folder");
  const fs::path pairs = fs::path(a.folder) / "pairs.json", runner = fs::path(a.folder) / "run.py";
  keepApart({{"the cases", a.options.cases}}, {{"--export", pairs.string()}});
  const PairCorpus made = pairCorpus(a.options);  // before anything is written
  std::error_code error;
  fs::create_directories(a.folder, error);
  if (error) throw UserError(a.folder + ": cannot be made: " + error.message());
  writeWhole(pairs, made.text);
  const bool theirs = fs::exists(runner, error);  // the file may contain the user's changes
  if (!theirs) writeWhole(runner, pairCorpusRunner());
  std::printf("%s: %ld pairs, %ld of them kept cases; %ld left out, of which the referee cannot tell\n",
              pairs.string().c_str(), made.kept + made.drawn, made.kept, made.undecided);
  std::printf("%s: %s\n", runner.string().c_str(), theirs ? "was there and stays" : "fill in one function");
}

void addCorpus(CommandLine& app, Session&) {
  CommandLine command =
      app.subcommand("corpus", "Writes hard pairs with proved distances, and a runner, for the authors of a library");
  auto a = std::make_shared<CorpusArguments>();
  PairCorpusOptions& o = a->options;
  command.option("--export", a->folder, "a folder, made if absent: pairs.json and run.py").required();
  command.option("--pairs", o.pairs, "drawn per two kinds of shape, beside the kept cases")
      .showDefault()
      .range(0L, 1000000L);
  command.option("--seed", o.seed, "of those that are drawn").showDefault().range(0L, std::numeric_limits<long>::max());
  command.option("--dimension", o.dimensions, "of those that are drawn: 2, 3 or both (default)").commaSeparated();
  command.option("--cases", o.cases, "a file of kept cases; default: tests/regressions/hard_cases.json").file();
  command.footer(
      "run.py has a function to be filled in and counts the wrong answers; a run.py that is there stays.\n"
      "Example: lpc corpus --export corpus --pairs 20\n"
      "         python3 corpus/run.py");
  command.callback([a] { exportCorpus(*a); });
}

LPC_COMMAND("corpus", addCorpus);

}  // namespace
}}  // namespace lpc::LPC_PRECISION
