// SPDX-License-Identifier: Zlib
// What a whole step owes to the symmetries of mechanics, for every solver: the same scene seen from elsewhere, in a
// mirror, or in another unit of mass is the same motion; and a body of infinite mass is the limit of a heavy one.
#include <gtest/gtest.h>

#include <functional>

#include "tests/check_property.h"
#include "tests/conformance/scene_change.h"
#include "tests/every_solver.h"
#include "tests/planted_bugs/solver_twins.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

constexpr bool kDouble = sizeof(Real) == 8;
constexpr int kSteps = 3, kRuns = 20;
// Rounding over a few steps of a few bodies, relative to the speeds.
constexpr Real kTolerance = kDouble ? Real(1e-9) : Real(1e-4);

template <int D>
ImpactScene<D> after(ImpactScene<D> s, Solver<D>& solver) {
  for (int i = 0; i < kSteps; ++i) s.step(solver);
  return s;
}

template <int D>
ImpactScene<D> drawScene(Draw& draw) {
  auto s = drawImpact<D>(draw, {.fixed = draw.coin(),
                                .friction = true,
                                .restitution = draw.coin() ? Real(0.3) : Real(0),
                                .gap = Real(0.05),
                                .joints = draw.below(2)});
  s.field.gravity = Vec<D>::Unit(1) * Real(-9.81);
  return s;
}

// R7: turned, shifted, and seen in passing.
template <int D>
void moves(Solver<D>& solver, Draw& draw) {
  const auto before = drawScene<D>(draw);
  const Pose<D> X{10 * drawVector<D>(draw), drawRotation<D>(draw)};
  const Vec<D> boost = 3 * drawVector<D>(draw);
  auto expected = after(before, solver);
  for (Pose<D>& x : expected.bodies.pose) x.p += kSteps * expected.dt * boost;
  expected = moved(expected, X, boost);
  const auto found = after(moved(before, X, boost), solver);
  require<D>(difference(expected, found), 10 * kTolerance * (1 + boost.norm()) * before.speed(), expected, found);
}

// R7 of joints that are warm: they start from impulses and from what the solver remembers. Without contacts, which
// would come and go by rounding.
template <int D>
void movesWarm(Solver<D>& solver, Draw& draw) {
  auto before = drawImpact<D>(draw, {.fixed = draw.coin(), .joints = 2});
  before.manifolds.clear(), before.active.clear();
  before.field.gravity = Vec<D>::Unit(1) * Real(-9.81);
  before = after(before, solver);
  const Pose<D> X{drawVector<D>(draw), drawRotation<D>(draw)};
  const auto expected = moved(after(before, solver), X, Vec<D>(Vec<D>::Zero()));
  const auto found = after(moved(before, X, Vec<D>(Vec<D>::Zero())), solver);
  require<D>(difference(expected, found), 10 * kTolerance * before.speed(), expected, found);
}

// R8: in a mirror.
template <int D>
void mirrors(Solver<D>& solver, Draw& draw) {
  const auto before = drawScene<D>(draw);
  const auto expected = mirrored(after(before, solver)), found = after(mirrored(before), solver);
  require<D>(difference(expected, found), kTolerance * before.speed(), expected, found);
}

// R11: in another unit of mass the motion is the same, and impulses scale.
template <int D>
void weighs(Solver<D>& solver, Draw& draw) {
  const auto before = drawScene<D>(draw);
  const Real k = draw.pick({Real(1e-3), Real(1e3)});
  const auto expected = heavier(after(before, solver), k), found = after(heavier(before, k), solver);
  Real error = difference(expected, found);
  for (std::size_t m = 0; m < expected.manifolds.size(); ++m) {
    const Real a = expected.manifolds[m].points[0].impulse[0], b = found.manifolds[m].points[0].impulse[0];
    error += std::abs(k * a - b) / k;
  }
  require<D>(error, 10 * kTolerance * before.speed(), expected, found);
}

// R13: nobody can tell a fixed body from one of 1e9 times the mass.
template <int D>
void heavyIsFixed(Solver<D>& solver, Draw& draw) {
  const auto fixed = drawImpact<D>(
      draw, {.fixed = true, .friction = true, .restitution = Real(0.3), .gap = Real(0.05), .joints = draw.below(2)});
  auto heavy = fixed;
  heavy.bodies.type[0] = BodyType::dynamic;
  heavy.bodies.mass[0] = Real(1e9), heavy.bodies.invMass[0] = Real(1e-9);
  heavy.bodies.invInertiaBody[0].diagonal().setConstant(Real(1e-9));
  const auto expected = after(fixed, solver), found = after(heavy, solver);
  require<D>(difference(expected, found, 1), (kDouble ? Real(1e-6) : 10 * kTolerance) * fixed.speed(), expected, found);
}

template <int D>
struct Named {
  const char* name;
  void (*property)(Solver<D>&, Draw&);
  std::vector<Bug> bugs;  // that it must catch
};
template <int D>
std::vector<Named<D>> properties() {
  return {{"Symmetry.MovesWithTheFrame",
           moves<D>,
           {Bug::armsOfTheWorld, Bug::slowsInTheWorld, D == 3 ? Bug::squareFriction : Bug::armsOfTheWorld}},
          {"Symmetry.WarmJointsMoveWithTheFrame", movesWarm<D>, {Bug::armsOfTheWorld}},
          {"Symmetry.Mirrors", mirrors<D>, {Bug::turnsLeft}},
          {"Symmetry.WeighsInAnyUnit", weighs<D>, {Bug::yields}},
          {"Symmetry.HeavyIsFixed", heavyIsFixed<D>, {Bug::movesFixed}}};
}

template <int D>
void run(const std::string& name, const Named<D>& p, Solver<D>& solver, bool mustFail) {
  SCOPED_TRACE(name);
  const auto property = [&] {
    RapidCheckDraw draw;
    p.property(solver, draw);
  };
  if (mustFail) {
    expectFalsified(name, property, kRuns);
  } else {
    check(name, property, kRuns);
  }
}

template <int D>
void everySolverHolds() {
  for (const std::string& spec : everySolver<D>()) {
    const auto solver = createStage<Solver<D>>(Spec::parse(spec));
    for (const Named<D>& p : properties<D>()) {
      // Heights turn with the frame: another order, another unfinished iteration.
      if (p.property == moves<D> && spec.find("bottom_up") != spec.npos) continue;
      run<D>(std::string(p.name) + " " + spec + " " + std::to_string(D) + "D", p, *solver, declares<D>(spec, p.name));
    }
  }
}

template <int D>
void plantedBugs() {
  for (const Named<D>& p : properties<D>()) {
    TwinSolver<D> right(Bug::none, 10);
    run<D>(std::string(p.name) + " twin", p, right, false);
    for (Bug bug : p.bugs) {
      TwinSolver<D> wrong(bug, 10);
      run<D>(std::string(p.name) + " planted bug " + std::to_string(static_cast<int>(bug)), p, wrong, true);
    }
  }
}

TEST(Symmetry, EverySolver2) { everySolverHolds<2>(); }
TEST(Symmetry, EverySolver3) { everySolverHolds<3>(); }
TEST(Symmetry, PlantedBugsAreCaught2) { plantedBugs<2>(); }
TEST(Symmetry, PlantedBugsAreCaught3) { plantedBugs<3>(); }

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
