// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "experiments/film/film.h"
#include "experiments/film/film_file.h"
#include "experiments/film/temporary_recording.h"
#include "experiments/lpc/command.h"
#include "experiments/lpc/scene_options.h"
#include "experiments/lpc/series_picture.h"
#include "experiments/lpc/series_plot.h"
#include "experiments/lpc/timeline.h"
#include "experiments/runner/child.h"
#include "experiments/runner/locations.h"
#include "experiments/runner/plugin_probe.h"
#include "experiments/runner/trial_plan.h"
#include "experiments/runner/worker_pool.h"
#include "experiments/trial/formats/output_file.h"
#include "experiments/trial/measure/metric.h"
#include "experiments/trial/plugin.h"
#include "experiments/trial/scene/saved_scene.h"
#include "experiments/trial/trial.h"
#include "framework/math/names.h"
#include "framework/world/stage_engine.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

using nlohmann::json;

struct RunSceneOptions {
  std::string scene, script, pipeline, precision = "f64", profile, record, plot, film;
  std::vector<std::string> params, saves;
  std::optional<int> dimension;
  std::optional<double> dt;
  std::optional<long> steps;
  std::optional<std::uint64_t> seed;
  bool asJson = false, plots = false, noSleeping = false, memory = false;
};

// AT:FILE.toml.
std::vector<SaveRequest> readSaves(const std::vector<std::string>& texts) {
  std::vector<SaveRequest> out;
  for (const std::string& text : texts) {
    const std::size_t colon = text.find(':');
    long step = -1;
    const char* end = text.data() + std::min(colon, text.size());
    const auto [stop, error] = std::from_chars(text.data(), end, step);
    if (colon == text.npos || error != std::errc() || stop != end || step < 0) {
      throw UserError("--save: '" + text +
                      "' is not AT:FILE.toml; valid: a step and a file name, such as 100:later.toml");
    }
    out.push_back({step, text.substr(colon + 1)});
    SavedScene::worldPath(out.back().scene);
  }
  return out;
}

// Of the entry itself, or of the one with a star for several ("us_*").
const MetricInfo* infoOf(const std::vector<DescribedMetric>& known, const char* what, const std::string& name) {
  const MetricInfo* starred = nullptr;
  for (const DescribedMetric& m : known) {
    if (m.what != what || m.kind != "world") continue;
    if (m.info.name == name) return &m.info;
    if (m.info.name.ends_with('*') && name.starts_with(m.info.name.substr(0, m.info.name.size() - 1))) {
      starred = &m.info;
    }
  }
  return starred;
}

std::string unitOf(const MetricInfo* info) { return info && info->unit != "1" ? std::string(info->unit) : ""; }

constexpr const char* kTimeline = "timeline";

void requireSeries(const std::string& name) {
  if (name == kTimeline) return;
  std::vector<std::string> names = {kTimeline};
  for (const DescribedMetric& m : describeMetrics()) {
    if (m.what != "series" || m.kind != "world") continue;
    if (m.info.name == name || (m.info.name == "sec_*" && name.starts_with("sec_"))) return;
    names.emplace_back(m.info.name);
  }
  throw UserError("--plot: unknown series '" + name + "'" + validNames(names, name));
}

// The phases and all series in a line each, or the requested ones.
void printPlots(const RunSceneOptions& o, const TrialResult& result) {
  const std::vector<DescribedMetric> known = describeMetrics();
  std::printf("\n");
  if (o.plot.empty() || o.plot == kTimeline) std::printf("%s", timeline(result.series).c_str());
  if (o.plot == kTimeline) return;
  if (o.plot.empty()) std::printf("\n");
  for (const auto& [name, series] : result.series) {
    const std::string unit = unitOf(infoOf(known, "series", name));
    if (o.plot.empty()) std::printf("%s", sparkline(name, series, unit).c_str());
    if (o.plot == name) std::printf("%s", plot(name, series, unit).c_str());
  }
  if (!o.plot.empty() && !result.series.count(o.plot)) std::printf("%s: this run has no such series\n", o.plot.c_str());
}

