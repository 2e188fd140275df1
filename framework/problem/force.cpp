// SPDX-License-Identifier: Zlib
#include "framework/problem/force.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
ForceRecord<D> makeForce(const ForceDef<D>& def, const Bodies<D>& bodies) {
  const Spec spec = Spec::parse(def.kind);
  ForceRecord<D> force;
  force.kind = createStage<ForceKind<D>>(spec);
  force.spec = Registry::instance().find(StageKind::force, D, spec.name).canonical(spec).text();
  force.bodyA = def.bodyA.slot, force.bodyB = def.bodyB.slot;
  const ForceEnds ends = force.kind->ends();
  const auto refuse = [&](const std::string& why) { throw UserError("force '" + spec.name + "' " + why); };
  const bool toAll = force.bodyB < 0;
  if (!ends.from && force.bodyA >= 0) refuse("takes no body a; valid: b alone, the body that it acts on");
  if (!ends.all && toAll) refuse("needs a body to act on; valid: b");
  if (!toAll && force.bodyA == force.bodyB)
    refuse("acts between a body and itself; valid: two bodies, or the world and a body");
  const auto moves = [&](std::int32_t body) { return body >= 0 && movedByForces(bodies, body); };
  if (!toAll && !moves(force.bodyA) && !moves(force.bodyB))
    refuse("acts on bodies that cannot move; valid: at least one dynamic body");
  if (!ends.anchors && (def.anchorA || def.anchorB)) refuse("takes no anchors; valid: no anchors");
  if (toAll && def.anchorB) refuse("acts at the centres of mass of all bodies; valid: no anchor on b");
  const auto local = [&](std::int32_t body, const std::optional<Vec<D>>& anchor) -> Vec<D> {
    if (!anchor) return Vec<D>::Zero();
    if (!anchor->allFinite()) refuse("has an anchor that is not finite");
    return body < 0 ? *anchor : Vec<D>(*anchor - bodies.center[body]);
  };
  force.localA = local(force.bodyA, def.anchorA), force.localB = local(force.bodyB, def.anchorB);
  const auto pose = [&](std::int32_t body) { return body < 0 ? Pose<D>{} : bodies.pose[body]; };
  force.kind->begin(force, pose(force.bodyA), pose(force.bodyB));
  return force;
}

template ForceRecord<2> makeForce(const ForceDef<2>&, const Bodies<2>&);
template ForceRecord<3> makeForce(const ForceDef<3>&, const Bodies<3>&);

}}  // namespace lpc::LPC_PRECISION
