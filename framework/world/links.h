// SPDX-License-Identifier: Zlib
#pragma once

#include <vector>

#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A joint, or a force that needs two anchors such as a spring, as it is drawn: from the centre of mass of A over both
/// anchors to that of B. World positions (m). `from` is `a` if A is the world.
template <int D>
struct Link {
  Vec<D> from = Vec<D>::Zero(), a = Vec<D>::Zero(), b = Vec<D>::Zero(), to = Vec<D>::Zero();
  bool force = false;
};

/// The links of all bodies in their present poses: active joints, then such forces. Links without a finite
/// position are left out.
template <int D>
std::vector<Link<D>> linksOf(const Simulation<D>& simulation) {
  std::vector<Link<D>> out;
  const Bodies<D>& bodies = simulation.bodies();
  const auto add = [&](const auto& record, const Vec<D>& localA, const Vec<D>& localB, bool force) {
    const Pose<D> X_WA = poseOf(bodies, record.bodyA), X_WB = poseOf(bodies, record.bodyB);
    Link<D> link{.a = X_WA * localA, .b = X_WB * localB, .to = X_WB.p, .force = force};
    link.from = record.bodyA < 0 ? link.a : X_WA.p;
    if (link.from.allFinite() && link.a.allFinite() && link.b.allFinite() && link.to.allFinite()) out.push_back(link);
  };
  if (simulation.settings().model.joints) {
    for (const JointRecord<D>& j : simulation.joints()) {
      if (j.active()) add(j, j.X_CaJ.p, j.X_CbJ.p, false);
    }
  }
  for (const ForceRecord<D>& f : simulation.forces()) {
    if (f.kind && f.kind->ends().anchors && !f.kind->ends().all) add(f, f.localA, f.localB, true);
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
