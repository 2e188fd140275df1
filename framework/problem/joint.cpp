// SPDX-License-Identifier: Zlib
#include "framework/problem/joint.h"

#include <cmath>

#include "framework/math/user_numbers.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
JointRecord<D> makeJoint(const JointDef<D>& def, const Pose<D>& X_WA, const Pose<D>& X_WB) {
  const Pose<D> X_WJb = def.X_WJb.value_or(def.X_WJ);
  for (const Pose<D>& X : {def.X_WJ, X_WJb}) checkPose(X, "the joint");
  for (const Real limit : {def.breakForce, def.breakTorque}) {
    if (limit > 0) continue;
    throw UserError("the joint breaks at " + std::to_string(limit) + " N or N m; valid: a number > 0, or infinity");
  }
  const Spec spec = Spec::parse(def.kind);
  JointRecord<D> joint;
  joint.kind = createStage<JointKind<D>>(spec);
  joint.spec = Registry::instance().find(StageKind::joint, D, spec.name).canonical(spec).text();
  joint.bodyA = def.bodyA.slot, joint.bodyB = def.bodyB.slot, joint.collide = def.collide;
  const auto seenFrom = [](const Pose<D>& X_WC, const Pose<D>& X_WJ) {
    const Pose<D> X_CW = X_WC.inverse();
    return Pose<D>{X_CW * X_WJ.p, (X_CW.q * X_WJ.q).normalized()};
  };
  joint.X_CaJ = seenFrom(X_WA, def.X_WJ), joint.X_CbJ = seenFrom(X_WB, X_WJb);
  for (const Pose<D>& X_CJ : {joint.X_CaJ, joint.X_CbJ}) {
    if (X_CJ.p.allFinite()) continue;
    throw UserError("the pose of the joint's body is not finite; valid: a body at a finite pose");
  }
  joint.breakForce = def.breakForce, joint.breakTorque = def.breakTorque;
  joint.kind->begin(joint, X_WA, X_WB);
  return joint;
}

template <int D>
JointError jointError(std::span<const ConstraintRow<D>> rows) {
  JointError out;
  for (const ConstraintRow<D>& r : rows) {
    if (!r.binds()) continue;
    double& sum = r.angular ? out.angular : out.linear;
    sum += double(r.error) * double(r.error);
  }
  return {std::sqrt(out.linear), std::sqrt(out.angular)};
}

template <int D>
JointLoad jointLoad(std::span<const ConstraintRow<D>> rows, std::span<const Real> impulse, Real dt) {
  Vec<D> force = Vec<D>::Zero();
  Ang<D> torque = Ang<D>::Zero();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    force += impulse[i] * rows[i].d;
    if (rows[i].angular) torque += impulse[i] * rows[i].armB;
  }
  return {force.norm() / dt, torque.norm() / dt};
}

#define LPC_INSTANTIATE(D)                                                               \
  template JointRecord<D> makeJoint(const JointDef<D>&, const Pose<D>&, const Pose<D>&); \
  template JointError jointError<D>(std::span<const ConstraintRow<D>>);                  \
  template JointLoad jointLoad<D>(std::span<const ConstraintRow<D>>, std::span<const Real>, Real)
LPC_INSTANTIATE(2);
LPC_INSTANTIATE(3);
#undef LPC_INSTANTIATE

}}  // namespace lpc::LPC_PRECISION
