// SPDX-License-Identifier: Zlib
#include "experiments/trial/scene/simulation_of_scene.h"

#include <sstream>

#include "experiments/trial/scene/scene_file.h"
#include "framework/math/check.h"
#include "framework/world/stage_engine.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
std::unique_ptr<Simulation<D>> simulationOf(const std::string& pipeline, const SceneSpec<D>& scene) {
  if (const auto engine = engineOf(pipeline)) {
    if (!scene.saved.empty()) throw UserError("an engine cannot load a saved world; valid: a pipeline of LPC's stages");
    for (const auto& e : scene.events) {
      if (e.oursAlone)
        throw UserError(*e.place + ": this event is not supported by engines; valid: a pipeline of LPC's stages");
    }
    return createStage<Engine<D>>(*engine)->start(scene.settings);
  }
  auto world = std::make_unique<World<D>>(Pipeline::parse(pipeline), scene.settings);
  if (scene.saved.empty()) return world;
  std::istringstream in(scene.saved);
  world->load(in);
  const std::string has = modelText(world->settings().model), asked = modelText(scene.settings.model);
  if (has != asked)
    throw UserError("the model of a saved world cannot be changed: it is '" + has + "', asked: '" + asked + "'");
  return world;
}

template std::unique_ptr<Simulation<2>> simulationOf(const std::string&, const SceneSpec<2>&);
template std::unique_ptr<Simulation<3>> simulationOf(const std::string&, const SceneSpec<3>&);

}}  // namespace lpc::LPC_PRECISION
