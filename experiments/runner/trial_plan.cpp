// SPDX-License-Identifier: Zlib
#include "experiments/runner/trial_plan.h"

#include <algorithm>
#include <filesystem>
#include <limits>

#include "experiments/parse/toml_reader.h"
#include "experiments/runner/code_identity.h"
#include "experiments/runner/locations.h"
#include "experiments/runner/plugin_probe.h"
#include "experiments/trial/box_distribution.h"
#include "experiments/trial/measure/problems_metrics.h"
#include "experiments/trial/pair_drawing.h"
#include "framework/math/names.h"
#include "framework/world/stage_engine.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;

constexpr int kSchema = 1;
constexpr long kMaxItems = 10000000;  // boxes, frames or pairs of one trial
constexpr long kMaxVertices = 4096;   // of a drawn hull
constexpr long kMaxCurve = 100000;    // iterations in a problem's trial, which solves it with each number up to this

bool existsIn(StageKind stage, int dimension, const std::string& name) {
  return Registry::instance().all().count({stage, dimension, name}) > 0;
}

// Completes a spec with every parameter. An algorithm that exists only in the other dimension is not a mistake of the
// user but a gap: `unsupported` gets the reason.
json canonicalStage(json& code, std::string& unsupported, StageKind stage, Spec& spec, int dimension) {
  if (!existsIn(stage, dimension, spec.name) && existsIn(stage, 5 - dimension, spec.name)) {
    unsupported =
        std::string(stageName(stage)) + " " + spec.name + " does not exist in " + std::to_string(dimension) + "D";
    return spec.text();
  }
  const auto complete = [&](int d) {
    const Registered& entry = Registry::instance().find(stage, d, spec.name);
    const Spec whole = entry.canonical(spec);
    checkConstructor(entry, whole);
    return whole;
  };
  try {
    spec = complete(dimension);
    code.update(codeHashes(stage, spec, dimension));
  } catch (const UserError& e) {
    try {
      complete(5 - dimension);
    } catch (const UserError&) {
      throw e;  // a mistake in either dimension; report that of the requested one
    }
    unsupported = e.what();  // a nested stage is missing in this dimension
  }
  return spec.text();
}

template <int D>
std::string differencesOf(const Spec& engine) {
  return createStage<Engine<D>>(engine)->differences();
}

// Stored with the trial: the engine, and how it always differs from our worlds.
json canonicalEngine(json& code, std::string& unsupported, Spec& engine, int dimension) {
  json out = {{"name", engine.name}, {"differs", ""}};
  const auto& all = Registry::instance().all();
  if (std::none_of(all.begin(), all.end(), [](const auto& r) { return r.second.stage == StageKind::engine; })) {
    unsupported = "this build has no engines (LPC_BUILD_ORACLES=OFF)";
    return out;
  }
  canonicalStage(code, unsupported, StageKind::engine, engine, dimension);
  const bool ours = existsIn(StageKind::engine, dimension, engine.name) &&
                    !isOfPlugin(Registry::instance().find(StageKind::engine, dimension, engine.name));
  if (unsupported.empty() && ours)
    out["differs"] = dimension == 2 ? differencesOf<2>(engine) : differencesOf<3>(engine);
  return out;
}

// The kind in a scene's parameter `joint`, with all its parameters.
void canonicalJoint(json& code, std::string& unsupported, const SceneFile& file, ParameterValues& params,
                    int dimension) {
  const auto it = params.find(kJointParameter);
  if (it == params.end() || !it->second.isText()) return;
  try {
    Spec kind = Spec::parse(it->second.text);
    it->second = canonicalStage(code, unsupported, StageKind::joint, kind, dimension).get<std::string>();
  } catch (const UserError& e) {
    throw UserError("parameter 'joint' of scene '" + file.name() + "': " + e.what());
  }
}

void seal(PlannedTrial& trial) {
  trial.canonical["schema"] = kSchema;
  trial.canonical["core"] = coreHash();
  trial.key = trialKey(trial.canonical);
  trial.request.trial = trialFromJson(trial.canonical);
}

