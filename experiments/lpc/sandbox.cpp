// SPDX-License-Identifier: Zlib
// Starts the window, which is a separate program: everything else works without its libraries.
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "experiments/lpc/command.h"
#include "experiments/lpc/scene_options.h"
#include "experiments/parse/toml_reader.h"
#include "experiments/runner/locations.h"
#include "experiments/runner/plugin_probe.h"
#include "experiments/runner/store.h"
#include "experiments/runner/trial_plan.h"
#include "experiments/trial/plugin.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

using nlohmann::json;

struct SandboxOptions {
  std::vector<std::string> what, pipelines, params;
  std::string number, script, profile, trial, input, precision = "f64";
  std::optional<std::uint64_t> seed;
  std::optional<double> dt;
  bool unseen = false, profiled = false, plots = false, noSleeping = false;
};

// `2d`, `3d` and what to open, in any order, as in the sandbox of 2009.
struct Asked {
  std::optional<int> dimension;
  std::string scene;
};
Asked readWhat(const SandboxOptions& o) {
  Asked out;
  for (const std::string& word : o.what) {
    if (word == "2d" || word == "2D" || word == "3d" || word == "3D") {
      const int dimension = word[0] - '0';
      if (out.dimension.value_or(dimension) != dimension)
        throw UserError("2d and 3d are both given; valid: one dimension");
      out.dimension = dimension;
    } else if (word.empty()) {
      throw UserError("the scene is ''; valid: a name, a number or a file");
    } else if (out.scene.empty()) {
      out.scene = word;
    } else {
      throw UserError("'" + word + "' and '" + out.scene + "' are both given; valid: one scene, or one store");
    }
  }
  if (!o.number.empty()) {
    if (!out.scene.empty())
      throw UserError("-s " + o.number + " and '" + out.scene + "' are both given; valid: one scene");
    out.scene = o.number;
  }
  return out;
}

[[noreturn]] void become(const std::string& program, std::vector<std::string> arguments) {
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (std::string& a : arguments) words.push_back(a.data());
  words.push_back(nullptr);
  std::fflush(nullptr);
  execv(program.c_str(), words.data());
  throw UserError(program + ": cannot be started");
}

std::filesystem::path programFolder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

// One program for each precision, like workers.
std::string programOf(const std::string& precision) {
  const std::string name = precision == "f64" ? "lpc-sandbox" : "lpc-sandbox-" + precision;
  const std::filesystem::path program = programFolder() / name;
  if (std::filesystem::exists(program)) return program.string();
  const std::string build = programFolder().parent_path().string();
  throw UserError(program.string() + " does not exist; build it: .ci/install_packages window && cmake " + build +
                  " && cmake --build " + build + " --target " + name);
}

