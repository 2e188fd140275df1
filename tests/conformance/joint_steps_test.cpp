// SPDX-License-Identifier: Zlib
// Duties of whole steps with joints, for every registered kind under every solver: the symmetries of mechanics, static
// bodies, and errors that shrink without leaving speed.
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>

#include "tests/check_property.h"
#include "tests/conformance/joined_bodies.h"
#include "tests/planted_bugs/joint_bugs.h"
#include "tests/planted_bugs/solver_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace joint_steps_test {

constexpr bool kDouble = sizeof(Real) == 8;
constexpr int kSteps = 5, kRuns = 10;
// Rounding over a few steps, relative to the speeds.
constexpr Real kTolerance = kDouble ? Real(1e-9) : Real(2e-4);

const std::string kLimited = "hinge{lower=-0.1,upper=0.2}";

/// Input of a property: a kind by its text, how it is made, and the solver.
template <int D>
struct Subject {
  Spec spec;
  std::function<Kind<D>(const Spec&)> make;
  Solver<D>& solver;

  Kind<D> kind() const { return make(spec); }
};

template <int D>
Kind<D> asRegistered(const Spec& spec) {
  return createStage<JointKind<D>>(spec);
}

template <int D>
ImpactScene<D> after(ImpactScene<D> s, Solver<D>& solver, int steps = kSteps) {
  for (int i = 0; i < steps; ++i) stepJoined(s, solver);
  return s;
}

template <int D>
ImpactScene<D> drawFalling(Draw& draw, const Kind<D>& kind, bool fixed, std::vector<Pose<D>>* made = nullptr) {
  auto s = drawJointed(draw, kind, fixed);
  if (made) *made = s.bodies.pose;
  nudge(s, draw, Real(0.05));
  s.field.gravity = Vec<D>::Unit(1) * Real(-9.81);
  return s;
}

// A mirror reverses rotations, so limits, motors and rest angles would have to change. They stay the same if the mirror
// also reverses the frames' z axes, about which hinges turn. 2D has no such axis. There, a hinge stays the same with A
// and B exchanged. A joint that slides along A's x stays the same with its frames reversed. A kind with rows that turn
// with A needs no change.
enum class Image { asItIs, exchanged, turnedRound };

// Joints are created at the poses before the nudge.
template <int D>
ImpactScene<D> image(const ImpactScene<D>& scene, const std::vector<Pose<D>>& made, Image how) {
  auto s = scene;
  s.bodies.pose = made;
  s = mirrored(s);
  for (JointRecord<D>& j : s.joints) {
    if constexpr (D == 3) {
      for (Pose<3>* X : {&j.X_CaJ, &j.X_CbJ}) X->q = X->q * Rot<3>{0, 0, 1, 0};
    } else if (how == Image::exchanged) {
      std::swap(j.bodyA, j.bodyB), std::swap(j.X_CaJ, j.X_CbJ);
    } else if (how == Image::turnedRound) {
      for (Pose<2>* X : {&j.X_CaJ, &j.X_CbJ}) X->q = X->q * Rot<2>{-1, 0};
    }
  }
  beginAnew(s);
  s.bodies = mirrored(scene).bodies;
  return s;
}

// R8: in a mirror.
template <int D>
void mirrors(const Subject<D>& on, Draw& draw) {
  std::vector<Pose<D>> made;
  const auto before = drawFalling(draw, on.kind(), draw.coin(), &made);
  const auto expected = mirrored(after(before, on.solver)),
             found = after(image(before, made, Image::asItIs), on.solver);
  Real error = difference(expected, found);
  for (const Image how : {Image::exchanged, Image::turnedRound}) {
    if (D == 2) error = std::min(error, difference(expected, after(image(before, made, how), on.solver)));
  }
  require<D>(error, kTolerance * 10 * before.speed(), expected, found);
}

// The same joint in another unit of mass: forces and torques among its parameters are k times as large.
template <int D>
Spec heavier(const Spec& spec, Real k) {
  const Registered& entry = Registry::instance().find(StageKind::joint, D, spec.name);
  Spec out = entry.canonical(spec);
  for (const ParamInfo& p : entry.params) {
    if (!p.unit.starts_with("N")) continue;
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", std::stod(out.find(p.name)->name) * double(k));
    Spec with = out;
    with.set(p.name, {text, {}});
    try {
      entry.create(with);
      out = with;
    } catch (const UserError&) {  // not valid in this mode: a rod's stiffness
    }
  }
  return out;
}

// R11: in another unit of mass.
template <int D>
void weighs(const Subject<D>& on, Draw& draw) {
  const auto before = drawFalling(draw, on.kind(), draw.coin());
  const Real k = draw.pick({Real(1e-3), Real(1e3)});
  auto other = heavier(before, k);
  other.joints[0].kind = on.make(heavier<D>(on.spec, k));
  const auto expected = heavier(after(before, on.solver), k), found = after(other, on.solver);
  Real error = difference(expected, found);
  for (std::size_t i = 0; i < kJointRows; ++i) {
    error += std::abs(k * expected.joints[0].impulse[i] - found.joints[0].impulse[i]) / k;
  }
  require<D>(error, 10 * kTolerance * before.speed(), expected, found);
}

