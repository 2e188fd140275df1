// SPDX-License-Identifier: Zlib
// Free motion: falling, springs, the tennis racket; conserved quantities, scaling, and what a single step can miss.
#include <array>
#include <memory>

#include "framework/world/invariants.h"
#include "tests/known_answers/known_answer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace integrator_test { namespace {

TEST(AnswerTable, HoldsFromBothSides) {
  const AnswerBound bound{0.01, 0.02};
  EXPECT_EQ(fault(&bound, 0.015), "");
  EXPECT_NE(fault(&bound, 0.021), "");
  EXPECT_NE(fault(&bound, 0.009), "");
  EXPECT_NE(fault(&bound, -0.015), "");
  EXPECT_NE(fault(&bound, std::nan("")), "");
  EXPECT_NE(fault(nullptr, 0), "") << "a figure without a row";
}

// TearDown requires every row of each tested answer; this test requires a test for each answer.
TEST(AnswerTable, HasATestForEachAnswer) {
  std::set<std::string> tests;
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  for (int i = 0; i < all.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *all.GetTestSuite(i);
    for (int k = 0; k < suite.total_test_count(); ++k) tests.insert(suite.GetTestInfo(k)->name());
  }
  EXPECT_GT(answerTable().size(), 100u);
  for (const auto& [key, bound] : answerTable()) EXPECT_TRUE(tests.contains(std::get<0>(key))) << std::get<0>(key);
}

const char* const kIntegrators[] = {"semi_implicit_euler", "explicit_euler", "rk4", "velocity_verlet"};
std::string splitWith(const std::string& integrator) { return "split_solver{integrator=" + integrator + "}"; }

// Fall of 2 s from rest: semi-implicit Euler is g T dt / 2 too low, explicit Euler too high, RK4 and Verlet are exact.
TEST_F(KnownAnswer, ballistic_integrators) {
  const double error[] = {-1, 1, 0, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    World<3> world = worldOf<3>(splitWith(kIntegrators[i]));
    const BodyHandle b = world.add(body<3>(Shape<3>::sphere(1), {0, 0, 0}));
    for (int k = 0; k < 120; ++k) world.step(Real(1) / 60);
    known("height, m", kIntegrators[i], -19.62 + error[i] * kG * 2 / 120, double(world.pose(b).p[1]));
  }
}

// A mass on a spring of 1 Hz with a long rest length, extended by x.
struct Oscillator {
  World<2> world;
  BodyHandle body;
  Oscillator(const std::string& solver, double x, double zeta)
      : world(Pipeline::parse("solver=" + solver), floating()) {
    body = world.add(test::body<2>(Shape<2>::sphere(Real(0.1)), at<2>(10 + x, 0)));
    const double w = 2 * kPi, m = double(world.mass(body));
    world.add(ForceDef<2>{.kind = springKind(w * w * m, 10, 2 * zeta * w * m), .bodyB = body});
  }
  static WorldSettings<2> floating() {
    WorldSettings<2> s;
    s.gravity.setZero();
    return s;
  }
  double x() const { return double(world.pose(body).p[0]) - 10; }
  double v() const { return double(world.motion(body).v[0]); }
};

