// SPDX-License-Identifier: Zlib
// Impacts, resting forces and how fast Gauss-Seidel converges, against formulas.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/conformance/impact_scene.h"
#include "tests/small_worlds.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

constexpr double kG = 9.81;
constexpr bool kDouble = sizeof(Real) == 8;

const char* const kSolvers[] = {"split_solver", "split_solver{velocity=millington}", "split_solver{velocity=naive}",
                                "soft_step"};

template <int D>
World<D> floating(const std::string& solver) {
  WorldSettings<D> s;
  s.gravity.setZero();
  return World<D>(Pipeline::parse("solver=" + solver), s);
}

// v1' = ((m1 - e m2) v1 + (1 + e) m2 v2) / (m1 + m2) and so on, m 1 : 3, v 2 and -1.
template <int D>
void headOn() {
  const double expected[][3] = {{0, -0.25, -0.25}, {0.5, -1.375, 0.125}, {1, -2.5, 0.5}};
  for (const char* solver : kSolvers) {
    for (const auto& [e, v1, v2] : expected) {
      World<D> world = floating<D>(solver);
      BodyDef<D> a = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(-1, 0));
      BodyDef<D> b = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(1, 0));
      b.shapes[0].density = 3;
      a.velocity = at<D>(2, 0), b.velocity = at<D>(-1, 0);
      a.shapes[0].restitution = b.shapes[0].restitution = Real(e);
      const Handle first = world.add(a), second = world.add(b);
      for (int i = 0; i < 60; ++i) world.step(Real(1) / 60);
      // soft_step pushes out what has overlapped, and e = 0 leaves the rest of a gap to be closed: not exact.
      const double tolerance = solver[1] == 'o' ? 0.02 : kDouble ? 1e-9 : 1e-4;
      EXPECT_NEAR(double(world.motion(first).v[0]), v1, tolerance) << solver << " e=" << e;
      EXPECT_NEAR(double(world.motion(second).v[0]), v2, tolerance) << solver << " e=" << e;
    }
  }
}
TEST(Impact, HeadOn2) { headOn<2>(); }
TEST(Impact, HeadOn3) { headOn<3>(); }

// A ball hits a free rod at b = 0.4 from its middle, e = 1: j = 2 v / (1/m + 1/M + b^2/I).
TEST(Impact, OffCentreRod) {
  for (const char* solver : {"split_solver", "split_solver{velocity=millington}", "split_solver{velocity=naive}"}) {
    World<2> world = floating<2>(solver);
    BodyDef<2> rod = body<2>(Shape<2>::box({Real(0.5), Real(0.01)}), {0, 0});
    rod.shapes[0].density = 2 / Real(0.02);  // M = 2
    BodyDef<2> ball = body<2>(Shape<2>::sphere(Real(0.05)), {Real(0.4), Real(0.2)});
    ball.shapes[0].density = Real(1 / (3.141592653589793 * 0.0025));  // m = 1
    ball.velocity = {0, -3};
    rod.shapes[0].restitution = ball.shapes[0].restitution = 1;
    rod.shapes[0].friction = ball.shapes[0].friction = 0;
    const Handle r = world.add(rod), b = world.add(ball);
    for (int i = 0; i < 12; ++i) world.step(Real(1) / 60);
    const double inertia = 2 * (1 + 0.02 * 0.02) / 12, j = 2 * 3 / (1 + 0.5 + 0.16 / inertia);
    EXPECT_NEAR(double(world.motion(b).v[1]), -3 + j, 1e-4) << solver;
    EXPECT_NEAR(double(world.motion(r).w[0]), -0.4 * j / inertia, 1e-3) << solver;
  }
}

