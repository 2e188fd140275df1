// SPDX-License-Identifier: Zlib
// Every registered solver, and split_solver with each part exchanged, through whole steps without a world.
#include <gtest/gtest.h>

#include "tests/check_property.h"
#include "tests/conformance/scene_change.h"
#include "tests/every_solver.h"
#include "tests/planted_bugs/solver_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace solver_test {

constexpr bool kDouble = sizeof(Real) == 8;

template <int D>
void keepsLinearMomentum(const Step<D>& step, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.friction = true, .restitution = Real(0.3), .gap = Real(0.05), .joints = 1});
  auto after = before;
  for (int i = 0; i < 3; ++i) step(after);
  const Real error = (after.momentum() - before.momentum()).norm();
  require<D>(error <= (kDouble ? Real(1e-9) : Real(5e-3)) * before.speed(), before, after, error);
}

// In 2D only: in 3D an Euler step of a turning body does not conserve it (see FreeTop).
template <int D>
void keepsAngularMomentum(const Step<D>& step, Draw& draw) {
  if (D == 3) return;
  auto before = drawImpact<D>(draw, {.friction = true, .restitution = Real(0.3)});
  before.dt = Real(1e-4);  // arms are those of the start of the step: the error grows with dt
  auto after = before;
  step(after);
  const Real error = (after.angularMomentum() - before.angularMomentum()).norm();
  require<D>(error <= Real(4e-3) * before.speed(), before, after, error);
}

/// Two to four bodies in a row, face on face, that attract each other and turn as one about an axis across the row. The
/// inertias are those of spheres: an Euler step of another body in 3D does not conserve the momentum (see FreeTop).
template <int D>
ImpactScene<D> drawTurningRow(Draw& draw) {
  ImpactScene<D> s;
  const Pose<D> X = drawPose<D>(draw, 2);
  const Vec<D> along = X.q * Vec<D>(Vec<D>::Unit(0)), drift = drawVector<D>(draw);
  Ang<D> spin = draw.real(0.3, 1.5) * Ang<D>::Unit(kAngDim<D> - 1);
  if constexpr (D == 3) spin = X.q * spin;
  const int n = 2 + draw.below(3);
  std::vector<Real> at = {0};
  for (int i = 1; i < n; ++i) at.push_back(at.back() + draw.real(0.5, 1));
  for (const Real x : at) {
    const Vec<D> arm = (x - at.back() / 2) * along;
    s.add(draw.real(1, 5), Ang<D>::Constant(draw.real(0.2, 2)), {X.p + arm, X.q}, {drift + cross(spin, arm), spin});
  }
  const Real friction = draw.real(0, 1);
  for (int i = 0; i + 1 < n; ++i) {
    for (int corner = 0; corner < kManifoldPoints<D>; ++corner) {
      Vec<D> p = Vec<D>::Zero();
      p[0] = (at[static_cast<std::size_t>(i)] + at[static_cast<std::size_t>(i) + 1] - at.back()) / 2;
      p[1] = Real(corner % 2 ? 0.3 : -0.3);
      if constexpr (D == 3) p[2] = Real(corner / 2 ? 0.3 : -0.3);
      corner == 0 ? s.touch(i, i + 1, along, X * p, 0, friction, 0) : s.addPoint(s.manifolds.back(), X * p, 0);
    }
  }
  s.field.pull = draw.real(2, 10) * spin.squaredNorm();  // more than the centrifugal force
  return s;
}

/// Updates the contacts as a generator would: faces turn with their bodies. Penetrating points are reset to touching:
/// position correction is not tested here.
template <int D>
void touchAgain(ImpactScene<D>& s, const ImpactScene<D>& first) {
  for (std::size_t i = 0; i < s.manifolds.size(); ++i) {
    Manifold<D>& m = s.manifolds[i];
    const Pose<D>&a = s.pose(m.bodyA), &b = s.pose(m.bodyB);
    m.normal = a.q * (first.pose(m.bodyA).q.inverse() * first.manifolds[i].normal);
    for (int k = 0; k < m.count; ++k) {
      ContactPoint<D>& c = m.points[static_cast<std::size_t>(k)];
      const Vec<D> middle = (a * c.localA + b * c.localB) / 2;
      c.separation = std::max(separationNow(m, c, a, b), Real(0));
      c.localA = a.inverse() * Vec<D>(middle - c.separation / 2 * m.normal);
      c.localB = b.inverse() * Vec<D>(middle + c.separation / 2 * m.normal);
    }
  }
}

