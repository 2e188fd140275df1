// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <string>

#include "framework/stage/stage_time_of_impact.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Two spheres for a convex shape: one inside the shape around `center` (in the shape's frame), and one that contains
/// the shape, around the origin of its frame.
template <int D>
struct InnerOuterRadii {
  Vec<D> center = Vec<D>::Zero();
  Real inner = 0, outer = 0;  // radii, m
};

/// Two convex parts with their motions in a step, kind of a <= kind of b. At least one is fast: it may pass through the
/// other unseen, and may be stopped.
template <int D>
struct FastPair {
  MovingPair<D> pair;
  InnerOuterRadii<D> a, b;
  bool fastA = false, fastB = false;
};

/// When a method of continuous collision runs.
enum class CcdPhase {
  never,
  before,  // before the solver: pairs that would touch by their velocities get contacts in advance, and the solver
           // keeps them apart
  after    // after the solver: fast bodies that touched on their way are stopped there
};

/// Keeps bodies that move far in a step from passing through each other.
///
/// With CcdPhase::after, a fast body moves until its first time of impact, and loses the rest of the step. The contacts
/// of the next step apply the impact to the other body. For other bodies a stopped body is at rest from then on.
template <int D>
class ContinuousCollision : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::continuous;
  static constexpr int kDimension = D;

  virtual CcdPhase ccdPhase() const = 0;
  /// A part is fast when one of its points may move farther in a step than threshold() (1) times the radius of its
  /// inner sphere. The radius counts as at least kLinearSlop.
  virtual Real threshold() const { return std::numeric_limits<Real>::infinity(); }
  /// True when the method supports these kinds. Called only with a <= b.
  virtual bool supports(ShapeKind, ShapeKind) const { return true; }
  /// Writes into `t` the times (s) at which fast parts must stop, over 0 <= t <= duration; infinite: no stop. Called
  /// only with CcdPhase::after. `t` has one entry per pair.
  virtual void timesOfImpact(std::span<const FastPair<D>>, Real /*duration*/, std::span<Real> t, WorkDone&) {
    std::fill(t.begin(), t.end(), std::numeric_limits<Real>::infinity());
  }
};

/// Throws UserError, "`subject` does not support ...; valid: ...", unless every pair of these kinds is supported.
template <int D>
void requireCasts(const ContinuousCollision<D>& continuous, const std::array<bool, kShapeKinds>& kinds,
                  const std::string& subject) {
  requirePairs([&](ShapeKind a, ShapeKind b) { return continuous.supports(a, b); }, kinds, subject,
               registeredSupport<ContinuousCollision<D>>);
}

}}  // namespace lpc::LPC_PRECISION
