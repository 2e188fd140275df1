// SPDX-License-Identifier: Zlib
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <sstream>

#include "experiments/lpc/command.h"
#include "experiments/runner/case_replay.h"
#include "experiments/runner/catalogue.h"
#include "experiments/runner/ledger_table.h"
#include "experiments/runner/reproduction.h"
#include "experiments/runner/verification.h"
#include "experiments/trial/formats/output_file.h"
#include "framework/math/check.h"
#include "framework/math/names.h"
#include "oracles/verify/case_run.h"
#include "oracles/verify/verdict.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

struct Arguments {
  VerificationOptions options;
  std::vector<std::string> stages;
  std::string role = "all", store = "results/verify.db", cases, csv;
  std::string repro, witness, out;
  bool storeNamed = false;
};

StageKind verifiedStage(const std::string& name) {
  std::vector<std::string> names;
  for (const StageKind stage : kVerifiedStages) {
    if (name == stageName(stage)) return stage;
    names.emplace_back(stageName(stage));
  }
  throw UserError("unknown stage '" + name + "'" + validNames(names, name));
}

void readChoices(Arguments& a) {
  if (a.options.metamorphic) {
    if (a.stages.empty()) a.stages = {std::string(stageName(StageKind::pairQuery))};
    if (a.stages.size() != 1 || a.stages.front() != stageName(StageKind::pairQuery)) {
      throw UserError("--metamorphic asks pair queries; valid: --stage pair_query");
    }
  }
  if (!a.stages.empty()) a.options.stages.clear();
  for (const std::string& name : a.stages) a.options.stages.push_back(verifiedStage(name));
  for (const std::string& p : a.options.precisions) {
    if (p != "f64" && p != "f32") throw UserError("unknown precision '" + p + "'; valid: f64, f32");
  }
  for (const int d : a.options.dimensions) {
    if (d != 2 && d != 3) throw UserError("the dimension is " + std::to_string(d) + "; valid: 2, 3");
  }
  if (a.role == "competitor") {
    a.options.role = AlgorithmRole::competitor;
  } else if (a.role == "witness") {
    a.options.role = AlgorithmRole::witness;
  } else if (a.role != "all") {
    throw UserError("unknown role '" + a.role + "'" + validNames({"competitor", "witness", "all"}, a.role));
  }
}

std::vector<CaseResult> runCaseFile(const std::string& path, const std::vector<std::string>& plugins) {
  const std::vector<Case> cases = readCases(path);
  std::vector<CaseResult> found = replayFound(path, cases, plugins);
  std::vector<Case> published = cases;
  std::erase_if(published, [](const Case& c) { return c.finding.has_value(); });
  std::vector<CaseResult> rows = runCases(published);
  rows.insert(rows.end(), found.begin(), found.end());
  return rows;
}

// Writes the table into a CSV file, and into a store for its report, if one is named.
int verifyCaseFile(const Arguments& a) {
  keepApart({{"the cases", a.cases}}, {{"--csv", a.csv}, {"--store", a.storeNamed ? a.store : ""}});
  std::error_code none;
  const bool isPipe = std::filesystem::is_fifo(a.csv, none);        // its reader would see the end of the pipe
  if (!a.csv.empty() && !isPipe) const OutputFile possible(a.csv);  // and closes it: an interrupted run leaves no file
  std::ostringstream table;
  const int exitCode = printCases(runCaseFile(a.cases, a.options.plugins), std::cout, &table);
  if (!a.csv.empty()) {
    std::cout.flush();  // it may be the same stream
    OutputFile csv(a.csv);
    csv.stream() << table.str(), csv.finish();
  }
  if (a.storeNamed) {
    Store store(a.store, true);
    describeProgram(store);
    store.setMeta("corpus_file", a.cases);
    store.setMeta("corpus", table.str());
  }
  return exitCode;
}

// Writes the program to a file and the description to the output; or the program to the output.
void writeProgram(const Arguments& a) {
  const std::string cases = a.cases.empty() ? keptCases() : a.cases;
  keepApart({{"the cases", cases}}, {{"--out", a.out}});
  const Reproduction made = reproduce(cases, a.repro, a.witness, a.out);
  if (a.out.empty()) {
    std::cout << made.program << std::flush;
    std::cerr << oneLine(made.told) << "\n";
    return;
  }
  OutputFile file(a.out);
  file.stream() << made.program, file.finish();
  std::cout << oneLine(made.told) << "\n";
}

