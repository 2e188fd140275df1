// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "experiments/lpc/command.h"
#include "experiments/lpc/scene_options.h"
#include "experiments/parse/toml_reader.h"
#include "experiments/runner/breaking.h"
#include "experiments/runner/catalogue.h"
#include "experiments/runner/scheduler.h"
#include "experiments/runner/sweep_axis.h"
#include "experiments/runner/sweep_cell.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

struct BreakOptions {
  BreakQuestion question;
  std::string scene, limit, precision = "f64";
  std::vector<std::string> pipelines, params;
  std::optional<double> from, to, budget;
  std::optional<int> dimension;
  std::optional<long> steps;
  std::string store = "results/break.db";
  bool quiet = false, timed = false;
};

constexpr const char* kSetting = "iterations";  // the axis of the setting at equal cost
constexpr int kTimedRepeats = 5;

// Fills in the known range of a scene's parameter.
void setEnds(BreakOptions& o, const SceneFile& file) {
  BreakQuestion& q = o.question;
  const SceneParameter* p = file.parameter(q.parameter);
  if (p && p->value.isText())
    throw UserError("parameter '" + q.parameter + "' holds a text; valid: a parameter that is a number");
  const bool ranged = p && p->lo > 0;
  if ((!o.from && !ranged) || (!o.to && !p)) {
    throw UserError(
        "'" + q.parameter + "' needs " + (!o.from ? "--from" : "--to") +
        (p ? ": its least value is " + asText(p->lo) : ": scene '" + file.name() + "' has no such parameter"));
  }
  q.from = o.from ? *o.from : p->lo, q.to = o.to ? *o.to : p->hi;
}

std::vector<std::string> commandOf(const BreakOptions& o) {
  const BreakQuestion& q = o.question;
  std::vector<std::string> out = {"break", o.scene, "--parameter", q.parameter};
  const auto add = [&](const char* option, const std::string& value) { out.insert(out.end(), {option, value}); };
  for (const std::string& pipeline : o.pipelines) add("--pipeline", pipeline);
  if (o.from) add("--from", asText(*o.from));
  if (o.to) add("--to", asText(*o.to));
  if (q.falling) out.emplace_back("--falling");
  if (q.truth > 0) add("--truth", asText(q.truth));
  if (q.limit) add("--limit", q.limit->text);
  if (q.seeds != BreakQuestion().seeds) add("--seeds", std::to_string(q.seeds));
  if (q.perturb != BreakQuestion().perturb) add("--perturb", asText(q.perturb));
  if (q.step != BreakQuestion().step) add("--grid", asText(q.step));
  if (q.ratio != BreakQuestion().ratio) add("--ratio", asText(q.ratio));
  if (o.dimension) add("--dimension", std::to_string(*o.dimension));
  if (o.precision != "f64") add("--precision", o.precision);
  for (const std::string& param : o.params) add("--param", param);
  if (o.steps) add("--steps", std::to_string(*o.steps));
  if (o.budget) add("--equal-cost", asText(*o.budget));
  if (o.timed) out.emplace_back("--timed");
  return out;
}

// At equal cost a pipeline marks the setting with $iterations; without a mark it is the effort of its solver.
std::string searched(const std::string& pipeline, int dimension) {
  if (pipeline.find(std::string("$") + kSetting) != pipeline.npos) return pipeline;
  std::optional<Spec> engine = engineOf(pipeline);
  Pipeline stages = Pipeline::parse(engine ? "" : pipeline);
  const StageKind kind = engine ? StageKind::engine : StageKind::solver;
  const auto [method, entry, effort] = effortIn(kind, dimension, engine ? *engine : stages[kind]);
  if (!effort) {
    const std::string& why = entry->info.noEffort;
    throw UserError("--equal-cost and '" + pipeline + "': " + method->name + " has no effort" +
                    (why.empty() ? "" : ": " + why) + "; valid: another method, or $" + kSetting);
  }
  if (const Spec* given = method->find(effort->name)) {
    throw UserError("--equal-cost and '" + pipeline + "', which sets " + effort->name + "=" + given->text() +
                    "; valid: a pipeline without it");
  }
  method->set(effort->name, Spec{std::string("$") + kSetting, {}});
  return engine ? "engine=" + engine->text() : stages.text();
}

