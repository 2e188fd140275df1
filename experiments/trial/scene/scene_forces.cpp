// SPDX-License-Identifier: Zlib
#include <algorithm>

#include "experiments/trial/scene/scene_parsed.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
ForceDef<D> readForce(TableReader& block, SceneNumbers& numbers) {
  ForceDef<D> def;
  if (const toml::node* node = block.find("anchor_a")) def.anchorA = numbers.vector<D>(*node);
  if (const toml::node* node = block.find("anchor_b")) def.anchorB = numbers.vector<D>(*node);
  const Spec kind = readKind(block, numbers, StageKind::force, D);
  def.kind = kind.text();
  atBlock(block, [&] { return kindOf(StageKind::force, kind.name, numbers, D).create(kind); });
  return def;
}

template <int D>
void placeForce(TableReader& block, SceneNumbers& numbers, const SceneSpec<D>& scene,
                typename SceneSpec<D>::Force& force) {
  force.step = numbers.whole(block, "from", 0, 0, kMaxSteps);
  force.removeAt = numbers.whole(block, "until", -1, -1, kMaxSteps);
  if (numbers.rehearsing()) return;
  // Remaining errors are between the kind and its ends at their poses in the file.
  Bodies<D> ends;
  const auto end = [&](int body) {
    if (body < 0) return BodyHandle{};
    const auto& spawn = scene.spawns[static_cast<std::size_t>(body)];
    force.step = std::max(force.step, spawn.step);
    ends.used.push_back(1), ends.type.push_back(spawn.body.type);
    MassProperties<D> mass;  // as in World::weigh
    for (const ShapeDef<D>& s : spawn.body.shapes) {
      mass = combined(mass, transformed(massProperties(s.shape, s.density), s.X_BS));
    }
    if (spawn.body.mass) mass = *spawn.body.mass;
    ends.center.push_back(mass.center);
    ends.pose.push_back({spawn.body.X_WB * mass.center, spawn.body.X_WB.q});
    return BodyHandle{static_cast<std::int32_t>(ends.used.size()) - 1, 0};
  };
  ForceDef<D> between = force.def;
  between.bodyA = end(force.bodyA);
  between.bodyB = force.bodyA == force.bodyB ? between.bodyA : end(force.bodyB);
  atBlock(block, [&] { return makeForce(between, ends); });
  if (force.removeAt >= 0 && force.removeAt <= force.step) {
    block.fail(*block.find("until"), "'until' is " + std::to_string(force.removeAt) +
                                         ", but the force starts at step " + std::to_string(force.step) +
                                         "; valid: a later one");
  }
}

template ForceDef<2> readForce(TableReader&, SceneNumbers&);
template ForceDef<3> readForce(TableReader&, SceneNumbers&);
template void placeForce(TableReader&, SceneNumbers&, const SceneSpec<2>&, SceneSpec<2>::Force&);
template void placeForce(TableReader&, SceneNumbers&, const SceneSpec<3>&, SceneSpec<3>::Force&);

}}  // namespace lpc::LPC_PRECISION
