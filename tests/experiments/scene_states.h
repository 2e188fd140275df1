// SPDX-License-Identifier: Zlib
// The table of scenes with default parameters, tests/experiments/scene_states.txt: number of bodies, and a hash of
// everything that the first step depends on.
#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

struct SceneState {
  std::size_t bodies = 0;
  std::string hash;
};

/// By name and dimension. A scene that is missing is new.
inline const std::map<std::pair<std::string, int>, SceneState>& sceneStates() {
  static const auto all = [] {
    std::map<std::pair<std::string, int>, SceneState> out;
    std::ifstream in(LPC_SOURCE_DIR "/tests/experiments/scene_states.txt");
    for (std::string line; std::getline(in, line);) {
      if (line.starts_with("#")) continue;
      std::istringstream words(line);
      std::string name;
      int dimension = 0;
      SceneState state;
      if (words >> name >> dimension >> state.bodies >> state.hash) out[{name, dimension}] = state;
    }
    return out;
  }();
  return all;
}

/// Number of bodies, so that a scene too large for a test need not be built. Zero for a new scene.
inline std::size_t bodiesOf(const std::string& scene, int dimension) {
  const auto it = sceneStates().find({scene, dimension});
  return it == sceneStates().end() ? 0 : it->second.bodies;
}

}}}  // namespace lpc::LPC_PRECISION::test
