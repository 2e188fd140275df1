// SPDX-License-Identifier: Zlib
#pragma once

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// How bodies have moved from where they came, told apart by direction, and whether they still rest on whom they rested
/// on: what falls changes its neighbours, what sags keeps them.
template <int D>
class Settling {
 public:
  /// By which time a scene that should stand is in place (s).
  static constexpr double kSettled = 1;
  /// Span of creep and jitter, at the end (s).
  static constexpr double kLast = 1;
  /// Slower than this is at rest (m/s); Box2D's sleep threshold.
  static constexpr double kRestSpeed = 0.05;

  /// Of the bodies in these slots, all dynamic and in the world: where they are now is where they came.
  void start(const Simulation<D>& world, std::vector<std::int32_t> slots);
  /// After each step, which took dt.
  void observe(const Simulation<D>& world, double dt);

  // Over the bodies of start() that are still there. Metres against and across gravity; rad.
  double sag = 0;         // now: farthest along gravity
  double rise = 0;        // now: farthest against it
  double lateral = 0;     // now: farthest across gravity; all of the way where there is none
  double lateralMax = 0;  // in any step
  double tilt = 0;        // now: largest turn

  /// m/s: the farthest that a body is from where it was kLast before, over kLast. NaN before that.
  double creep() const;
  /// The same along gravity: how fast a body still sinks.
  double sinking() const;
  /// m/s: speed of the fastest body, median over the last kLast.
  double jitter() const;
  /// s: since when no body was faster than kRestSpeed; NaN when one is.
  double restSince() const { return m_fast ? kNaN : m_restSince; }
  /// Pairs of bodies that touch now and did not at kSettled, and those of which it is the other way round. Empty before
  /// kSettled, and where contacts are not told.
  std::optional<long> supportsChanged(const Simulation<D>& world) const;
  /// Has nothing happened but that bodies sank: each of start() still rests, through others, on something that does not
  /// fall, and they touch whom they touched at kSettled? False where contacts are not told.
  bool stands(const Simulation<D>& world) const;

 private:
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  using Pairs = std::set<std::pair<std::int32_t, std::int32_t>>;
  struct Body {
    std::int32_t slot;
    std::uint32_t generation;
    Pose<D> start;
  };
  template <class Way>
  double farthest(const Way& way) const;  // of the bodies' ways of the last kLast, over it
  static std::optional<Pairs> touching(const Simulation<D>& world);

  std::vector<Body> m_bodies;
  std::optional<Pairs> m_supports;  // at kSettled
  // Of the last kLast: positions by step and body, and speeds by step.
  std::vector<std::vector<Vec<D>>> m_positions;
  std::vector<double> m_speeds;
  std::size_t m_window = 0, m_steps = 0;
  Vec<D> m_down = Vec<D>::Zero();  // along gravity
  double m_time = 0, m_restSince = 0;
  bool m_fast = false;
};

}}  // namespace lpc::LPC_PRECISION