// Semi-implicit Euler and Verlet are stable up to w dt = 2, the former with period pi dt / asin(w dt / 2). Explicit
// Euler grows by sqrt(1 + (w dt)^2) a step.
TEST_F(KnownAnswer, spring_stability) {
  const double w = 2 * kPi;
  for (const char* integrator : {"semi_implicit_euler", "velocity_verlet"}) {
    double stable = 1.9, blows = 2.1;
    while (blows - stable > 1e-4) {
      const double factor = (stable + blows) / 2;
      Oscillator o(splitWith(integrator), 0.01, 0);
      double far = 0;
      for (int i = 0; i < 4000 && far < 5; ++i) o.world.step(Real(factor / w)), far = std::max(far, std::abs(o.x()));
      (far < 5 ? stable : blows) = factor;
    }
    known("limit of w dt", integrator, 2, (stable + blows) / 2);
  }
  for (double dt : {0.01, 0.05, 0.1}) {
    Oscillator o("split_solver", 0.1, 0);
    double previous = o.x(), first = 0, last = 0;
    int crossings = 0;
    for (int i = 0; i * dt < 50; ++i) {
      o.world.step(Real(dt));
      if (previous > 0 && o.x() <= 0) {
        last = (i + 1) * dt - dt * o.x() / (o.x() - previous);
        if (crossings++ == 0) first = last;
      }
      previous = o.x();
    }
    known("dt = " + std::to_string(dt).substr(0, 4) + ": period, s", "semi_implicit_euler",
          kPi * dt / std::asin(w * dt / 2), (last - first) / (crossings - 1));
  }
  Oscillator kept("split_solver", 0.1, 0);  // w dt = 0.63; v is updated before x
  const auto size2 = [&] {
    return kept.v() * kept.v() + w * w * kept.x() * kept.x() - w * w * 0.1 * kept.x() * kept.v();
  };
  const double size2Before = size2();
  for (int i = 0; i < 100; ++i) kept.world.step(Real(0.1));
  known("dt = 0.10: v^2 + w^2 x^2 - w^2 dt x v, after over before", "semi_implicit_euler", 1, size2() / size2Before);
  Oscillator o("split_solver{integrator=explicit_euler}", 0.1, 0);
  const auto size = [&] { return std::hypot(o.v(), w * o.x()); };
  const double from = size();
  for (int i = 0; i < 100; ++i) o.world.step(Real(0.01));
  known("dt = 0.01: growth in 1 s", "explicit_euler", std::pow(1 + 0.01 * w * 0.01 * w, 50), size() / from);
}

// x = e^(-z w t) (cos wd t + z w / wd sin wd t) at t = 1 s, z = 0.1, dt = 1 ms.
TEST_F(KnownAnswer, spring_damped) {
  for (const char* integrator : kIntegrators) {
    Oscillator o(splitWith(integrator), 1, 0.1);
    for (int i = 0; i < 1000; ++i) o.world.step(Real(0.001));
    known("x, m", integrator, 0.5315351237271717, o.x());
  }
}

// Spun about the middle axis, a body flips twice in 4 K(m) / r. A body with inertia 1 : 2 : 3 would be flat, so it is
// 1.0004 : 2.0004 : 3 - 0.0004 or so, as computed by the world.
TEST_F(KnownAnswer, dzhanibekov) {
  for (const char* integrator : {"rk4", "velocity_verlet", "implicit_gyroscopic"}) {
    World<3> world = worldOf<3>(splitWith(integrator), {0, 0, 0});
    // I = m (b^2 + c^2) / 12 and so on, extents squared.
    const double a2 = 2, b2 = 1, c2 = 4e-4, mass = 12;
    BodyDef<3> def =
        body<3>(Shape<3>::box({Real(std::sqrt(a2) / 2), Real(std::sqrt(b2) / 2), Real(std::sqrt(c2) / 2)}), {0, 0, 0});
    def.shapes[0].density = Real(mass / std::sqrt(a2 * b2 * c2));
    def.angularVelocity = {Real(0.01), 1, Real(0.01)};
    const BodyHandle h = world.add(def);
    const double i1 = b2 + c2, i2 = a2 + c2, i3 = a2 + b2, e = (i1 * 1e-4 + i2 + i3 * 1e-4) / 2;
    const double l2 = i1 * i1 * 1e-4 + i2 * i2 + i3 * i3 * 1e-4;
    ASSERT_GT(l2, 2 * e * i2);
    const double r = std::sqrt((i3 - i2) * (l2 - 2 * e * i1) / (i1 * i2 * i3));
    const double m = (i2 - i1) * (2 * e * i3 - l2) / ((i3 - i2) * (l2 - 2 * e * i1)), period = 4 * ellipticK(m) / r;
    const Real dt = Real(1) / 200;
    const auto spin = [&] { return Ang<3>(world.pose(h).q.inverse() * Vec<3>(world.motion(h).w)); };
    // The time of the next flip to the same side.
    const auto flip = [&](double until) {
      for (double previous = double(spin()[1]); world.time() < until;) {
        world.step(dt);
        const double w = double(spin()[1]);
        if (previous > 0 && w <= 0) return double(world.time()) - double(dt) * w / (w - previous);
        previous = w;
      }
      return 0.0;
    };
    const auto tell = [&](const std::string& when) {
      const Ang<3> w = spin();
      const double x = i1 * double(w[0]), y = i2 * double(w[1]), z = i3 * double(w[2]);
      known("energy after over before" + when, integrator, 1, (x * x / i1 + y * y / i2 + z * z / i3) / 2 / e);
      known("L after over before" + when, integrator, 1, std::sqrt((x * x + y * y + z * z) / l2));
    };
    const double first = flip(100);
    known("period, s", integrator, period, flip(100) - first);
    tell("");
    if (!kDouble) continue;  // later flips depend on the rounding error
    double last = 0;
    for (int i = 1; i < 10; ++i) last = flip(1000);
    known("mean period of 20 flips, s", integrator, period, (last - first) / 10);
    tell(", 20 flips");
  }
}

