// SPDX-License-Identifier: Zlib
// Every registered kind of joint, with the parameters that change its behaviour, under every solver and resolver.
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "tests/check_property.h"
#include "tests/conformance/joined_bodies.h"
#include "tests/expect_caught.h"
#include "tests/planted_bugs/joint_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace joint_test {

constexpr Real kTolerance = sizeof(Real) == 8 ? Real(1e-10) : Real(5e-4);  // of one solve, relative to the speeds in it
constexpr Real kConverged = sizeof(Real) == 8 ? Real(1e-6) : Real(2e-3);
constexpr int kRuns = 15;  // cases of each property, and of each planted bug

/// Input of a property: the kind under test, the resolvers, and the correct kind.
template <int D>
struct Subject {
  Kind<D> kind;
  VelocityResolver<D>*normal, *patient;
  Kind<D> law;

  /// The rows of the correct kind.
  JointRows<D> owed(const ImpactScene<D>& s) const {
    JointRecord<D> joint = s.joints[0];
    joint.kind = law;
    return s.rows(joint);
  }
};

// R1, R2: impulses act on both bodies, whatever the rows. A gear's torques are not equal: the world takes the
// difference.
template <int D>
void keepsMomenta(const Subject<D>& on, Draw& draw) {
  auto before = drawJointed(draw, on.kind);
  const auto after = solved(before, *on.normal);
  const Real linear = (after.momentum() - before.momentum()).norm();
  const Real angular = (after.angularMomentum() - before.angularMomentum()).norm();
  const Real change = balanced(on.owed(before)) ? std::max(linear, angular) : linear;
  require<D>(change <= kTolerance * 50 * before.speed(), before, after, change);
}

// R3: a joint without a motor adds no energy.
template <int D>
void addsNoEnergy(const Subject<D>& on, Draw& draw) {
  const auto before = drawJointed(draw, on.kind, draw.coin());
  if (!passive(on.law)) return;
  const auto after = solved(before, *on.normal);
  const Real gain = after.energy() - before.energy();
  require<D>(gain <= kTolerance * 50 * (before.energy() + 1), before, after, gain);
}

// R4: a stop only pushes, and a motor keeps its limit.
template <int D>
void keepsItsLimits(const Subject<D>& on, Draw& draw) {
  auto before = drawJointed(draw, on.kind, draw.coin());
  nudge(before, draw, Real(0.3));
  const auto after = solved(before, *on.normal);
  const JointRows<D> wanted = on.owed(before);
  for (int i = 0; i < wanted.count; ++i) {
    const ConstraintRow<D>& row = wanted.row[static_cast<std::size_t>(i)];
    const Real impulse = after.joints[0].impulse[static_cast<std::size_t>(i)];
    const Real slack = kTolerance * 10;
    require<D>(impulse >= row.lo * before.dt - slack && impulse <= row.hi * before.dt + slack, before, after, impulse);
  }
}

// R5, R18: the velocity along a rigid row is zero.
template <int D>
void stopsDrifting(const Subject<D>& on, Draw& draw) {
  const auto before = drawJointed(draw, on.kind, draw.coin());
  auto after = solved(before, *on.patient);
  after.joints[0].kind = on.law;
  const Real v = after.jointVelocity(after.joints[0]);
  require<D>(v <= kConverged * 100 * before.speed(), before, after, v);
}

// R6: a second solve changes nothing.
template <int D>
void secondSolveChangesNothing(const Subject<D>& on, Draw& draw) {
  const auto before = drawJointed(draw, on.kind, draw.coin());
  if (!rigid(on.law)) return;
  auto once = solved(before, *on.patient);
  once.joints[0].impulse.fill(0);
  const auto twice = solved(once, *on.patient);
  const Real change = difference(once, twice);
  require<D>(change <= kConverged * 10 * before.speed(), once, twice, change);
}