void print(const WorldRequest& asked, const TrialResult& result) {
  std::printf("scene     %s in %dD, %s, dt %.6g s\n", asked.scene.c_str(), asked.dimension, asked.precision.c_str(),
              asked.dt);
  if (!asked.script.empty()) {
    std::printf("script    %s\n", asked.script.c_str());
  }
  std::printf("pipeline  %s\n", asked.pipeline.c_str());
  std::printf("outcome   %s", result.outcome.c_str());
  if (result.outcome != "ok") std::printf(" at step %ld: %s", result.step, result.reason.c_str());
  std::printf("\nhash      %s\n", result.hash.c_str());
  const std::vector<DescribedMetric> known = describeMetrics();
  for (const MetricRole role : {MetricRole::cost, MetricRole::error, MetricRole::detail}) {
    std::string heading = std::string(roleName(role)) + "\n";
    for (const auto& [name, value] : result.metrics) {
      const MetricInfo* info = infoOf(known, "metric", name);
      if (std::isnan(value) || (info ? info->role : MetricRole::detail) != role) continue;
      const std::string unit = unitOf(info).empty() ? "" : " " + unitOf(info);
      std::printf("%s  %-26s %.6g%s\n", heading.c_str(), name.c_str(), value, unit.c_str());
      heading.clear();
    }
  }
}

// Each stage with its phases below it, in the order of their first use in a step.
void printMemory(std::vector<ScopeMemory> memory, long steps) {
  const auto stageOf = [](const std::string& scope) { return scope.substr(0, scope.find('.')); };
  std::vector<std::string> stages;
  for (const ScopeMemory& m : memory) {
    if (std::find(stages.begin(), stages.end(), stageOf(m.scope)) == stages.end()) stages.push_back(stageOf(m.scope));
  }
  const auto place = [&](const ScopeMemory& m) {
    return std::pair(std::find(stages.begin(), stages.end(), stageOf(m.scope)), m.scope.find('.') != m.scope.npos);
  };
  std::stable_sort(memory.begin(), memory.end(),
                   [&](const ScopeMemory& a, const ScopeMemory& b) { return place(a) < place(b); });
  std::printf("\n%-22s %12s %12s %12s %10s %8s\n", "memory", "held B", "allocated B", "allocations", "a step",
              "last in");
  const auto row = [&](const std::string& name, const MemoryUse& use, const std::string& last) {
    std::printf("  %-20s %12lld %12lld %12lld %10.4g %8s\n", name.c_str(), static_cast<long long>(use.held),
                static_cast<long long>(use.allocated), static_cast<long long>(use.allocations),
                double(use.allocations) / double(std::max(1L, steps)), last.c_str());
  };
  MemoryUse together;
  for (const ScopeMemory& m : memory) {
    row(m.scope, m.use, m.lastStep < 0 ? "never" : std::to_string(m.lastStep));
    together += m.use;
  }
  row("together", together, "");
}

// Empty if the worker reported an error.
std::optional<std::string> answerOf(const std::string& program, const json& request) {
  Child worker(program, request.dump(), -1, true);
  if (!worker.wait(&InterruptGuard::interrupted)) throw Interrupted();
  if (worker.flooded()) throw std::runtime_error("the worker's output exceeds its limit");
  if (worker.signal()) throw std::runtime_error("the worker crashed with signal " + std::to_string(worker.signal()));
  if (worker.exitCode() == 2) return std::nullopt;
  if (worker.exitCode()) throw std::runtime_error("the worker ended with " + std::to_string(worker.exitCode()));
  return worker.output();
}