// A thin rod of 100 rad/s, 1.7 rad a step, at an angle to its axis, for a second. Without the gyroscopic term it keeps
// its energy and the size of its angular momentum, but not the direction. Backward Euler loses both.
TEST_F(KnownAnswer, fast_rod) {
  for (const char* integrator : {"semi_implicit_euler", "implicit_gyroscopic"}) {
    World<3> world = worldOf<3>(splitWith(integrator), {0, 0, 0});
    BodyDef<3> def = body<3>(Shape<3>::box({Real(0.5), Real(0.05), Real(0.05)}), {0, 0, 0});
    def.angularVelocity = {80, 60, 0};
    world.add(def);
    const StateInvariants<3> from = stateInvariants<3>(world);
    double most = from.kinetic;
    for (int i = 0; i < 60; ++i) {
      world.step(Real(1) / 60);
      most = std::max(most, stateInvariants<3>(world).kinetic);
    }
    const StateInvariants<3> now = stateInvariants<3>(world);
    known("most energy over that at the start", integrator, 1, most / from.kinetic);
    known("energy after over before", integrator, 1, now.kinetic / from.kinetic);
    known("L after over before", integrator, 1, now.angularMomentum.norm() / from.angularMomentum.norm());
  }
}

// A ball of radius 0.05 flies at a wall 0.02 thick: a step of v dt > w + 2 r may miss it. For a share 1 - (w + 2 r) /
// (v dt) of start phases no step touches the wall.
TEST_F(KnownAnswer, tunnelling_threshold) {
  const double r = 0.05, w = 0.02, dt = 1.0 / 60, threshold = (w + 2 * r) / dt;
  for (double factor : {0.9, 1.1, 2.0, 10.0}) {
    const double v = factor * threshold;
    const int phases = 500;
    int missed = 0;
    for (int i = 0; i < phases; ++i) {
      WorldSettings<2> settings;
      settings.gravity.setZero(), settings.margin = 0;
      World<2> world(Pipeline{}, settings);
      world.add(body<2>(Shape<2>::box({Real(w / 2), 5}), {0, 0}, BodyType::fixed));
      BodyDef<2> ball = body<2>(Shape<2>::sphere(Real(r)), at<2>(-2 - v * dt * (i + 0.5) / phases, 0));
      ball.velocity = at<2>(v, 0);
      world.add(ball);
      bool touched = false;
      for (int k = 0; k < static_cast<int>(4.5 / (v * dt)) + 2 && !touched; ++k) {
        world.step(Real(dt));
        touched = !world.manifolds().empty();
      }
      missed += !touched;
    }
    const std::string share = "v = " + std::to_string(factor).substr(0, 4) + " w + 2r a step: share that misses";
    known(share, "discrete steps", std::max(0.0, 1 - 1 / factor), static_cast<double>(missed) / phases);
  }
}

// A row of dominoes is knocked over; then again with all lengths x 4 and all times x 2: the wave is twice as fast.
double dominoSpeed(const std::string& solver, double scale) {
  WorldSettings<2> settings;
  settings.margin = Real(double(kContactMargin) * scale);
  World<2> world(Pipeline::parse("solver=" + solver), settings);
  world.add(body<2>(Shape<2>::box(at<2>(100, 1)), {0, -1}, BodyType::fixed));
  const int n = 24;
  std::vector<BodyHandle> row;
  for (int i = 0; i < n; ++i) {
    row.push_back(
        world.add(body<2>(Shape<2>::box(at<2>(0.1 * scale, 0.5 * scale)), at<2>(0.6 * i * scale, 0.5 * scale))));
  }
  world.setMotion(row[0], {at<2>(0.5 * std::sqrt(scale), 0), Ang<2>(Real(-1.5 / std::sqrt(scale)))});
  const Real dt = static_cast<Real>(std::sqrt(scale) / 480);
  double times[2] = {0, 0};
  const int marks[2] = {10, 20};
  for (int found = 0; found < 2 && world.stepCount() < 10000;) {
    world.step(dt);
    if (double(world.pose(row[static_cast<std::size_t>(marks[found])]).q.radians()) < -0.1)
      times[found++] = double(world.time());
  }
  return 10 * 0.6 * scale / (times[1] - times[0]);
}
TEST_F(KnownAnswer, domino_froude) {
  for (const char* solver : {"split_solver", "soft_step"}) {
    known("speed ratio at 4 times the size", solver, 2, dominoSpeed(solver, 4) / dominoSpeed(solver, 1));
  }
}

