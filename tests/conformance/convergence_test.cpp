// SPDX-License-Identifier: Zlib
// Convergence of iterations over contacts in one step, for every registered velocity resolver with each of its choices,
// and for every solver without a resolver. The result must not depend on the order, must improve with more iterations,
// and must converge at the predicted rate. A solver's second step must change nothing. Joints:
// joint_convergence_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "framework/problem/contact_problem.h"
#include "tests/check_property.h"
#include "tests/conformance/by_iterations.h"
#include "tests/conformance/scene_change.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace convergence_test {

constexpr bool kDouble = sizeof(Real) == 8;
constexpr Real kRounding = kDouble ? Real(1e-11) : Real(1e-5);  // of the energy, over a few sweeps
constexpr Real kConverged = kDouble ? Real(1e-6) : Real(2e-3);
constexpr int kRuns = 60, kMany = 2000;

/// The scene after a number of iterations.
template <int D>
using Comes = std::function<ImpactScene<D>(const ImpactScene<D>& before, int iterations)>;

template <int D>
Comes<D> bySolving(Solves<D> solves) {
  return [solves](const ImpactScene<D>& before, int iterations) { return solved(before, *solves(iterations)); };
}

/// The method under test, and one that is known to converge.
template <int D>
struct Subject {
  Comes<D> comes, right;
  int atMost = 0;  // iterations of a method with a tolerance, by default; 0: a method that sweeps as often as specified
  int many = kMany;
  Real dt = 0;  // s, a whole step of a drawn scene, in which bodies turn and contacts move; 0: velocities only
  ImpactScene<D> draw(Draw& draw, const Drawn& wanted) const {
    auto s = drawImpact<D>(draw, wanted);
    if (dt > 0) s.dt = dt;
    return s;
  }
  /// The change of speeds (m/s) caused by turning bodies.
  Real turning(const ImpactScene<D>& s) const { return 10 * dt * s.speed() * s.speed(); }
};

int atMost(const Registered& entry) {
  const ParamInfo* const effort = firstOf(ParamRole::effort, entry.params);
  if (!effort || effort->type != "integer" || !firstOf(ParamRole::tolerance, entry.params)) return 0;
  return std::stoi(effort->defaultText);
}

/// Do sweeps converge long before they stop? Contacts that nearly coincide or nearly contradict each other take any
/// number of sweeps.
template <int D>
bool endIsNear(const ImpactScene<D>& before, const ImpactScene<D>& end, const Subject<D>& on) {
  return difference(on.right(before, kMany / 20), end) <= kConverged * before.speed();
}

/// Is no contact closing that the step has opened? Otherwise bodies still move when the step ends: speculative contacts
/// leave the stop to the next step.
template <int D>
bool nothingOpenCloses(const ImpactScene<D>& s) {
  return std::all_of(s.manifolds.begin(), s.manifolds.end(), [&](const Manifold<D>& m) {
    const ContactPoint<D>& c = m.points[0];
    return c.separation <= Real(1e-12) || s.contactVelocity(m, c).dot(m.normal) > -kConverged / 1000;
  });
}

