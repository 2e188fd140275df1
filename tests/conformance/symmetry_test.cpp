// SPDX-License-Identifier: Zlib
// Symmetries of mechanics that a whole step must keep, for every solver. The scene in another frame, in a mirror, or
// with another unit of mass has the same motion. A body of infinite mass is the limit of a heavy one.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <vector>

#include "framework/math/random.h"
#include "tests/check_property.h"
#include "tests/conformance/scene_change.h"
#include "tests/every_solver.h"
#include "tests/planted_bugs/solver_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace symmetry_test {

constexpr bool kDouble = sizeof(Real) == 8;
constexpr int kSteps = 3, kRuns = 20;
// Rounding over a few steps of a few bodies, relative to the speeds.
constexpr Real kTolerance = kDouble ? Real(1e-9) : Real(1e-4);

// Where a speed is at a threshold, or where Coulomb's law lets a wedged body stay or move, rounding decides. This is no
// fault of the method if its result moves as far when only the last digits of the scene change. Such cases are counted
// and must be few.
constexpr Real kLastDigits = 100 * std::numeric_limits<Real>::epsilon();
constexpr int kOthers = 64;
constexpr int kFew = 20;      // one scene in twenty
std::vector<char> undecided;  // by scene, in the order of judging

template <int D>
ImpactScene<D> after(ImpactScene<D> s, Solver<D>& solver) {
  for (int i = 0; i < kSteps; ++i) s.step(solver);
  return s;
}

// The scene with other last digits.
template <int D>
ImpactScene<D> nudged(ImpactScene<D> s, Real digits, Random& random) {
  const auto nudge = [&](auto&& vector, Real scale) {
    for (int k = 0; k < vector.size(); ++k) vector[k] += digits * scale * Real(random.uniform(-1, 1));
  };
  for (std::size_t i = 0; i < s.bodies.pose.size(); ++i) {
    nudge(s.bodies.pose[i].p, 1);
    if (s.bodies.type[i] == BodyType::fixed) continue;
    nudge(s.bodies.motion[i].v, s.speed()), nudge(s.bodies.motion[i].w, s.speed());
    const Real lighter = 1 + digits * Real(random.uniform(-1, 1));
    s.bodies.mass[i] /= lighter, s.bodies.invMass[i] *= lighter;
    s.bodies.invInertiaBody[i] *= 1 + digits * Real(random.uniform(-1, 1));
  }
  for (Manifold<D>& m : s.manifolds) {
    for (int k = 0; k < m.count; ++k) {
      ContactPoint<D>& c = m.points[static_cast<std::size_t>(k)];
      nudge(c.localA, 1), nudge(c.localB, 1);
      c.separation = separationNow(m, c, s.pose(m.bodyA), s.pose(m.bodyB));
    }
  }
  return s;
}

template <int D>
Real places(const ImpactScene<D>& one, const ImpactScene<D>& other) {
  return difference(one, other);
}

// The results differ by no more than the limit, or than the method's own result moves.
template <int D, typename Error>
void agree(const Error& error, Real limit, const ImpactScene<D>& before, const ImpactScene<D>& expected,
           const ImpactScene<D>& found, Solver<D>& solver, Real digits = kLastDigits) {
  Real moved = 0;
  undecided.push_back(!(error(expected, found) <= limit));
  if (undecided.back()) {
    const auto own = after(before, solver);
    Random random(1);
    for (int i = 0; i < kOthers; ++i) {
      moved = std::max(moved, error(own, after(nudged(before, digits, random), solver)));
    }
  }
  require<D>(error(expected, found), std::max(limit, 10 * moved), expected, found);
}

template <int D>
ImpactScene<D> drawImpacts(Draw& draw) {
  auto s = drawImpact<D>(draw, {.fixed = draw.coin(),
                                .friction = true,
                                .restitution = draw.coin() ? Real(0.3) : Real(0),
                                .gap = Real(0.05),
                                .joints = draw.below(2)});
  s.field.gravity = Vec<D>::Unit(1) * Real(-9.81);
  return s;
}

// R7: turned, shifted, and moving past.
template <int D>
void moves(Solver<D>& solver, Draw& draw) {
  const auto before = drawImpacts<D>(draw);
  const Pose<D> X{10 * drawVector<D>(draw), drawRotation<D>(draw)};
  const Vec<D> boost = 3 * drawVector<D>(draw);
  auto expected = after(before, solver);
  for (Pose<D>& x : expected.bodies.pose) x.p += kSteps * expected.dt * boost;
  expected = moved(expected, X, boost);
  const auto found = after(moved(before, X, boost), solver);
  agree<D>(places<D>, 10 * kTolerance * (1 + boost.norm()) * before.speed(), before, expected, found, solver);
}

