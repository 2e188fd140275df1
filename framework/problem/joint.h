// SPDX-License-Identifier: Zlib
// Joints: what a user adds, what a world keeps, and what a kind of joint is. A kind is one file in algorithms/joint/;
// nobody else knows its name, since every resolver takes its rows.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "framework/math/check.h"
#include "framework/math/indexed.h"
#include "framework/problem/body.h"
#include "framework/problem/constraint_row.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

inline constexpr int kJointRows = 8;

/// A joint as a user adds it. Both bodies get a frame at X_WJ, in which the kind says what may move: `lpc list --stage
/// joint` names kinds and parameters.
template <int D>
struct JointDef {
  std::string kind = "pivot";         // with parameters: "hinge{lower=-0.5,upper=0.5}"
  Handle bodyA = {}, bodyB = {};      // bodyA may be the world: Handle{}
  Pose<D> X_WJ{};                     // at the time of adding; in 3D its z is a hinge's axis
  std::optional<Pose<D>> X_WJb = {};  // the frame on B, where it is another: the far end of a rope
  bool collide = false;               // do the two bodies collide with each other?
  Real breakForce = std::numeric_limits<Real>::infinity();   // N: a step that needs more is the joint's last
  Real breakTorque = std::numeric_limits<Real>::infinity();  // N m, of the angular rows
};

template <int D>
class JointKind;

template <int D>
struct JointRecord {
  std::shared_ptr<const JointKind<D>> kind;  // null: a free slot
  std::string spec;                          // the kind with every parameter
  std::int32_t bodyA = -1, bodyB = -1;       // bodyA -1: the world
  std::uint8_t collide = 0, broken = 0;      // a broken joint has no rows
  std::uint32_t generation = 0;
  Pose<D> X_CaJ{}, X_CbJ{};  // in the centre-of-mass frames; X_WJ where A is the world
  Real breakForce = 0, breakTorque = 0;
  IndexedArray<Real, kJointRows> impulse{};  // of the last step, on B, by row: N s or N m s
  IndexedArray<Real, kJointRows> memory{};   // the solver's own, by row
  std::array<Real, 4> state{};               // the kind's own

  bool active() const { return kind && !broken; }
};

/// The rows of one joint. Row numbers are for ever: they do not depend on what is active, so that row i of this step
/// starts from impulse i of the last.
template <int D>
struct JointRows {
  IndexedArray<ConstraintRow<D>, kJointRows> row;
  int count = 0;

  /// Along d at a point: rA and rB from the centres of mass, m.
  ConstraintRow<D>& point(const Vec<D>& d, const Vec<D>& rA, const Vec<D>& rB, Real error) {
    ConstraintRow<D>& r = next();
    r.d = d, r.armA = cross(rA, d), r.armB = cross(rB, d), r.error = error;
    return r;
  }
  /// About an axis, unit.
  ConstraintRow<D>& turn(const Ang<D>& axis, Real error) {
    ConstraintRow<D>& r = next();
    r.armA = r.armB = axis, r.error = error, r.angular = true;
    return r;
  }
  /// For the row just added: a number that is kept for a part that this joint has not.
  ConstraintRow<D>& absent() {
    ConstraintRow<D>& r = next();
    r.block = RowBlock::box, r.lo = r.hi = 0;
    return r;
  }
  std::span<const ConstraintRow<D>> all() const { return {row.data(), row.data() + count}; }

 private:
  ConstraintRow<D>& next() {
    LPC_ASSERT(count < kJointRows);
    return row[count++] = {};
  }
};

/// The two frames of a joint at given poses.
template <int D>
struct JointFrames {
  Vec<D> rA, rB;  // from the centres of mass to the frames' origins, world, m
  Vec<D> gap;     // origin of B's frame minus origin of A's, m
  Rot<D> qA, qB;  // of the frames in the world

  JointFrames(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB)
      : rA(X_WA.q * joint.X_CaJ.p), rB(X_WB.q * joint.X_CbJ.p), qA(X_WA.q * joint.X_CaJ.q), qB(X_WB.q * joint.X_CbJ.q) {
    gap = (X_WB.p - X_WA.p) + rB - rA;  // positions first: far from the origin the sum would lose digits
  }
};

/// How a kind of joint holds two bodies. Stateless: what a joint remembers is in its record.
template <int D>
class JointKind : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::joint;
  static constexpr int kDimension = D;

  /// Of a new joint: sets `state`. Throws UserError when the frames make no such joint.
  virtual void begin(JointRecord<D>& /*joint*/, const Pose<D>& /*X_WA*/, const Pose<D>& /*X_WB*/) const {}
  /// The rows at these poses, equality rows first. Appends; changes nothing else; any poses, any number of times.
  virtual void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const = 0;
  /// After a step: may update `state`.
  virtual void finish(JointRecord<D>& /*joint*/, const Pose<D>& /*X_WA*/, const Pose<D>& /*X_WB*/) const {}
  /// Of a new joint, after begin(), and when one of its bodies was changed: the massBetween() them, kg.
  virtual void weigh(JointRecord<D>& /*joint*/, Real /*mass*/) const {}
};

/// The joint of a definition between bodies at these poses. Throws UserError for an unknown kind or parameter, forces
/// to break at that are not > 0, and frames that make no such joint.
template <int D>
JointRecord<D> makeJoint(const JointDef<D>& def, const Pose<D>& X_WA, const Pose<D>& X_WB);

/// How far the parts of a joint are from where they should be: metres and radians are never added.
struct JointError {
  double linear = 0;   // m
  double angular = 0;  // rad
};

/// X_WC of a body, the world's own for -1.
template <int D>
Pose<D> poseOf(const Bodies<D>& bodies, std::int32_t body) {
  return body < 0 ? Pose<D>{} : bodies.pose[body];
}

/// The mass (kg) that two bodies have against each other, m M / (m + M): what a spring between them swings. Of those
/// that do not move, the other's own. a -1: the world.
template <int D>
Real massBetween(const Bodies<D>& bodies, std::int32_t a, std::int32_t b) {
  const Real mA = a < 0 ? Real(0) : bodies.mass[a];
  const Real mB = bodies.mass[b];
  return mA > 0 && mB > 0 ? mA * (mB / (mA + mB)) : mA + mB;
}

/// Rows of a joint at the bodies' present poses; none where it is free or broken.
template <int D>
void jointRows(const JointRecord<D>& joint, const Bodies<D>& bodies, JointRows<D>& out) {
  out.count = 0;
  if (joint.active()) joint.kind->rows(joint, poseOf(bodies, joint.bodyA), poseOf(bodies, joint.bodyB), out);
}

/// Of the rows that are rigid: equalities, and stops that are passed.
template <int D>
JointError jointError(std::span<const ConstraintRow<D>> rows);

struct JointLoad {
  Real force = 0;   // N
  Real torque = 0;  // N m, of the angular rows
};
/// What B feels of the joint, from impulses (by row) over dt (s).
template <int D>
JointLoad jointLoad(std::span<const ConstraintRow<D>> rows, std::span<const Real> impulse, Real dt);

}}  // namespace lpc::LPC_PRECISION
