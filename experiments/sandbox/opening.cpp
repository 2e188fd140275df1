// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/opening.h"

#include <nlohmann/json.hpp>

namespace lpc::inline LPC_PRECISION {

using nlohmann::json;

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
  if (o.features) scene.settings.features = featuresFromText(*o.features);
  if (scene.saved.empty()) scene.settings.features.joints = true;  // a hand may make them; who makes none pays nothing
  return scene;
}

template SceneSpec<2> specOf(const SceneFile&, const Opening&);
template SceneSpec<3> specOf(const SceneFile&, const Opening&);

}  // namespace lpc::inline LPC_PRECISION