// Five balls with gaps: k arrive, k leave.
TEST(Impact, NewtonsCradle) {
  for (const char* solver : {"split_solver", "split_solver{velocity=millington}", "split_solver{velocity=naive}"}) {
    for (int arriving : {1, 2, 3}) {
      World<2> world = floating<2>(solver);
      std::vector<Handle> balls;
      for (int i = 0; i < 5; ++i) {
        // Gaps wider than a step's way and the margin: one impact at a time.
        BodyDef<2> ball = body<2>(Shape<2>::sphere(Real(0.5)), {Real(1.1 * i - (i < arriving ? 0.5 : 0)), 0});
        ball.velocity = {Real(i < arriving ? 1 : 0), 0};
        ball.shapes[0].restitution = 1;
        balls.push_back(world.add(ball));
      }
      for (int i = 0; i < 180; ++i) world.step(Real(1) / 60);
      for (int i = 0; i < 5; ++i) {
        EXPECT_NEAR(double(world.motion(balls[static_cast<std::size_t>(i)]).v[0]), i >= 5 - arriving ? 1 : 0, 1e-4)
            << solver << ' ' << arriving << " ball " << i;
      }
    }
  }
}

// Heights of bounces h e^(2n). A step of dt blurs an impact by v dt.
template <int D>
void bounces() {
  const Real dt = Real(1) / 2000;
  for (const char* solver : kSolvers) {
    for (double e : {0.5, 0.8, 0.95}) {
      World<D> world(Pipeline::parse("solver=" + std::string(solver)));
      BodyDef<D> ground = body<D>(Shape<D>::box(Vec<D>::Ones()), at<D>(0, -1), BodyType::fixed);
      BodyDef<D> ball = body<D>(Shape<D>::sphere(Real(0.25)), at<D>(0, 1.25));
      ground.shapes[0].restitution = ball.shapes[0].restitution = Real(e);
      world.add(ground);
      const Handle b = world.add(ball);
      double top = 0, previous = 1, expected = 1;
      int bounce = 0;
      for (int i = 0; i < 10000 && bounce < 3; ++i) {
        world.step(dt);
        const double y = double(world.pose(b).p[1]) - 0.25, v = double(world.motion(b).v[1]);
        if (previous > 0 && v <= 0 && i > 0 && top > 0) {  // the summit
          expected *= e * e;
          EXPECT_NEAR(y, expected, 0.01) << solver << " e=" << e << " bounce " << bounce;
          ++bounce;
        }
        top = v > 0 ? y : 0, previous = v;
      }
      EXPECT_EQ(bounce, 3) << solver << " e=" << e;
    }
  }
}
TEST(Impact, Bounces2) { bounces<2>(); }
TEST(Impact, Bounces3) { bounces<3>(); }

// A hundred bounces with e = 1: the energy must not rise.
TEST(Impact, ElasticBallNeverRises) {
  for (const char* solver : kSolvers) {
    World<2> world(Pipeline::parse("solver=" + std::string(solver)));
    BodyDef<2> ground = body<2>(Shape<2>::box(Vec<2>::Ones()), {0, -1}, BodyType::fixed);
    BodyDef<2> ball = body<2>(Shape<2>::sphere(Real(0.25)), {0, Real(1.25)});
    ground.shapes[0].restitution = ball.shapes[0].restitution = 1;
    world.add(ground);
    const Handle b = world.add(ball);
    double highest = 0;
    for (int i = 0; i < 90 * 240; ++i) {
      world.step(Real(1) / 240);
      highest = std::max(highest, double(world.pose(b).p[1]) - 0.25);
    }
    // soft_step catches a bounce up to a step early, v dt above the ground: 4.43 / 240 m. The others bounce exactly.
    EXPECT_LT(highest, 1 + (solver[1] == 'o' ? 4.43 / 240 : kDouble ? 1e-6 : 1e-3)) << solver;
  }
}