// R7: in a moved, turned and translating frame the motion is the same.
template <int D>
void turnsWithTheFrame(const Subject<D>& on, Draw& draw) {
  const auto before = drawJointed(draw, on.kind);
  const Pose<D> X{drawVector<D>(draw), drawRotation<D>(draw)};
  const Vec<D> boost = drawVector<D>(draw);
  auto other = moved(before, X, boost);
  beginAnew(other);
  const auto here = solved(before, *on.patient), there = solved(other, *on.patient);
  Real error = 0;
  for (int i = 0; i < 2; ++i) error = std::max(error, (X.q * (here.motion(i).v + boost) - there.motion(i).v).norm());
  require<D>(error <= kConverged * 20 * before.speed(), before, there, error);
}

// R13: the world acts as a static body.
template <int D>
void worldIsAFixedBody(const Subject<D>& on, Draw& draw) {
  auto body = drawJointed(draw, on.kind, true);
  body.joints[0].X_CaJ = body.pose(0) * body.joints[0].X_CaJ;
  body.bodies.pose[0] = {};
  auto world = body;
  world.joints[0].bodyA = -1;
  const auto a = solved(body, *on.normal), b = solved(world, *on.normal);
  require<D>(a.motion(0).v.isZero(0) && a.motion(0).w.isZero(0), body, a, 0);
  require<D>(a.motion(1).v == b.motion(1).v && a.motion(1).w == b.motion(1).w, a, b, 0);
}

// R19: bodies that cannot move or turn, two joints in one place, both ends in one point, both at the centres of mass.
template <int D>
void degenerateIsFinite(const Subject<D>& on, Draw& draw) {
  auto before = drawJointed(draw, on.kind, draw.coin());
  for (std::size_t i = 0; i < 2; ++i) {
    const int what = draw.below(5);
    if (what == 1 || what == 3) before.bodies.invMass[i] = 0;
    if (what == 2 || what == 3) before.bodies.invInertia[i].setZero();
    if (what == 4) before.bodies.invMass[i] *= Real(1e6);
  }
  if (draw.coin()) {
    before.bodies.pose[1] = before.bodies.pose[0];
    before.joints[0].X_CaJ.p.setZero(), before.joints[0].X_CbJ.p.setZero();
  }
  before.joints.push_back(before.joints[0]);
  if (draw.coin()) nudge(before, draw, 3);
  const auto after = solved(before, *on.patient);
  require<D>(after.finite(), before, after, 0);
}

template <int D>
struct Named {
  const char* name;
  std::function<void(const Subject<D>&, Draw&)> property;
  JointBug bug;    // that the property must catch ...
  const char* of;  // ... in this kind
};

template <int D>
std::vector<Named<D>> properties() {
  const char* limited = "hinge{lower=-0.1,upper=0.2}";
  return {{"Joint.KeepsMomenta", keepsMomenta<D>, JointBug::oneBody, "weld"},
          {"Joint.AddsNoEnergy", addsNoEnergy<D>, JointBug::drives, "weld"},
          {"Joint.KeepsItsLimits", keepsItsLimits<D>, JointBug::pulls, limited},
          {"Joint.KeepsItsLimits", keepsItsLimits<D>, JointBug::endless, "hinge{motor_speed=2,motor_torque=3}"},
          {"Joint.KeepsItsLimits", keepsItsLimits<D>, JointBug::endless, "mouse{max_force=30}"},
          {"Joint.StopsDrifting", stopsDrifting<D>, JointBug::yields, "pivot"},
          {"Joint.SecondSolveChangesNothing", secondSolveChangesNothing<D>, JointBug::yields, "weld"},
          {"Joint.TurnsWithTheFrame", turnsWithTheFrame<D>, JointBug::ownAxes, "distance"},
          {"Joint.WorldIsAFixedBody", worldIsAFixedBody<D>, JointBug::noArm, "pivot"},
          {"Joint.DegenerateIsFinite", degenerateIsFinite<D>, JointBug::dividesByNothing, limited}};
}