// R13: a static body does not move by one bit, and is the limit of a body with 1e9 times the mass.
template <int D>
void heavyIsFixed(const Subject<D>& on, Draw& draw) {
  auto fixed = drawFalling(draw, on.kind(), true);
  fixed.field.gravity.setZero();
  auto heavy = fixed;
  heavy.bodies.type[0] = BodyType::dynamic;
  heavy.bodies.mass[0] = Real(1e9), heavy.bodies.invMass[0] = Real(1e-9);
  heavy.bodies.invInertiaBody[0].diagonal().setConstant(Real(1e-9));
  const auto expected = after(fixed, on.solver), found = after(heavy, on.solver);
  require<D>(difference(expected, found, 1), (kDouble ? Real(1e-6) : 10 * kTolerance) * fixed.speed(), expected, found);
  RC_ASSERT(expected.pose(0).p == fixed.pose(0).p && expected.motion(0).v.isZero(0) && expected.motion(0).w.isZero(0));
}

// R15: joined bodies rest once the error is gone. The extension of a spring is no error.
template <int D>
void leavesNoSpeed(const Subject<D>& on, Draw& draw) {
  if (!rigid(asRegistered<D>(on.spec))) return;
  auto before = drawJointed(draw, on.kind(), draw.coin());
  for (Motion<D>& motion : before.bodies.motion) motion = {};
  nudge(before, draw, Real(0.4));
  const auto rested = after(before, on.solver, 60);
  require<D>(rested.energy(), kEps, before, rested);
}

template <int D>
struct Named {
  const char* name;
  const char* declared;  // the failure that a solver declares with a pivot
  std::function<void(const Subject<D>&, Draw&)> property;
  JointBug bug;  // that the property must catch in `of`
  const char* of;
};

template <int D>
std::vector<Named<D>> properties() {
  return {{"JointStep.Mirrors", "Symmetry.Mirrors", mirrors<D>, JointBug::turnsLeft, "distance"},
          {"JointStep.WeighsInAnyUnit", "Symmetry.WeighsInAnyUnit", weighs<D>, JointBug::yields, "hinge"},
          {"JointStep.WeighsInAnyUnit", "Symmetry.WeighsInAnyUnit", weighs<D>, JointBug::weightless, "mouse"},
          {"JointStep.HeavyIsFixed", "", heavyIsFixed<D>, JointBug::none, nullptr},
          {"JointStep.LeavesNoSpeed", "JointStep.PullsLeaveNoSpeed", leavesNoSpeed<D>, JointBug::yields, "weld"}};
}

template <int D>
void testAll() {
  for (const std::string& solver : everySolverOfJoints<D>()) {
    const auto steps = createStage<Solver<D>>(Spec::parse(solver));
    for (const std::string& spec : everyKind<D>()) {
      const Subject<D> on{Spec::parse(spec), asRegistered<D>, *steps};
      for (const Named<D>& p : properties<D>()) {
        const std::string name = std::string(p.name) + " " + spec + " " + solver + " " + std::to_string(D) + "D";
        SCOPED_TRACE(name);
        const bool ofStops = declares<D>(solver, p.name) && hasStop(on.kind());
        if (!declares<D>(solver, p.declared) && !ofStops) {
          check(name, drawn(p, on), kRuns);
        } else if (spec == (ofStops ? kLimited : "pivot")) {
          expectFalsified(name, drawn(p, on), kRuns);
        }
      }
    }
  }
}

template <int D>
void plantedBugs() {
  const auto steps = createStage<Solver<D>>(Spec{"split_solver", {}});
  for (const Named<D>& p : properties<D>()) {
    if (p.bug == JointBug::none) continue;
    const auto wrong = [&p](const Spec& spec) -> Kind<D> {
      return std::make_shared<WrongJoint<D>>(asRegistered<D>(spec), p.bug);
    };
    const Subject<D> on{Spec::parse(p.of), wrong, *steps};
    expectFalsified(std::string(p.name) + " planted bug " + std::to_string(D) + "D", drawn(p, on), kRuns);
  }
  // A fault that does not depend on the kind: a solver in which a static body is only heavy.
  const Named<D> heavy = properties<D>()[3];
  TwinSolver<D> right(Bug::none, 10), moves(Bug::movesFixed, 10);
  check("JointStep.HeavyIsFixed twin", drawn(heavy, Subject<D>{Spec{"pivot", {}}, asRegistered<D>, right}), kRuns);
  expectFalsified("JointStep.HeavyIsFixed planted bug " + std::to_string(D) + "D",
                  drawn(heavy, Subject<D>{Spec{"pivot", {}}, asRegistered<D>, moves}), kRuns);
}

TEST(JointStep, EveryKindUnderEverySolver2) { testAll<2>(); }
TEST(JointStep, EveryKindUnderEverySolver3) { testAll<3>(); }
TEST(JointStep, PlantedBugsAreCaught2) { plantedBugs<2>(); }
TEST(JointStep, PlantedBugsAreCaught3) { plantedBugs<3>(); }

}  // namespace joint_steps_test
}}}  // namespace lpc::LPC_PRECISION::test
