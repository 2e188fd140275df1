// SPDX-License-Identifier: Zlib
#include <algorithm>
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
  bool storeNamed = false, skipBroken = false;
};

StageKind verifiedStage(const std::string& name) {
  std::vector<std::string> names;
  for (const StageKind stage : kVerifiedStages) {
    if (name == stageName(stage)) return stage;
    names.emplace_back(stageName(stage));
  }
  throw UserError("unknown stage '" + name + "'" + validNames(names, name));
}

void readPrecisions(const Arguments& a) {
  for (const std::string& p : a.options.precisions) {
    if (p != "f64" && p != "f32") throw UserError("unknown precision '" + p + "'; valid: f64, f32");
  }
}

void readChoices(Arguments& a) {
  if (a.options.metamorphic) {
    if (a.stages.empty()) a.stages = {std::string(stageName(StageKind::pairQuery))};
    if (a.stages.size() != 1 || a.stages.front() != stageName(StageKind::pairQuery)) {
      throw UserError("--metamorphic tests pair queries only; valid: --stage pair_query");
    }
  }
  if (!a.stages.empty()) a.options.stages.clear();
  for (const std::string& name : a.stages) a.options.stages.push_back(verifiedStage(name));
  readPrecisions(a);
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

// Cases without a finding run in the given precisions; a found one runs in its own.
std::vector<CaseResult> runCaseFile(const Arguments& a) {
  constexpr bool kDouble = sizeof(Real) == 8;
  const auto asked = [&](const char* precision) {
    return std::find(a.options.precisions.begin(), a.options.precisions.end(), precision) != a.options.precisions.end();
  };
  const auto isRead = [](const Case& c) { return c.mistake.empty(); };
  const std::vector<Case> cases = readCases(a.cases, a.skipBroken ? BrokenCases::kept : BrokenCases::refused);
  if (std::none_of(cases.begin(), cases.end(), isRead)) {
    throw UserError(a.cases + ": no case can be read; the first, '" + cases[0].id + "': " + cases[0].mistake);
  }
  const std::string other = kDouble ? "f32" : "f64";
  const std::vector<CaseResult> replayed =
      replayCases(a.cases, cases, asked(other.c_str()) ? other : "", a.options.plugins);
  std::vector<Case> here = cases;  // those without a finding, and those that cannot be read
  std::erase_if(here, [&](const Case& c) { return isRead(c) && (c.finding || !asked(kDouble ? "f64" : "f32")); });
  std::vector<CaseResult> rows = runCases(here);
  rows.insert(rows.end(), replayed.begin(), replayed.end());
  return rows;
}

// Writes the table into a CSV file, and into a store for its report, if one is named.
int verifyCaseFile(const Arguments& a) {
  keepApart({{"the cases", a.cases}}, {{"--csv", a.csv}, {"--store", a.storeNamed ? a.store : ""}});
  std::error_code none;
  const bool isPipe = std::filesystem::is_fifo(a.csv, none);        // its reader would see the end of the pipe
  if (!a.csv.empty() && !isPipe) const OutputFile possible(a.csv);  // and closes it: an interrupted run leaves no file
  std::ostringstream table;
  readPrecisions(a);
  const int exitCode = printCases(runCaseFile(a), std::cout, &table, a.skipBroken);
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
  long notOwed = 0, asked = 0;  // wrong answers of ours that are not faults; all of their answers
  for (const auto& [key, entry] : ledger) {
    if (key.axis != "all" || entry.role != AlgorithmRole::competitor) continue;
    notOwed += entry.faults() - faultsOfOurs(key, entry), asked += entry[Tally::asked];
  }
  for (const std::string& line : writeFoundCases(store, a.store)) std::cout << line << "\n";
  std::cout << a.store << ": " << done.asked << " inputs tested, " << done.skipped << " already in the store\n";
  std::cout << (faults  ? "WRONG: " + std::to_string(faults) + " answers of LPC's own methods"
                : asked ? "LPC's own methods: all correct"
                        : "LPC's own methods: none was tested");
  if (notOwed > 0)
    std::cout << "; approximate pair queries, which guarantee only the side: " << notOwed << " wrong distances";
  std::cout << "\n";
  session.exitCode = faults ? 1 : 0;
  if (done.stopped) {
    std::cout << "stopped; the same command continues\n";
    session.exitCode = 130;
  }
}

void addVerify(CommandLine& app, Session& session) {
  CommandLine command = app.subcommand("verify",
                                       "Compares pair queries, contacts and broadphases with the referee's exact "
                                       "answers, on random inputs or a file of cases");
  auto a = std::make_shared<Arguments>();
  VerificationOptions& o = a->options;
  std::vector<Option> ofSeeded;
  const auto seeded = [&](const char* name, auto& value, const char* meaning) -> Option& {
    return ofSeeded.emplace_back(command.option(name, value, meaning));
  };
  seeded("--pairs", o.pairs,
         "inputs per stage: pairs per two kinds of shape, sets of boxes or velocity problems; in blocks of 200 "
         "(--metamorphic: 10)")
      .showDefault()
      .range(1L, 1000000000L);
  seeded("--minutes", o.minutes, "continues with further blocks for this time").range(0.01, 1e5);
  seeded("--seed", o.seed, "seed of the inputs").showDefault().range(0L, std::numeric_limits<long>::max());
  seeded("--stage", a->stages, "pair_query, contacts, broadphase (these are the default), velocity, time_of_impact")
      .commaSeparated();
  seeded("--dimension", o.dimensions, "2, 3 or both (default)").commaSeparated();
  Option precision = command.option("--precision", o.precisions, "f64 (default), f32 or both");
  precision.commaSeparated();
  seeded("--role", a->role, "competitor, witness or all (default)");
  seeded("--methods", o.methods,
         "methods with parameters, separated by spaces; default: all, and witnesses also at their tightest tolerance "
         "and in a world frame");
  Option store =
      command.option("--store", a->store, "SQLite file, created if absent; stored inputs are not tested again");
  store.showDefault();
  Option metamorphic =
      command.flag("--metamorphic", o.metamorphic,
                   "pair queries: counts violations of invariances per million, such as swapping the shapes");
  ofSeeded.push_back(metamorphic);
  seeded("--jobs", o.jobs, "parallel workers; default: one per core").range(1L, 4096L);
  command.flag("--quiet", o.quiet, "no progress line");
  Option cases = command.option("--cases", a->cases, "file of cases, instead of random inputs");
  cases.file();
  for (const Option& option : ofSeeded) cases.without(option);
  Option skip =
      command.flag("--skip-broken", a->skipBroken, "with --cases: skips and counts cases that cannot be read");
  skip.with(cases);
  Option csv = command.option("--csv", a->csv, "with --cases: writes the table to this file");
  csv.file().with(cases);
  Option repro = command.option("--repro", a->repro,
                                "writes a case (id, or number from 0) as a C++ program that uses only the witness's "
                                "library; from --cases, default: tests/regressions/hard_cases.json");
  Option witness = command.option("--witness", a->witness, "with --repro: the witness, such as fcl_libccd");
  repro.with(witness).without(csv).without(store).without(precision).without(skip);
  witness.with(repro);
  for (const Option& option : ofSeeded) repro.without(option);
  command.option("--out", a->out, "with --repro: writes the program to this file").file().with(repro);
  command.footer(
      "Exit code 1 when one of LPC's own methods is wrong, or an expected value of --cases is. An approximate pair "
      "query\nis wrong only on the wrong side. Wrong answers of witnesses are only recorded. A case found by lpc "
      "verify "
      "is\ntested in its original precision, with the method that failed first, and the table says whether it fails "
      "again.\n"
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
