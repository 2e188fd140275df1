// SPDX-License-Identifier: Zlib
// Ensembles: the same scene many times, each run slightly perturbed at the start.
#include "experiments/trial/scene/scene_parsed.h"
#include "framework/shape/mass.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// A separate random stream; that of the file's expressions starts at the seed itself.
constexpr std::uint64_t kStream = 0x7065727475726221u;

template <class Vector>
Vector drawn(Random& random, double amount) {
  Vector out;
  for (int d = 0; d < out.size(); ++d) out[d] = static_cast<Real>(random.uniform(-amount, amount));
  return out;
}

// Centre of mass, in the body's frame.
template <int D>
Vec<D> centerOf(const BodyDef<D>& body) {
  MassProperties<D> mass;
  for (const ShapeDef<D>& def : body.shapes) {
    mass = combined(mass, transformed(massProperties(def.shape, def.density), def.X_BS));
  }
  return mass.center;
}

}  // namespace

template <int D>
void perturb(SceneSpec<D>& scene, double amount, std::uint64_t seed) {
  if (amount == 0) return;  // not one bit
  Random random(seed ^ kStream);
  for (auto& spawn : scene.spawns) {
    BodyDef<D>& body = spawn.body;
    if (body.type != BodyType::dynamic || spawn.exact) continue;
    // Drawn for every body: a pinned or non-rotating body then does not shift the numbers of others.
    const Vec<D> shift = drawn<Vec<D>>(random, amount);
    const Ang<D> turn = drawn<Ang<D>>(random, amount);
    const bool turns = body.rotatable && scene.settings.model.rotation;
    const Rot<D> q = turns ? Rot<D>(rotationOf(turn) * body.X_WB.q) : body.X_WB.q;
    if (body.pinned) {  // it turns about its centre of mass, which is fixed
      const Vec<D> center = centerOf(body);
      body.X_WB.p += body.X_WB.q * center - q * center;
    } else {
      body.X_WB.p += shift;
    }
    body.X_WB.q = q;
    scene.seeded = scene.seeded || turns || !body.pinned;
  }
}

template void perturb(SceneSpec<2>&, double, std::uint64_t);
template void perturb(SceneSpec<3>&, double, std::uint64_t);

}}  // namespace lpc::LPC_PRECISION