void require(const json& cell, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (!cell.contains(name)) {
      throw UserError("a trial of kind '" + cell.at("kind").get<std::string>() + "' needs the axis '" + name + "'");
    }
  }
}

void requirePrecision(const std::string& precision) {
  if (precision != "f64" && precision != "f32") {
    throw UserError("unknown precision '" + precision + "'; valid: f64, f32");
  }
}

std::string text(const json& cell, const char* name) {
  if (!cell.at(name).is_string()) {
    throw UserError("axis '" + std::string(name) + "' is " + cell.at(name).dump() + "; valid: a name");
  }
  return cell.at(name);
}

// For trials without a world.
void addDefaults(json& cell, const char* sizeName, int size) {
  cell.emplace(sizeName, size);  // emplace keeps an existing value
  cell.emplace("seed", 1), cell.emplace("repeat", 0), cell.emplace("timed", false), cell.emplace("precision", "f64");
  wholeNumber(cell, "dimension", 2, 3);
  wholeNumber(cell, "n", 1, kMaxItems), wholeNumber(cell, sizeName, 1, kMaxItems);
  wholeNumber(cell, "seed", 0, std::numeric_limits<long>::max());
  requirePrecision(text(cell, "precision"));
}

// An axis that names an entry of a table, with every parameter.
template <class Entry>
void canonicalEntry(json& cell, const char* axis, const std::vector<Entry>& table) {
  const Spec spec = Spec::parse(text(cell, axis));
  cell[axis] = findEntry(table, axis, spec.name).info.canonical(spec).text();
}

}  // namespace

void PlannedTrial::setRepeat(int repeat) {
  request.base().repeat = repeat, axes["repeat"] = repeat;
  mark("repeat", repeat);
}
void PlannedTrial::setSeed(std::uint64_t seed) {
  request.base().seed = seed, axes["seed"] = seed;
  mark("seed", seed);
}
void PlannedTrial::mark(const char* name, json value) {
  canonical[name] = std::move(value);
  key = trialKey(canonical);
}

bool isFrozenAxis(const std::string& kind, const std::string& axis) {
  static const std::map<std::string, std::set<std::string>> kAxes = {
      {"boxes", {"dimension", "n", "distribution", "frames", "broadphase", "seed"}},
      {"pairs",
       {"dimension", "n", "drawing", "pair_query", "kind_a", "kind_b", "vertices", "seed", "scene", "from", "steps",
        "stream"}},
      {"problems", {"problems", "problem", "velocity", "start", "order", "friction", "iterations"}}};
  static const std::set<std::string> kAll = {"precision", "timed", "repeat"};
  return kAll.count(axis) || kAxes.at(kind).count(axis);
}

long wholeNumber(const json& axes, const std::string& name, long lo, long hi) {
  const json& value = axes.at(name);
  if (!value.is_number_integer() || value < lo || value > hi) {
    throw UserError("axis '" + name + "' is " + value.dump() + "; valid: whole numbers from " + std::to_string(lo) +
                    " to " + std::to_string(hi));
  }
  return value;
}

std::string trialKey(const json& canonical) { return hexHash(canonical.dump()); }

const SceneFile& Planner::scene(const std::string& nameOrPath, const std::string& script) {
  const std::pair key(nameOrPath, script);
  auto it = m_scenes.find(key);
  if (it == m_scenes.end()) {
    const std::string path = findToml("scenes", nameOrPath);
    it = m_scenes.emplace(key, SceneFile::load(path, script.empty() ? "" : findToml("scripts", script))).first;
  }
  return it->second;
}