template <int D>
std::unique_ptr<VelocityResolver<D>> patientOf(const Registered& entry) {
  return createStage<VelocityResolver<D>>(withIterations(entry, 3000, 3000));
}

template <int D>
void testAll() {
  for (const Registered* entry : Registry::instance().list(StageKind::velocity, D)) {
    if (!competes(*entry)) continue;
    const auto normal = createStage<VelocityResolver<D>>({entry->info.name, {}});
    const auto patient = patientOf<D>(*entry);
    for (const std::string& spec : everyKind<D>()) {
      const Subject<D> on{kindOf<D>(spec), normal.get(), patient.get(), kindOf<D>(spec)};
      for (const Named<D>& p : properties<D>()) {
        const std::string name =
            std::string(p.name) + " " + spec + " " + entry->info.name + " " + std::to_string(D) + "D";
        SCOPED_TRACE(name);
        const auto run = [&] {
          RapidCheckDraw draw;
          p.property(on, draw);
        };
        // A failure that a resolver declares must be observed with a pivot.
        const bool known = declares(*entry, {entry->info.name, {}}, p.name);
        if (!known) {
          check(name, run, kRuns);
        } else if (spec == "pivot") {
          expectFalsified(name, run, kRuns);
        }
      }
    }
  }
}

template <int D>
void plantedBugs() {
  const auto normal = createStage<VelocityResolver<D>>(Spec{"catto", {}});
  const auto patient = patientOf<D>(Registry::instance().find(StageKind::velocity, D, "catto"));
  for (const Named<D>& p : properties<D>()) {
    const Kind<D> wrong = std::make_shared<WrongJoint<D>>(kindOf<D>(p.of), p.bug);
    const Subject<D> on{wrong, normal.get(), patient.get(), kindOf<D>(p.of)};
    expectFalsified(
        std::string(p.name) + " planted bug",
        [&] {
          RapidCheckDraw draw;
          p.property(on, draw);
        },
        kRuns);
  }
}

TEST(JointConformance, EveryKind2) { testAll<2>(); }
TEST(JointConformance, EveryKind3) { testAll<3>(); }
TEST(JointConformance, PlantedBugsAreCaught2) { plantedBugs<2>(); }
TEST(JointConformance, PlantedBugsAreCaught3) { plantedBugs<3>(); }

/// A flywheel hinged to the world: moment of inertia 2, about z, its centre of mass on the axis.
template <int D>
struct Flywheel {
  ImpactScene<D> scene;
  std::unique_ptr<Solver<D>> solver;

  Flywheel(const Kind<D>& kind, const std::string& text, Real speed)
      : solver(createStage<Solver<D>>(Spec::parse(text))) {
    Motion<D> motion;
    motion.w[kAngDim<D> - 1] = speed;
    scene.add(3, Ang<D>::Constant(2), {}, motion);
    JointRecord<D> j;
    j.kind = kind, j.bodyB = 0;
    kind->begin(j, {}, {});
    scene.joints.push_back(j);
  }
  Real speed() const { return scene.motion(0).w[kAngDim<D> - 1]; }
  Real angle() const { return scene.joints[0].state[0]; }
  void step(int n = 1) {
    for (int i = 0; i < n; ++i) {
      scene.step(*solver);
      JointRecord<D>& j = scene.joints[0];
      j.kind->finish(j, {}, scene.pose(0));
    }
  }
};

template <int D>
using HingeProperty = bool (*)(const Kind<D>&, const std::string&);

// R3 of a motor: it keeps its limits of torque and speed.
template <int D>
bool motorKeepsItsTorque(const Kind<D>& motor, const std::string& solver) {  // 5 rad/s, at most 4 N m
  Flywheel<D> wheel(motor, solver, 0);
  for (int i = 1; i <= 300; ++i) {
    wheel.step();
    const double t = i / 60.0, most = std::min(5.0, 4.0 / 2 * t);
    if (std::abs(double(wheel.speed()) - most) > 0.01 * most) return false;
  }
  return true;
}

