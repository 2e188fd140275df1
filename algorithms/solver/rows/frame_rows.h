// SPDX-License-Identifier: Zlib
// Rows shared by several kinds of joints: along and about the axes of A's frame, with limits, a motor or a spring.
#pragma once

#include <string>

#include "framework/math/check.h"
#include "framework/problem/joint.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

inline constexpr Real kFarLimit = Real(1e6);  // m or rad: no limit

/// Row of B's point along axis i of A's frame; the error is its offset from A's point (m). Both bodies feel the impulse
/// at B's point, so it adds no torque however far the points are apart. Its v is that of B's point as seen from A.
template <int D>
ConstraintRow<D>& slide(const JointFrames<D>& at, int i, JointRows<D>& out) {
  const Vec<D> d = at.qA * Vec<D>(Vec<D>::Unit(i));
  return out.point(d, Vec<D>(at.rA + at.gap), at.rB, at.gap.dot(d));
}

/// The shortest rotation of B's frame relative to A's, about A's axes (rad).
template <int D>
Ang<D> turnInA(const JointFrames<D>& at) {
  return turnOf(at.qA.inverse() * at.qB);
}
inline Ang<2> axisOfTurn(const JointFrames<2>&, int) { return Ang<2>(Real(1)); }
inline Ang<3> axisOfTurn(const JointFrames<3>& at, int i) { return at.qA * Vec<3>(Vec<3>::Unit(i)); }

/// Two rows in 3D that align the z axes of both frames, none in 2D. Returns that axis.
inline Ang<2> alignAxes(const JointFrames<2>&, JointRows<2>&) { return Ang<2>(Real(1)); }
// Along A's own x and y, which turn with A: a basis made from the axis alone would jump somewhere.
inline Ang<3> alignAxes(const JointFrames<3>& at, JointRows<3>& out) {
  const Vec<3> zA = at.qA * Vec<3>(0, 0, 1), zB = at.qB * Vec<3>(0, 0, 1);
  const Vec<3> bent = cross(zA, zB);
  const Real sine = bent.norm();
  // The length of the error is the angle between the axes, not its sine.
  const Real scale = sine > 0 ? static_cast<Real>(angleOf(sine, zA.dot(zB)) / sine) : Real(1);
  for (const Vec<3>& axis : {Vec<3>(at.qA * Vec<3>(1, 0, 0)), Vec<3>(at.qA * Vec<3>(0, 1, 0))}) {
    out.turn(axis, scale * axis.dot(bent));
  }
  return zA;
}
/// The cosine of the angle between the axes that alignAxes() aligns.
inline Real alignment(const JointFrames<2>&) { return 1; }
inline Real alignment(const JointFrames<3>& at) { return (at.qA * Vec<3>(0, 0, 1)).dot(at.qB * Vec<3>(0, 0, 1)); }

/// Turns a row with B's position as its error into the nearer of two limits, or into both if they are equal.
template <int D>
void keepBetween(ConstraintRow<D>& row, Real lower, Real upper) {
  const bool low = row.error - lower < upper - row.error;
  row.error -= low ? lower : upper;
  row.block = RowBlock::box;
  if (lower != upper) (low ? row.lo : row.hi) = 0;
}
/// A motor with a limited force (N, N m).
template <int D>
void drive(ConstraintRow<D>& row, Real speed, Real most) {
  row.block = RowBlock::box, row.law = RowLaw::motor;
  row.error = 0, row.speed = speed, row.lo = -most, row.hi = most;
}
template <int D>
void makeSpring(ConstraintRow<D>& row, Real stiffness, Real damping) {
  row.block = RowBlock::box, row.law = RowLaw::spring;
  row.stiffness = stiffness, row.damping = damping;
}

/// What several kinds have along or about one axis: limits, a motor, a spring; each a row.
struct Axis {
  Real lower = -kFarLimit, upper = kFarLimit;  // m or rad
  Real motorSpeed = 0, motorMost = 0;          // m/s and N, or rad/s and N m; motorMost 0: no motor
  Real stiffness = 0, damping = 0, rest = 0;   // N/m or N m/rad; m or rad

  /// Throws UserError. `most`: the kind's name for motorMost.
  void check(const std::string& kind, const std::string& most) const {
    if (lower > upper) throw UserError("'" + kind + "' has lower above upper; valid: lower <= upper");
    if (motorSpeed != 0 && motorMost == 0) {
      throw UserError("'" + kind + "' has a motor_speed, but no motor force or torque; valid: " + most +
                      " > 0, or motor_speed=0");
    }
    if (rest != 0 && stiffness == 0) {
      throw UserError("'" + kind + "' has a rest position, but no spring; valid: stiffness > 0, or rest=0");
    }
  }
  // `make()` appends a row with B's position as error.
  template <int D, class Make>
  void addLimits(JointRows<D>& out, const Make& make) const {
    if (lower == -kFarLimit && upper == kFarLimit) {
      out.absent();
    } else {
      keepBetween<D>(make(), lower, upper);
    }
  }
  template <int D, class Make>
  void addMotor(JointRows<D>& out, const Make& make) const {
    if (motorMost == 0) {
      out.absent();
    } else {
      drive<D>(make(), motorSpeed, motorMost);
    }
  }
  template <int D, class Make>
  void addSpring(JointRows<D>& out, const Make& make) const {
    if (stiffness == 0 && damping == 0) {
      out.absent();
    } else {
      ConstraintRow<D>& row = make();
      row.error -= rest;
      makeSpring(row, stiffness, damping);
    }
  }
};

}}}  // namespace lpc::LPC_PRECISION::solver
