// SPDX-License-Identifier: Zlib
// Constraint rows: the resolver's view of joints, and of contacts for methods that take a whole problem.
#pragma once

#include <cstdint>
#include <limits>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

enum class RowLaw : std::uint8_t {
  rigid,   // error = 0; a stop, which has one limit of the force at 0, keeps error >= 0 or error <= 0
  spring,  // force = -stiffness x error - damping x v
  motor    // v = speed
};

enum class RowBlock : std::uint8_t {
  equality,  // solved together with the other equality rows of its joint; no limits
  box,       // solved alone, its force between lo and hi
  cone       // friction: with the other tangents of its point, |force| <= friction x the force of row `normal`
};

/// One scalar constraint between bodies A and B. Along it, B moves relative to A with
///
///     v = d . (v_B - v_A) + armB . w_B - armA . w_A        m/s, or rad/s where the row is angular (d = 0)
///
/// A positive force pushes B along d and turns it along armB, and A the opposite way. All vectors are in world axes.
/// Between its limits the force follows the row's law.
template <int D>
struct ConstraintRow {
  static constexpr Real kNoLimit = std::numeric_limits<Real>::infinity();

  Vec<D> d = Vec<D>::Zero();     // unit, or zero
  Ang<D> armA = Ang<D>::Zero();  // r x d, m; a unit axis where the row is angular
  Ang<D> armB = Ang<D>::Zero();
  Real bend = 0;            // 1/m: rotation of d when B moves across it; 1 / distance along a line of two points
  Real error = 0;           // m or rad: displacement of B along the row from its target
  Real speed = 0;           // target speed of a motor, m/s or rad/s
  Real bounce = -kNoLimit;  // of a contact in impact: the least v afterwards, m/s
  Real stiffness = 0;       // of a spring, N/m or N m/rad
  Real damping = 0;         // of a spring, N s/m or N m s/rad
  Real lo = -kNoLimit, hi = kNoLimit;  // limits of the force, N or N m; both 0: the row is inactive
  Real friction = 0;                   // coefficient of a cone row
  std::int32_t normal = -1;            // of a cone row: the normal row, which limits its force
  RowBlock block = RowBlock::equality;
  RowLaw law = RowLaw::rigid;
  bool angular = false;

  bool absent() const { return lo == 0 && hi == 0; }
  /// True when the row's error must be corrected.
  bool binds() const { return law == RowLaw::rigid && !absent() && !open(); }
  /// True for a stop that is not reached yet. |error| is the remaining distance. The stop may be reached within the
  /// step, but exerts no force before.
  bool open() const { return law == RowLaw::rigid && (lo == 0) != (hi == 0) && (lo == 0 ? error > 0 : error < 0); }
};

/// Velocity v of the row. The sum adds the terms of B, then subtracts those of A, as for velocities of points.
template <int D>
Real rowSpeed(const ConstraintRow<D>& row, const Vec<D>& vA, const Ang<D>& wA, const Vec<D>& vB, const Ang<D>& wB) {
  return row.d.dot(vB) + row.armB.dot(wB) - row.d.dot(vA) - row.armA.dot(wA);
}

}}  // namespace lpc::LPC_PRECISION