/// Least and largest eigenvalue of a symmetric matrix, row by row, by Jacobi's rotations (Golub and Van Loan, Matrix
/// Computations, 8.5). Eigen's solver would take almost 15 s to compile, in each precision.
std::pair<double, double> extremeEigenvalues(std::vector<double> a, std::size_t n) {
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return a[i * n + j]; };
  const auto rotate = [](double& x, double& y, double c, double s) {
    const double old = x;
    x = c * old - s * y, y = s * old + c * y;
  };
  for (int sweep = 0; sweep < 30; ++sweep) {  // five or six suffice
    for (std::size_t p = 0; p < n; ++p) {
      for (std::size_t q = p + 1; q < n; ++q) {
        if (at(p, q) == 0) continue;
        const double half = (at(q, q) - at(p, p)) / (2 * at(p, q));
        const double t = (half < 0 ? -1 : 1) / (std::abs(half) + std::sqrt(half * half + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (std::size_t k = 0; k < n; ++k) rotate(at(k, p), at(k, q), c, s);
        for (std::size_t k = 0; k < n; ++k) rotate(at(p, k), at(q, k), c, s);
        at(p, q) = at(q, p) = 0;
      }
    }
  }
  double least = at(0, 0), most = at(0, 0);
  for (std::size_t i = 1; i < n; ++i) least = std::min(least, at(i, i)), most = std::max(most, at(i, i));
  return {least, most};
}

TEST(ConvergenceEigenvalues, EqualClosedForms) {
  const auto [least, most] = extremeEigenvalues({2, -1, 0, -1, 2, -1, 0, -1, 2}, 3);
  EXPECT_NEAR(least, 2 - std::sqrt(2.0), 1e-14);
  EXPECT_NEAR(most, 2 + std::sqrt(2.0), 1e-14);
}

/// Friction small enough for a unique solution. With De Saxce's correction, the problem is to find impulses x in their
/// cones, with F(x) = W x + v + mu |u_t| n in the dual cones. By the eigenvalues of W,
/// (F(x) - F(y)) . (x - y) >= (least - mu largest) |x - y|^2; for two solutions the left side is never positive.
/// A pyramid's |u_t| is up to sqrt(2) times as large.
template <int D>
Real frictionOfOneAnswer(ImpactScene<D> s) {
  const struct : PositionResolver<D> {
  } none;
  ContactProblem<D> problem;
  problem.set({s.dt, s.lastDt, s.bodies, s.manifolds, s.active, s.joints, none, s.model, kRestitutionThreshold, s.work,
               s.profiler});
  const int n = problem.size();
  std::vector<std::int32_t> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), 0);
  std::vector<double> w;
  problem.assemble(all, w);
  const auto [least, most] = extremeEigenvalues(w, static_cast<std::size_t>(n));
  return Real(std::max(0.5 * least / most, 0.0));
}

std::vector<int> drawOrder(int n, Draw& draw) {
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = 1; i < order.size(); ++i) {
    std::swap(order[i], order[i - static_cast<std::size_t>(draw.below(static_cast<int>(i) + 1))]);
  }
  return order;
}

/// Body i becomes body[i], contact k contact[k].
template <int D>
ImpactScene<D> reordered(const ImpactScene<D>& s, const std::vector<int>& body, const std::vector<int>& contact) {
  ImpactScene<D> out = s;
  for (std::size_t i = 0; i < body.size(); ++i) {
    const auto to = static_cast<std::size_t>(body[i]);
    Bodies<D>& b = out.bodies;
    b.pose[to] = s.bodies.pose[i], b.motion[to] = s.bodies.motion[i], b.type[to] = s.bodies.type[i];
    b.mass[to] = s.bodies.mass[i], b.invMass[to] = s.bodies.invMass[i];
    b.invInertiaBody[to] = s.bodies.invInertiaBody[i], b.invInertia[to] = s.bodies.invInertia[i];
  }
  for (std::size_t k = 0; k < contact.size(); ++k) {
    Manifold<D>& m = out.manifolds[static_cast<std::size_t>(contact[k])];
    m = s.manifolds[k];
    m.bodyA = m.shapeA = body[static_cast<std::size_t>(m.bodyA)];
    m.bodyB = m.shapeB = body[static_cast<std::size_t>(m.bodyB)];
  }
  return out;
}

// R9: bodies and contacts stored in another order give the same result.
template <int D>
void orderDoesNotMatter(const Subject<D>& on, Draw& draw) {
  auto before = on.draw(draw, {.fixed = draw.coin(), .friction = draw.coin(), .gap = on.dt > 0 ? Real(0) : Real(0.02)});
  const Real mu = frictionOfOneAnswer(before);
  for (Manifold<D>& m : before.manifolds) m.friction = std::min(m.friction, mu);
  RC_PRE(endIsNear(before, on.right(before, kMany), on));
  const std::vector<int> body = drawOrder(before.bodies.size(), draw);
  const std::vector<int> contact = drawOrder(static_cast<int>(before.manifolds.size()), draw);
  const auto a = on.comes(before, on.many), b = on.comes(reordered(before, body, contact), on.many);
  if (on.dt > 0) RC_PRE(nothingOpenCloses(a) && nothingOpenCloses(b));
  require<D>(difference(reordered(a, body, contact), b),
             (kDouble ? Real(1e-4) : Real(2e-2)) * before.speed() + on.turning(before), a, b);
}

