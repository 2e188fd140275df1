// SPDX-License-Identifier: Zlib
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>

#include "experiments/film/falls.h"
#include "experiments/lpc/command.h"
#include "experiments/runner/catalogue.h"
#include "experiments/runner/scheduler.h"
#include "experiments/runner/store_check.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

struct SweepOptions {
  std::string sweep, store, precision;
  std::vector<std::string> only, with, set;
  bool dryRun = false;
  RunOptions run;
};

// Drops the trials of the other precision, and sweeps without others.
void keepPrecision(std::vector<PlannedSweep>& sweeps, const std::string& precision) {
  if (precision != "f64" && precision != "f32") {
    throw UserError("--precision " + precision + "; valid: f64, f32");
  }
  const auto other = [&](const PlannedTrial& t) { return t.asked().precision != precision; };
  for (PlannedSweep& s : sweeps) {
    std::erase_if(s.trials, other);
    std::erase_if(s.calibrated, [&](const CalibratedCell& cell) { return other(cell.plan(1).at(0)); });
    std::erase_if(s.ladders, [&](const Ladder& ladder) {
      return other(ladder.plan({ladder.question.from, 1, s.calibration ? 1 : 0, false}).at(0));
    });
  }
  std::erase_if(sweeps,
                [](const PlannedSweep& s) { return s.trials.empty() && s.calibrated.empty() && s.ladders.empty(); });
}

// Prints the plan. The cells of a search are known except for their setting.
void printPlan(const PlannedSweep& s) {
  std::size_t trials = 0, timed = 0, unsupported = 0, searches = 0;
  const auto count = [&](const PlannedTrial& t, std::size_t times) {
    trials += times, timed += times * t.timed(), unsupported += times * !t.unsupported.empty();
  };
  for (const PlannedTrial& t : s.trials) count(t, 1);
  for (const CalibratedCell& cell : s.calibrated) {
    searches += cell.budgets.size();
    for (const PlannedTrial& t : cell.plan(1)) count(t, cell.budgets.size());
  }
  std::printf("%-24s %5zu trials, %zu timed, %zu unsupported", s.name.c_str(), trials, timed, unsupported);
  if (searches > 0) {
    std::printf(", after %zu searches of %s at budgets of %s (%zu %s), each of at most %d settings", searches,
                s.calibration->setting.c_str(), s.calibration->metric.c_str(), s.calibrated.size(),
                s.calibrated.size() == 1 ? "cell" : "cells", s.calibration->mostTried());
  }
  if (!s.ladders.empty()) {
    // Each value needs its seeds and, in a calibrated sweep, the search of its setting; values that hold are timed.
    std::size_t most = 0;
    for (const Ladder& ladder : s.ladders) {
      const BreakQuestion& q = ladder.question;
      const auto settings = static_cast<std::size_t>(s.calibration ? s.calibration->mostTried() : 0);
      most += static_cast<std::size_t>(q.mostTrials()) + static_cast<std::size_t>(q.mostTried()) * settings;
      if (ladder.timed) most += ladder.plan({q.from, 1, settings > 0 ? 1 : 0, true}).size();
    }
    std::printf(", after %zu searches for breaking points, of at most %zu trials in all", s.ladders.size(), most);
    if (s.calibration) std::printf(", those that find the %s of each value among them", s.calibration->setting.c_str());
  }
  std::printf("\n");
}

// All trials, each counted once.
void printEnd(const std::string& store, const RunSummary& done) {
  std::string outcomes;
  for (const auto& [outcome, n] : done.outcomes) {
    outcomes += (outcomes.empty() ? " (" : ", ") + std::to_string(n) + " " + outcome;
    if (outcome != "wrong") continue;
    std::string kinds;
    for (const auto& [of, count] : done.wrong)
      kinds += (kinds.empty() ? ": " : " + ") + std::to_string(count) + " " + of;
    outcomes += kinds;
  }
  std::printf("%s: %ld trials planned, %ld were done, %ld run, %ld of these not ok%s%s", store.c_str(), done.planned,
              done.skipped, done.run, done.bad, outcomes.c_str(), outcomes.empty() ? "" : ")");
  if (done.shared > 0) std::printf(", %ld shared", done.shared);
  if (done.left() > 0) std::printf(", %ld not run", done.left());
  std::printf("\n");
}

void sweep(SweepOptions& o, Session& session) {
  std::vector<PlannedSweep> sweeps = planSweeps(o.sweep, o.only, o.with, o.set);
  for (const PlannedSweep& s : sweeps) {
    for (const std::string& note : s.notes) std::fprintf(stderr, "lpc: sweep %s: %s\n", s.name.c_str(), note.c_str());
  }
  if (!o.precision.empty()) keepPrecision(sweeps, o.precision);
  if (o.dryRun) {
    checkStore(o.store);
    for (const PlannedSweep& s : sweeps) printPlan(s);
    return;
  }
  if (std::error_code none; !std::filesystem::exists(o.store, none)) checkWorkers(sweeps);  // before it is made
  Store store(o.store, true);
  store.claim();
  describeProgram(store);
  o.run.partial = !o.only.empty();
  o.run.plugins = session.plugins;
  for (PlannedSweep& s : sweeps) addPlugins(s.command, session);
  std::set<std::string> changed;
  for (const PlannedSweep& s : sweeps) changed.merge(store.changed(s));
  if (!changed.empty()) {
    std::fprintf(stderr, "lpc: %zu trials of %s run again: their scene, code, compiler or options have changed\n",
                 changed.size(), o.store.c_str());
  }
  RunSummary done = runSweeps(sweeps, store, o.run);
  for (const PlannedSweep& s : sweeps) done.stopped = done.stopped || !filmFalls(s, store, o.run);
  printEnd(o.store, done);
  if (done.stopped) {
    std::printf("stopped; the same command continues\n");
    session.exitCode = 130;
  }
}

void addSweep(CommandLine& app, Session& session) {
  CommandLine command = app.subcommand("sweep", "Runs the trials of a sweep that its store lacks");
  auto o = std::make_shared<SweepOptions>();
  o->store = "results/lpc.db";
  command.option("sweep", o->sweep, "name in experiments/sweeps, or a TOML file; a set such as quick runs several")
      .required();
  command.option("--store", o->store, "SQLite file, made if absent").showDefault();
  command
      .option("--only", o->only, "keeps each cell that has one of these labels, algorithms or scenes (comma-separated)")
      .commaSeparated();
  command.option("--with", o->with, "LABEL=PIPELINE: one more method among the labelled ones (may be repeated)");
  command.option("--set", o->set, "AXIS=VALUE: this value in place of the axis's own (may be repeated)");
  command.option(
      "--precision", o->precision,
      "only trials of this precision, f64 or f32; the plan in the store has no others until they are asked for");
  command.option("--jobs", o->run.jobs, "untimed trials at once; default: one per core").range(1L, 4096L);
  command.flag("--retry", o->run.retry, "runs timeouts, crashes and out-of-memory again");
  command.flag("--dry-run", o->dryRun, "counts the trials, looks whether the store can take them, and runs none");
  command.flag("--quiet", o->run.quiet, "no progress line");
  command.footer(
      "Example: lpc sweep broadphase_crossover --only naive,region_tree --store results/mine.db\n"
      "         lpc sweep resolvers --with 'catto20=solver=split_solver{velocity=catto{iterations=20}}'");
  command.callback([o, &session] { sweep(*o, session); });
}

LPC_COMMAND("sweep", addSweep);

}  // namespace
}}  // namespace lpc::LPC_PRECISION
