// SPDX-License-Identifier: Zlib
#include "experiments/trial/measure/control.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "experiments/trial/scene/simulation_of_scene.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kSeconds = 0.5;
constexpr double kShare = 0.01;  // of the distance

}  // namespace

std::string Control::reason() const {
  char why[160];
  std::snprintf(why, sizeof why,
                "control failed: a free body that must fall by %.4g m falls by %.4g m, so resting bodies prove nothing",
                right, fallen);
  return why;
}

template <int D>
Control dropAlone(const std::string& pipeline, const SceneSpec<D>& scene, const BodyDef<D>& body) {
  SceneSpec<D> alone;
  alone.name = scene.name, alone.settings = scene.settings, alone.dt = scene.dt;
  const std::unique_ptr<Simulation<D>> world = simulationOf(pipeline, alone);
  BodyDef<D> falls = body;
  falls.velocity.setZero(), falls.angularVelocity = decltype(falls.angularVelocity)::Zero(), falls.pinned = false;
  const BodyHandle h = world->add(falls);
  const Vec<D> start = world->pose(h).p, gravity = scene.settings.gravity;
  const double dt = double(scene.dt), g = double(gravity.norm());
  const long steps = std::max(1L, std::lround(kSeconds / dt));
  for (long i = 0; i < steps; ++i) world->step(scene.dt);
  const double t = static_cast<double>(steps) * dt;
  Control out;
  out.fallen = double((world->pose(h).p - start).dot(gravity)) / g;
  out.right = g * t * t / 2;
  out.slack = g * t * dt / 2 + kShare * out.right;  // semi-implicit or explicit Euler
  return out;
}

template Control dropAlone(const std::string&, const SceneSpec<2>&, const BodyDef<2>&);
template Control dropAlone(const std::string&, const SceneSpec<3>&, const BodyDef<3>&);

}}  // namespace lpc::LPC_PRECISION