// R10: twice as many iterations leave no more energy, and no less than the solution has. Without restitution and
// friction, the solution is the motion of least kinetic energy that contact impulses can reach, and each Gauss-Seidel
// step decreases that energy (Hildreth 1957). The excess over the solution's energy has two terms. The first is half
// the squared distance to the solution in the energy norm. The second is each remaining impulse times the separating
// speed of its contact in the solution. The distance alone may grow where an impulse is taken back. A method with a
// tolerance may make twice its default iterations, and is compared to within that tolerance.
template <int D>
void moreIsNoWorse(const Subject<D>& on, Draw& draw) {
  const auto before = on.draw(draw, {.fixed = draw.coin()});
  const auto end = on.right(before, kMany);
  RC_PRE(endIsNear(before, end, on));
  const int sweeps = 1 + draw.below(8), few = on.atMost > 0 ? on.atMost : sweeps;
  const Real turning = on.turning(before) * before.speed();
  const Real slack = (on.atMost > 0 ? kConverged : kRounding) * (1 + before.energy()) + turning;
  const auto once = on.comes(before, few), twice = on.comes(before, 2 * few);
  if (on.dt > 0) RC_PRE(nothingOpenCloses(once) && nothingOpenCloses(twice));
  require<D>(twice.energy() - once.energy(), slack, once, twice);
  require<D>(end.energy() - twice.energy(), kConverged * (1 + before.energy()) + turning, end, twice);
}

// On the ground a light body, and a heavy one on it, both falling at 1 m/s.
template <int D>
ImpactScene<D> heavyOnLight(Real heavy, Real light) {
  ImpactScene<D> s;
  const Vec<D> up = Vec<D>::Unit(1);
  for (const Real mass : {Real(0), light, heavy}) {
    const Real height = Real(s.bodies.size()), v = mass > 0 ? Real(1) : Real(0);
    s.add(mass, Ang<D>::Constant(mass), {height * up, {}}, {-v * up, Ang<D>::Zero()});
    const int last = s.bodies.size() - 1;
    if (last > 0) s.touch(last - 1, last, up, (height - Real(0.5)) * up, 0, 0, 0);
  }
  return s;
}

// R12: each sweep reduces the heavy body's speed by the factor M/(M+m). Some resolvers sweep several times per
// iteration.
template <int D>
void convergesAsPredicted(const Subject<D>& on, Draw& draw) {
  const Real light = draw.real(1, 2), heavy = light * draw.real(1, 50);
  const auto before = heavyOnLight<D>(heavy, light);
  const auto speed = [&](int iterations) { return on.comes(before, iterations).motion(2).v[1]; };
  RC_PRE(speed(2) < 0 && speed(3) < 0);  // thrown up: see heavyIsNotThrownUp
  const Real sweeps = std::log(speed(3) / speed(2)) / std::log(heavy / (heavy + light));
  RC_LOG() << "an iteration is " << sweeps << " sweeps\n" << before;
  RC_ASSERT(std::abs(sweeps - std::round(sweeps)) <= (kDouble && on.dt == 0 ? Real(1e-9) : Real(1e-3)));
  RC_ASSERT(sweeps > Real(0.5));
}

// R18 with more than one contact: a falling body without restitution is not thrown up.
template <int D>
void heavyIsNotThrownUp(const Subject<D>& on, Draw& draw) {
  const auto before = heavyOnLight<D>(draw.real(1, 50), 1);
  const auto after = on.comes(before, 1 + draw.below(16));
  require<D>(after.motion(2).v[1], Real(1e-3), before, after);
}

