// SPDX-License-Identifier: Zlib
// Every registered integrator against closed forms: free fall, an oscillator, a free top. A failure that
// info().failures declares must be observed.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <map>

#include "tests/conformance/impact_scene.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace integrator_test {

constexpr bool kDouble = sizeof(Real) == 8;

// Free motion of a scene without contacts by one integrator, as split_solver drives it.
template <int D>
void fly(ImpactScene<D>& s, Integrator<D>& integrator, int steps) {
  std::vector<Motion<D>> drift(s.bodies.pose.size());
  for (int k = 0; k < steps; ++k) {
    for (std::size_t i = 0; i < drift.size(); ++i) {
      s.bodies.invInertia[i] = rotateInertia(s.bodies.pose[i].q, s.bodies.invInertiaBody[i]);
    }
    integrator.integrate({s.dt, s.time, s.bodies, s.field, s.model, s.work}, drift);
    for (std::size_t i = 0; i < drift.size(); ++i) {
      s.bodies.pose[i].p += s.dt * drift[i].v;
      s.bodies.pose[i].q = integrateRotation(s.bodies.pose[i].q, Ang<D>(s.dt * drift[i].w));
    }
    s.time += s.dt;
  }
  for (std::size_t i = 0; i < drift.size(); ++i) {
    s.bodies.invInertia[i] = rotateInertia(s.bodies.pose[i].q, s.bodies.invInertiaBody[i]);
  }
}

template <int D>
Real fallError(Integrator<D>& integrator, int steps) {  // against -g T^2 / 2 after T = 2 s
  ImpactScene<D> s;
  s.add(3, Ang<D>::Ones(), {});
  s.field.gravity[1] = Real(-9.81);
  s.dt = Real(2) / static_cast<Real>(steps);
  fly(s, integrator, steps);
  EXPECT_NEAR(s.motion(0).v[1], -9.81 * 2, kDouble ? 1e-9 : 1e-2);
  return s.pose(0).p[1] + Real(9.81) * 2;
}

// x'' = -w^2 x, w = 2 pi, from x = 1 at rest, for `periods`. Energy relative to the start.
template <int D>
Real oscillatorEnergy(Integrator<D>& integrator, Real wdt, int periods) {
  const Real w = Real(6.283185307179586);
  ImpactScene<D> s;
  s.add(2, Ang<D>::Ones(), {Vec<D>::Unit(0), {}});
  s.field.spring = w * w;
  s.dt = wdt / w;
  fly(s, integrator, static_cast<int>(static_cast<Real>(periods) / s.dt));
  return (s.motion(0).v.squaredNorm() + w * w * s.pose(0).p.squaredNorm()) / (w * w);
}

template <int D>
Real oscillatorError(Integrator<D>& integrator,
                     int steps) {  // errors cancel over a whole period, so 0.7 of one
  const Real w = Real(6.283185307179586);
  ImpactScene<D> s;
  s.add(2, Ang<D>::Ones(), {Vec<D>::Unit(0), {}});
  s.field.spring = w * w;
  s.dt = Real(0.7) / static_cast<Real>(steps);
  fly(s, integrator, steps);
  const Real x = Real(std::cos(0.7 * double(w))), v = -w * Real(std::sin(0.7 * double(w)));
  return (s.pose(0).p - x * Vec<D>::Unit(0)).norm() + (s.motion(0).v - v * Vec<D>::Unit(0)).norm() / w;
}

// Rotating the inertia into the world frame and back costs about eight roundings of the momentum a step, at worst all
// in one direction.
constexpr Real kTurnRounding = 8 * std::numeric_limits<Real>::epsilon();

// A top with moments 1, 2, 3 that spins about its middle axis, which is unstable (Dzhanibekov).
ImpactScene<3> top(Real dt) {
  ImpactScene<3> s;
  s.add(1, Ang<3>(1, 2, 3), {}, {Vec<3>::Zero(), Ang<3>(Real(0.01), 1, Real(0.01))});
  s.dt = dt;
  return s;
}

// --- properties: each returns whether it holds, so that declared failures and planted bugs can fail ------------------

