// SPDX-License-Identifier: Zlib
// A shipped scene that a test plays step by step.
#pragma once

#include <string>

#include "experiments/runner/locations.h"
#include "experiments/trial/scene/scene_file.h"
#include "framework/scene/director.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

template <int D>
struct Play {
  SceneSpec<D> scene;
  World<D> world;
  Director<D> director;

  Play(const std::string& name, const ParameterValues& values, const std::string& pipeline = "")
      : scene(built(name, values)), world(Pipeline::parse(pipeline), scene.settings), director(scene) {}
  void step() { director.advance(world), world.step(scene.dt); }
  void steps(long n) {
    for (long i = 0; i < n; ++i) step();
  }
  BodyHandle body(const std::string& bodyName) const {
    for (std::size_t i = 0; i < scene.spawns.size(); ++i) {
      if (scene.spawns[i].body.name == bodyName) return director.body(static_cast<int>(i));
    }
    return {};
  }

 private:
  static SceneSpec<D> built(const std::string& name, const ParameterValues& values) {
    const SceneFile file = SceneFile::load(findToml("scenes", name));
    return file.build<D>(values, file.defaultSeed());
  }
};

}}}  // namespace lpc::LPC_PRECISION::test