// R2 over a second: contact forces between bodies that turn together act on both along one line.
template <int D>
void turningKeepsAngularMomentum(const Step<D>& step, Draw& draw) {
  const auto before = drawTurningRow<D>(draw);
  Real scale = 0;
  for (int i = 0; i < before.bodies.size(); ++i) {
    scale += before.bodies.mass[static_cast<std::size_t>(i)] * before.pose(i).p.norm() * before.motion(i).v.norm() +
             (before.inertia(i) * before.motion(i).w).norm();
  }
  auto after = before;
  for (int k = 0; k < 60; ++k) {
    step(after);
    touchAgain(after, before);
  }
  const Real error = (after.angularMomentum() - before.angularMomentum()).norm();
  require<D>(error <= 400 * kEps * scale, before, after, error / scale);  // some roundings of each step
}

template <int D>
void fixedBodiesStay(const Step<D>& step, Draw& draw) {
  auto before = drawImpact<D>(draw, {.fixed = true, .friction = true, .gap = Real(0.05), .joints = 1});
  before.field.gravity = Vec<D>::Unit(1) * Real(-9.81);
  auto after = before;
  for (int i = 0; i < 3; ++i) step(after);
  const bool same = after.pose(0).p == before.pose(0).p && after.pose(0).q.matrix() == before.pose(0).q.matrix() &&
                    after.motion(0).v.isZero(0) && after.motion(0).w.isZero(0);
  require<D>(same, before, after, 0);
}

template <int D>
void degenerateIsFinite(const Step<D>& step, Draw& draw) {
  auto before = drawImpact<D>(draw, {.fixed = true, .friction = true, .restitution = 1, .gap = Real(0.3), .joints = 2});
  before.field.gravity = Vec<D>::Unit(1) * Real(-9.81);
  for (Manifold<D>& m : before.manifolds) m.friction = draw.pick({Real(0), Real(1e6)});
  for (std::size_t i = 1; i < before.bodies.pose.size(); ++i) {
    const int what = draw.below(4);
    if (what == 1 || what == 3) before.bodies.invMass[i] = 0, before.bodies.pinned[i] = 1;
    if (what == 2 || what == 3) before.bodies.invInertia[i].setZero(), before.bodies.invInertiaBody[i].setZero();
  }
  if (draw.coin()) {  // two joints instead of one, at the centres of two bodies that coincide
    before.bodies.pose[1].p = before.bodies.pose[0].p;
    for (JointRecord<D>& j : before.joints) {
      j.bodyA = 0, j.bodyB = 1;
      j.X_CaJ.p.setZero(), j.X_CbJ.p.setZero();
    }
  }
  if (draw.coin()) before.dt = draw.pick({Real(1e-6), Real(1)});
  auto after = before;
  for (int i = 0; i < 3; ++i) step(after);
  require<D>(after.finite(), before, after, 0);
}

// A kinematic body follows its velocity through any obstacle.
template <int D>
void kinematicObeys(const Step<D>& step, Draw& draw) {
  auto before = drawImpact<D>(draw, {.fixed = true, .friction = true, .gap = Real(0.05)});
  before.bodies.type[0] = BodyType::kinematic;
  before.bodies.motion[0].v = Vec<D>::Unit(0);
  before.field.gravity = Vec<D>::Unit(1) * Real(-9.81);
  auto after = before;
  for (int i = 0; i < 3; ++i) step(after);
  const Real error = (after.pose(0).p - before.pose(0).p - 3 * before.dt * Vec<D>::Unit(0)).norm();
  require<D>(error <= Real(1e-6), before, after, error);
}

// R3: without forces and restitution a step never adds kinetic energy.
template <int D>
void addsNoEnergy(const Step<D>& step, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.fixed = draw.coin(), .friction = true, .approaching = true});
  auto after = before;
  step(after);
  const Real gain = after.energy() - before.energy();
  require<D>(gain <= (kDouble ? Real(1e-9) : Real(1e-3)) * (1 + before.energy()), before, after, gain);
}