void verify(Arguments& a, Session& session) {
  a.options.plugins = session.plugins;
  if (!a.repro.empty()) return writeProgram(a);
  if (!a.cases.empty()) {
    session.exitCode = verifyCaseFile(a);
    return;
  }
  readChoices(a);
  checkVerification(a.options);  // before a store is made
  Store store(a.store, true);
  store.claim();
  describeProgram(store);
  const VerificationSummary done = runVerification(a.options, store);
  const Ledger ledger = ledgerOf(a.options, store);
  const int faults = printLedger(ledger, std::cout);
  long notOwed = 0;  // wrong answers of ours that are not faults
  for (const auto& [key, entry] : ledger) {
    if (key.axis == "all" && entry.role == AlgorithmRole::competitor)
      notOwed += entry.faults() - faultsOfOurs(key, entry);
  }
  for (const std::string& line : writeFoundCases(store, a.store)) std::cout << line << "\n";
  std::cout << a.store << ": " << done.asked << " inputs asked, " << done.skipped << " were done\n";
  std::cout << (faults ? "WRONG: " + std::to_string(faults) + " of our own methods" : "our own methods: all right");
  if (notOwed > 0)
    std::cout << "; of approximate pair queries, which owe the side, " << notOwed << " distances are wrong";
  std::cout << "\n";
  session.exitCode = faults ? 1 : 0;
  if (done.stopped) {
    std::cout << "stopped; the same command continues\n";
    session.exitCode = 130;
  }
}

void addVerify(CommandLine& app, Session& session) {
  CommandLine command = app.subcommand(
      "verify", "Pair queries, contacts and broadphases on seeded inputs (or a file of cases) before the referee");
  auto a = std::make_shared<Arguments>();
  VerificationOptions& o = a->options;
  std::vector<Option> ofSeeded;
  const auto seeded = [&](const char* name, auto& value, const char* meaning) -> Option& {
    return ofSeeded.emplace_back(command.option(name, value, meaning));
  };
  seeded("--pairs", o.pairs,
         "pairs per two kinds of shape, sets of boxes, velocity problems, in blocks of 200 (--metamorphic: of 10)")
      .showDefault()
      .range(1L, 1000000000L);
  seeded("--minutes", o.minutes, "goes on with further blocks until then").range(0.01, 1e5);
  seeded("--seed", o.seed, "of the inputs").showDefault().range(0L, std::numeric_limits<long>::max());
  seeded("--stage", a->stages, "pair_query, contacts, broadphase (default: these), velocity, time_of_impact")
      .commaSeparated();
  seeded("--dimension", o.dimensions, "2, 3 or both (default)").commaSeparated();
  seeded("--precision", o.precisions, "f64 (default), f32 or both").commaSeparated();
  seeded("--role", a->role, "competitor, witness or all (default)");
  seeded("--methods", o.methods,
         "methods with parameters, separated by spaces; default: all, witnesses also at their tightest tolerance and "
         "in a world's frame");
  Option store = command.option("--store", a->store, "SQLite file, made if absent; what it has is not asked again");
  store.showDefault();
  Option metamorphic =
      command.flag("--metamorphic", o.metamorphic,
                   "pair queries: what must not matter, as swapping the shapes; violations per million");
  ofSeeded.push_back(metamorphic);
  seeded("--jobs", o.jobs, "workers at once; default: one per core").range(1L, 4096L);
  command.flag("--quiet", o.quiet, "no progress line");
  Option cases = command.option("--cases", a->cases, "a file of cases instead of seeded inputs");
  cases.file();
  for (const Option& option : ofSeeded) cases.without(option);
  Option csv = command.option("--csv", a->csv, "with --cases: the table as a file");
  csv.file().with(cases);
  Option repro =
      command.option("--repro", a->repro,
                     "a case, by id or number from 0, as a C++ program against a witness's library alone; of "
                     "tests/regressions/hard_cases.json unless there is --cases");
  Option witness = command.option("--witness", a->witness, "with --repro: whose library, such as fcl_libccd");
  repro.with(witness).without(csv).without(store);
  witness.with(repro);
  for (const Option& option : ofSeeded) repro.without(option);
  command.option("--out", a->out, "with --repro: the program as a file").file().with(repro);
  command.footer(
      "Exit code 1 when one of our own methods is wrong, of approximate pair queries: on the wrong side; witnesses "
      "are\n"
      "only recorded. A case that was found here is asked in the precision in which it was found, first the method "
      "that\n"
      "failed, and told whether it fails again.\n"
      "Examples:\n"
      "  lpc verify --pairs 1000 --seed 7\n"
      "  lpc verify --minutes 10 --precision f64,f32 --role competitor\n"
      "  lpc verify --dimension 3 --stage pair_query --methods sat gjk_epa{iterations=20} fcl_libccd\n"
      "  lpc verify --stage velocity --pairs 1000\n"
      "  lpc verify --metamorphic --pairs 1000\n"
      "  lpc verify --cases tests/regressions/hard_cases.json --csv verdicts.csv\n"
      "  lpc verify --repro fcl-508-box-box --witness fcl_libccd --out repro.cpp");
  command.callback([a, store, &session] {
    a->storeNamed = store.given();
    verify(*a, session);
  });
}

LPC_COMMAND("verify", addVerify);

}  // namespace
}}  // namespace lpc::LPC_PRECISION
