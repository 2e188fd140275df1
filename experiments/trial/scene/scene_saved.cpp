// SPDX-License-Identifier: Zlib
// Scenes that begin with a saved world.
#include <filesystem>
#include <sstream>

#include "experiments/trial/scene/scene_parsed.h"
#include "framework/world/saved_state.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

SavedKind kindOf(const std::string& bytes) {
  std::istringstream in(bytes);
  return savedKind(in);
}

}  // namespace

std::string readSaved(TableReader& top, const SceneFile::Parsed& scene) {
  const toml::node* place = top.find("saved");
  if (!place) return {};
  const std::string name = top.requireString("saved");
  try {
    const std::string bytes = readFile((std::filesystem::path(scene.path).parent_path() / name).string());
    const SavedKind kind = kindOf(bytes);
    if (scene.dimensions != std::vector<int>{kind.dimension}) {
      throw UserError("the saved world is " + std::to_string(kind.dimension) + "D; valid: dimensions = [" +
                      std::to_string(kind.dimension) + "]");
    }
    return bytes;
  } catch (const UserError& e) {
    top.fail(*place, e.what());
  }
}

template <int D>
void startFromSaved(TableReader& top, const SceneFile::Parsed& parsed, SceneSpec<D>& scene) {
  for (const char* key : {"settings", "gravity", "restitution_threshold", "margin", "mixing", "sleeping_contacts"}) {
    if (const toml::node* own = top.find(key)) {
      top.fail(*own, "'" + std::string(key) +
                         "' is given with 'saved'; valid: no such key, because the saved world has its own");
    }
  }
  if (!top.find("dt"))
    top.fail(*top.find("saved"), "'saved' needs 'dt' (s); valid: the time step of the saved run, or another");
  scene.saved = parsed.saved;
  if (kindOf(parsed.saved).realBytes != static_cast<int>(sizeof(Real))) return;
  World<D> world(Pipeline::parse("contacts=query_clip"));  // supports all shapes
  try {
    std::istringstream in(parsed.saved);
    world.load(in);
  } catch (const UserError& e) {
    top.fail(*top.find("saved"), e.what());
  }
  const std::string needs = modelText(world.settings().model);
  if (modelText(parsed.model) != needs) {
    const toml::node* own = top.find("needs");
    top.fail(own ? *own : *top.find("saved"), "the saved world has the model '" + needs + "', the scene '" +
                                                  modelText(parsed.model) + "'; valid: the same");
  }
  scene.settings = world.settings();
  for (std::int32_t i = 0; i < world.bodies().size(); ++i) {
    if (!world.bodies().used[static_cast<std::size_t>(i)]) continue;
    const BodyHandle body = world.handle(i);
    scene.spawns.push_back({.body = world.definition(body), .existing = body});
  }
}

template void startFromSaved(TableReader&, const SceneFile::Parsed&, SceneSpec<2>&);
template void startFromSaved(TableReader&, const SceneFile::Parsed&, SceneSpec<3>&);

}}  // namespace lpc::LPC_PRECISION