// R4: contacts push, and friction stays in its cone.
template <int D>
void staysInTheCone(const Step<D>& step, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.fixed = draw.coin(), .friction = true, .restitution = draw.real(0, 1)});
  auto after = before;
  step(after);
  for (const Manifold<D>& m : after.manifolds) {
    const auto& impulse = m.points[0].impulse;
    Real sideways = 0;
    for (std::size_t d = 1; d < D; ++d) sideways += impulse[d] * impulse[d];
    const Real excess = std::sqrt(sideways) - m.friction * impulse[0];
    const Real rounding = (kDouble ? Real(1e-9) : Real(1e-3)) * (1 + impulse[0]);
    require<D>(impulse[0] >= 0 && excess <= rounding, before, after, excess);
  }
}

// R18: a contact without restitution stops, and does not bounce.
template <int D>
void inelasticStops(const Step<D>& step, Draw& draw) {
  auto before = drawImpact<D>(draw, {.fixed = draw.coin(), .approaching = true, .contacts = 1});
  before.dt = Real(1e-4);  // arms turn by w dt within the step, which looks like a residual velocity
  auto after = before;
  step(after);
  const Manifold<D>& m = after.manifolds[0];
  const Real v = std::abs(after.contactVelocity(m, m.points[0]).dot(m.normal));
  require<D>(v <= 10 * before.dt * before.speed() * before.speed(), before, after, v);
}

template <int D>
struct Named {
  const char* name;
  void (*property)(const Step<D>&, Draw&);
  Bug bug;
};
template <int D>
std::vector<Named<D>> properties() {
  std::vector<Named<D>> list = {{"Solver.KeepsLinearMomentum", keepsLinearMomentum<D>, Bug::oneBodyOnly},
                                {"Solver.FixedBodiesStay", fixedBodiesStay<D>, Bug::movesFixed},
                                {"Solver.KinematicObeys", kinematicObeys<D>, Bug::movesFixed},
                                {"Solver.AddsNoEnergy", addsNoEnergy<D>, Bug::addsEnergy},
                                {"Solver.StaysInTheCone", staysInTheCone<D>, Bug::frictionUnbounded},
                                {"Solver.InelasticStops", inelasticStops<D>, Bug::addsEnergy},
                                {"Solver.DegenerateIsFinite", degenerateIsFinite<D>, Bug::dividesByNothing}};
  // In f32, rounding over a second exceeds the loss of the methods that declare it.
  if (kDouble) {
    list.push_back({"Solver.TurningKeepsAngularMomentum", turningKeepsAngularMomentum<D>, Bug::twoPoints});
  }
  if (D == 2) list.push_back({"Solver.KeepsAngularMomentum", keepsAngularMomentum<D>, Bug::twoPoints});
  return list;
}

constexpr int kRuns = 25;  // cases of each property, and of each planted bug

template <int D>
void testAll() {
  const auto specs = everySolver<D>();
  ASSERT_GE(specs.size(), 10u);
  for (const std::string& text : specs) {
    const auto solver = createStage<Solver<D>>(Spec::parse(text));
    for (const Named<D>& p : properties<D>()) {
      const std::string name = std::string(p.name) + " " + text + " " + std::to_string(D) + "D";
      SCOPED_TRACE(name);
      const auto run = [&] {
        RapidCheckDraw draw;
        p.property([&](ImpactScene<D>& s) { s.step(*solver); }, draw);
      };
      if (declares<D>(text, p.name)) {
        expectFalsified(name, run, kRuns);
      } else {
        check(name, run, kRuns);
      }
    }
  }
}

template <int D>
void plantedBugs() {
  for (const Named<D>& p : properties<D>()) {
    SCOPED_TRACE(p.name);
    TwinSolver<D> wrong(p.bug, 5);
    expectFalsified(
        std::string(p.name) + " planted bug",
        [&] {
          RapidCheckDraw draw;
          p.property([&](ImpactScene<D>& s) { s.step(wrong); }, draw);
        },
        kRuns);
  }
}

TEST(SolverConformance, EverySolver2) { testAll<2>(); }
TEST(SolverConformance, EverySolver3) { testAll<3>(); }
TEST(SolverConformance, PlantedBugsAreCaught2) { plantedBugs<2>(); }
TEST(SolverConformance, PlantedBugsAreCaught3) { plantedBugs<3>(); }