const Planner::Defaults* Planner::built(const SceneFile& file, const ParameterValues& params, std::uint64_t seed,
                                        int dimension, std::string& unsupported) {
  const std::string id = file.path() + '\0' + file.scriptPath() + json(params).dump() + std::to_string(seed) + "/" +
                         std::to_string(dimension);
  if (const auto it = m_built.find(id); it != m_built.end()) return &it->second;
  const auto defaults = [](const auto& spec) {
    Defaults found{spec.dt, spec.steps, {}, spec.seeded};
    for (const auto& joint : spec.joints) found.kinds.emplace(StageKind::joint, joint.def.kind);
    for (const auto& force : spec.forces) found.kinds.emplace(StageKind::force, force.def.kind);
    return found;
  };
  try {
    const Defaults found =
        dimension == 2 ? defaults(file.build<2>(params, seed)) : defaults(file.build<3>(params, seed));
    return &m_built.emplace(id, found).first->second;
  } catch (const UnsupportedJoint& e) {
    unsupported = e.what();
    return nullptr;
  }
}

PlannedTrial Planner::world(const std::string& name, const WorldCell& cell) {
  const SceneFile& file = scene(name, cell.script);
  PlannedTrial out;
  out.request.sceneFile = file.path(), out.request.scriptFile = file.scriptPath();
  const int dimension = cell.dimension.value_or(file.dimensions().at(0));
  if (dimension != 2 && dimension != 3) {
    throw UserError("the dimension is " + std::to_string(dimension) + "; valid: 2, 3");
  }
  if (cell.dt && !(*cell.dt > 0 && *cell.dt <= kMaxDt)) {
    throw UserError("dt is " + asText(*cell.dt) + " s; valid: above 0, up to " + asText(kMaxDt));
  }
  if (cell.steps && *cell.steps < 0) {
    throw UserError("the number of steps is " + std::to_string(*cell.steps) + "; valid: 0 or more");
  }
  requirePrecision(cell.precision);
  const std::uint64_t seed = cell.seed.value_or(file.defaultSeed());
  ParameterValues params = file.values(cell.params);
  json code = json::object();
  std::optional<Spec> engine = engineOf(cell.pipeline);
  json engineData;
  Pipeline pipeline = Pipeline::parse(engine ? "" : cell.pipeline);
  if (engine) {
    engineData = canonicalEngine(code, out.unsupported, *engine, dimension);
  } else {
    for (const StageKind stage : kWorldStages) canonicalStage(code, out.unsupported, stage, pipeline[stage], dimension);
  }

  Defaults defaults{cell.dt.value_or(0), cell.steps.value_or(0), {}, true};
  const std::string features = cell.features ? *cell.features : modelText(file.model());
  std::string missing;  // why the scene cannot be built
  canonicalJoint(code, missing, file, params, dimension);
  if (!file.has(dimension)) missing = "scene " + file.name() + " does not exist in " + std::to_string(dimension) + "D";
  if (const Defaults* found = missing.empty() ? built(file, params, seed, dimension, missing) : nullptr) {
    if (!cell.dt) defaults.dt = found->dt;
    if (!cell.steps) defaults.steps = found->steps;
    out.seeded = found->seeded;
    for (const auto& [stage, kind] : found->kinds) code.update(codeHashes(stage, Spec::parse(kind), dimension));
  }
  if (!missing.empty()) out.unsupported = missing;
  WorldRequest asked;
  asked.scene = file.name(), asked.params = params, asked.dimension = dimension, asked.precision = cell.precision;
  asked.pipeline = engine ? "engine=" + engine->text() : pipeline.text();
  asked.dt = defaults.dt, asked.steps = defaults.steps, asked.seed = seed;
  asked.features = modelText(modelFromText(features)), asked.repeat = cell.repeat, asked.timed = cell.timed;
  // Its content is in the scene's hash.
  if (!cell.script.empty()) asked.script = std::filesystem::path(file.scriptPath()).stem().string();
  asked.posesEvery = cell.posesEvery.value_or(0), asked.series = cell.series;
  out.canonical = toJson(asked);
  out.canonical["scene_hash"] = hexHash(file.content()), out.canonical["code"] = code;
  if (engine) out.canonical["engine"] = engineData;
  seal(out);
  return out;
}

