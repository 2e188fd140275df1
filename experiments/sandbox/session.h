// SPDX-License-Identifier: Zlib
// A scene that is simulated and changed by hand, by one or several competitors at once, without a window: the state
// that the sandbox shows. All competitors get the same scene, actions and steps. It can be stepped back.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "experiments/sandbox/action.h"
#include "framework/scene/director.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Sample of one competitor after one step. NaN: not measured, or an engine that does not report its contacts.
struct Sample {
  double seconds = 0;                                             // of the step
  double energy = std::numeric_limits<double>::quiet_NaN();       // J, kinetic and potential
  double penetration = std::numeric_limits<double>::quiet_NaN();  // m, the deepest contact
  double error = 0;  // m, largest distance of a body from its position in the first competitor
};

inline constexpr int kTimedSteps = 60;
/// s, the median of the last samples, since single steps vary. 0 before the first.
double medianTime(const std::vector<Sample>& samples);

/// Makes a step of dt and returns its duration (s).
template <int D>
using Stepper = std::function<double(Simulation<D>& world, Real dt)>;
/// By wall clock, for worlds and engines: an engine's profiler has no times.
template <int D>
double timedStep(Simulation<D>& world, Real dt);

template <int D>
class Session {
 public:
  struct Competitor {
    std::string pipeline;  // or "engine=..."
    std::unique_ptr<Simulation<D>> world;
    std::string fallen;           // the reason why it stopped; empty: it runs
    std::vector<Sample> samples;  // [i]: after i + 1 steps
    long partedAt = -1;  // the first step after which a body was farther than `kParted` from its position in the first
                         // competitor; -1: none
    long since = 0;      // the step before which it got this pipeline
  };
  /// m: a larger distance is a different run. In a pile, rounding grows to it within seconds.
  static constexpr double kParted = 1e-3;

  /// Called now and then while an engine repeats its steps: the competitor and the finished part, 0 to 1. False aborts.
  using ProgressCallback = std::function<bool(std::size_t competitor, double part)>;

  /// Throws UserError for pipelines that this scene or this build cannot have.
  Session(SceneSpec<D> scene, const std::vector<std::string>& pipelines, Stepper<D> stepper = timedStep<D>);

  // --- running -------------------------------------------------------------------------------------------------------
  /// Steps all competitors that have not fallen.
  void step();
  /// Goes one step back: restores the last kept state and repeats the steps from there, with the actions in between.
  /// Later actions are dropped at the next action. False at the beginning. An engine keeps no states: it restarts and
  /// repeats all of its steps, and calls `progress`. An aborted engine has fallen permanently.
  bool back(const ProgressCallback& progress = {});
  long steps() const { return m_steps; }
  /// State of the first competitor. Also true after `back`, until it continues.
  bool fallen() const;
  Real dt() const { return m_scene.dt; }

  /// Whether energy and penetration of the coming steps are measured.
  void measure(bool measure) { m_measure = measure; }
  /// Whether the first competitor's profiler keeps the times of each step. A step back restarts its list.
  void keepFrames(bool keep);

  // --- actions, before the next step, as the last of its events ------------------------------------------------------
  /// Throws UserError if the first competitor rejects it, without a change. If only another competitor rejects it, that
  /// one has fallen.
  void perform(typename Action<D>::What what);
  const std::vector<Action<D>>& actions() const { return m_actions; }
  /// Number of numbered bodies; the next one added gets this number.
  int bodies() const;
  /// Its number; -1 if it has none. `slot` is the competitor's.
  int bodyAt(std::int32_t slot, std::size_t competitor = 0) const;
  BodyHandle handle(int body, std::size_t competitor = 0) const;

  /// A copy of the first competitor's world before the coming step, after the scene's actions before it; the copy has
  /// no further events. Null for an engine.
  std::unique_ptr<World<D>> ready() const;

  const SceneSpec<D>& scene() const { return m_scene; }
  const std::vector<Competitor>& competitors() const { return m_competitors; }
  Simulation<D>& world(std::size_t competitor = 0) { return *m_competitors[competitor].world; }
  const Simulation<D>& world(std::size_t competitor = 0) const { return *m_competitors[competitor].world; }

 private:
  // State of a competitor that is not shown.
  struct Play {
    std::unique_ptr<Director<D>> director;
    std::vector<BodyHandle> hand;  // of the bodies added by hand
    std::size_t action = 0;        // index of the next due action
    long steps = 0;                // steps made; a saved world may start with more
    bool givenUp = false;          // by `progress`
  };
  struct Keyframe {
    long step, since;
    std::string pipeline;
    Pipeline stages;  // which the scene may have replaced
    std::string bytes;
    Director<D> director;
    std::vector<BodyHandle> hand;
    std::size_t action;
  };

  void begin(std::size_t competitor);
  void stepCompetitor(std::size_t competitor);
  void playOne(std::size_t competitor, const Action<D>& action);
  void playDue(std::size_t competitor);
  bool takenBack(const typename Action<D>::What& what);
  void look(std::size_t competitor, double seconds);
  void keep(std::size_t competitor);
  void goTo(std::size_t competitor, long step, const ProgressCallback& progress);
  void markError(std::size_t competitor);

  SceneSpec<D> m_scene;
  Stepper<D> m_stepper;
  long m_steps = 0;
  bool m_keepFrames = false, m_measure = false;
  std::vector<Action<D>> m_actions;  // by step
  std::vector<Competitor> m_competitors;
  std::vector<Play> m_plays;
  std::vector<std::vector<Keyframe>> m_kept;
};

}}  // namespace lpc::LPC_PRECISION