// A limit of two turns is reached after two turns, and holds.
template <int D>
bool countsTurns(const Kind<D>& hinge, const std::string& solver) {  // upper = 4 pi
  constexpr double kTwoTurns = 4 * std::numbers::pi;
  Flywheel<D> wheel(hinge, solver, 3);
  double before = 0;
  for (int i = 0; i < 400; ++i) {
    wheel.step();
    const double angle = double(wheel.angle());
    if (angle < before - 0.01 || angle > kTwoTurns + 0.02) return false;
    before = angle;
  }
  return std::abs(before - kTwoTurns) < 0.02;
}

// A body that leaves a stop is not held.
template <int D>
bool letsGo(const Kind<D>& hinge, const std::string& solver) {  // lower = 0
  Flywheel<D> wheel(hinge, solver, 1);
  wheel.step(30);
  return std::abs(double(wheel.speed()) - 1) < 1e-4;
}

// A stop holds against a motor of any strength.
template <int D>
bool motorStopsAtTheStop(const Kind<D>& hinge, const std::string& solver) {  // upper = 0.5, 1 rad/s
  Flywheel<D> wheel(hinge, solver, 0);
  wheel.step(300);
  return std::abs(double(wheel.angle()) - 0.5) < 0.02 && std::abs(double(wheel.speed())) < 0.05;
}

template <int D>
void hinges() {
  const auto motor = kindOf<D>("hinge{motor_speed=5,motor_torque=4}");
  const auto turns = kindOf<D>("hinge{upper=12.566370614359172}"), stop = kindOf<D>("hinge{lower=0}");
  for (const std::string& solver : everySolverOfJoints<D>()) {
    EXPECT_TRUE(motorKeepsItsTorque<D>(motor, solver)) << solver;
    EXPECT_TRUE(countsTurns<D>(turns, solver)) << solver;
    EXPECT_TRUE(letsGo<D>(stop, solver)) << solver;
    int held = 0;
    for (const char* torque : {"10", "1000", "1000000"}) {
      const auto both = kindOf<D>(std::string("hinge{upper=0.5,motor_speed=1,motor_torque=") + torque + "}");
      held += motorStopsAtTheStop<D>(both, solver);
    }
    EXPECT_EQ(held == 3, !declares<D>(solver, "Joint.StopHoldsAgainstItsMotor")) << solver << " " << held;
  }
  // Ablations of the failures that avbd and pgs_soft declare.
  const auto strong = kindOf<D>("hinge{upper=0.5,motor_speed=1,motor_torque=1000000}");
  EXPECT_TRUE(motorStopsAtTheStop<D>(strong, "pgs_soft{joints=rigid}"));
  EXPECT_TRUE(motorStopsAtTheStop<D>(strong, "avbd{tries=3}"));
  const auto wrong = [](const Kind<D>& right, JointBug bug) { return std::make_shared<WrongJoint<D>>(right, bug); };
  const std::string dimension = " " + std::to_string(D) + "D";
  expectCaught("a motor without a limit" + dimension,
               motorKeepsItsTorque<D>(wrong(motor, JointBug::endless), "split_solver"));
  expectCaught("an angle that forgets turns" + dimension,
               countsTurns<D>(wrong(turns, JointBug::jumps), "split_solver"));
  expectCaught("a stop that pulls" + dimension, letsGo<D>(wrong(stop, JointBug::pulls), "split_solver"));
}
TEST(JointConformance, HingeMotorsAndStopsHold2) { hinges<2>(); }
TEST(JointConformance, HingeMotorsAndStopsHold3) { hinges<3>(); }

// Hinges declare: if both stops are within reach of a step, only the nearer one holds.
TEST(JointConformance, AHingeKeepsTheNearerStopAlone) {
  Flywheel<2> wheel(kindOf<2>("hinge{lower=-0.01,upper=0.011}"), "split_solver{position=none}", 10);
  wheel.step();
  EXPECT_GT(wheel.angle(), 0.1);
}

