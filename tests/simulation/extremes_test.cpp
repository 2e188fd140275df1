// SPDX-License-Identifier: Zlib
// What nobody would call physics and a scene may still say: every solver comes through it with numbers.
#include <gtest/gtest.h>

#include "framework/invariants.h"
#include "tests/every_solver.h"
#include "tests/small_worlds.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

/// Every body finite, and what contacts and joints push.
template <int D>
bool staysFinite(World<D>& world, Real dt, int steps) {
  for (int i = 0; i < steps; ++i) {
    world.step(dt);
    if (!invariants(world).finite) return false;
  }
  return true;
}

// Three boxes in one place, half in the ground, and three balls a micrometre apart under it.
template <int D>
bool survivesOverlap(const std::string& solver) {
  World<D> world(Pipeline::parse("solver=" + solver));
  addGround(world);
  for (int i = 0; i < 3; ++i) world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0)));
  for (int i = 0; i < 3; ++i) world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(1e-6 * i, -0.4)));
  return staysFinite(world, Real(1) / 60, 30);
}

template <int D>
bool survivesStep(const std::string& solver, double dt) {
  World<D> world(Pipeline::parse("solver=" + solver));
  addGround(world);
  for (int i = 0; i < 3; ++i) world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0.5 + i)));
  const Handle bob = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(5, 5)));
  world.add(pivot<D>(world.handle(0), bob, at<D>(4, 5)));
  return staysFinite(world, static_cast<Real>(dt), 20);
}

// A joint of each kind that has a spring, with none and with the stiffest there is.
template <int D>
bool survivesStiffness(const std::string& solver, bool stiff) {
  World<D> world(Pipeline::parse("solver=" + solver));
  addGround(world);
  int n = 0;
  for (const Registered* kind : Registry::instance().list(StageKind::joint, D)) {
    Spec spec{kind->info.name, {}};
    for (const ParamInfo& p : kind->params) {
      if (!p.name.ends_with("stiffness")) continue;
      if (kind->info.name == "distance") spec.set("mode", {"spring", {}});
      spec.set(p.name, {stiff ? "1e12" : "0", {}});
    }
    if (spec.fields.empty()) continue;
    const double x = 3 * n++;
    const Handle b = world.add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(x, 5)));
    JointDef<D> joint{.kind = spec.text(), .bodyA = world.handle(0), .bodyB = b};
    joint.X_WJ.p = at<D>(x, 5.5), joint.X_WJb = Pose<D>{at<D>(x + 1, 5), {}};
    world.add(joint);
  }
  return n > 1 && staysFinite(world, Real(1) / 60, 20);
}

template <int D>
void everySolverSurvives() {
  for (const std::string& solver : everySolver<D>()) {
    EXPECT_TRUE(survivesOverlap<D>(solver)) << solver;
    for (const double dt : {10.0, 1e-9}) EXPECT_TRUE(survivesStep<D>(solver, dt)) << solver << ' ' << dt;
    for (const bool stiff : {false, true}) EXPECT_TRUE(survivesStiffness<D>(solver, stiff)) << solver << ' ' << stiff;
  }
}
TEST(Extremes, EverySolverSurvives2) { everySolverSurvives<2>(); }
TEST(Extremes, EverySolverSurvives3) { everySolverSurvives<3>(); }

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
