// SPDX-License-Identifier: Zlib
// A scene that is played and changed by hand, by one competitor or several at once, without a window: what the sandbox
// shows. All competitors ("lanes") get the same scene, the same deeds and the same steps. It can be stepped back.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "experiments/sandbox/deed.h"
#include "framework/scene/director.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Of one lane after one step. NaN: nobody looked, or an engine does not tell its contacts.
struct Sample {
  double seconds = 0;                                             // of the step
  double energy = std::numeric_limits<double>::quiet_NaN();       // J, kinetic and potential
  double penetration = std::numeric_limits<double>::quiet_NaN();  // m, the deepest contact
  double error = 0;  // m, the farthest that a body is from where the first lane has it
};

inline constexpr int kTimedSteps = 60;
/// s, the median of the last of them: a single step says little. 0 before the first.
double medianTime(const std::vector<Sample>& samples);

/// Makes a step of dt and says how long it took (s).
template <int D>
using Stepper = std::function<double(Simulation<D>& world, Real dt)>;
/// By the clock, whoever steps: an engine's profiler tells no time.
template <int D>
double timedStep(Simulation<D>& world, Real dt);

template <int D>
class Session {
 public:
  struct Lane {
    std::string pipeline;  // or "engine=..."
    std::unique_ptr<Simulation<D>> world;
    std::string fallen;           // why it goes no further; empty: it runs
    std::vector<Sample> samples;  // [i]: after i + 1 steps
    long partedAt = -1;  // the first step after which a body was farther than `kParted` from the first lane's; -1: none
    long since = 0;      // the step before which it got this pipeline
  };
  /// m: farther apart than this is another run. What rounding does grows to it within seconds of a heap.
  static constexpr double kParted = 1e-3;

  /// While an engine makes its steps again, now and then: the lane and the part that is done, 0 to 1. False: that is
  /// enough.
  using Patience = std::function<bool(std::size_t lane, double part)>;

  /// Throws UserError for pipelines that this scene or this build cannot have.
  Session(SceneSpec<D> scene, const std::vector<std::string>& pipelines, Stepper<D> stepper = timedStep<D>);

  // --- running -------------------------------------------------------------------------------------------------------
  /// All lanes that have not fallen.
  void step();
  /// To the state of a step less, from the last one that was kept and the same steps again: what was done by hand in
  /// between is done again, what was done after it is forgotten by the next deed. False at the beginning.
  /// An engine keeps no states: it begins anew and makes all of its steps again, which `patience` is told of. Who is
  /// given up so has fallen, for good.
  bool back(const Patience& patience = {});
  long steps() const { return m_steps; }
  /// Of the first lane. True as well after `back`, until it goes on.
  bool fallen() const;
  Real dt() const { return m_scene.dt; }

  /// Whether energy and penetration of the coming steps are looked at.
  void measure(bool measure) { m_measure = measure; }
  /// Whether the first lane's profiler keeps what each step took. A step back begins its list anew.
  void keepFrames(bool keep);

  // --- deeds, before the next step, as the last of its events -------------------------------------------------------
  /// Throws UserError where the first lane refuses it: nothing has changed then. A lane that alone cannot has fallen.
  void perform(typename Deed<D>::What what);
  const std::vector<Deed<D>>& deeds() const { return m_deeds; }
  /// How many bodies have a number: the next that is added has this one.
  int bodies() const;
  /// Its number; -1: of nobody. `slot` is the lane's.
  int bodyAt(std::int32_t slot, std::size_t lane = 0) const;
  Handle handle(int body, std::size_t lane = 0) const;

  /// A copy of the first lane's world as the coming step finds it, after all that the scene does before it: who goes on
  /// with it has no more of the scene. Nobody: it is an engine.
  std::unique_ptr<World<D>> ready() const;

  const SceneSpec<D>& scene() const { return m_scene; }
  const std::vector<Lane>& lanes() const { return m_lanes; }
  Simulation<D>& world(std::size_t lane = 0) { return *m_lanes[lane].world; }
  const Simulation<D>& world(std::size_t lane = 0) const { return *m_lanes[lane].world; }

 private:
  // What a lane is besides what is shown of it.
  struct Play {
    std::unique_ptr<Director<D>> director;
    std::vector<Handle> hand;  // of the bodies that came by hand
    std::size_t deed = 0;      // the next one that is due
    long steps = 0;            // that were made; those of a saved world began before
    bool givenUp = false;      // by who waited for it
  };
  struct Keyframe {
    long step, since;
    std::string pipeline;
    Pipeline stages;  // which the scene may have exchanged
    std::string bytes;
    Director<D> director;
    std::vector<Handle> hand;
    std::size_t deed;
  };

  void begin(std::size_t lane);
  void stepLane(std::size_t lane);
  void playOne(std::size_t lane, const Deed<D>& deed);
  void playDue(std::size_t lane);
  bool takenBack(const typename Deed<D>::What& what);
  void look(std::size_t lane, double seconds);
  void keep(std::size_t lane);
  void goTo(std::size_t lane, long step, const Patience& patience);
  void markError(std::size_t lane);

  SceneSpec<D> m_scene;
  Stepper<D> m_stepper;
  long m_steps = 0;
  bool m_keepFrames = false, m_measure = false;
  std::vector<Deed<D>> m_deeds;  // by step
  std::vector<Lane> m_lanes;
  std::vector<Play> m_plays;
  std::vector<std::vector<Keyframe>> m_kept;
};

}}  // namespace lpc::LPC_PRECISION
