// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Motion of a shape through a step: its body's centre of mass moves at constant v and the body turns at constant w, by
/// `integrateRotation`.
template <int D>
struct ShapeMotion {
  Pose<D> X_WC{};      // of the centre of mass at the start
  Pose<D> X_CS{};      // of the shape on its body
  Motion<D> motion{};  // v of the centre (m/s), w (rad/s)

  Pose<D> bodyAt(Real t) const { return {X_WC.p + t * motion.v, integrateRotation(X_WC.q, t * motion.w)}; }
};

/// Two moving shapes, kind of a <= kind of b. The body of a plane does not move.
template <int D>
struct MovingPair {
  ShapeView<D> a, b;
  ShapeMotion<D> A, B;

  /// The pair at time t (s), for a pair query. Body poses are subtracted first: far from the origin their difference is
  /// exact, the sum of pose and offset is not.
  PairView<D> at(Real t) const { return {a, b, A.X_CS.inverse() * poseBetween(A.bodyAt(t), B.bodyAt(t)) * B.X_CS}; }
};

/// Time of impact of two shapes. With phi(t) their signed distance and s the size of the error measure (m):
///
/// - converged, hit: phi(t) <= 1e-9 s (f32: 1e-4 s), and phi > 0 before. Shapes that touch at the start have t = 0.
/// - converged, no hit: phi > 0 throughout; t is the duration.
/// - iterationLimit, or another status of the pair query: phi > 0 is proved before t, not beyond. `hit` is that of the
///   last answer of the query.
/// - failed: a distance or normal is not a number, or a motion is not finite; phi > 0 still holds before t.
///
/// With any status, t is never later than the true time of impact, unless the pair query's distances are too large.
template <int D>
struct TimeOfImpactAnswer {
  QueryStatus status = QueryStatus::refused;
  bool hit = false;
  Real t = 0;                // s
  PairAnswer<D> there = {};  // the shapes at t, in A's frame at t; with closest points on a hit
};

/// Finds times of impact.
template <int D>
class TimeOfImpact : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::timeOfImpact;
  static constexpr int kDimension = D;

  /// True when the method supports these kinds. Called only with a <= b.
  virtual bool supports(ShapeKind a, ShapeKind b) const = 0;
  /// Finds the times of impact of pairs of supported kinds, over 0 <= t <= duration (s). `answers` has one entry per
  /// pair.
  virtual void cast(std::span<const MovingPair<D>> pairs, Real duration, std::span<TimeOfImpactAnswer<D>> answers,
                    WorkDone& work) = 0;
};

}}  // namespace lpc::LPC_PRECISION
