// SPDX-License-Identifier: Zlib
#pragma once

#include <compare>
#include <optional>
#include <utility>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/scene/scene_spec.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Plays a scene's script: bodies come, are joined, pushed and set, forces come and go at step numbers, never at clock
/// times, so every run is the same (the 2009 report, 6.6.1). Within a step come bodies, their joints and forces, then
/// the events in the order of the file, then joints and forces of bodies that these brought; last go bodies.
template <int D>
class Director {
 public:
  explicit Director(SceneSpec<D> scene);

  /// Does what is due before the world's next step. Call it once before every Simulation::step. Its steps count from
  /// the first call: a world that was saved goes on with a script of its own. Throws UserError with file and line for
  /// an event that this simulation, as it is then, refuses.
  void advance(Simulation<D>& world) { begin(world), finish(world); }
  /// Its two halves, for who acts in between, as the last of the step's events would: a hand whose deeds a script can
  /// then say again. What they find is after all events, and before the joints and forces that wait for these and the
  /// bodies that go by themselves.
  void begin(Simulation<D>& world);
  void finish(Simulation<D>& world);
  const SceneSpec<D>& scene() const { return m_scene; }
  // By place in the scene's lists; slot -1 before it came. It stays known after it is removed.
  Handle body(int spawn) const { return at(m_bodyHandles, spawn); }
  JointHandle joint(int joint) const { return at(m_jointHandles, joint); }
  ForceHandle force(int force) const { return at(m_forceHandles, force); }

  // --- what events do, each in its turn ------------------------------------------------------------------------------
  void bring(Simulation<D>& world, int spawn);
  void addJoint(Simulation<D>& world, int joint);
  void addForce(Simulation<D>& world, int force);
  /// Who is spawn i, made of another.
  void is(int spawn, Handle body) { m_bodyHandles.at(static_cast<std::size_t>(spawn)) = body; }

 private:
  template <class H>
  static H at(const IndexedVector<H>& handles, int i) {
    return i >= 0 && static_cast<std::size_t>(i) < handles.size() ? handles[i] : H{};
  }
  /// What is due when, in its order.
  struct Turns {
    struct Turn {
      long step;
      bool late;  // after the events
      int who;
      auto operator<=>(const Turn&) const = default;
    };
    std::vector<Turn> list;  // sorted
    std::size_t next = 0;

    template <class F>
    void play(long step, bool late, const F& f) {
      const std::pair now(step, late);
      for (; next < list.size() && std::pair(list[next].step, list[next].late) <= now; ++next) f(list[next].who);
    }
  };

  SceneSpec<D> m_scene;
  IndexedVector<Handle> m_bodyHandles;
  IndexedVector<JointHandle> m_jointHandles;
  IndexedVector<ForceHandle> m_forceHandles;
  std::optional<long> m_begin;  // the world's step number when the script began
  Turns m_coming, m_joints, m_forces, m_leaving;
  std::size_t m_nextEvent = 0;
  struct Ending {
    long step;
    ForceHandle force;
  };
  std::vector<Ending> m_ending;  // forces that are there and end
};

}}  // namespace lpc::LPC_PRECISION