// A box on the ground, by its corners. It stays at rest, with the impulse m g dt.
template <int D>
ImpactScene<D> restingBox() {
  ImpactScene<D> s;
  s.add(0, Ang<D>::Zero(), {});
  Vec<D> center = Vec<D>::Zero();
  center[1] = Real(0.5);
  s.add(2, Ang<D>::Constant(Real(1) / 3), {center, {}});
  s.field.gravity[1] = Real(-9.81);
  for (int corner = 0; corner < kManifoldPoints<D>; ++corner) {
    Vec<D> p = Vec<D>::Zero();
    p[0] = Real(corner % 2 ? 0.5 : -0.5);
    if constexpr (D == 3) p[2] = Real(corner / 2 ? 0.5 : -0.5);
    if (corner == 0) {
      s.touch(0, 1, Vec<D>::Unit(1), p, 0, Real(0.5), 0);
    } else {
      s.addPoint(s.manifolds[0], p, 0);
    }
  }
  return s;
}

template <int D>
void rests() {
  for (const std::string& text : everySolver<D>()) {
    const auto solver = createStage<Solver<D>>(Spec::parse(text));
    auto s = restingBox<D>();
    for (int i = 0; i < 240; ++i) s.step(*solver);
    // Without accumulation friction differs between corners, and the box trembles; explicit integrators float.
    const bool trembles = text.find("=naive") != text.npos || text.find("=millington") != text.npos;
    EXPECT_NEAR(s.pose(1).p[1], 0.5, 0.02) << text;
    EXPECT_LT(std::abs(s.motion(1).v[0]), trembles ? 0.1 : 1e-3) << text;
    Real impulse = 0;
    for (int k = 0; k < s.manifolds[0].count; ++k)
      impulse += s.manifolds[0].points[static_cast<std::size_t>(k)].impulse[0];
    if (text == "split_solver" || text == "soft_step") {
      EXPECT_NEAR(impulse, 2 * 9.81 / 60, kDouble ? 1e-6 : 1e-3) << text;
    }
  }
}
TEST(SolverConformance, RestingBoxRests2) { rests<2>(); }
TEST(SolverConformance, RestingBoxRests3) { rests<3>(); }

// Two contacts of one sliding body. The first bounces and unloads the second: friction must shrink with the load.
template <int D>
void bouncesKeepTheCone() {
  for (const std::string& text : everySolver<D>()) {
    const auto solver = createStage<Solver<D>>(Spec::parse(text));
    ImpactScene<D> s;
    s.add(0, Ang<D>::Zero(), {});
    const Vec<D> x = Vec<D>::Unit(0), y = Vec<D>::Unit(1);
    s.add(1, Ang<D>::Constant(Real(0.5)), {y / 2, {}}, {8 * x - 4 * y, Ang<D>::Zero()});
    s.field.gravity = Real(-9.81) * y;
    for (const Real side : {Real(0.4), Real(-0.4)}) s.touch(0, 1, y, side * x, 0, Real(0.5), side > 0 ? 1 : Real(0.05));
    s.step(*solver);
    for (const Manifold<D>& m : s.manifolds) {
      const auto& impulse = m.points[0].impulse;
      EXPECT_LE(std::abs(impulse[1]), Real(0.5) * impulse[0] + 100 * kEps) << text << ' ' << D << 'D';
    }
  }
}
TEST(SolverConformance, BouncesKeepTheCone2) { bouncesKeepTheCone<2>(); }
TEST(SolverConformance, BouncesKeepTheCone3) { bouncesKeepTheCone<3>(); }

// Features that are off cost nothing and do nothing.
TEST(SolverConformance, FeaturesAreObeyed) {
  for (const char* text : {"split_solver", "soft_step", "split_solver{velocity=millington}"}) {
    const auto solver = createStage<Solver<3>>(Spec::parse(text));
    auto s = restingBox<3>();
    s.bodies.motion[1] = {Vec<3>(1, 0, 0), Ang<3>(0, 2, 0)};
    s.model.friction = false, s.model.rotation = false;
    for (auto& i : s.bodies.invInertiaBody) i.setZero();
    for (int i = 0; i < 10; ++i) s.step(*solver);
    EXPECT_NEAR(s.motion(1).v[0], 1, 1e-6) << text;
    EXPECT_EQ(s.pose(1).q.matrix(), Rot<3>{}.matrix()) << text;
    auto j = restingBox<3>();
    j.manifolds.clear(), j.active.clear();
    j.join(0, 1, Vec<3>(0, 2, 0), Vec<3>::Zero());
    j.model.joints = false;
    for (int i = 0; i < 10; ++i) j.step(*solver);
    EXPECT_NEAR(j.motion(1).v[1], -9.81 / 6, 1e-4) << text;
  }
}