PlannedTrial Planner::boxes(json cell) {
  cell["kind"] = "boxes";
  require(cell, {"dimension", "n", "distribution", "broadphase"});
  addDefaults(cell, "frames", 60);
  canonicalEntry(cell, "distribution", boxDistributions());
  PlannedTrial out;
  json code = json::object();
  Spec spec = Spec::parse(text(cell, "broadphase"));
  cell["broadphase"] = canonicalStage(code, out.unsupported, StageKind::broadphase, spec, cell["dimension"]);
  cell["code"] = code;
  out.canonical = std::move(cell);
  seal(out);
  return out;
}

PlannedTrial Planner::problems(json cell) {
  cell["kind"] = "problems";
  require(cell, {"problems", "velocity"});
  cell.emplace("problem", 0), cell.emplace("iterations", 50), cell.emplace("start", "warm");
  cell.emplace("order", "recorded"), cell.emplace("friction", "on");
  cell.emplace("repeat", 0), cell.emplace("timed", false), cell.emplace("precision", "f64");
  requirePrecision(text(cell, "precision"));
  wholeNumber(cell, "iterations", 0, kMaxCurve);
  const std::pair<const char*, std::vector<std::string>> choices[] = {
      {"start", {"warm", "cold"}}, {"order", {"recorded", "coloured"}}, {"friction", {"on", "off"}}};
  for (const auto& [axis, valid] : choices) {
    if (std::find(valid.begin(), valid.end(), text(cell, axis)) != valid.end()) continue;
    throw UserError("axis '" + std::string(axis) + "' is " + cell[axis].dump() + validNames(valid, text(cell, axis)));
  }
  PlannedTrial out;
  const std::string path = out.request.sceneFile = findProblems(text(cell, "problems"));
  auto it = m_problems.find(path);
  if (it == m_problems.end()) {
    const std::string bytes = readFile(path);
    it = m_problems.emplace(path, std::pair(hexHash(bytes), ProblemFile::parse(bytes, path))).first;
  }
  const ProblemFile& file = it->second.second;
  wholeNumber(cell, "problem", 0, static_cast<long>(file.size()) - 1);
  cell["problems"] = std::filesystem::path(path).stem().string(), cell["problems_hash"] = it->second.first;
  cell["dimension"] = file.dimension;
  json code = json::object();
  Spec spec = Spec::parse(text(cell, "velocity"));
  if (existsIn(StageKind::solver, file.dimension, spec.name)) {
    out.unsupported = spec.name + " integrates between its passes, so it has no separate velocity problem";
  } else {
    cell["velocity"] = canonicalStage(code, out.unsupported, StageKind::velocity, spec, file.dimension);
    if (out.unsupported.empty() && file.isMatrix(cell["problem"].get<std::size_t>())) {
      const bool able = Registry::instance().find(StageKind::velocity, file.dimension, spec.name).info.matrixAlone;
      if (!able) out.unsupported = spec.name + " needs bodies, and a problem given as a matrix has none";
      if (able && cell["order"] == "coloured")
        out.unsupported = "a problem given as a matrix has no bodies for colouring contacts";
    }
    for (const char* reference : kReferenceResolvers) {
      code.update(codeHashes(StageKind::velocity, Spec::parse(reference), file.dimension));
    }
  }
  cell["code"] = code;
  out.canonical = std::move(cell);
  seal(out);
  return out;
}

