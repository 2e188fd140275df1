// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/scene_spec.h"

namespace lpc::inline LPC_PRECISION {

/// Plays a scene's script: bodies come, are joined, pushed and set, forces come and go at step numbers, never at clock
/// times, so every run is the same (the 2009 report, 6.6.1).
template <int D>
class Director {
 public:
  explicit Director(SceneSpec<D> scene);

  /// Does what is due before the world's next step. Call it once before every Simulation::step. Its steps count from
  /// the first call: a world that was saved goes on with a script of its own.
  void advance(Simulation<D>& world);
  const SceneSpec<D>& scene() const { return m_scene; }
  /// The body of spawn i; slot -1 before it came. It stays known after it is removed.
  Handle body(int spawn) const;

 private:
  SceneSpec<D> m_scene;
  std::vector<Handle> m_handles;
  long m_begin = -1;                                             // the world's step number when the script began
  std::vector<std::pair<long, std::size_t>> m_joints, m_forces;  // when each is due, sorted
  std::size_t m_next = 0, m_nextJoint = 0, m_nextForce = 0, m_nextEvent = 0;
  struct Ending {
    long step;
    ForceHandle force;
  };
  std::vector<Ending> m_ending;  // forces that are there and end
};

}  // namespace lpc::inline LPC_PRECISION
