// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/opening.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "experiments/parse/toml_reader.h"
#include "experiments/runner/locations.h"

namespace lpc { inline namespace LPC_PRECISION {

using nlohmann::json;

namespace {

// Quoted for a shell.
std::string word(const std::string& text) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) || std::strchr("._-/=+,", c); };
  return std::all_of(text.begin(), text.end(), plain) ? text : "'" + text + "'";
}

// A scene of experiments/scenes is named without its path.
std::string sceneWord(const std::string& path) {
  const std::string name = std::filesystem::path(path).stem().string();
  const std::vector<std::string> known = listToml("scenes");
  const bool ours = std::find(known.begin(), known.end(), path) != known.end();
  return ours && !std::filesystem::exists(name) ? name : path;
}

}  // namespace

Opening openingFromJson(const json& in) {
  Opening out;
  out.scene = in.at("scene"), out.script = in.value("script", "");
  out.parameters = in.value("parameters", ParameterValues{});
  if (in.contains("seed")) out.seed = in.at("seed").get<std::uint64_t>();
  out.dimension = in.at("dimension");
  out.pipelines = in.at("pipelines").get<std::vector<std::string>>();
  if (in.contains("dt")) out.dt = in.at("dt").get<double>();
  if (in.contains("features")) out.features = in.at("features").get<std::string>();
  out.steps = in.value("steps", 0L), out.say = in.value("say", "");
  out.profile = in.value("profile", ""), out.plots = in.value("plots", false);
  out.input = in.value("input", "");
  out.plugins = in.value("plugins", std::vector<std::string>{});
  return out;
}

template <int D>
SceneSpec<D> specOf(const SceneFile& file, const Opening& o) {
  ParameterValues given;
  for (const auto& [name, value] : o.parameters) {
    if (file.parameter(name) || name == kPerturbParameter) given[name] = value;
  }
  SceneSpec<D> scene = file.build<D>(given, o.seed.value_or(file.defaultSeed()));
  if (o.dt) scene.dt = static_cast<Real>(*o.dt);
  if (o.features) scene.settings.model = modelFromText(*o.features);
  if (scene.saved.empty())
    scene.settings.model.joints = true;  // joints may be made by hand; a world without joints pays nothing
  return scene;
}

std::string runOf(const Opening& o, const SceneFile& file, const std::string& script) {
  std::string out = "lpc run " + word(sceneWord(o.scene)) + " --script " + word(script) + " --dimension " +
                    std::to_string(o.dimension);
  for (const auto& [name, value] : o.parameters) {
    const SceneParameter* p = file.parameter(name);
    if (!p && name != kPerturbParameter) continue;
    const ParameterValue usual = p ? p->value : ParameterValue(0.0);
    if (value.number == usual.number && value.text == usual.text) continue;
    out += " --param " + word(name + "=" + (value.isText() ? value.text : asText(value.number)));
  }
  if (o.seed) out += " --seed " + std::to_string(*o.seed);
  if (o.dt) out += " --dt " + asText(*o.dt);
  if (!o.pipelines.front().empty()) out += " --pipeline " + word(o.pipelines.front());
  return out;
}

template SceneSpec<2> specOf(const SceneFile&, const Opening&);
template SceneSpec<3> specOf(const SceneFile&, const Opening&);

}}  // namespace lpc::LPC_PRECISION