// The same of prismatic joints and wheels, and of a cone: in 2D its two sides are stops.
TEST(JointConformance, OfTwoStopsTheNearerHoldsAlone) {
  const auto solver = createStage<Solver<2>>(Spec::parse("split_solver{position=none}"));
  for (const char* kind :
       {"prismatic{lower=-0.01,upper=0.011}", "wheel{lower=-0.01,upper=0.011}", "cone_twist{swing=0.01}"}) {
    ImpactScene<2> s;
    s.add(1, Ang<2>::Ones(), {}, {Vec<2>(10, 0), Ang<2>(Real(-10))});
    s.join(kind, -1, 0, {}, {});
    s.step(*solver);
    EXPECT_GT(s.pose(0).p[0] + std::abs(turnOf(s.pose(0).q)[0]), 0.1) << kind;
  }
}

/// Two flywheels hinged to the world and joined by this kind; the second is driven.
template <int D>
struct Geared {
  ImpactScene<D> scene;
  std::unique_ptr<Solver<D>> solver;

  Geared(const Kind<D>& kind, const std::string& text, const std::string& driven)
      : solver(createStage<Solver<D>>(Spec::parse(text))) {
    for (const Real i : {Real(0), Real(1)}) {
      scene.add(i + 1, Ang<D>::Constant((i + 1) / 2), {2 * i * Vec<D>::Unit(0), {}});
    }
    scene.join("hinge", -1, 0, scene.pose(0), scene.pose(0));
    scene.join(driven, -1, 1, scene.pose(1), scene.pose(1));
    join<D>(scene, kind, 0, 1, {}, Vec<D>::Zero());
  }
  Real turned(std::size_t i) const { return scene.joints[i].state[0]; }
};

// Ten turns of B and thirty of A, in step to a hundredth of a radian.
template <int D>
bool turnsInRatio(const Kind<D>& gear, const std::string& solver) {  // ratio 3
  Geared<D> pair(gear, solver, "hinge{motor_speed=2,motor_torque=100}");
  for (int i = 0; i < 1900; ++i) {
    stepJoined(pair.scene, *pair.solver);
    if (std::abs(pair.turned(0) + 3 * pair.turned(1)) > Real(0.01)) return false;
  }
  return std::abs(pair.turned(1) - Real(1900) / 30) < 1;
}
template <int D>
void gears() {
  const auto gear = kindOf<D>("gear{ratio=3}");
  for (const std::string& solver : everySolverOfJoints<D>()) {
    EXPECT_TRUE(turnsInRatio<D>(gear, solver)) << solver;
  }
  const auto forgets = std::make_shared<WrongJoint<D>>(gear, JointBug::jumps);
  expectCaught("a gear that forgets turns " + std::to_string(D) + 'D', turnsInRatio<D>(forgets, "split_solver"));
  const auto alone = std::make_shared<WrongJoint<D>>(gear, JointBug::oneBody);
  expectCaught("a gear that turns one body " + std::to_string(D) + 'D', turnsInRatio<D>(alone, "split_solver"));
}
TEST(JointConformance, GearsTurnInTheirRatio2) { gears<2>(); }
TEST(JointConformance, GearsTurnInTheirRatio3) { gears<3>(); }

// Gears declare: more than half a turn in a step is taken for less than half a turn backwards.
TEST(JointConformance, AGearLosesTurnsOfHalfATurnAStep) {
  const auto error = [](Real turn) {
    ImpactScene<2> s;
    s.add(1, Ang<2>::Ones(), {}), s.add(1, Ang<2>::Ones(), {Vec<2>(1, 0), {}});
    s.join("gear", 0, 1, {}, {});
    s.bodies.pose[0].q = Rot<2>::angle(double(turn)), s.bodies.pose[1].q = Rot<2>::angle(double(-turn));
    s.bodies.pose[1].q = s.bodies.pose[1].q * Rot<2>::angle(0.1);
    JointRecord<2>& j = s.joints[0];
    j.kind->finish(j, s.pose(0), s.pose(1));
    return double(s.rows(j).row[0].error);
  };
  EXPECT_NEAR(error(3), 0.1, 1e-6);
  EXPECT_NEAR(error(Real(3.2)), 0.1 - 2 * std::numbers::pi, 1e-6);
}