template <int D>
bool oscillatorBounded(Integrator<D>& integrator) {  // no growth
  return oscillatorEnergy(integrator, Real(0.5), 40) < Real(1.7);
}
template <int D>
bool oscillatorKeepsEnergy(Integrator<D>& integrator) {  // for a thousand periods
  const Real e = oscillatorEnergy(integrator, Real(0.5), 1000);
  return e > Real(0.6) && e < Real(1.7);
}
template <int D>
bool freeTopKeepsAngularMomentum(Integrator<D>&) {
  return true;  // nothing changes the direction of a plane's angular momentum
}
template <>
bool freeTopKeepsAngularMomentum<3>(Integrator<3>& integrator) {
  ImpactScene<3> s = top(Real(0.01));
  const Ang<3> before = s.angularMomentum();
  fly(s, integrator, 4000);
  return (s.angularMomentum() - before).norm() < kTurnRounding * 4000 * before.norm();
}

// A thin rod of moments 0.01, 1, 1 at 100 rad/s, 1.7 rad a step, at an angle to its axis. A method that adds energy
// makes it spin about that axis, up to a hundred times as fast.
double fastRodEnergy(Integrator<3>& integrator) {  // largest energy within a minute, relative to the start
  ImpactScene<3> s;
  s.add(1, Ang<3>(Real(0.01), 1, 1), {}, {Vec<3>::Zero(), Ang<3>(80, 60, 0)});
  s.dt = Real(1) / 60;
  const double start = double(s.energy());
  double most = start;
  for (int i = 0; i < 3600; ++i) {
    fly(s, integrator, 1);
    most = std::max(most, double(s.energy()));
  }
  return most / start;
}
template <int D>
bool freeTopAddsNoEnergy(Integrator<D>&) {
  return true;  // there is no gyroscopic term in a plane
}
template <>
bool freeTopAddsNoEnergy<3>(Integrator<3>& integrator) {
  return fastRodEnergy(integrator) < 1.01;
}

template <int D>
struct Named {
  const char* name;
  bool (*property)(Integrator<D>&);
};
template <int D>
std::vector<Named<D>> properties() {
  std::vector<Named<D>> list = {{"Oscillator.Bounded", oscillatorBounded<D>},
                                {"Oscillator.KeepsEnergy", oscillatorKeepsEnergy<D>}};
  if (D == 3) {
    list.push_back({"FreeTop.KeepsAngularMomentum", freeTopKeepsAngularMomentum<D>});
    list.push_back({"FreeTop.AddsNoEnergy", freeTopAddsNoEnergy<D>});
  }
  return list;
}

template <int D>
void testAll() {
  const auto entries = Registry::instance().list(StageKind::integrator, D);
  ASSERT_GE(entries.size(), 3u);
  for (const Registered* entry : entries) {
    const auto integrator = createStage<Integrator<D>>({entry->info.name, {}});
    for (const Named<D>& p : properties<D>()) {
      bool known = false;
      for (const FailureMode& f : entry->info.failures) known = known || f.test == p.name;
      EXPECT_EQ(p.property(*integrator), !known) << entry->info.name << ' ' << p.name << ' ' << D << "D";
    }
    // Integrators do not move kinematic and static bodies.
    ImpactScene<D> s;
    s.add(0, Ang<D>::Zero(), {}, {Vec<D>::Unit(0), Ang<D>::Ones()});
    s.bodies.type[0] = BodyType::kinematic;
    s.field.gravity = Vec<D>::Ones();
    fly(s, *integrator, 10);
    EXPECT_EQ(s.motion(0).v, Vec<D>::Unit(0)) << entry->info.name;
    EXPECT_NEAR(s.pose(0).p[0], 10 * s.dt, 1e-6) << entry->info.name;
  }
}

// Signed error g T dt / 2 of the Euler methods; RK4 and Verlet have none.
template <int D>
void ballistic() {
  const std::map<std::string, Real> sign = {{"explicit_euler", Real(1)},
                                            {"semi_implicit_euler", Real(-1)},
                                            {"implicit_gyroscopic", Real(-1)},
                                            {"velocity_verlet", Real(0)},
                                            {"rk4", Real(0)}};
  const Real tolerance = kDouble ? Real(1e-10) : Real(5e-3);
  for (const auto& [name, s] : sign) {
    const auto integrator = createStage<Integrator<D>>({name, {}});
    for (int steps : {120, 240}) {
      const Real dt = Real(2) / static_cast<Real>(steps);
      EXPECT_NEAR(fallError(*integrator, steps), s * Real(9.81) * 2 * dt / 2, tolerance) << name << ' ' << steps;
    }
  }
}

