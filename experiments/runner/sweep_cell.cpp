// SPDX-License-Identifier: Zlib
#include "experiments/runner/sweep_cell.h"

#include <filesystem>
#include <limits>

#include "experiments/runner/sweep_axis.h"
#include "framework/math/names.h"
#include "framework/stage/stages.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;

double number(const std::string& axis, const json& value) {
  if (!value.is_number()) throw UserError("axis '" + axis + "' is " + value.dump() + "; valid: numbers");
  return value;
}

}  // namespace

std::string beside(const std::string& sweep, const std::string& given, const char* ending) {
  const auto folder = std::filesystem::path(sweep).parent_path();
  for (const std::string& name : {given, given + ending}) {
    if (std::filesystem::is_regular_file(folder / name)) return (folder / name).string();
  }
  return given;
}

void AxisFiles::add(const SceneFile& scene, bool scriptIsAnAxis) {
  add("scene", scene.name(), scene.path());
  const std::string& script = scene.scriptPath();
  if (scriptIsAnAxis) add("script", script.empty() ? "none" : std::filesystem::path(script).stem().string(), script);
}

void AxisFiles::add(const std::string& axis, const std::string& name, const std::string& path) {
  const std::string& first = m_paths.try_emplace({axis, name}, path).first->second;
  if (first == path || (!first.empty() && !path.empty() && std::filesystem::equivalent(first, path))) return;
  const auto told = [](const std::string& p) { return p.empty() ? std::string("no file") : p; };
  throw UserError("axis '" + axis + "': '" + name + "' is both " + told(first) + " and " + told(path) +
                  ", so their results would have one name; valid: files of different names");
}

void collectNames(const Spec& spec, std::set<std::string>& out) {
  out.insert(spec.name);
  for (const auto& [key, value] : spec.fields) collectNames(value, out);
}

CellPipeline::CellPipeline(const std::string& text, const json& axes, std::set<std::string>& used)
    : m_text(text), m_axes(axes) {
  const std::string base = withValues(text, axes, m_ofEngine);
  used.insert(m_ofEngine.begin(), m_ofEngine.end());
  m_engine = engineOf(base);
  if (!m_engine) m_stages = Pipeline::parse(base);
}

void CellPipeline::put(const std::string& part, std::set<std::string>& names, std::set<std::string>& used) {
  std::set<std::string> named;
  const std::string text = withValues(part, m_axes, named);
  used.insert(named.begin(), named.end());
  if (const auto engine = engineOf(text)) {
    m_engine = engine, m_ofEngine = named;
    return;
  }
  m_ofParts.merge(named);
  for (const StageKind stage : m_stages.replace(text)) {
    m_replaced.insert(stage), collectNames(m_stages[stage], names);
  }
}

std::string CellPipeline::finish(std::set<std::string>& names) const {
  if (!m_engine) return m_stages.text();
  collectNames(*m_engine, names);
  return "engine=" + m_engine->text();
}

std::set<std::string> CellPipeline::named() const {
  if (m_engine) return m_ofEngine;
  std::set<std::string> out = m_ofParts;
  try {
    const Pipeline stages = Pipeline::parse(m_text);
    for (const StageKind kind : kWorldStages) {
      if (!m_replaced.count(kind)) out.merge(namedIn(stages[kind].text(), m_axes));
    }
  } catch (const UserError&) {  // a $name may stand for more than a value
    out.merge(namedIn(m_text, m_axes));
  }
  return out;
}

std::string readWorldAxes(const SceneFile& file, const json& axes, const std::set<std::string>& used, WorldCell& cell,
                          std::map<std::string, std::string>& roles) {
  std::string model;
  for (const auto& [name, value] : axes.items()) {
    roles.emplace(name, stageByName(name)      ? "stage"
                        : file.parameter(name) ? "parameter"
                        : used.count(name)     ? "setting"
                                               : "run");
    if (name == "scene" || name == "script") {
    } else if (name == "dimension") {
      cell.dimension = static_cast<int>(wholeNumber(axes, name, 2, 3));
    } else if (name == "precision") {
      cell.precision = valueText(value);
    } else if (name == "dt") {
      cell.dt = number(name, value);
    } else if (name == "steps") {
      cell.steps = wholeNumber(axes, name, 0, std::numeric_limits<long>::max());
    } else if (name == "seed") {
      cell.seed = static_cast<std::uint64_t>(wholeNumber(axes, name, 0, std::numeric_limits<long>::max()));
    } else if (name == "model") {
      model = valueText(value);
    } else if (cell.params.count(name)) {
    } else if (file.parameter(name)) {
      cell.params[name] = number(name, value);
    } else if (!used.count(name)) {
      std::vector<std::string> valid = {"scene", "script", "dimension", "precision", "dt", "steps", "seed", "model"};
      for (const SceneParameter& p : file.parameters()) valid.push_back(p.name);
      for (const StageInfo& stage : kStages) {
        if (isWorldStage(stage)) valid.emplace_back(stage.name);
      }
      throw UserError("axis '" + name + "' is unknown for scene '" + file.name() + "'" + validNames(valid, name) +
                      ", a table of pipelines, or $" + name + " in a pipeline");
    }
  }
  return model;
}

PlannedTrial frozenTrial(Planner& planner, const std::string& kind, const json& axes, bool timed,
                         std::map<std::string, std::string>& roles, std::set<std::string>& names) {
  json cell = axes;
  cell["timed"] = timed, cell["repeat"] = 0;
  const char* method = kind == "boxes" ? "broadphase" : kind == "pairs" ? "pair_query" : "velocity";
  const SceneFile* scene =
      kind == "pairs" && axes.contains("scene") ? &planner.scene(valueText(axes["scene"])) : nullptr;
  for (const auto& [name, value] : cell.items()) {
    const bool ofScene = scene && scene->parameter(name);
    if (!ofScene && !isFrozenAxis(kind, name))
      throw UserError("axis '" + name + "' is unknown in a sweep of kind '" + kind + "'");
    if (axes.contains(name)) roles.emplace(name, name == method ? "stage" : ofScene ? "parameter" : "run");
  }
  if (scene) names.insert(scene->name());
  if (axes.contains(method)) collectNames(Spec::parse(valueText(axes[method])), names);
  if (kind == "problems") return planner.problems(std::move(cell));
  return kind == "boxes" ? planner.boxes(std::move(cell)) : planner.pairs(std::move(cell));
}

}}  // namespace lpc::LPC_PRECISION