// An angular error of a body that cannot turn cannot be corrected. The other errors must still be corrected.
TEST(JointConformance, UncorrectableErrorsDoNotBlockOthers) {
  const auto solver = createStage<Solver<2>>(Spec::parse("split_solver{position=nonlinear}"));
  ImpactScene<2> s;
  s.add(1, Ang<2>::Zero(), {});
  s.join("hinge{lower=0.5}", -1, 0, {}, {});
  s.add(0, Ang<2>::Zero(), {Vec<2>(5, 0), {}});
  s.add(1, Ang<2>::Constant(1), {Vec<2>(5, 1), {}});
  s.touch(1, 2, Vec<2>(0, 1), Vec<2>(5, Real(0.5)), Real(-0.1), 0, 0);
  for (int i = 0; i < 10; ++i) s.step(*solver);
  EXPECT_GT(s.manifolds[0].points[0].separation, -0.01);
}

/// Errors (m, rad) after two seconds, relative to the initial ones (where there was one).
template <int D>
JointError errorAfter(const Kind<D>& kind, const std::string& text, Real apart) {
  const auto solver = createStage<Solver<D>>(Spec::parse(text));
  ImpactScene<D> s;
  s.add(2, Ang<D>::Constant(Real(0.5)), {});
  s.add(3, Ang<D>::Constant(Real(0.7)), {Vec<D>::Unit(0), {}});
  JointRecord<D> j;
  j.kind = kind, j.bodyA = 0, j.bodyB = 1;
  j.X_CaJ.p = Vec<D>::Unit(0) / 2, j.X_CbJ.p = -Vec<D>::Unit(0) / 2;
  try {
    kind->begin(j, s.pose(0), s.pose(1));
  } catch (const UserError&) {  // a kind with two ends
    j.X_CbJ.p.setZero();
    kind->begin(j, s.pose(0), s.pose(1));
  }
  s.joints.push_back(j);
  s.bodies.pose[1].p += apart * Vec<D>::Ones();
  s.bodies.pose[1].q = integrateRotation(s.bodies.pose[1].q, Ang<D>(apart * Ang<D>::Ones()));
  const JointError before = s.jointError(s.joints[0]);
  for (int i = 0; i < 120; ++i) s.step(*solver);
  const JointError after = s.jointError(s.joints[0]);
  const auto share = [&](double now, double then) { return now / std::max(then, double(apart)); };
  return {share(after.linear, before.linear), share(after.angular, before.angular)};
}

// R16: errors in metres and radians shrink.
template <int D>
void errorsShrink() {
  for (const std::string& kind : everyKind<D>()) {
    for (const std::string& solver : everySolverOfJoints<D>()) {
      if (declares<D>(solver, "PositionError.Shrinks") || declares<D>(solver, "JointError.Shrinks")) continue;
      const JointError left = errorAfter<D>(kindOf<D>(kind), solver, Real(0.05));
      EXPECT_LT(left.linear, 0.1) << kind << " " << solver;
      EXPECT_LT(left.angular, 0.1) << kind << " " << solver;
    }
  }
  const auto bug = std::make_shared<WrongJoint<D>>(kindOf<D>("weld"), JointBug::wrongSign);
  const JointError left = errorAfter<D>(bug, "split_solver", Real(0.05));
  expectCaught("an error fed back with the wrong sign " + std::to_string(D) + "D",
               left.linear < 0.1 && left.angular < 0.1);
}
TEST(JointConformance, ErrorsShrink2) { errorsShrink<2>(); }
TEST(JointConformance, ErrorsShrink3) { errorsShrink<3>(); }

}  // namespace joint_test
}}}  // namespace lpc::LPC_PRECISION::test
