// SPDX-License-Identifier: Zlib
// The text of a scene is rejected, or the scene is built in each of its dimensions.
#include "experiments/trial/scene/scene_file.h"
#include "tests/fuzz/target.h"

namespace lpc { inline namespace LPC_PRECISION {

void fuzz(std::string_view text) {
  try {
    const SceneFile scene = SceneFile::parse(std::string(text), "scene.toml");
    try {
      if (scene.has(2)) scene.build<2>({}, 1);
    } catch (const UserError&) {
    }
    if (scene.has(3)) scene.build<3>({}, 1);
  } catch (const UserError&) {
  }
}

}}  // namespace lpc::LPC_PRECISION
