// SPDX-License-Identifier: Zlib
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "experiments/lpc/command.h"
#include "experiments/runner/child.h"
#include "experiments/runner/locations.h"
#include "experiments/runner/trial_plan.h"
#include "experiments/trial/plugin.h"
#include "experiments/trial/trial.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using nlohmann::json;

struct Options {
  std::string scene, pipeline, precision = "f64", profile, record;
  std::vector<std::string> params;
  std::optional<int> dimension;
  std::optional<double> dt;
  std::optional<long> steps;
  std::optional<std::uint64_t> seed;
  bool asJson = false;
};

ParameterValues readParameters(const std::vector<std::string>& texts) {
  ParameterValues out;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    char* end = nullptr;
    const char* given = equals == std::string::npos ? "" : text.c_str() + equals + 1;
    const double value = std::strtod(given, &end);
    if (!*given || (*end && name != kJointParameter)) {
      throw UserError("--param " + text + " is not NAME=NUMBER, or joint=KIND");
    }
    out[name] = *end ? ParameterValue(std::string(given)) : ParameterValue(value);
  }
  return out;
}

void print(const PlannedTrial& trial, const TrialResult& result) {
  std::printf("scene     %s in %dD, %s, dt %.6g s\n", trial.canonical["scene"].get<std::string>().c_str(),
              trial.canonical["dimension"].get<int>(), trial.canonical["precision"].get<std::string>().c_str(),
              trial.canonical["dt"].get<double>());
  std::printf("pipeline  %s\n", trial.canonical["pipeline"].get<std::string>().c_str());
  std::printf("outcome   %s", result.outcome.c_str());
  if (result.outcome != "ok") std::printf(" at step %ld: %s", result.step, result.reason.c_str());
  std::printf("\nhash      %s\n", result.hash.c_str());
  for (const auto& [name, value] : result.metrics) {
    if (!std::isnan(value)) std::printf("  %-26s %.6g\n", name.c_str(), value);
  }
}

void runScene(const Options& o, Session& session) {
  WorldCell cell;
  cell.params = readParameters(o.params);
  cell.dimension = o.dimension, cell.pipeline = o.pipeline, cell.precision = o.precision, cell.timed = true;
  cell.dt = o.dt, cell.steps = o.steps, cell.seed = o.seed;
  Planner planner;
  const PlannedTrial trial = planner.world(o.scene, cell);
  if (!trial.unsupported.empty()) throw UserError(trial.unsupported);
  json request = {{"trial", trial.canonical}, {"scene_file", trial.sceneFile}, {"progress", !o.asJson}};
  for (const std::string& path : session.plugins) {
    if (pluginPrecision(path) == o.precision) request["plugins"].push_back(std::filesystem::absolute(path).string());
  }
  if (!o.profile.empty()) request["profile"] = o.profile;
  if (!o.record.empty()) request["record"] = o.record;
  Child worker(workerPath(o.precision, trial.canonical.contains("engine")), request.dump(), -1, true);
  worker.wait();
  if (worker.signal()) throw std::runtime_error("the worker crashed with signal " + std::to_string(worker.signal()));
  if (worker.exitCode() == 2) {  // it has said why
    session.exitCode = 2;
    return;
  }
  if (worker.exitCode()) throw std::runtime_error("the worker ended with " + std::to_string(worker.exitCode()));
  if (o.asJson) {
    std::printf("%s\n", worker.output().c_str());
  }
  const TrialResult result = resultFromJson(json::parse(worker.output()));
  if (!o.asJson) {
    print(trial, result);
    if (!o.profile.empty()) std::printf("profile   %s\n", o.profile.c_str());
    if (!o.record.empty()) std::printf("recording %s\n", o.record.c_str());
  }
  session.exitCode = result.outcome == "ok" ? 0 : 1;
}

void addRun(CommandLine& app, Session& session) {
  CommandLine command = app.subcommand("run", "Runs one scene and prints its metrics; exit code 1 when it fails");
  auto o = std::make_shared<Options>();
  command.option("scene", o->scene, "name in experiments/scenes, or a TOML file").required();
  command.option("--pipeline", o->pipeline,
                 "algorithms, such as \"solver=soft_step{substeps=4} sleep=none\", or \"engine=box2d\"");
  command.option("--param", o->params, "a parameter of the scene, NAME=NUMBER or joint=KIND (may be repeated)");
  command.option("--dt", o->dt, "length of a step (s); default: the scene's");
  command.option("--steps", o->steps, "number of steps; default: the scene's");
  command.option("--seed", o->seed, "of the scene's random numbers; default: the scene's")
      .range(0L, std::numeric_limits<long>::max());
  command.option("--dimension", o->dimension, "2 or 3; default: the scene's first");
  command.option("--precision", o->precision, "f64 or f32");
  command.option("--profile", o->profile, "writes times and counts per step as CSV");
  command.option("--record", o->record, "writes all poses of all steps");
  command.flag("--json", o->asJson, "the whole result as JSON, with a series per step");
  command.footer("Example: lpc run pyramid --param base=10 --dimension 3 --profile pyramid.csv");
  command.callback([o, &session] { runScene(*o, session); });
}

LPC_COMMAND("run", addRun);

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
