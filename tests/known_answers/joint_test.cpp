// SPDX-License-Identifier: Zlib
// Pendulums by the elliptic integral, springs by their closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/small_worlds.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

constexpr double kG = 9.81, kPi = 3.141592653589793;
constexpr bool kDouble = sizeof(Real) == 8;

// K(m), the complete elliptic integral of the first kind, by the arithmetic-geometric mean.
double ellipticK(double m) {
  double a = 1, b = std::sqrt(1 - m);
  while (std::abs(a - b) > 1e-15) {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b), a = mean;
  }
  return kPi / (2 * a);
}

TEST(Pendulum, TheEllipticIntegralItself) {  // 4 sqrt(l/g) K: the figures of a point pendulum of 1 m
  EXPECT_NEAR(4 * std::sqrt(1 / kG) * ellipticK(std::pow(std::sin(kPi / 36), 2)), 2.009892627298601, 1e-12);
  EXPECT_NEAR(4 * std::sqrt(1 / kG) * ellipticK(0.5), 2.3678419475762373, 1e-12);
}

// A ball on a pivot 1 m above its centre, let go at an angle: its first full period.
template <int D>
double period(const std::string& solver, double degrees, Real dt) {
  World<D> world(Pipeline::parse("solver=" + solver));
  const double angle = degrees * kPi / 180;
  const Handle post = world.add(body<D>(Shape<D>::sphere(Real(0.01)), at<D>(0, 5), BodyType::fixed));
  const Handle bob = world.add(body<D>(Shape<D>::sphere(Real(0.1)), at<D>(std::sin(angle), 5 - std::cos(angle))));
  world.add(PivotDef<D>{post, bob, at<D>(0, 5), false});
  double crossings[2] = {0, 0}, previous = 1;
  int found = 0;
  for (int i = 0; i < static_cast<int>(20 / dt) && found < 2; ++i) {
    world.step(dt);
    const double x = double(world.pose(bob).p[0]);
    if (previous > 0 && x <= 0) {  // outwards to the left: once a period
      crossings[found++] = double(world.time()) - double(dt) * x / (x - previous);
    }
    previous = x;
  }
  return crossings[1] - crossings[0];
}

// The ball turns with its arm: the length of the point pendulum that swings like it is l + I / (m l).
template <int D>
double error(const std::string& solver, double degrees, Real dt) {
  const double length = 1 + (D == 2 ? 0.5 : 0.4) * 0.01;
  const double m = std::pow(std::sin(degrees * kPi / 360), 2);
  const double expected = 4 * std::sqrt(length / kG) * ellipticK(m);
  return (period<D>(solver, degrees, dt) - expected) / expected;
}

const char* const kSolvers[] = {"split_solver",
                                "split_solver{integrator=rk4}",
                                "split_solver{position=baumgarte}",
                                "split_solver{velocity=millington}",
                                "split_solver{velocity=naive}",
                                "soft_step"};

template <int D>
void pendulum() {
  for (const char* solver : kSolvers) {
    for (double degrees : {10.0, 90.0}) EXPECT_LT(std::abs(error<D>(solver, degrees, Real(1) / 480)), 0.01) << solver;
  }
}
// From 170 degrees the period hangs on the last per cent of energy, of which a joint solved at the velocity loses a
// share in proportion to dt: the error must go to zero with it.
template <int D>
void highPendulum() {
  for (const char* solver : kSolvers) {
    const double coarse = std::abs(error<D>(solver, 170, Real(1) / 480));
    const double fine = std::abs(error<D>(solver, 170, Real(1) / 4800));
    EXPECT_LT(fine, 0.3 * coarse) << solver;
    EXPECT_LT(fine, 0.1) << solver;
  }
}
TEST(Pendulum, FromTheTop2) { highPendulum<2>(); }
TEST(Pendulum, FromTheTop3) { highPendulum<3>(); }
TEST(Pendulum, Period2) { pendulum<2>(); }
TEST(Pendulum, Period3) { pendulum<3>(); }

// A mass on a spring whose rest length is long: w = sqrt(k/m). Semi-implicit Euler holds up to w dt = 2 and no further.
TEST(SpringOscillator, LimitOfSemiImplicitEuler) {
  for (double factor : {0.995, 1.005}) {
    WorldSettings<2> settings;
    settings.gravity.setZero();
    World<2> world({}, settings);
    const Handle b = world.add(body<2>(Shape<2>::sphere(Real(0.1)), {Real(10.01), 0}));
    const double w = 2 * kPi;
    auto spring = std::make_shared<Spring<2>>();
    spring->bodyB = b, spring->restLength = 10;
    spring->stiffness = Real(w * w * double(world.mass(b)));
    world.add(spring);
    double far = 0;
    for (int i = 0; i < 400; ++i) {
      world.step(Real(factor * 2 / w));
      far = std::max(far, std::abs(double(world.pose(b).p[0]) - 10));
      if (far > 5) break;
    }
    EXPECT_EQ(far < 1, factor < 1) << factor << ' ' << far;
  }
}

// x = e^(-z w t) (cos wd t + z w / wd sin wd t): 0.53154 after 1 s at z = 0.1.
TEST(SpringOscillator, Damped) {
  const std::pair<const char*, double> tolerance[] = {{"semi_implicit_euler", 5e-3}, {"rk4", kDouble ? 1e-6 : 1e-3}};
  for (const auto& [integrator, eps] : tolerance) {
    WorldSettings<2> settings;
    settings.gravity.setZero();
    World<2> world(Pipeline::parse("solver=split_solver{integrator=" + std::string(integrator) + "}"), settings);
    const Handle b = world.add(body<2>(Shape<2>::sphere(Real(0.1)), {11, 0}));
    const double w = 2 * kPi, m = double(world.mass(b));
    auto spring = std::make_shared<Spring<2>>();
    spring->bodyB = b, spring->restLength = 10;
    spring->stiffness = Real(w * w * m), spring->damping = Real(2 * 0.1 * w * m);
    world.add(spring);
    for (int i = 0; i < 1000; ++i) world.step(Real(0.001));
    EXPECT_NEAR(double(world.pose(b).p[0]) - 10, 0.5315351237271717, eps) << integrator;
  }
}

// Free fall of a whole world: g T dt / 2 too low for semi-implicit Euler, too high for explicit, right for RK4.
TEST(FreeFall, ErrorsOfTheIntegrators) {
  const std::pair<const char*, double> sign[] = {{"explicit_euler", 1}, {"semi_implicit_euler", -1}, {"rk4", 0}};
  for (const auto& [integrator, s] : sign) {
    World<3> world(Pipeline::parse("solver=split_solver{integrator=" + std::string(integrator) + "}"));
    const Handle b = world.add(body<3>(Shape<3>::sphere(1), {0, 0, 0}));
    for (int i = 0; i < 120; ++i) world.step(Real(1) / 60);
    EXPECT_NEAR(double(world.pose(b).p[1]), -19.62 + s * 0.1635, kDouble ? 1e-9 : 5e-3) << integrator;
  }
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
