// SPDX-License-Identifier: Zlib
#include "experiments/runner/needs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "experiments/lpc/command.h"
#include "experiments/lpc/scene_options.h"
#include "experiments/parse/toml_reader.h"
#include "experiments/runner/catalogue.h"
#include "experiments/runner/scene_model.h"
#include "experiments/runner/scheduler.h"
#include "experiments/trial/measure/metric.h"
#include "experiments/trial/trial.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

struct NeedsOptions {
  NeedsQuestion question;
  std::vector<std::string> params;
  std::string store = "results/needs.db";
  bool quiet = false;
};

double least(const std::vector<double>& x) { return x.empty() ? NAN : *std::min_element(x.begin(), x.end()); }
double most(const std::vector<double>& x) { return x.empty() ? NAN : *std::max_element(x.begin(), x.end()); }

std::string number(const char* format, double value) {
  char text[48];
  if (std::isnan(value)) return "-";
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string spread(const std::vector<double>& x) {
  if (x.empty()) return "-";
  return number("%.2f", quantile(x, 0.5)) + " (" + number("%.2f", least(x)) + " .. " + number("%.2f", most(x)) + ")";
}

void printRow(const std::string& what, const std::string& time, const std::string& rows, const std::string& median,
              const std::string& largest, const std::string& remark) {
  char text[200];
  std::snprintf(text, sizeof text, "%-18s %-24s %-12s %-11s %-11s", what.c_str(), time.c_str(), rows.c_str(),
                median.c_str(), largest.c_str());
  std::string line = text + (remark.empty() ? "" : "  " + remark);
  line.erase(line.find_last_not_of(' ') + 1);
  std::printf("%s\n", line.c_str());
}

void printModel(const ModelSeen& m, const ModelSeen& again) {
  const bool compared = m.trials > m.failed;
  printRow(m.model.empty() ? "minimal, again" : m.model, spread(m.time),
           m.rows.empty() ? "-" : number("%.3f", quantile(m.rows, 0.5)),
           compared ? number("%.2g", quantile(m.median, 0.5)) : "-", compared ? number("%.2g", most(m.largest)) : "-",
           remarkOn(m, again));
}

void print(const PlannedSweep& sweep, const NeedsSeen& seen) {
  const WorldRequest& own = sweep.trials.front().world();
  std::printf("%s in %dD: model by its file: %s\n", own.scene.c_str(), own.dimension,
              own.features.empty() ? "minimal" : own.features.c_str());
  std::printf(
      "Time and multiply-adds over those of this (minimal) model: median over %d seeds (least .. most).\nDistance of "
      "bodies' end positions from the minimal model's (m): median over bodies and seeds, and largest.\n",
      seen.seeds);
  std::printf("Stages: %s\n\n", own.pipeline.c_str());
  if (seen.failed) {
    std::printf("minimal fails with %d of %d seeds, which are excluded: %s\n", seen.failed, seen.seeds,
                seen.failure.c_str());
  }
  printRow("model", "time", "multiply-adds", "median", "farthest", "");
  const auto again =
      std::find_if(seen.models.begin(), seen.models.end(), [](const auto& m) { return m.model.empty(); });
  if (!seen.largest.empty()) {
    printRow("another seed", "-", "-", number("%.2g", quantile(seen.median, 0.5)), number("%.2g", most(seen.largest)),
             most(seen.largest) > 0 ? "" : "seeds move nothing in this scene");
  }
  for (const ModelSeen& m : seen.models) printModel(m, *again);
}

std::vector<std::string> commandOf(const NeedsOptions& o) {
  const NeedsQuestion& q = o.question;
  std::vector<std::string> out = {"needs", q.scene, "--seeds", std::to_string(q.seeds)};
  const auto add = [&](const char* option, const std::string& value) { out.insert(out.end(), {option, value}); };
  if (q.perturbation != NeedsQuestion().perturbation) add("--perturb", asText(q.perturbation));
  if (q.dimension) add("--dimension", std::to_string(*q.dimension));
  if (!q.pipeline.empty()) add("--pipeline", q.pipeline);
  for (const std::string& param : o.params) add("--param", param);
  if (q.steps) add("--steps", std::to_string(*q.steps));
  return out;
}

void needs(NeedsOptions& o, Session& session) {
  o.question.params = readParameters(o.params);
  std::vector<PlannedSweep> sweeps = {planNeeds(o.question)};
  sweeps[0].command = commandOf(o);
  addPlugins(sweeps[0].command, session);
  RunOptions run;
  run.plugins = session.plugins, run.quiet = o.quiet;
  if (std::error_code none; !std::filesystem::exists(o.store, none)) checkWorkers(sweeps);  // before it is made
  NeedsSeen seen;
  {
    Store store(o.store, true);
    store.claim();
    describeProgram(store);
    if (runSweeps(sweeps, store, run).stopped) {
      std::printf("stopped; the same command continues\n");
      session.exitCode = 130;
      return;
    }
    seen = readNeeds(sweeps[0], store);
  }
  print(sweeps[0], seen);
  std::printf("\n%s: lpc report %s draws it\n", o.store.c_str(), o.store.c_str());
}

void addNeeds(CommandLine& app, Session& session) {
  CommandLine command = app.subcommand(
      "needs", "Switches each part of a scene's model in turn and reports the saved time and the changed result");
  auto o = std::make_shared<NeedsOptions>();
  NeedsQuestion& q = o->question;
  command.option("scene", q.scene, "name in experiments/scenes, or a TOML file").required();
  command.option("--seeds", q.seeds, "runs per model, each with its own seed").showDefault().range(1L, 10000L);
  command
      .option("--perturb", q.perturbation,
              "largest perturbation of a body's start pose by the seed (m and rad); larger values show more of the "
              "scene's variation")
      .showDefault()
      .range(0.0, kMostPerturbed);
  command.option("--dimension", q.dimension, "2 or 3; default: the scene's first");
  command.option("--pipeline", q.pipeline, "algorithms, such as \"solver=soft_step{substeps=4}\"");
  command.option("--param", o->params, "a parameter of the scene, NAME=NUMBER or joint=KIND (may be repeated)");
  command.option("--steps", q.steps, "number of steps; default: the scene's");
  command.option("--store", o->store, "SQLite file, created if absent; stored trials are not run again").showDefault();
  command.flag("--quiet", o->quiet, "no progress line");
  command.footer("Example: lpc needs pyramid --param base=10 --seeds 3");
  command.callback([o, &session] { needs(*o, session); });
}

LPC_COMMAND("needs", addNeeds);

}  // namespace
}}  // namespace lpc::LPC_PRECISION