void runScene(const RunSceneOptions& o, Session& session) {
  const std::string plotFile = o.plot.ends_with(".svg") ? o.plot : "";
  if (!o.plot.empty() && plotFile.empty()) requireSeries(o.plot);
  NamedFiles inputs = {{"the scene", findToml("scenes", o.scene)}};
  if (!o.script.empty()) inputs.emplace_back("the script", findToml("scripts", o.script));
  for (const std::string& path : session.plugins) inputs.emplace_back("the plugin", path);
  for (const std::string& path : {o.record, o.profile}) {
    if (isOwnStream(path))
      throw UserError(path + ": is a stream of this process, which the worker cannot write; valid: a file");
  }
  const std::vector<SaveRequest> saves = readSaves(o.saves);
  NamedFiles outputs = {{"--record", o.record}, {"--profile", o.profile}, {"--film", o.film}, {"--plot", plotFile}};
  for (const SaveRequest& s : saves) {
    outputs.emplace_back("--save", s.scene), outputs.emplace_back("--save", SavedScene::worldPath(s.scene));
  }
  keepApart(inputs, outputs);
  if (!o.film.empty()) filmKind(o.film);  // before the run, which may take hours
  WorldCell cell;
  cell.params = readParameters(o.params), cell.script = o.script;
  Planner planner;
  const SceneFile& file = planner.scene(o.scene, o.script);
  cell.dimension = o.dimension,
  cell.pipeline = pipelineOf(o.pipeline, o.dimension.value_or(file.dimensions().at(0)), o.noSleeping);
  if (o.memory && engineOf(cell.pipeline)) {
    throw UserError("--memory: an engine has its own stages and allocator; valid: a pipeline of LPC's stages");
  }
  cell.precision = o.precision, cell.timed = true;
  cell.dt = o.dt, cell.steps = o.steps, cell.seed = o.seed;
  const PlannedTrial trial = planner.world(o.scene, cell);
  if (!trial.unsupported.empty()) throw UserError(trial.unsupported);
  requireCheckedConstructors();
  TrialRequest request = trial.request;
  request.progress = !o.asJson, request.memory = o.memory, request.profile = o.profile, request.saves = saves;
  for (const std::string& path : session.plugins) {
    if (pluginPrecision(path) == o.precision) request.plugins.push_back(std::filesystem::absolute(path).string());
  }
  for (const SaveRequest& s : saves) {
    if (request.ofEngine())
      throw UserError("--save: the state of an engine cannot be saved; valid: a pipeline of LPC's stages");
    if (const long last = trial.world().steps; s.step > last) {
      throw UserError("--save: the run has " + std::to_string(last) + " steps; asked: step " + std::to_string(s.step));
    }
  }
  std::optional<OutputFile> picture;
  if (!plotFile.empty()) picture.emplace(plotFile);
  const InterruptGuard interrupts;
  // A film needs a recording, which is temporary unless the user asked for it.
  std::optional<TemporaryRecording> temporary;
  const bool asText = o.record.ends_with(".csv") || o.record.ends_with(".json");
  if (asText) request.trajectory = o.record;
  if ((asText || o.record.empty()) && !o.film.empty()) temporary.emplace();
  const std::string recording = temporary ? temporary->path() : asText ? "" : o.record;
  request.record = recording;
  std::vector<std::string> partial;  // left over by a killed worker
  std::vector<std::string> written = {o.record, o.profile};
  for (const SaveRequest& s : saves) written.push_back(s.scene), written.push_back(SavedScene::worldPath(s.scene));
  for (const std::string& path : written) {
    if (path.empty()) continue;
    if (const std::string there = OutputFile::writtenAt(path); there != path) partial.push_back(there);
  }
  std::optional<std::string> answer;
  try {
    answer = answerOf(workerPath(o.precision, request.ofEngine()), toJson(request));
  } catch (...) {
    for (const std::string& path : partial) std::remove(path.c_str());
    throw;
  }
  if (!answer) {
    session.exitCode = 2;
    return;
  }
  TrialResult result;
  try {
    result = resultFromJson(json::parse(*answer));
  } catch (const json::exception&) {
    throw std::runtime_error("the worker's result is unreadable");
  }
  if (o.asJson) {
    std::printf("%s\n", answer->c_str());
  } else {
    print(trial.world(), result);
    if (!result.memory.empty()) printMemory(result.memory, std::lround(result.metrics.at("steps_done")));
    if (o.plots && !picture) printPlots(o, result);
    if (picture) {
      picture->stream() << seriesPicture(
          o.scene + ", " + (cell.pipeline.empty() ? "the default pipeline" : cell.pipeline), result.series,
          trial.world().dt);
      picture->finish();
      std::printf("plot      %s\n", plotFile.c_str());
    }
    if (!o.profile.empty()) std::printf("profile   %s\n", o.profile.c_str());
    if (!o.record.empty()) std::printf("%s %s\n", asText ? "rows     " : "recording", o.record.c_str());
    for (const SaveRequest& s : saves) {
      const bool reached = result.outcome == "ok" || (result.outcome != "unsupported" && s.step <= result.step);
      std::printf(reached ? "saved     step %ld as %s\n" : "not saved step %ld as %s: the run ended earlier\n", s.step,
                  s.scene.c_str());
    }
  }
  if (!o.film.empty() && result.outcome != "unsupported") {  // otherwise nothing has moved
    // Before the film, which may still fail.
    if (std::fflush(stdout) != 0)
      throw UserError(std::string("standard output cannot be written: ") + std::strerror(errno));
    const std::string told = filmRecording(recording, o.film);
    if (!o.asJson) std::printf("%s\n", told.c_str());
  }
  session.exitCode = result.outcome == "ok" ? 0 : 1;
}