// Without a window, behaves like `lpc run`.
[[noreturn]] void runUnseen(const SandboxOptions& o, const Asked& asked) {
  if (o.pipelines.size() > 1)
    throw UserError("-i with several pipelines; valid: one pipeline, because -i opens no window");
  std::vector<std::string> words = {"run", asked.scene};
  const auto add = [&](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
  add({"--precision", o.precision});
  if (asked.dimension) add({"--dimension", std::to_string(*asked.dimension)});
  if (!o.script.empty()) add({"--script", o.script});
  if (o.profiled || o.plots) add({"--profile", o.profile.empty() ? "sandbox_profile.csv" : o.profile});
  if (o.plots) add({"--plot", "timeline"});
  if (o.noSleeping) add({"--no-sleeping"});
  if (o.pipelines.size() == 1) add({"--pipeline", o.pipelines[0]});
  for (const std::string& p : o.params) add({"--param", p});
  if (o.seed) add({"--seed", std::to_string(*o.seed)});
  if (o.dt) add({"--dt", asText(*o.dt)});
  become((programFolder() / "lpc").string(), words);
}

// The cell of a sweep, one step before its failure.
json trialOpening(const std::string& store, const std::string& key) {
  const StoredTrial found = Store(store, false).find(key);
  const json& t = found.canonical;
  if (t.at("kind") != "world") {
    throw UserError("--trial: " + key + " is a trial of kind '" + t.at("kind").get<std::string>() +
                    "'; valid: kind 'world'");
  }
  const auto asked = std::get<WorldRequest>(trialFromJson(t));
  WorldCell cell;
  cell.params = asked.params, cell.script = asked.script, cell.dimension = asked.dimension;
  cell.pipeline = asked.pipeline, cell.dt = asked.dt, cell.seed = asked.seed, cell.precision = asked.precision;
  Planner planner;
  const PlannedTrial now = planner.world(asked.scene, cell);
  if (!now.unsupported.empty()) throw UserError(now.unsupported);
  std::string told = found.outcome;
  if (found.step > 0) told += " at step " + std::to_string(found.step);
  if (!found.reason.empty()) told += ": " + found.reason;
  for (const char* part : {"scene_hash", "core", "code"}) {
    if (now.canonical.value(part, json()) == t.value(part, json())) continue;
    told += "; scene or code have changed since, so it may not fail again";
    break;
  }
  return {{"scene", now.request.sceneFile},
          {"script", now.request.scriptFile},
          {"parameters", asked.params},
          {"seed", asked.seed},
          {"dimension", asked.dimension},
          {"pipelines", {asked.pipeline}},
          {"dt", asked.dt},
          {"precision", asked.precision},
          {"features", asked.features},
          {"steps", found.step > 0 ? found.step - 1 : 0},
          {"say", told}};
}

json sceneOpening(const SandboxOptions& o, const Asked& asked) {
  Planner planner;
  const SceneFile& file = planner.scene(asked.scene, o.script);
  WorldCell cell;
  cell.params = readParameters(o.params), cell.script = o.script, cell.seed = o.seed, cell.dt = o.dt;
  cell.dimension = asked.dimension, cell.precision = o.precision;
  json out = {{"scene", file.path()}, {"script", file.scriptPath()}, {"precision", o.precision}};
  for (std::string pipeline : o.pipelines.empty() ? std::vector<std::string>{""} : o.pipelines) {
    pipeline = pipelineOf(pipeline, asked.dimension.value_or(file.dimensions().at(0)), o.noSleeping);
    cell.pipeline = pipeline;
    const PlannedTrial trial = planner.world(asked.scene, cell);
    if (!trial.unsupported.empty()) throw UserError(trial.unsupported);
    requireCheckedConstructors();
    out["pipelines"].push_back(pipeline);
    out["dimension"] = trial.asked().dimension;
    out["parameters"] = trial.world().params, out["dt"] = trial.world().dt;
  }
  if (o.seed) out["seed"] = *o.seed;
  return out;
}

void sandbox(const SandboxOptions& o, const Session& session) {
  Asked asked = readWhat(o);
  if (!o.trial.empty() && asked.scene.empty())
    throw UserError("--trial needs a store; valid: lpc sandbox STORE.db --trial KEY");
  if (!o.trial.empty() && asked.dimension)
    throw UserError("--trial and a dimension are both given; valid: --trial alone, which has its own");
  if (!o.profile.empty() && !o.profiled && !o.plots) throw UserError("-o needs a profile; valid: with -p or -g");
  if (asked.scene.empty()) asked.scene = "1";  // that of 2009
  if (o.unseen) runUnseen(o, asked);
  if (o.pipelines.size() > 8) throw UserError(std::to_string(o.pipelines.size()) + " pipelines; valid: up to 8");
  json opening = o.trial.empty() ? sceneOpening(o, asked) : trialOpening(asked.scene, o.trial);
  if (o.profiled || o.plots) opening["profile"] = o.profile.empty() ? "sandbox_profile.csv" : o.profile;
  opening["plots"] = o.plots, opening["input"] = o.input;
  const std::string precision = opening.at("precision");
  for (const std::string& path : session.plugins) {
    if (pluginPrecision(path) == precision) opening["plugins"].push_back(path);
  }
  become(programOf(precision), {opening.dump()});
}

void addSandbox(CommandLine& app, Session& session) {
  CommandLine command = app.subcommand("sandbox", "Opens a scene in a window: edit it by hand, compare competitors");
  auto o = std::make_shared<SandboxOptions>();
  command.option(
      "scene", o->what,
      "2d or 3d, and a scene: name in experiments/scenes, number of a preset or TOML file; or a store with --trial");
  const Option ofScene[] = {
      command.option("-s,--scene", o->number, "number of a 2009 preset, 0 to 11, or a scene"),
      command.option("-S,--script", o->script,
                     "script to play in the scene: number of a director script, name or file"),
      command.option("--pipeline", o->pipelines,
                     "algorithms, or engine=NAME; up to 8 run side by side (may be repeated)"),
      command.option("--param", o->params, "a parameter of the scene, NAME=NUMBER or joint=KIND (may be repeated)"),
      command.option("--dt", o->dt, "length of a step (s); default: the scene's"),
      command.option("--seed", o->seed, "seed of the scene's random numbers; default: the scene's"),
      command.option("--precision", o->precision, "f64 or f32; with --trial: the trial's"),
      command.flag("--no-sleeping", o->noSleeping, "keeps every body awake")};
  Option unseen = command.flag("-i", o->unseen, "runs without a window, like lpc run");
  command.flag("-p", o->profiled, "writes times and counts of each step as CSV at exit");
  command.flag("-g", o->plots, "like -p, and plots them in a panel, or with -i in the terminal");
  Option profile = command.option("-o", o->profile, "file of the profile; default: sandbox_profile.csv");
  Option trial = command.option("--trial", o->trial,
                                "trial of a store, by the first digits of its key: opens it one step before it failed");
  trial.without(unseen);
  for (const Option& other : ofScene) trial.without(other);  // options that the cell already decides
  Option input = command.option("--input", o->input, "replays keys and mouse from a file");
  input.file().without(unseen);
  command.footer(
      "Example: lpc sandbox\n"
      "         lpc sandbox 3d -s 5\n"
      "         lpc sandbox pyramid --pipeline solver=soft_step --pipeline solver=avbd\n"
      "         lpc sandbox results/quick.db --trial 3f2a");
  const Option named[] = {ofScene[0], ofScene[1], trial, input, profile};
  command.callback([o, named = std::to_array(named), &session] {
    const std::pair<const char*, const std::string*> texts[] = {{"--scene", &o->number},
                                                                {"--script", &o->script},
                                                                {"--trial", &o->trial},
                                                                {"--input", &o->input},
                                                                {"-o", &o->profile}};
    for (std::size_t i = 0; i < named.size(); ++i) {
      if (named[i].given() && texts[i].second->empty())
        throw UserError(std::string(texts[i].first) + ": the value is empty; valid: see lpc sandbox --help");
    }
    sandbox(*o, session);
  });
}

LPC_COMMAND("sandbox", addSandbox);

}  // namespace
}}  // namespace lpc::LPC_PRECISION
