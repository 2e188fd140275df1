// SPDX-License-Identifier: Zlib
// Convergence of every solver with the step length: the motion of a spring converges (R17); the energy drift and the
// joint error of a pendulum go to zero (R16).
#include <gtest/gtest.h>

#include <cmath>

#include "framework/world/invariants.h"
#include "tests/every_solver.h"
#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace order_test { namespace {

constexpr double kG = 9.81;

// A ball of mass 1, on a spring of rest length 1 and stiffness 20 to the origin, is thrown sideways. Returns its
// position after 1 s by an independent Runge-Kutta method in ten thousand steps.
Eigen::Vector2d springReference() {
  struct State {
    Eigen::Vector2d x, v;
  };
  const auto rate = [](const State& s) {
    const double length = s.x.norm();
    return State{s.v, -20 * (length - 1) / length * s.x};
  };
  const auto moved = [](const State& s, const State& k, double h) { return State{s.x + h * k.x, s.v + h * k.v}; };
  State s{{1.5, 0}, {0, 1}};
  const double h = 1e-4;
  for (int i = 0; i < 10000; ++i) {
    const State a = rate(s), b = rate(moved(s, a, h / 2)), c = rate(moved(s, b, h / 2)), d = rate(moved(s, c, h));
    s = State{s.x + h / 6 * (a.x + 2 * b.x + 2 * c.x + d.x), s.v + h / 6 * (a.v + 2 * b.v + 2 * c.v + d.v)};
  }
  return s.x;
}

template <int D>
double springError(const std::string& solver, int steps, const Eigen::Vector2d& expected) {
  WorldSettings<D> settings;
  settings.gravity.setZero();
  World<D> world(Pipeline::parse("solver=" + solver), settings);
  BodyDef<D> def = body<D>(Shape<D>::sphere(Real(0.1)), at<D>(1.5, 0));
  def.velocity = at<D>(0, 1);
  const BodyHandle ball = world.add(def);
  world.add(ForceDef<D>{.kind = springKind(20 * double(world.mass(ball)), 1), .bodyB = ball});
  for (int i = 0; i < steps; ++i) world.step(Real(1) / static_cast<Real>(steps));
  const Vec<D> p = world.pose(ball).p;
  return std::hypot(double(p[0]) - expected[0], double(p[1]) - expected[1]);
}

// Order of convergence: log2 of the error ratio for half the step.
template <int D>
double springOrder(const std::string& solver) {
  const Eigen::Vector2d expected = springReference();
  return std::log2(springError<D>(solver, 100, expected) / springError<D>(solver, 200, expected));
}

struct Swing {
  double energy, joint;  // worst errors: share of m g l; m
};

// A cube on a pivot, 1 m from it, is released at the pivot's height; 2 s.
template <int D>
Swing pendulum(const std::string& solver, int stepsPerSecond) {
  World<D> world(Pipeline::parse("solver=" + solver));
  const BodyHandle post = world.add(body<D>(Shape<D>::sphere(Real(0.01)), at<D>(0, 5), BodyType::fixed));
  const BodyHandle bob = world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.1))), at<D>(1, 5)));
  world.add(pivot<D>(post, bob, at<D>(0, 5)));
  const double start = invariants(world).potential;
  Swing worst{0, 0};
  for (int i = 0; i < 2 * stepsPerSecond; ++i) {
    world.step(Real(1) / static_cast<Real>(stepsPerSecond));
    const Invariants<D> now = invariants(world);
    worst.energy = std::max(worst.energy, std::abs(now.kinetic + now.potential - start));
    worst.joint = std::max(worst.joint, now.jointError);
  }
  worst.energy /= double(world.mass(bob)) * kG;
  return worst;
}

// With a quarter of the step: about a quarter of the energy drift and of the joint error, down to the error that a
// position resolver leaves on purpose.
template <int D>
bool pendulumConverges(const std::string& solver) {
  const Swing coarse = pendulum<D>(solver, 120), fine = pendulum<D>(solver, 480);
  return coarse.energy < 0.25 && fine.energy < 0.3 * coarse.energy && coarse.joint < 0.07 &&
         fine.joint < std::max(0.3 * coarse.joint, double(kLinearSlop) / 5);
}

template <int D>
void everySolverConverges() {
  for (const std::string& solver : everySolver<D>(true)) {
    const bool verlet = solver.find("velocity_verlet") != solver.npos;
    const double order = solver.find("rk4") != solver.npos ? 4 : verlet ? 2 : 1;
    EXPECT_NEAR(springOrder<D>(solver), order, 0.05) << solver << ' ' << D << 'D';
    EXPECT_EQ(pendulumConverges<D>(solver), !declares<D>(solver, "Order.PendulumKeepsItsEnergy"))
        << solver << ' ' << D << 'D';
  }
  const std::string bug = "planted_solver{bug=heats}", dimension = ' ' + std::to_string(D) + 'D';
  expectCaught("Order of a spring " + bug + dimension, std::abs(springOrder<D>(bug) - 1) < 0.05);
  expectCaught("Order of a pendulum " + bug + dimension, pendulumConverges<D>(bug));
}
TEST(Order, EverySolverConverges2) { everySolverConverges<2>(); }
TEST(Order, EverySolverConverges3) { everySolverConverges<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::order_test
