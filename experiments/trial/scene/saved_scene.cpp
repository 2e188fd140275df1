// SPDX-License-Identifier: Zlib
#include "experiments/trial/scene/saved_scene.h"

#include <algorithm>
#include <filesystem>

#include "experiments/parse/toml_reader.h"
#include "experiments/trial/scene/scene_file.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// `cache,friction` becomes `"cache", "friction"`.
std::string quoted(const std::string& list) {
  std::string out;
  for (std::size_t at = 0; !list.empty() && at != list.npos;) {
    const std::size_t end = list.find(',', at);
    out += (out.empty() ? "\"" : ", \"") + list.substr(at, end == list.npos ? end : end - at) + "\"";
    at = end == list.npos ? end : end + 1;
  }
  return out;
}

}  // namespace

std::string SavedScene::worldPath(const std::string& scenePath) {
  std::filesystem::path path(scenePath);
  const std::string name = path.stem().string();
  const bool plain =
      std::none_of(name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == '"' || c == '\\'; });
  if (path.extension() != ".toml" || name.empty() || !plain) {
    throw UserError("'" + scenePath + "' is not a scene file; valid: NAME.toml");
  }
  return path.replace_extension(".world").string();
}

SavedScene::SavedScene(long step, const std::string& scenePath)
    : m_step(step), m_path(scenePath), m_scene(scenePath), m_world(worldPath(scenePath)) {}

template <int D>
void SavedScene::write(const World<D>& world, const SceneSpec<D>& scene, const std::string& pipeline) {
  const std::string name = std::filesystem::path(m_path).stem().string();
  std::ostream& out = m_scene.stream();
  const auto limit = [&](const char* key, Real value) {
    if (value > 0) out << key << " = " << asText(double(value)) << '\n';
  };
  out << "# " << scene.name << " after " << m_step
      << " steps, without later events of its script. To continue bit for bit:\n"
      << "# --pipeline \"" << pipeline << "\"\n"
      << "name = \"" << name << "\"\n"
      << "summary = " << toml::value<std::string>(scene.name + " after " + std::to_string(m_step) + " steps") << '\n'
      << "dimensions = [" << D << "]\n"
      << "needs = [" << quoted(modelText(world.settings().model)) << "]\n"
      << "saved = \"" << name << ".world\"\n"
      << "dt = " << asText(double(scene.dt)) << '\n'
      << "steps = " << (m_step < scene.steps ? scene.steps - m_step : scene.steps) << "\n\n[limits]\n";
  limit("drift", scene.limits.drift), limit("creep", scene.limits.creep), limit("speed", scene.limits.speed);
  if (scene.limits.mayLeave) out << "may_leave = 1\n";
  world.save(m_world.stream());
  m_scene.check(), m_world.check();
  m_written = true;
}

void SavedScene::finish() {
  if (m_written) m_world.finish(), m_scene.finish();
}

template void SavedScene::write(const World<2>&, const SceneSpec<2>&, const std::string&);
template void SavedScene::write(const World<3>&, const SceneSpec<3>&, const std::string&);

}}  // namespace lpc::LPC_PRECISION