void addRun(CommandLine& app, Session& session) {
  CommandLine command = app.subcommand("run", "Runs one scene and prints its metrics; exit code 1 when it fails");
  auto o = std::make_shared<RunSceneOptions>();
  command.option("scene", o->scene, "name in experiments/scenes, the number of a preset, or a TOML file").required();
  command.option(
      "--script", o->script,
      "script to play in the scene: name in experiments/scripts, number of a 2009 director script, or a file");
  command.option("--pipeline", o->pipeline,
                 "algorithms, such as \"solver=soft_step{substeps=4} sleep=none\", or \"engine=box2d\"; 2009: the "
                 "algorithms of the 2009 report");
  command.option("--param", o->params, "a parameter of the scene, NAME=NUMBER or joint=KIND (may be repeated)");
  command.option("--dt", o->dt, "length of a step (s); default: the scene's");
  command.option("--steps", o->steps, "number of steps; default: the scene's");
  command.option("--seed", o->seed, "seed of the scene's random numbers; default: the scene's")
      .range(0L, std::numeric_limits<long>::max());
  command.option("--dimension", o->dimension, "2 or 3; default: the scene's first");
  command.option("--precision", o->precision, "f64 or f32");
  command.option("--profile", o->profile,
                 "writes times and counts per step as CSV; with --memory also the allocations");
  command.flag("--memory", o->memory, "prints the bytes that each stage allocates and holds");
  command.option(
      "--record", o->record,
      "writes all poses of all steps to this file: for lpc replay, or as rows of text to NAME.csv or NAME.json");
  command.option("--save", o->saves,
                 "AT:FILE.toml: writes the world after AT steps as a scene that starts from it (may be repeated)");
  command.flag("--no-sleeping", o->noSleeping, "keeps every body awake, whatever the pipeline");
  command.option("--film", o->film,
                 "draws the run: NAME.svg (animated), NAME.strip.svg (eight moments) or NAME/ (PNG files)");
  Option plot =
      command.option("--plot", o->plot,
                     "draws this series over the steps, or `timeline`: the phases of a step as in the 2009 "
                     "report; without a name: the timeline, and every series in one line; NAME.svg: a picture of "
                     "energy, penetration and speed");
  plot.valueOptional();
  plot.without(command.flag("--json", o->asJson, "the whole result as JSON, with all series"));
  command.footer(
      "Example: lpc run pyramid --param base=10 --dimension 3 --profile pyramid.csv\n"
      "         lpc run bouncing_ball --plot kinetic\n"
      "         lpc run director_1 --param rain_until=500 --plot timeline\n"
      "         lpc run bouncing_ball --plot bouncing_ball.svg\n"
      "         lpc run pyramid --memory\n"
      "         lpc run pyramid --film pyramid.svg");
  command.callback([o, plot, &session] {
    o->plots = plot.given();
    runScene(*o, session);
  });
}

LPC_COMMAND("run", addRun);

}  // namespace
}}  // namespace lpc::LPC_PRECISION