// R6 of whole steps: if the first leaves no closing contact, the second changes no velocity, started cold or warm.
// Bodies that turn within 10 us change by up to `turning`.
template <int D>
void secondStepChangesNothing(const Subject<D>& on, Draw& draw) {
  const auto before = on.draw(draw, {.fixed = draw.coin(), .contacts = 3});
  const bool cold = draw.coin();
  RC_PRE(endIsNear(before, on.right(before, kMany), on));
  auto once = on.comes(before, on.many);
  RC_PRE(nothingOpenCloses(once));
  for (Manifold<D>& m : once.manifolds) {
    if (cold) m.points[0].impulse.fill(0);
  }
  const auto twice = on.comes(once, on.many);
  Real change = 0;
  for (int i = 0; i < once.bodies.size(); ++i) {
    change = std::max(
        {change, (twice.motion(i).v - once.motion(i).v).norm(), (twice.motion(i).w - once.motion(i).w).norm()});
  }
  require<D>(change, kConverged * 10 * before.speed() + on.turning(before), once, twice);
}

template <int D>
struct Named {
  const char* name;
  const char* ofJoints;  // the same property of joints: a failure declared of one is declared of the other
  void (*property)(const Subject<D>&, Draw&);
  std::vector<Bug> bugs;  // that the property must catch
};

template <int D>
std::vector<Named<D>> properties() {
  return {{"Impulse.OrderDoesNotMatter",
           "Joint.OrderDoesNotMatter",
           orderDoesNotMatter<D>,
           {Bug::givesUp, Bug::keepsFirstImpulse}},
          {"Impulse.MoreIsNoWorse", "Joint.MoreIsNoWorse", moreIsNoWorse<D>, {Bug::armsOfTheWorld, Bug::pulls}},
          {"Impulse.ConvergesAsPredicted", "Joint.ConvergesAsPredicted", convergesAsPredicted<D>, {Bug::yields}}};
}

template <int D>
auto drawn(const Named<D>& p, const Subject<D>& on) {
  return [&p, on] {
    RapidCheckDraw draw;
    p.property(on, draw);
  };
}

template <int D>
void testOne(const Registered& entry, const Spec& spec) {
  for (const Named<D>& p : properties<D>()) {
    const std::string name = std::string(p.name) + " " + spec.text() + " " + std::to_string(D) + "D";
    SCOPED_TRACE(name);
    const auto property =
        drawn<D>(p, {bySolving(registered<D>(entry, spec)), bySolving(twin<D>(Bug::none)), atMost(entry)});
    if (declares(entry, spec, p.name) || declares(entry, spec, p.ofJoints)) {
      expectFalsified(name, property, 10 * kRuns);  // some faults are rare; the first one ends the search
    } else {
      check(name, property, kRuns);
    }
  }
}

template <int D>
void testAll() {
  for (const Registered* entry : Registry::instance().list(StageKind::velocity, D)) {
    if (!competes(*entry)) continue;
    testOne<D>(*entry, {entry->info.name, {}});
    for (const std::string& manner : otherManners(*entry)) {
      testOne<D>(*entry, Spec::parse(entry->info.name + "{" + manner + "}"));
    }
  }
}

template <int D>
void plantedBugs() {
  for (const Named<D>& p : properties<D>()) {
    SCOPED_TRACE(p.name);
    const Subject<D> right{bySolving(twin<D>(Bug::none)), bySolving(twin<D>(Bug::none))};
    check(std::string(p.name) + " twin", drawn<D>(p, right), kRuns);
    for (std::size_t i = 0; i < p.bugs.size(); ++i) {
      expectFalsified(std::string(p.name) + " planted bug " + std::to_string(i + 1) + ' ' + std::to_string(D) + 'D',
                      drawn<D>(p, {bySolving(twin<D>(p.bugs[i])), right.right}), kRuns);
    }
  }
}

TEST(Convergence, EveryResolver2) { testAll<2>(); }
TEST(Convergence, EveryResolver3) { testAll<3>(); }
TEST(Convergence, PlantedBugsAreCaught2) { plantedBugs<2>(); }
TEST(Convergence, PlantedBugsAreCaught3) { plantedBugs<3>(); }