// Halving dt divides the error by 2^order.
template <int D>
void order() {
  const std::map<std::string, int> orders = {{"explicit_euler", 1},
                                             {"semi_implicit_euler", 1},
                                             {"implicit_gyroscopic", 1},
                                             {"velocity_verlet", 2},
                                             {"rk4", 4}};
  for (const auto& [name, expected] : orders) {
    const auto integrator = createStage<Integrator<D>>({name, {}});
    const int steps = expected == 4 ? (kDouble ? 100 : 12) : expected == 2 ? 50 : 400;
    const double ratio = double(oscillatorError(*integrator, steps) / oscillatorError(*integrator, 2 * steps));
    EXPECT_NEAR(std::log2(ratio), expected, expected == 4 ? 0.4 : 0.15) << name;
  }
}

TEST(IntegratorConformance, Every2) { testAll<2>(); }
TEST(IntegratorConformance, Every3) { testAll<3>(); }
TEST(IntegratorConformance, Ballistic2) { ballistic<2>(); }
TEST(IntegratorConformance, Ballistic3) { ballistic<3>(); }
TEST(IntegratorConformance, Order2) { order<2>(); }
TEST(IntegratorConformance, Order3) { order<3>(); }

// Both are stable up to w dt = 2. Semi-implicit Euler conserves v^2 + w^2 x^2 - w^2 dt x v exactly; Verlet conserves
// v^2 + w^2 x^2 (1 - (w dt / 2)^2).
TEST(IntegratorConformance, SymplecticLimitsAndInvariants) {
  for (const char* name : {"semi_implicit_euler", "velocity_verlet"}) {
    SCOPED_TRACE(name);
    const bool verlet = name == std::string("velocity_verlet");
    const auto integrator = createStage<Integrator<2>>({name, {}});
    EXPECT_LT(oscillatorEnergy(*integrator, Real(1.99), 100), 500);
    EXPECT_GT(oscillatorEnergy(*integrator, Real(2.01), 100), 500);
    const Real w = Real(6.283185307179586);
    ImpactScene<2> s;
    s.add(2, Ang<2>::Ones(), {Vec<2>::Unit(0), {}});
    s.field.spring = w * w, s.dt = Real(0.05);
    const Real start = verlet ? 1 - (w * s.dt / 2) * (w * s.dt / 2) : Real(1);
    for (int i = 0; i < 200; ++i) {
      fly(s, *integrator, 1);
      const Real x = s.pose(0).p[0], v = s.motion(0).v[0];
      const Real kept =
          verlet ? v * v / (w * w) + start * x * x : (v * v + w * w * x * x - w * w * s.dt * x * v) / (w * w);
      ASSERT_NEAR(kept, start, kDouble ? 1e-12 : 1e-3) << i;
    }
  }
}

// The amplitude of explicit Euler grows by sqrt(1 + (w dt)^2) a step: 1.2177 per second at dt = 0.01, w = 2 pi.
TEST(IntegratorConformance, ExplicitGrowth) {
  const auto integrator = createStage<Integrator<2>>({"explicit_euler", {}});
  const Real energy = oscillatorEnergy(*integrator, Real(0.06283185307179586), 1);
  EXPECT_NEAR(std::sqrt(double(energy)), 1.2177482712932757, kDouble ? 2e-3 : 5e-3);
}

// The middle component returns after 4 K(m) / r = 39.1057341973 s, two flips a period.
TEST(IntegratorConformance, DzhanibekovPeriod) {
  const auto rk4 = createStage<Integrator<3>>({"rk4", {}});
  ImpactScene<3> s = top(Real(39.10573419728772) / 4000);
  const Real energy = s.energy();
  fly(s, *rk4, 2000);
  const Vec<3> half = s.pose(0).q.inverse() * s.motion(0).w;
  EXPECT_NEAR(half[1], -1, 1e-3);
  fly(s, *rk4, 2000);
  const Vec<3> w = s.pose(0).q.inverse() * s.motion(0).w;
  const double tolerance = kDouble ? 1e-7 : 1e-2;
  EXPECT_NEAR(w[0], 0.01, tolerance);
  EXPECT_NEAR(w[1], 1, tolerance);
  EXPECT_NEAR(w[2], 0.01, tolerance);
  EXPECT_NEAR(s.energy(), energy, std::max(1e-8, double(kTurnRounding) * 4000 * double(energy)));
}