PlannedSweep plan(BreakOptions& o) {
  BreakQuestion& q = o.question;
  const auto planner = std::make_shared<Planner>();
  const SceneFile& file = planner->scene(o.scene);
  const ParameterValues params = readParameters(o.params);
  file.values(params);
  if (params.count(q.parameter))
    throw UserError("--param " + q.parameter + " is the searched parameter; valid: another parameter");
  if (o.steps && q.parameter == "steps") throw UserError("--steps is the searched parameter; valid: no --steps");
  q.checkParameter();
  setEnds(o, file);
  const int dimension = o.dimension.value_or(file.dimensions().at(0));
  PlannedSweep out;
  out.name = "break_" + file.name() + "_" + q.parameter, out.kind = "world";
  out.summary = "breaking points: the " + q.title() + " of " + file.name() + " that holds";
  out.charts = {"breaking_map"}, out.command = commandOf(o);
  out.roles = {{"question", "run"}, {"pipeline", "label"}, {"scene", "run"}, {"seed", "run"}, {"dimension", "run"}};
  if (o.budget) {
    if (!(*o.budget > 0)) throw UserError("--equal-cost is " + asText(*o.budget) + "; valid: above 0");
    out.calibration = Calibration{"cost", "work_multiply_adds", "--equal-cost", kSetting, 256, false};
    out.roles["budget"] = "run";
  }
  const auto roles = std::make_shared<std::map<std::string, std::string>>();
  for (const std::string& pipeline : o.pipelines) {
    const std::string text = o.budget ? searched(pipeline, dimension) : pipeline;
    const auto trialsAt = [=, &file, &o](const Ladder::Place& p) {
      nlohmann::json axes = {{o.question.parameter, axisNumber(p.value)}, {"seed", p.seed}};
      if (o.question.parameter != kPerturbParameter) axes[kPerturbParameter] = o.question.perturb;
      if (o.budget) axes[kSetting] = p.setting;
      std::set<std::string> used;
      WorldCell cell;
      cell.pipeline = withValues(text, axes, used);
      cell.params = params, cell.dimension = dimension, cell.precision = o.precision, cell.steps = o.steps;
      cell.timed = p.timed;
      readWorldAxes(file, axes, used, cell, *roles);
      std::vector<PlannedTrial> trials = {planner->world(o.scene, cell)};
      axes.update({{"kind", "world"},
                   {"scene", file.name()},
                   {"dimension", dimension},
                   {"precision", o.precision},
                   {"pipeline", pipeline},
                   {"timed", p.timed},
                   {"repeat", 0}});
      trials[0].axes = axes;
      for (int repeat = 1; p.timed && repeat < kTimedRepeats; ++repeat) {
        PlannedTrial again = trials[0];
        again.setRepeat(repeat);
        trials.push_back(std::move(again));
      }
      return trials;
    };
    const nlohmann::json axes = {
        {"scene", file.name()}, {"dimension", dimension}, {"precision", o.precision}, {"pipeline", pipeline}};
    addLadder(out, {q, axes, o.budget.value_or(0), trialsAt, o.timed});
  }
  for (const auto& [name, role] : *roles) out.roles.emplace(name, role);
  return out;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.5g", value);
  return text;
}

// The value at which half of the seeds fail, with its interval.
std::string interval(const BreakQuestion& q, const Broken& b) {
  if (q.seeds < kFewestSeeds) return "fewer than " + std::to_string(kFewestSeeds) + " seeds give no interval";
  return "half of the seeds fail " + (b.half ? "at " + number(*b.half) + ", " : "") + "between " +
         (b.low ? number(*b.low) : "below " + number(q.from)) + " and " +
         (b.high ? number(*b.high) : "beyond " + number(q.to)) + " (95 %)";
}

std::string aside(double ratio) {
  char text[48];
  std::snprintf(text, sizeof text, "%.2g %% %s", 100 * std::abs(ratio - 1), ratio < 1 ? "below" : "above");
  return text;
}

void print(const BreakQuestion& q, const Broken& b) {
  std::string line, then;
  if (!b.unsupported.empty()) {
    line = "unsupported: " + b.unsupported;
  } else if (b.stopped) {
    line = "stopped before the search ended";
  } else {
    line = !b.held ? "no tried value holds" : number(b.held->value) + (b.fell ? "" : ", the last tried") + " holds";
    line += "; " + interval(q, b);
    if (b.fell) {
      line += "; " + number(b.fell->value) + ": " + std::to_string(b.fell->failed) + " of " +
              std::to_string(b.fell->of) + " fail, " + b.fell->failure;
    }
    if (b.half && q.truth > 0) line += "; closed form: " + number(q.truth) + ", " + aside(*b.half / q.truth);
    if (b.held && std::isfinite(b.held->cost)) line += "; " + number(b.held->cost) + " multiply-adds per step";
    for (const double value : b.passesBeyond) then += (then.empty() ? "" : ", ") + number(value);
  }
  std::printf("%s\n  %s\n", b.axes.at("pipeline").get<std::string>().c_str(), line.c_str());
  if (!then.empty())
    std::printf("  not monotone: %zu values beyond it hold again: %s\n", b.passesBeyond.size(), then.c_str());
}

