// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <string>

#include "framework/stage/stage_time_of_impact.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A ball inside a convex shape, about a point of it (in the shape's frame), and one around the shape's own origin.
template <int D>
struct Girth {
  Vec<D> center = Vec<D>::Zero();
  Real inner = 0, outer = 0;  // radii, m
};

/// Two convex parts on their ways through a step, kind of a <= kind of b. At least one is fast: it may go through the
/// other unseen, and may be stopped.
template <int D>
struct FastPair {
  MovingPair<D> pair;
  Girth<D> a, b;
  bool fastA = false, fastB = false;
};

/// When a method of continuous collision is asked.
enum class Lookout {
  never,
  before,  // of pairs that would meet by their speeds, contacts are made before they touch: the solver keeps them apart
  after    // of pairs that met on the ways that the solver has sent them, the fast ones are stopped there
};

/// Keeps bodies that go far in a step from passing through each other between its two ends.
///
/// After the solver, a fast body goes on until its first meeting, and loses the rest of the step; what it does to the
/// other is for the contacts of the next step. Who has been stopped stands still for the others.
template <int D>
class ContinuousCollision : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::continuous;
  static constexpr int kDimension = D;

  virtual Lookout lookout() const = 0;
  /// A part is fast when one of its points may go farther in a step than this share (1) of its inner ball's radius, or
  /// of kLinearSlop where that is more.
  virtual Real threshold() const { return std::numeric_limits<Real>::infinity(); }
  /// Only a <= b is asked.
  virtual bool supports(ShapeKind, ShapeKind) const { return true; }
  /// When the fast ones must stop (s), infinite where they need not, over 0 <= t <= duration. Asked with
  /// Lookout::after only. `t` has as many entries.
  virtual void meetings(std::span<const FastPair<D>>, Real /*duration*/, std::span<Real> t, WorkDone&) {
    std::fill(t.begin(), t.end(), std::numeric_limits<Real>::infinity());
  }
};

/// Throws UserError, "who does not support ...", unless every two of these kinds can be asked.
template <int D>
void requireCasts(const ContinuousCollision<D>& continuous, const std::array<bool, kShapeKinds>& kinds,
                  const std::string& who) {
  requirePairs([&](ShapeKind a, ShapeKind b) { return continuous.supports(a, b); }, kinds, who);
}

}}  // namespace lpc::LPC_PRECISION