// R7 with warm joints: they start from impulses and the solver's memory. Without contacts, which would appear and
// vanish by rounding.
template <int D>
void movesWarm(Solver<D>& solver, Draw& draw) {
  auto before = drawImpact<D>(draw, {.fixed = draw.coin(), .joints = 2});
  before.manifolds.clear(), before.active.clear();
  before.field.gravity = Vec<D>::Unit(1) * Real(-9.81);
  before = after(before, solver);
  const Pose<D> X{drawVector<D>(draw), drawRotation<D>(draw)};
  const auto expected = moved(after(before, solver), X, Vec<D>(Vec<D>::Zero()));
  const auto found = after(moved(before, X, Vec<D>(Vec<D>::Zero())), solver);
  agree<D>(places<D>, 10 * kTolerance * before.speed(), before, expected, found, solver);
}

// R8: in a mirror.
template <int D>
void mirrors(Solver<D>& solver, Draw& draw) {
  const auto before = drawImpacts<D>(draw);
  const auto expected = mirrored(after(before, solver)), found = after(mirrored(before), solver);
  agree<D>(places<D>, kTolerance * before.speed(), before, expected, found, solver);
}

// R11: with another unit of mass the motion is the same, and impulses scale.
template <int D>
void weighs(Solver<D>& solver, Draw& draw) {
  const auto before = drawImpacts<D>(draw);
  const Real k = draw.pick({Real(1) / 1024, Real(1024)});  // squares of powers of two: no rounding differs
  const auto expected = after(before, solver);
  auto found = after(heavier(before, k), solver);
  for (Manifold<D>& m : found.manifolds) m.points[0].impulse[0] /= k;
  const auto error = [](const ImpactScene<D>& one, const ImpactScene<D>& other) {
    Real sum = difference(one, other);
    for (std::size_t m = 0; m < one.manifolds.size(); ++m) {
      sum += std::abs(one.manifolds[m].points[0].impulse[0] - other.manifolds[m].points[0].impulse[0]);
    }
    return sum;
  };
  agree<D>(error, 10 * kTolerance * before.speed(), before, expected, found, solver);
}

// R13: a static body acts as one of 1e12 times the mass.
template <int D>
void heavyIsFixed(Solver<D>& solver, Draw& draw) {
  const auto fixed = drawImpact<D>(
      draw, {.fixed = true, .friction = true, .restitution = Real(0.3), .gap = Real(0.05), .joints = draw.below(2)});
  auto heavy = fixed;
  heavy.bodies.type[0] = BodyType::dynamic;
  heavy.bodies.mass[0] = Real(1e12), heavy.bodies.invMass[0] = Real(1e-12);
  heavy.bodies.invInertiaBody[0].diagonal().setConstant(Real(1e-12));
  const auto expected = after(fixed, solver), found = after(heavy, solver);
  const auto error = [](const ImpactScene<D>& one, const ImpactScene<D>& other) { return difference(one, other, 1); };
  agree<D>(error, (kDouble ? Real(1e-6) : 10 * kTolerance) * fixed.speed(), fixed, expected, found, solver,
           std::max(Real(1e-12), kLastDigits));
}

template <int D>
struct Named {
  const char* name;
  void (*property)(Solver<D>&, Draw&);
  std::vector<Bug> bugs;  // that the property must catch
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
    undecided.clear();
    check(name, property, kRuns);
    // The cases of a kept input of an earlier run come first, with all steps of its shrinking.
    const auto all = std::min<std::ptrdiff_t>(std::ssize(undecided), caseCount(kRuns));
    EXPECT_LE(std::count(undecided.end() - all, undecided.end(), true), 1 + caseCount(kRuns) / kFew)
        << "too many scenes in which rounding chooses";
  }
}

// A static body takes no colour and joins no islands; a heavy one does. For these methods this changes the order, a
// step size, or the end of an unfinished iteration.
bool joinsByMass(const std::string& spec) {
  for (const char* part : {"order=coloured", "velocity=admm", "velocity=proximal_newton", "impact=poisson"}) {
    if (spec.find(part) != spec.npos) return true;
  }
  return false;
}

template <int D>
void everySolverHolds() {
  for (const std::string& spec : everySolver<D>()) {
    const auto solver = createStage<Solver<D>>(Spec::parse(spec));
    for (const Named<D>& p : properties<D>()) {
      // Heights turn with the frame, which changes the order and so the unfinished iteration.
      if (p.property == moves<D> && spec.find("bottom_up") != spec.npos) continue;
      if (p.property == heavyIsFixed<D> && joinsByMass(spec)) continue;
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

}  // namespace symmetry_test
}}}  // namespace lpc::LPC_PRECISION::test
