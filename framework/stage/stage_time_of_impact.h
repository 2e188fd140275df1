// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION {

/// How a shape moves through a step: its body's centre of mass at constant v, turning at constant w, as
/// `integrateRotation` turns it.
template <int D>
struct ShapeMotion {
  Pose<D> X_WC{};      // of the centre of mass at the start
  Pose<D> X_CS{};      // of the shape on its body
  Motion<D> motion{};  // v of the centre (m/s), w (rad/s)

  Pose<D> bodyAt(Real t) const { return {X_WC.p + t * motion.v, integrateRotation(X_WC.q, t * motion.w)}; }
};

/// Two shapes under way, kind of a <= kind of b. The body of a plane stands still.
template <int D>
struct MovingPair {
  ShapeView<D> a, b;
  ShapeMotion<D> A, B;

  /// As a pair query sees them at time t (s). Bodies are subtracted first: far from the origin the difference of their
  /// poses is exact, the sum of pose and offset is not.
  PairView<D> at(Real t) const { return {a, b, A.X_CS.inverse() * poseBetween(A.bodyAt(t), B.bodyAt(t)) * B.X_CS}; }
};

/// When two shapes first touch. With phi(t) their signed distance and s the size of the error measure (m):
///
/// - converged, hit: phi(t) <= 1e-9 s (f32: 1e-4 s), and phi > 0 before. Who touches at the start does so at t = 0.
/// - converged, no hit: phi > 0 all the while; t is the duration.
/// - iterationLimit, or what else a pair query's answer was: phi > 0 before t. So far is proved, no farther, and `hit`
///   says what the query last said.
/// - failed: a gap without a number or a direction, or a motion without numbers; also then phi > 0 before t.
///
/// Never late, whatever the status, by a pair query whose distances are not too large.
template <int D>
struct TimeOfImpactAnswer {
  QueryStatus status = QueryStatus::refused;
  bool hit = false;
  Real t = 0;                // s
  PairAnswer<D> there = {};  // the shapes at t, in A's frame then; with witnesses where they hit
};

/// Finds times of impact.
template <int D>
class TimeOfImpact : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::timeOfImpact;
  static constexpr int kDimension = D;

  /// Only a <= b is asked.
  virtual bool supports(ShapeKind a, ShapeKind b) const = 0;
  /// Pairs of kinds that it supports, over 0 <= t <= duration (s). `answers` has as many entries.
  virtual void cast(std::span<const MovingPair<D>> pairs, Real duration, std::span<TimeOfImpactAnswer<D>> answers,
                    WorkDone& work) = 0;
};

}}  // namespace lpc::LPC_PRECISION
