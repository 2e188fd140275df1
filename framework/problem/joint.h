// SPDX-License-Identifier: Zlib
// Joints: how a user defines one, the data that a world stores, and the interface of a kind of joint. A kind is one
// file in algorithms/joint/. No other code uses its name, since every resolver takes its rows.
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

/// A joint as a user adds it. Both bodies get a frame at X_WJ, in which the kind defines the free motion. `lpc list
/// --stage joint` lists kinds and parameters.
template <int D>
struct JointDef {
  std::string kind = "pivot";                                // with parameters: "hinge{lower=-0.5,upper=0.5}"
  BodyHandle bodyA = {}, bodyB = {};                         // bodyA may be the world: BodyHandle{}
  Pose<D> X_WJ{};                                            // when the joint is added; in 3D a hinge turns about its z
  std::optional<Pose<D>> X_WJb = {};                         // the frame on B, when it differs: the far end of a rope
  bool collide = false;                                      // true: the two bodies collide with each other
  Real breakForce = std::numeric_limits<Real>::infinity();   // N: the joint breaks in a step that needs more
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
  Pose<D> X_CaJ{}, X_CbJ{};  // in the centre-of-mass frames; X_WJ when A is the world
  Real breakForce = 0, breakTorque = 0;
  IndexedArray<Real, kJointRows> impulse{};  // of the last step, on B, by row: N s or N m s
  IndexedArray<Real, kJointRows> memory{};   // data of the solver, by row
  std::array<Real, 4> state{};               // data of the kind

  bool active() const { return kind && !broken; }
};

/// The rows of one joint. A row keeps its number whether other rows are active or not, so that impulse i of the last
/// step warm starts row i.
template <int D>
struct JointRows {
  IndexedArray<ConstraintRow<D>, kJointRows> row;
  int count = 0;

  /// Adds a row along d at a point. rA and rB are the arms from the centres of mass to the point, m.
  ConstraintRow<D>& point(const Vec<D>& d, const Vec<D>& rA, const Vec<D>& rB, Real error) {
    ConstraintRow<D>& r = next();
    r.d = d, r.armA = cross(rA, d), r.armB = cross(rB, d), r.error = error;
    return r;
  }
  /// Adds a row about a unit axis.
  ConstraintRow<D>& turn(const Ang<D>& axis, Real error) {
    ConstraintRow<D>& r = next();
    r.armA = r.armB = axis, r.error = error, r.angular = true;
    return r;
  }
  /// Adds an inactive row, so that the row numbers after a missing part of the joint do not change.
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

/// A kind of joint. Stateless: data of a joint is in its record.
template <int D>
class JointKind : public Stage {
 public:
  static constexpr StageKind kStage = StageKind::joint;
  static constexpr int kDimension = D;

  /// Called for a new joint; sets `state`. Throws UserError when the frames are invalid for this kind.
  virtual void begin(JointRecord<D>& /*joint*/, const Pose<D>& /*X_WA*/, const Pose<D>& /*X_WB*/) const {}
  /// Appends the rows at these poses to `out`, equality rows first. May be called at any poses, any number of times.
  virtual void rows(const JointRecord<D>& joint, const Pose<D>& X_WA, const Pose<D>& X_WB, JointRows<D>& out) const = 0;
  /// Called after a step; may update `state`.
  virtual void finish(JointRecord<D>& /*joint*/, const Pose<D>& /*X_WA*/, const Pose<D>& /*X_WB*/) const {}
  /// Called for a new joint after begin(), and when one of its bodies has changed. `mass` is massBetween() of its
  /// bodies, kg.
  virtual void weigh(JointRecord<D>& /*joint*/, Real /*mass*/) const {}
};

/// Makes a joint from its definition, between bodies at these poses. Throws UserError for an unknown kind or parameter,
/// breaking forces that are not > 0, and frames that are invalid for this kind.
template <int D>
JointRecord<D> makeJoint(const JointDef<D>& def, const Pose<D>& X_WA, const Pose<D>& X_WB);

/// Distance of a joint from its target. Metres and radians are never added.
struct JointError {
  double linear = 0;   // m
  double angular = 0;  // rad
};

/// X_WC of a body; the identity for -1, the world.
template <int D>
Pose<D> poseOf(const Bodies<D>& bodies, std::int32_t body) {
  return body < 0 ? Pose<D>{} : bodies.pose[body];
}

/// Reduced mass (kg) of two bodies, m M / (m + M): the mass that a spring between them moves. When one does not move,
/// the mass of the other. a = -1: the world.
template <int D>
Real massBetween(const Bodies<D>& bodies, std::int32_t a, std::int32_t b) {
  const Real mA = a < 0 ? Real(0) : bodies.mass[a];
  const Real mB = bodies.mass[b];
  return mA > 0 && mB > 0 ? mA * (mB / (mA + mB)) : mA + mB;
}

/// Rows of a joint at the bodies' current poses; none for a free slot or a broken joint.
template <int D>
void jointRows(const JointRecord<D>& joint, const Bodies<D>& bodies, JointRows<D>& out) {
  out.count = 0;
  if (joint.active()) joint.kind->rows(joint, poseOf(bodies, joint.bodyA), poseOf(bodies, joint.bodyB), out);
}

/// Error of the rigid rows: equalities, and stops that are exceeded.
template <int D>
JointError jointError(std::span<const ConstraintRow<D>> rows);

struct JointLoad {
  Real force = 0;   // N
  Real torque = 0;  // N m, of the angular rows
};
/// Load of the joint on B, from impulses (by row) over dt (s).
template <int D>
JointLoad jointLoad(std::span<const ConstraintRow<D>> rows, std::span<const Real> impulse, Real dt);

}}  // namespace lpc::LPC_PRECISION