// --- Whole steps ---
// In f64 only: methods that move positions compute velocities by division by a part of this step.
constexpr Real kShort = Real(1e-5);
// Sweeps that start after springs have acted, or from a problem that turning has changed, take more than kMany.
constexpr int kSweeps = 4000;

template <int D>
Comes<D> byStepping(std::function<std::unique_ptr<Solver<D>>(int)> made) {
  return [made](ImpactScene<D> s, int iterations) {
    const auto solver = made(iterations);
    s.step(*solver);
    return s;
  };
}
template <int D>
Comes<D> twinStep(Bug bug) {
  return byStepping<D>([bug](int n) { return std::make_unique<TwinSolver<D>>(bug, n); });
}
template <int D>
Subject<D> ofSteps(Comes<D> comes, int many) {
  return {std::move(comes), bySolving(twin<D>(Bug::none)), 0, many, kShort};
}

template <int D>
std::vector<Named<D>> stepProperties() {
  return {{"Solver.OrderDoesNotMatter", "", orderDoesNotMatter<D>, {Bug::givesUp, Bug::keepsFirstImpulse}},
          {"Solver.MoreIsNoWorse", "", moreIsNoWorse<D>, {Bug::armsOfTheWorld, Bug::pulls}},
          {"Solver.ConvergesAsPredicted", "", convergesAsPredicted<D>, {Bug::yields}},
          {"Solver.HeavyIsNotThrownUp", "", heavyIsNotThrownUp<D>, {Bug::addsEnergy}},
          {"Solver.SecondStepChangesNothing", "", secondStepChangesNothing<D>, {Bug::hastens}}};
}

template <int D>
void testSolvers() {
  for (const Registered* entry : Registry::instance().list(StageKind::solver, D)) {
    const bool ofParts =
        std::any_of(entry->params.begin(), entry->params.end(), [](const ParamInfo& p) { return p.stage != nullptr; });
    if (!competes(*entry) || ofParts) continue;  // the resolver of a composed solver is tested alone
    const Subject<D> on = ofSteps<D>(
        byStepping<D>([entry](int n) { return createStage<Solver<D>>(withIterations(*entry, n, n)); }), kSweeps);
    for (const Named<D>& p : stepProperties<D>()) {
      const std::string name = std::string(p.name) + " " + entry->info.name + " " + std::to_string(D) + "D";
      SCOPED_TRACE(name);
      if (declares(*entry, {entry->info.name, {}}, p.name)) {
        expectFalsified(name, drawn<D>(p, on), 10 * kRuns);
      } else {
        check(name, drawn<D>(p, on), kRuns);
      }
    }
  }
}

template <int D>
void plantedBugsInSteps() {
  for (const Named<D>& p : stepProperties<D>()) {
    SCOPED_TRACE(p.name);
    check(std::string(p.name) + " twin", drawn<D>(p, ofSteps<D>(twinStep<D>(Bug::none), kSweeps)), kRuns);
    for (std::size_t i = 0; i < p.bugs.size(); ++i) {
      expectFalsified(std::string(p.name) + " planted bug " + std::to_string(i + 1) + ' ' + std::to_string(D) + 'D',
                      drawn<D>(p, ofSteps<D>(twinStep<D>(p.bugs[i]), kSweeps)), kRuns);
    }
  }
}

TEST(StepConvergence, EverySolver2) {
  if (!kDouble) GTEST_SKIP() << "in f64 only";
  testSolvers<2>();
}
TEST(StepConvergence, EverySolver3) {
  if (!kDouble) GTEST_SKIP() << "in f64 only";
  testSolvers<3>();
}
TEST(StepConvergence, PlantedBugsAreCaught2) {
  if (!kDouble) GTEST_SKIP() << "in f64 only";
  plantedBugsInSteps<2>();
}
TEST(StepConvergence, PlantedBugsAreCaught3) {
  if (!kDouble) GTEST_SKIP() << "in f64 only";
  plantedBugsInSteps<3>();
}

}  // namespace convergence_test
}}}  // namespace lpc::LPC_PRECISION::test