// A pendulum under every solver: the joint stays together.
template <int D>
void jointsHold() {
  for (const std::string& text : everySolver<D>()) {
    if (text.find("position=none") != std::string::npos || text.find("explicit_euler") == 0) continue;
    const auto solver = createStage<Solver<D>>(Spec::parse(text));
    ImpactScene<D> s;
    s.add(0, Ang<D>::Zero(), {});
    s.add(1, Ang<D>::Constant(Real(0.1)), {Vec<D>::Unit(0), {}});
    s.add(1, Ang<D>::Constant(Real(0.1)), {2 * Vec<D>::Unit(0), {}});
    s.join(0, 1, Vec<D>::Zero(), Vec<D>::Zero());
    s.join(1, 2, Real(1.5) * Vec<D>::Unit(0), Vec<D>::Zero());
    s.field.gravity[1] = Real(-9.81);
    double worst = 0;
    for (int i = 0; i < 300; ++i) {
      s.step(*solver);
      for (const JointRecord<D>& j : s.joints) worst = std::max(worst, s.jointError(j).linear);
    }
    EXPECT_LT(worst, 0.1) << text;
  }
}
TEST(SolverConformance, JointsHold2) { jointsHold<2>(); }
TEST(SolverConformance, JointsHold3) { jointsHold<3>(); }

// Impulses in manifolds are those of a whole step: a shorter step needs proportionally less impulse, and the box does
// not jump.
TEST(SolverConformance, StepsOfAnotherLengthKeepTheForce) {
  for (const char* text : {"split_solver", "soft_step"}) {
    const auto solver = createStage<Solver<2>>(Spec::parse(text));
    auto s = restingBox<2>();
    for (int i = 0; i < 120; ++i) s.step(*solver);
    const Real y = s.pose(1).p[1];
    s.dt /= 4;
    for (int i = 0; i < 20; ++i) {
      s.step(*solver);
      EXPECT_NEAR(s.pose(1).p[1], y, 2e-3) << text << i;
      EXPECT_LT(std::abs(s.motion(1).v[1]), 0.05) << text << i;
    }
  }
}

// Soft contacts sag like springs: more sub-steps do not make them stiffer, more hertz do.
TEST(SoftStep, SagIsThatOfASpring) {
  const auto sag = [](const std::string& text) {
    const auto solver = createStage<Solver<2>>(Spec::parse(text));
    auto s = restingBox<2>();
    s.bodies.mass[0] = 1e6;  // two dynamic bodies, so that the softer constant is used
    s.bodies.invMass[0] = Real(1e-6), s.bodies.type[0] = BodyType::dynamic;
    s.field.gravity.setZero();
    s.add(0, Ang<2>::Zero(), {});
    struct Press final : Forces<2> {
      void eval(const ForceState<2>&, Real, std::span<Wrench<2>> out) const override {
        for (auto& w : out) w = {};
        out[1].force[1] = Real(-2 * 9.81 * 20);
      }
    } press;
    NoDetection detect;
    s.graph.reset(s.bodies, s.manifolds, s.joints, s.work);
    for (int i = 0; i < 240; ++i) {
      solver->step({s.dt, s.lastDt, s.time, s.bodies, s.manifolds, s.active, s.joints, press, detect, s.model,
                    kRestitutionThreshold, s.work, s.profiler, s.graph});
      s.lastDt = s.dt;
    }
    return -separationNow(s.manifolds[0], s.manifolds[0].points[0], s.pose(0), s.pose(1));
  };
  const Real four = sag("soft_step{substeps=4,relax=0}"), sixteen = sag("soft_step{substeps=16,relax=0}");
  EXPECT_GT(four, 1e-4);
  EXPECT_NEAR(sixteen / four, 1, 0.5);
  EXPECT_LT(sag("soft_step{substeps=16,hertz=120,relax=0}"), Real(0.3) * sixteen);
}

}  // namespace solver_test
}}}  // namespace lpc::LPC_PRECISION::test
