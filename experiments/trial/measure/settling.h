// SPDX-License-Identifier: Zlib
#pragma once

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Measures how bodies have moved from their initial poses, separately by direction, and whether they still rest on the
/// same bodies: a falling body changes its supports, a sagging one keeps them.
template <int D>
class Settling {
 public:
  /// Time by which a scene that should stand has settled (s).
  static constexpr double kSettled = 1;
  /// Window of creep and jitter, at the end (s).
  static constexpr double kLast = 1;
  /// A slower body is at rest (m/s); Box2D's sleep threshold.
  static constexpr double kRestSpeed = 0.05;

  /// Starts with the present poses of the bodies in these slots, all dynamic and in the world.
  void start(const Simulation<D>& world, std::vector<std::int32_t> slots);
  /// Call after each step of length dt.
  void observe(const Simulation<D>& world, double dt);

  // Over the bodies of start() that still exist. Metres along and across gravity; rad.
  double sag = 0;         // now: largest displacement along gravity
  double rise = 0;        // now: largest against gravity
  double lateral = 0;     // now: largest across gravity; of the whole displacement without gravity
  double lateralMax = 0;  // in any step
  double tilt = 0;        // now: largest rotation

  /// m/s: largest displacement of a body during the last kLast, over kLast. NaN before that.
  double creep() const;
  /// The same along gravity: the speed at which a body still sinks.
  double sinking() const;
  /// m/s: speed of the fastest body, median over the last kLast.
  double jitter() const;
  /// s: the time since which no body was faster than kRestSpeed; NaN if one is.
  double restSince() const { return m_fast ? kNaN : m_restSince; }
  /// Number of body pairs that touch now but not at kSettled, or the reverse. Empty before kSettled, and if contacts
  /// are not reported.
  std::optional<long> supportsChanged(const Simulation<D>& world) const;
  /// Whether bodies have only sunk: each body of start() still rests, through others, on one that cannot fall, and
  /// touches the same bodies as at kSettled. False if contacts are not reported.
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
  double farthest(const Way& way) const;  // of the bodies' displacements during the last kLast, over kLast
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