// Also in rotations, and for a tumbling top.
TEST(IntegratorConformance, VerletIsOfOrderTwoInTurns) {
  const auto integrator = createStage<Integrator<3>>({"velocity_verlet", {}});
  const auto rk4 = createStage<Integrator<3>>({"rk4", {}});
  const auto after = [](Integrator<3>& method, int steps) {
    ImpactScene<3> s = top(Real(4) / static_cast<Real>(steps));
    s.bodies.motion[0].w = Ang<3>(1, Real(0.7), Real(-0.4));
    fly(s, method, steps);
    return s;
  };
  const ImpactScene<3> exact = after(*rk4, kDouble ? 4000 : 200);
  const auto error = [&](int steps) {
    const ImpactScene<3> s = after(*integrator, steps);
    return double((s.pose(0).q.matrix() - exact.pose(0).q.matrix()).norm() +
                  (s.motion(0).w - exact.motion(0).w).norm());
  };
  EXPECT_NEAR(std::log2(error(25) / error(50)), 2, 0.15);
}

// Backward Euler loses energy and angular momentum in proportion to the step.
TEST(IntegratorConformance, ImplicitGyroscopicOnlyLoses) {
  for (const int iterations : {1, 20}) {
    SCOPED_TRACE(iterations);
    const auto integrator =
        createStage<Integrator<3>>(Spec::parse("implicit_gyroscopic{iterations=" + std::to_string(iterations) + "}"));
    double lost[2] = {0, 0};
    for (int k = 0; k < 2; ++k) {
      ImpactScene<3> s = top(Real(0.02) / static_cast<Real>(k + 1));
      double energy = double(s.energy());
      const double start = energy;
      for (int i = 0; i < 1000 * (k + 1); ++i) {
        fly(s, *integrator, 1);
        // Twice the rounding of the momentum, up or down.
        ASSERT_LE(double(s.energy()), energy * (1 + 4 * double(kTurnRounding))) << i;
        energy = double(s.energy());
      }
      lost[k] = start - energy;
    }
    EXPECT_NEAR(lost[1] / lost[0], 0.5, 0.02);
    EXPECT_GT(lost[0], 0.01);
  }
}

// Planted bug: a thousandth too much force, a hundredth too much displacement, and some spin without cause.
template <int D>
class Generous final : public Integrator<D> {
 public:
  void integrate(const IntegrateInput<D>& in, std::span<Motion<D>> drift) override {
    std::vector<Wrench<D>> wrenches(drift.size());
    in.forces.eval({in.bodies, in.bodies.pose, in.bodies.motion}, in.time, wrenches);
    for (std::size_t i = 0; i < drift.size(); ++i) {
      in.bodies.motion[i].v += Real(1.001) * in.dt * in.bodies.invMass[i] * wrenches[i].force;
      in.bodies.motion[i].w *= Real(1.0001);
      drift[i] = in.bodies.motion[i];
      drift[i].v *= Real(1.01);
    }
  }
};

TEST(IntegratorConformance, PlantedBugIsCaught) {
  Generous<3> wrong;
  ImpactScene<3> s;
  s.add(3, Ang<3>::Ones(), {});
  s.field.gravity[1] = Real(-9.81), s.dt = Real(2) / 120;
  fly(s, wrong, 120);
  EXPECT_GT(std::abs(s.motion(0).v[1] + Real(9.81) * 2), Real(1e-2));
  EXPECT_FALSE(oscillatorBounded<3>(wrong) && oscillatorKeepsEnergy<3>(wrong) && freeTopKeepsAngularMomentum<3>(wrong));
  EXPECT_FALSE(freeTopKeepsAngularMomentum<3>(wrong));
}

}  // namespace integrator_test
}}}  // namespace lpc::LPC_PRECISION::test
