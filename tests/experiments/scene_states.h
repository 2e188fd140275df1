// SPDX-License-Identifier: Zlib
// The table of scenes at their defaults, tests/experiments/scene_states.txt: how many bodies, and a hash of all that
// the first step starts from.
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

/// By name and dimension. A scene that is not in it is a new one.
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

/// Of a scene that need not be built to know that it is too large for a test. Zero for a new one.
inline std::size_t bodiesOf(const std::string& scene, int dimension) {
  const auto it = sceneStates().find({scene, dimension});
  return it == sceneStates().end() ? 0 : it->second.bodies;
}

}}}  // namespace lpc::LPC_PRECISION::test
