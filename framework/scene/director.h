// SPDX-License-Identifier: Zlib
#pragma once

#include <compare>
#include <optional>
#include <utility>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/scene/scene_spec.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Plays a scene's script. Bodies, joints, forces and other events happen at step numbers, never at clock times, so
/// every run is the same (the 2009 report, 6.6.1). Order within a step:
///
/// 1. new bodies, and joints of bodies in the world
/// 2. removal of forces, then new forces
/// 3. events in the order of the file
/// 4. joints and forces of bodies that these events added
/// 5. removal of bodies
template <int D>
class Director {
 public:
  explicit Director(SceneSpec<D> scene);

  /// Performs everything that is due before the world's next step. Call it once before every Simulation::step. Steps
  /// count from the first call, so a loaded world can continue with a new script. Throws UserError with file and line
  /// when the simulation rejects an event.
  void advance(Simulation<D>& world) { begin(world), finish(world); }
  /// The two halves of advance(). A caller may act between them, as the last event of the step, so that a user's
  /// actions can be written as a script. Between them all events of the step have happened. Joints and forces of bodies
  /// added by events, and scheduled removals of bodies, follow in finish().
  void begin(Simulation<D>& world);
  void finish(Simulation<D>& world);
  const SceneSpec<D>& scene() const { return m_scene; }
  // Handles by index in the scene's lists. The slot is -1 before the object is added. The handle stays known after
  // removal.
  BodyHandle body(int spawn) const { return at(m_bodyHandles, spawn); }
  JointHandle joint(int joint) const { return at(m_jointHandles, joint); }
  ForceHandle force(int force) const { return at(m_forceHandles, force); }

  // --- called by events, in order ------------------------------------------------------------------------------------
  void addBody(Simulation<D>& world, int spawn);
  void addJoint(Simulation<D>& world, int joint);
  void addForce(Simulation<D>& world, int force);
  /// Sets the body of spawn i, which an event has made from another body.
  void setBody(int spawn, BodyHandle body) { m_bodyHandles.at(static_cast<std::size_t>(spawn)) = body; }

 private:
  template <class H>
  static H at(const IndexedVector<H>& handles, int i) {
    return i >= 0 && static_cast<std::size_t>(i) < handles.size() ? handles[i] : H{};
  }
  /// A list of indices with the step at which each is due, in order.
  struct Schedule {
    struct Turn {
      long step;
      bool late;  // after the events
      int index;
      auto operator<=>(const Turn&) const = default;
    };
    std::vector<Turn> list;  // sorted
    std::size_t next = 0;

    template <class F>
    void play(long step, bool late, const F& f) {
      const std::pair now(step, late);
      for (; next < list.size() && std::pair(list[next].step, list[next].late) <= now; ++next) f(list[next].index);
    }
  };

  SceneSpec<D> m_scene;
  IndexedVector<BodyHandle> m_bodyHandles;
  IndexedVector<JointHandle> m_jointHandles;
  IndexedVector<ForceHandle> m_forceHandles;
  std::optional<long> m_begin;  // the world's step number at the start of the script
  Schedule m_coming, m_joints, m_forces, m_leaving;
  std::size_t m_nextEvent = 0;
  struct Ending {
    long step;
    ForceHandle force;
  };
  std::vector<Ending> m_ending;  // forces in the world that will be removed
};

}}  // namespace lpc::LPC_PRECISION