void breakScene(BreakOptions& o, Session& session) {
  std::vector<PlannedSweep> sweeps = {plan(o)};
  addPlugins(sweeps[0].command, session);
  RunOptions run;
  run.plugins = session.plugins, run.quiet = o.quiet;
  if (std::error_code none; !std::filesystem::exists(o.store, none)) checkWorkers(sweeps);  // before it is made
  Store store(o.store, true);
  store.claim();
  describeProgram(store);
  const bool stopped = runSweeps(sweeps, store, run).stopped;
  const auto& axes = sweeps[0].ladders.at(0).axes;
  std::printf("%s in %dD, %s: the %s with which fewer than half of %ld seeds (at the edge; else %ld) fail%s%s\n",
              axes["scene"].get<std::string>().c_str(), axes["dimension"].get<int>(), o.precision.c_str(),
              o.question.title().c_str(), o.question.seeds, o.question.fewSeeds(),
              o.question.limit ? ", by outcome or " : "", o.question.limit ? o.question.limit->text.c_str() : "");
  for (const Broken& b : sweeps[0].broken) print(o.question, b);
  if (stopped) {
    std::printf("stopped; the same command continues\n");
    session.exitCode = 130;
    return;
  }
  std::printf("%s: lpc report %s draws it\n", o.store.c_str(), o.store.c_str());
}

void addBreak(CommandLine& app, Session& session) {
  CommandLine command = app.subcommand(
      "break", "Finds the parameter value at which each method breaks, over seeds, with a confidence interval");
  auto o = std::make_shared<BreakOptions>();
  BreakQuestion& q = o->question;
  command.option("scene", o->scene, "name in experiments/scenes, or a TOML file").required();
  command.option("--parameter", q.parameter, "parameter to search: one of the scene, dt, or $NAME in a pipeline")
      .required();
  command.option("--pipeline", o->pipelines, "algorithms, such as \"solver=soft_step{substeps=4}\" (may be repeated)")
      .required();
  command.option("--from", o->from, "smallest value, above 0; default: the scene's minimum");
  command.option("--to", o->to, "largest value; default: the scene's maximum");
  command.flag("--falling", q.falling, "find the smallest value that holds, not the largest");
  const Option limit =
      command.option("--limit", o->limit, "METRIC<NUMBER or METRIC>NUMBER: a further condition for a run to hold");
  command.option("--truth", q.truth, "closed-form breaking value; prints the deviation from it");
  command.option("--seeds", q.seeds, "seeds per value at the edge; at most 4 elsewhere").showDefault().range(1L, 1000L);
  command.option("--perturb", q.perturb, "largest perturbation of a body's start pose by the seed (m and rad)")
      .showDefault()
      .range(0.0, kMostPerturbed);
  command.option("--grid", q.step, "factor between values of the coarse scan before the search")
      .showDefault()
      .range(1.001, 2.0);
  command
      .option("--ratio", q.ratio, "final ratio of the two values that enclose the breaking value, for real parameters")
      .showDefault()
      .range(1.001, 2.0);
  command.option("--dimension", o->dimension, "2 or 3; default: the scene's first");
  command.option("--precision", o->precision, "f64 or f32").showDefault();
  command.option("--param", o->params, "another parameter of the scene, NAME=NUMBER or joint=KIND (may be repeated)");
  command.option("--steps", o->steps, "number of steps; default: the scene's");
  command.option("--equal-cost", o->budget,
                 "multiply-adds per step: sets each method's effort, or $iterations, to this cost");
  command.flag("--timed", o->timed, "also measures the time of the last value that holds");
  command.option("--store", o->store, "SQLite file, created if absent; stored trials are not run again").showDefault();
  command.flag("--quiet", o->quiet, "no progress line");
  command.footer(
      "Example: lpc break vertical_stack --parameter n --to 64 --pipeline solver=split_solver --pipeline "
      "solver=soft_step\n"
      "         lpc break bridge --parameter n --to 64 --limit \"joint_error_max<0.01\" --pipeline solver=soft_step");
  command.callback([o, limit, &session] {
    if (limit.given()) o->question.limit.emplace(o->limit);
    breakScene(*o, session);
  });
}

LPC_COMMAND("break", addBreak);

}  // namespace
}}  // namespace lpc::LPC_PRECISION