// N boxes at rest: under box i (1 is the top) the impulses of a step are i m g dt. In float a column of cubes is not at
// rest after ten seconds: its forces are 5 to 8 % off.
template <int D>
void stackForces() {
  for (const char* solver : {"split_solver", "split_solver{order=reverse}", "soft_step"}) {
    World<D> world(Pipeline::parse("solver=" + std::string(solver)));
    addGround(world);
    const int n = 10;
    for (int i = 0; i < n; ++i) world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0, 0.5 + i)));
    for (int i = 0; i < 600; ++i) world.step(Real(1) / 60);
    ASSERT_EQ(world.manifolds().size(), static_cast<std::size_t>(n)) << solver;
    for (const Manifold<D>& m : world.manifolds()) {
      double impulse = 0;
      for (int k = 0; k < m.count; ++k) impulse += double(m.points[static_cast<std::size_t>(k)].impulse[0]);
      const double expected = (n - m.bodyA) * kG / 60;
      EXPECT_NEAR(impulse, expected, (kDouble || D == 2 ? 0.01 : 0.1) * expected) << solver << " under box " << m.bodyB;
    }
  }
}
TEST(Stack, ForcesOfTen2) { stackForces<2>(); }
TEST(Stack, ForcesOfTen3) { stackForces<3>(); }

// --- convergence: one sweep after another, cold, on a column that gravity has just pulled ---------------------------

// Bodies of the given masses, bottom first, that only move up and down.
ImpactScene<2> column(const std::vector<double>& masses) {
  ImpactScene<2> s;
  s.add(0, Ang<2>::Zero(), {});
  for (std::size_t i = 0; i < masses.size(); ++i) {
    s.add(Real(masses[i]), Ang<2>::Zero(), {{0, Real(i + 1)}, {}}, {{0, -1}, Ang<2>::Zero()});
    s.touch(static_cast<int>(i), static_cast<int>(i) + 1, {0, 1}, {0, Real(i) + Real(0.5)}, 0, 0, 0);
  }
  return s;
}

template <int D>
struct Unbiased final : PositionResolver<D> {};

// Error of the impulses after that many sweeps: those of rest are the weights above.
double impulseError(const std::vector<double>& masses, int sweeps) {
  auto s = column(masses);
  const auto catto = createStage<VelocityResolver<2>>(
      Spec::parse("catto{warm_start=false,iterations=" + std::to_string(sweeps) + "}"));
  const Unbiased<2> none;
  s.solve(*catto, none);
  double error = 0, above = 0;
  for (std::size_t i = masses.size(); i-- > 0;) {
    above += masses[i];
    error = std::max(error, std::abs(double(s.manifolds[i].points[0].impulse[0]) - above) / above);
  }
  return error;
}

// Heavy (r m) on light (m) on the ground: the error of a sweep is r / (1 + r) of the last one.
TEST(MassRatio, GaussSeidelFactor) {
  for (double r : {1.0, 10.0, 100.0}) {
    const int k = r == 1 ? 8 : 40;
    const double factor = impulseError({1, r}, k + 1) / impulseError({1, r}, k);
    EXPECT_NEAR(factor, r / (1 + r), kDouble ? 1e-6 : 2e-3) << r;
    const double light = impulseError({r, 1}, 4) / impulseError({r, 1}, 3);  // light on heavy
    if (kDouble && r < 50) {
      EXPECT_NEAR(light, 1 / (1 + r), 1e-3) << r;
    }
  }
}

// N equal boxes: the spectral radius of Gauss-Seidel on tridiag(-1, 2, -1) with first diagonal 1.
TEST(Stack, GaussSeidelFactor) {
  const std::pair<int, double> known[] = {
      {2, 0.5}, {5, 0.9045084971874741}, {10, 0.9755282581475777}, {20, 0.9938441702975684}};
  for (const auto& [n, rho] : known) {
    const std::vector<double> masses(static_cast<std::size_t>(n), 1.0);
    const int k = n == 2 ? 8 : 20 * n;
    const double factor = impulseError(masses, k + 1) / impulseError(masses, k);
    if (kDouble || n <= 5) {
      EXPECT_NEAR(factor, rho, kDouble ? 1e-5 : 2e-2) << n;
    }
  }
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