// Lengths x s, times x sqrt(s): the same fall, scaled. Differences come from lengths and speeds that are not scaled:
// slop, thresholds.
std::vector<Vec<2>> fall(const std::string& solver, double s) {
  WorldSettings<2> settings;
  settings.margin = Real(double(kContactMargin) * s);
  settings.restitutionThreshold = Real(double(kRestitutionThreshold) * std::sqrt(s));
  World<2> world(Pipeline::parse("solver=" + solver), settings);
  world.add(body<2>(Shape<2>::box(at<2>(20 * s, s)), at<2>(0, -s), BodyType::fixed));
  BodyDef<2> box = body<2>(Shape<2>::box(at<2>(0.5 * s, 0.3 * s)), at<2>(0, 2 * s));
  box.X_WB.q = Rot<2>::angle(0.3);
  box.shapes[0].restitution = Real(0.3);
  const BodyHandle h = world.add(box);
  std::vector<Vec<2>> path;
  for (int i = 0; i < 300; ++i) {
    world.step(static_cast<Real>(std::sqrt(s) / 60));
    path.push_back(world.pose(h).p / Real(s));
  }
  return path;
}
TEST_F(KnownAnswer, scale_similarity) {
  for (const char* solver : {"split_solver", "split_solver{position=none}", "soft_step"}) {
    for (const auto& [s, name] : {std::pair(0.01, "1/100"), std::pair(100.0, "100")}) {
      const std::vector<Vec<2>> one = fall(solver, 1), scaled = fall(solver, s);
      double apart = 0;
      for (std::size_t i = 0; i < one.size(); ++i) apart = std::max(apart, double((scaled[i] - one[i]).norm()));
      known("height after 1 s at size " + std::string(name), solver, double(one[59][1]), double(scaled[59][1]));
      known("farthest in 5 s from the fall at size 1, at size " + std::string(name), solver, 0, apart);
    }
  }
}

// Two bodies on a damped spring, one of them pivoted to a third, without external forces: momenta are conserved.
template <int D>
void momenta() {
  for (const char* solver :
       {"split_solver", "split_solver{integrator=rk4}", "split_solver{velocity=millington}", "soft_step"}) {
    World<D> world = worldOf<D>(solver, Vec<D>::Zero());
    BodyDef<D> def = body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.3))), at<D>(0, 0));
    def.velocity = at<D>(1, 0.5, -0.2), def.angularVelocity = Ang<D>::Constant(Real(0.4));
    const BodyHandle a = world.add(def);
    def.X_WB.p = at<D>(2, 0.3), def.velocity = at<D>(-1, 0.2, 0.3), def.shapes[0].density = 2;
    const BodyHandle b = world.add(def);
    def.X_WB.p = at<D>(2, 1.3), def.velocity = at<D>(0, 0);
    world.add(pivot<D>(b, world.add(def), at<D>(2, 0.8)));
    world.add(ForceDef<D>{.kind = springKind(20, 1.5, 0.2),
                          .bodyA = a,
                          .bodyB = b,
                          .anchorA = at<D>(0.1, 0.2),
                          .anchorB = at<D>(-0.2, 0.1)});
    const Invariants<D> from = invariants(world);
    double p = 0, l = 0;
    for (int i = 0; i < 600; ++i) {
      world.step(Real(1) / 240);
      const Invariants<D> now = invariants(world);
      p = std::max(p, (now.momentum - from.momentum).norm() / from.momentum.norm());
      l = std::max(l, (now.angularMomentum - from.angularMomentum).norm() / from.angularMomentum.norm());
    }
    known(in<D>("change of p over p"), solver, 0, p);
    known(in<D>("change of L over L"), solver, 0, l);
  }
}
TEST_F(KnownAnswer, two_body_spring_momentum) { momenta<2>(), momenta<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::integrator_test
