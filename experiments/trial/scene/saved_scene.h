// SPDX-License-Identifier: Zlib
// Writes a running world as a scene that begins with it: `lpc run SCENE --save AT:FILE.toml`.
#pragma once

#include <string>

#include "experiments/trial/formats/output_file.h"
#include "framework/scene/scene_spec.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {

/// FILE.toml, the scene, and FILE.world beside it, the bytes. Nothing is written for a step that the run does not
/// reach.
class SavedScene {
 public:
  /// Throws UserError for another ending, and CannotWrite if nothing can be written.
  SavedScene(long step, const std::string& scenePath);

  static std::string worldPath(const std::string& scenePath);  // throws UserError for another ending
  long step() const { return m_step; }
  template <int D>
  void write(const World<D>& world, const SceneSpec<D>& scene, const std::string& pipeline);
  void finish();

 private:
  long m_step;
  std::string m_path;
  OutputFile m_scene, m_world;
  bool m_written = false;
};

}}  // namespace lpc::LPC_PRECISION