PlannedTrial Planner::streamOfPairs(json cell) {
  require(cell, {"dimension", "pair_query", "stream"});
  for (const char* axis : {"kind_a", "kind_b", "vertices"}) {
    if (cell.contains(axis))
      throw UserError("axis '" + std::string(axis) +
                      "' and 'scene' exclude each other, because a scene has its own shapes");
  }
  cell.emplace("from", 0), cell.emplace("steps", 60), cell.emplace("drawing", "near");
  cell.emplace("repeat", 0), cell.emplace("timed", false), cell.emplace("precision", "f64");
  requirePrecision(text(cell, "precision"));
  const auto dimension = static_cast<int>(wholeNumber(cell, "dimension", 2, 3));
  wholeNumber(cell, "from", 0, kMaxItems), wholeNumber(cell, "steps", 1, kMaxItems);
  const std::vector<std::string> streams = {"cold", "warm", "drawn"};
  if (std::find(streams.begin(), streams.end(), text(cell, "stream")) == streams.end()) {
    throw UserError("axis 'stream' is " + cell["stream"].dump() + validNames(streams, text(cell, "stream")));
  }
  canonicalEntry(cell, "drawing", pairDrawings());
  const SceneFile& file = scene(text(cell, "scene"));
  cell.emplace("seed", file.defaultSeed());
  const auto seed = static_cast<std::uint64_t>(wholeNumber(cell, "seed", 0, std::numeric_limits<long>::max()));
  ParameterValues asked;
  for (const SceneParameter& p : file.parameters()) {
    if (!cell.contains(p.name)) continue;
    if (!cell[p.name].is_number()) {
      throw UserError("axis '" + p.name + "' is " + cell[p.name].dump() + "; valid: numbers");
    }
    asked[p.name] = cell[p.name].get<double>();
    cell.erase(p.name);
  }
  ParameterValues params = file.values(asked);
  PlannedTrial out;
  out.request.sceneFile = file.path();
  json code = json::object();
  Spec spec = Spec::parse(text(cell, "pair_query"));
  cell["pair_query"] = canonicalStage(code, out.unsupported, StageKind::pairQuery, spec, dimension);
  std::string missing;
  canonicalJoint(code, missing, file, params, dimension);
  if (!file.has(dimension)) missing = "scene " + file.name() + " does not exist in " + std::to_string(dimension) + "D";
  if (const Defaults* found = missing.empty() ? built(file, params, seed, dimension, missing) : nullptr) {
    for (const auto& [stage, kind] : found->kinds) code.update(codeHashes(stage, Spec::parse(kind), dimension));
    Pipeline world;  // that records the stream
    for (const StageKind stage : kWorldStages) canonicalStage(code, missing, stage, world[stage], dimension);
  }
  if (!missing.empty()) out.unsupported = missing;
  code["oracles"] = oraclesHash();
  cell["scene"] = file.name(), cell["scene_hash"] = hexHash(file.content()), cell["params"] = params,
  cell["code"] = code;
  out.canonical = std::move(cell);
  seal(out);
  return out;
}

PlannedTrial Planner::pairs(json cell) {
  cell["kind"] = "pairs";
  if (cell.contains("scene")) return streamOfPairs(std::move(cell));
  for (const char* axis : {"stream", "from", "steps"}) {
    if (cell.contains(axis))
      throw UserError("axis '" + std::string(axis) + "' needs the axis 'scene', which gives the pairs");
  }
  require(cell, {"dimension", "kind_a", "kind_b", "pair_query"});
  addDefaults(cell, "n", 1024);
  cell.emplace("drawing", "in_turn");
  canonicalEntry(cell, "drawing", pairDrawings());
  if (shapeKindFromName(text(cell, "kind_a")) > shapeKindFromName(text(cell, "kind_b"))) {
    std::swap(cell["kind_a"], cell["kind_b"]);
  }
  if (cell.contains("vertices")) {
    wholeNumber(cell, "vertices", 4, kMaxVertices);
    if (cell["kind_a"] != "polytope" && cell["kind_b"] != "polytope") {
      throw UserError("axis 'vertices' is for hulls; valid: with 'polytope' as kind_a or kind_b");
    }
  }
  PlannedTrial out;
  json code = json::object();
  Spec spec = Spec::parse(text(cell, "pair_query"));
  cell["pair_query"] = canonicalStage(code, out.unsupported, StageKind::pairQuery, spec, cell["dimension"]);
  code["oracles"] = oraclesHash();  // the referee decides the errors
  cell["code"] = code;
  out.canonical = std::move(cell);
  seal(out);
  return out;
}

}}  // namespace lpc::LPC_PRECISION
