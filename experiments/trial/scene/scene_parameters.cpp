// SPDX-License-Identifier: Zlib
// Parameters of scenes: numbers with ranges, and the kind of its joints as text.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "experiments/trial/scene/scene_parsed.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {

void to_json(nlohmann::json& out, const ParameterValue& value) {
  if (value.isText()) {
    out = value.text;
  } else {
    out = value.number;
  }
}
void from_json(const nlohmann::json& in, ParameterValue& value) {
  value = in.is_string() ? ParameterValue(in.get<std::string>()) : ParameterValue(in.get<double>());
}

std::vector<SceneParameter> readParameters(TableReader& top) {
  const SceneParameter everyScenes{kPerturbParameter, "how far bodies start from their places, by the seed (m and rad)",
                                   0.0, 0, kMostPerturbed};
  const toml::table* parameters = top.table("parameters");
  if (!parameters) return {everyScenes};
  std::vector<SceneParameter> out;
  for (const auto& [name, node] : inFileOrder(*parameters)) {
    if (out.size() == kMostNames) top.fail(*node, kTooManyNames);
    if (name == everyScenes.name) top.fail(*node, "'" + name + "' is a parameter of every scene; valid: another name");
    if (!node->is_table()) top.fail(*node, "parameter '" + name + "' is " + describe(*node) + "; valid: a table");
    try {
      Expressions::checkName(name);
    } catch (const UserError& e) {
      top.fail(*node, "parameter " + std::string(e.what()));
    }
    if (std::find(std::begin(kSetNames), std::end(kSetNames), name) != std::end(kSetNames)) {
      top.fail(*node, "parameter '" + name + "' is a name that scenes set themselves; valid: all but " +
                          joined({std::begin(kSetNames), std::end(kSetNames)}));
    }
    TableReader p(*node->as_table(), top.file(), "parameter '" + name + "'");
    SceneParameter parameter{name, p.requireString("meaning"), {}};
    if (name == kJointParameter && p.require("default").is_string()) {
      parameter.value = p.requireString("default");
      if (!parameter.value.isText()) top.fail(*node, "the default of 'joint' is empty; valid: a kind of joint");
      try {
        const Spec kind = Spec::parse(parameter.value.text);
        const auto inPlane = Registry::instance().list(StageKind::joint, 2);
        const bool planar =
            std::any_of(inPlane.begin(), inPlane.end(), [&](const Registered* r) { return r->info.name == kind.name; });
        Registry::instance().find(StageKind::joint, planar ? 2 : 3, kind.name).create(kind);
      } catch (const UserError& e) {
        top.fail(*node, e.what());
      }
    } else {
      parameter.value = p.number("default", 0), parameter.lo = p.number("min", 0), parameter.hi = p.number("max", 0);
      p.require("default"), p.require("min"), p.require("max");
      if (!(parameter.lo <= parameter.value.number && parameter.value.number <= parameter.hi)) {
        top.fail(*node, "the default of '" + name + "' is not between its min and max");
      }
    }
    p.finish();
    out.push_back(std::move(parameter));
  }
  out.push_back(everyScenes);
  return out;
}

void addScriptParameters(TableReader& script, SceneFile::Parsed& scene) {
  std::vector<SceneParameter> own = readParameters(script);
  own.pop_back();  // `perturb`, which every scene has
  for (SceneParameter& p : own) {
    for (const SceneParameter& other : scene.parameters) {
      if (p.name != other.name) continue;
      const toml::node& place = *script.table("parameters")->get(p.name);
      script.fail(place, "parameter '" + p.name + "' is one of scene '" + scene.name + "', too; valid: another name");
    }
    if (scene.parameters.size() > kMostNames) script.fail(*script.find("parameters"), kTooManyNames);
    scene.parameters.insert(scene.parameters.end() - 1, std::move(p));
  }
}

const SceneParameter* SceneFile::parameter(std::string_view name) const {
  for (const SceneParameter& p : m_parsed->parameters) {
    if (p.name == name) return &p;
  }
  return nullptr;
}

ParameterValues SceneFile::values(const ParameterValues& given) const {
  ParameterValues out;
  std::vector<std::string> names;
  for (const SceneParameter& p : m_parsed->parameters) out[p.name] = p.value, names.push_back(p.name);
  for (const auto& [name, value] : given) {
    const SceneParameter* p = parameter(name);
    if (!p) {
      throw UserError("scene '" + m_parsed->name + "' has no parameter '" + name + "'" + validNames(names, name));
    }
    const bool ofItsKind = value.isText() == p->value.isText();
    if (!ofItsKind || !(value.isText() || (value.number >= p->lo && value.number <= p->hi))) {
      throw UserError("parameter '" + name + "' of scene '" + m_parsed->name + "' is " +
                      (value.isText() ? "'" + value.text + "'" : asText(value.number)) +
                      "; valid: " + (p->value.isText() ? "a kind of joint" : asText(p->lo) + " to " + asText(p->hi)));
    }
    out[name] = value;
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
