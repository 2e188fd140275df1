// SPDX-License-Identifier: Zlib
#pragma once

#include <memory>
#include <vector>

#include "framework/stage/stage_time_of_impact.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Counts impulses between shapes that would not have met: the contact's points were farther apart than the world's
/// margin, and the two shapes, moved through the step at their initial velocities plus gravity, miss each other. One
/// per pair of convex parts and step.
template <int D>
class GhostHits {
 public:
  GhostHits();
  void before(const Simulation<D>& world);  // call before each step, after the script
  void observe(const Simulation<D>& world,
               double dt);  // call after each step; none for an engine that reports no contacts
  double count() const { return m_told ? m_count : std::numeric_limits<double>::quiet_NaN(); }

 private:
  bool misses(const Simulation<D>& world, const Manifold<D>& m, Real dt);

  std::unique_ptr<TimeOfImpact<D>> m_cast;
  std::vector<Pose<D>> m_pose;      // X_WC by body slot
  std::vector<Motion<D>> m_motion;  // of the centres of mass
  double m_count = 0;
  bool m_told = true;
};

}}  // namespace lpc::LPC_PRECISION
