// SPDX-License-Identifier: Zlib
// Every position resolver inside split_solver, and every solver without one, without gravity: errors shrink, no speed
// remains (R15), static bodies stay. A failure that info().failures declares must be observed.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/check_property.h"
#include "tests/conformance/scene_change.h"
#include "tests/every_solver.h"
#include "tests/planted_bugs/solver_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace position_test {

constexpr int kSteps = 60;
constexpr Real kRounding = sizeof(Real) == 8 ? Real(1e-13) : Real(1e-4);  // kg m^2/s, of about 10

// Two resting bodies that overlap in one point.
template <int D>
ImpactScene<D> overlap(Draw& draw, bool fixed) {
  ImpactScene<D> s;
  const Ang<D> inertia = Ang<D>::Constant(draw.real(0.3, 1));
  s.add(fixed ? Real(0) : draw.real(1, 5), inertia, {Vec<D>::Zero(), drawRotation<D>(draw)});
  s.add(draw.real(1, 5), inertia, {Vec<D>::Unit(0), drawRotation<D>(draw)});
  const Vec<D> p = Vec<D>::Unit(0) / 2 + Real(0.3) * drawVector<D>(draw);
  s.touch(0, 1, drawDirection<D>(draw), p, -draw.real(0.02, 0.1), 0, 0);
  return s;
}

template <int D>
Real deepest(const ImpactScene<D>& s) {
  Real depth = 0;
  for (const Manifold<D>& m : s.manifolds) {
    for (int k = 0; k < m.count; ++k) depth = std::max(depth, -m.points[static_cast<std::size_t>(k)].separation);
  }
  return depth;
}

template <int D>
void errorShrinks(const Step<D>& step, Draw& draw) {
  const auto before = overlap<D>(draw, draw.coin());
  auto after = before;
  for (int i = 0; i < kSteps; ++i) step(after);
  // The depth shrinks to the slop, without throwing the bodies apart: they separate by no more than the initial depth.
  const Real depth = -after.manifolds[0].points[0].separation;
  require<D>(depth <= kLinearSlop * Real(1.1), before, after, depth);
}

template <int D>
void addsNoVelocity(const Step<D>& step, Draw& draw) {
  const auto before = overlap<D>(draw, draw.coin());
  auto after = before;
  for (int i = 0; i < kSteps; ++i) step(after);
  require<D>(after.energy() <= kEps, before, after, after.energy());
}

template <int D>
void endsInTouch(const Step<D>& step, Draw& draw) {
  const auto before = overlap<D>(draw, draw.coin());
  auto after = before;
  for (int i = 0; i < kSteps; ++i) step(after);
  const Real gap = after.manifolds[0].points[0].separation;
  require<D>(gap <= std::numeric_limits<Real>::epsilon(), before, after, gap);  // but for the rounding of positions
}

template <int D>
void turnsPinnedBodies(const Step<D>& step, Draw& draw) {
  auto before = overlap<D>(draw, false);
  for (std::size_t i = 0; i < 2; ++i) before.bodies.pinned[i] = 1, before.bodies.invMass[i] = 0;
  // An arm along the normal could not turn out of the contact.
  const Manifold<D>& m = before.manifolds[0];
  const Vec<D> r = before.pose(1).q * m.points[0].localB;
  RC_PRE((r - r.dot(m.normal) * m.normal).norm() > 6 * deepest(before));
  auto after = before;
  for (int i = 0; i < kSteps / 3; ++i) step(after);  // Baumgarte's bodies keep turning
  require<D>(deepest(after) < Real(0.6) * deepest(before), before, after, deepest(after));
  require<D>(after.pose(0).p == before.pose(0).p && after.pose(1).p == before.pose(1).p, before, after, 0);
}

template <int D>
void fixedBodiesStay(const Step<D>& step, Draw& draw) {
  auto before = overlap<D>(draw, true);
  before.join(0, 1, Vec<D>::Unit(0) / 2, Real(0.01) * drawVector<D>(draw));
  auto after = before;
  for (int i = 0; i < 5; ++i) step(after);
  const bool same = after.pose(0).p == before.pose(0).p && after.pose(0).q.matrix() == before.pose(0).q.matrix() &&
                    after.motion(0).v.isZero(0);
  require<D>(same, before, after, 0);
}

template <int D>
void jointErrorShrinks(const Step<D>& step, Draw& draw) {
  ImpactScene<D> before;
  const Ang<D> inertia = Ang<D>::Constant(draw.real(0.3, 1));
  before.add(draw.coin() ? Real(0) : draw.real(1, 5), inertia, {Vec<D>::Zero(), drawRotation<D>(draw)});
  before.add(draw.real(1, 5), inertia, {Vec<D>::Unit(0), drawRotation<D>(draw)});
  before.join(0, 1, drawVector<D>(draw), Real(0.05) * drawDirection<D>(draw));
  auto after = before;
  for (int i = 0; i < kSteps; ++i) step(after);
  const auto error = static_cast<Real>(after.jointError(after.joints[0]).linear);
  require<D>(error < Real(0.002), before, after, error);
}

// A correction that moves translating bodies also moves the points about which their momenta act.
template <int D>
void keepsAngularMomentum(const Step<D>& step, Draw& draw) {
  auto before = overlap<D>(draw, false);
  for (Motion<D>& motion : before.bodies.motion) motion.v = drawVector<D>(draw);
  auto after = before;
  step(after);
  const Real change = (after.angularMomentum() - before.angularMomentum()).norm();
  require<D>(change <= kRounding, before, after, change);
}

template <int D>
struct Named {
  const char* name;
  std::function<void(const Step<D>&, Draw&)> property;
};

template <int D>
std::vector<Named<D>> properties() {
  return {{"PositionError.Shrinks", errorShrinks<D>},
          {"PositionError.AddsNoVelocity", addsNoVelocity<D>},
          {"PositionError.EndsInTouch", endsInTouch<D>},
          {"PositionError.TurnsPinnedBodies", turnsPinnedBodies<D>},
          {"PositionError.FixedBodiesStay", fixedBodiesStay<D>},
          {"JointError.Shrinks", jointErrorShrinks<D>}};
}

constexpr int kRuns = 40;  // cases of each property, and of each planted bug

template <int D>
void testAll() {
  int subjects = 0;
  for (const std::string& spec : everySolver<D>()) {
    // Every position resolver, and every solver without one.
    if (spec.starts_with("split_solver") && spec.find("{position=") == spec.npos) continue;
    ++subjects;
    const auto solver = createStage<Solver<D>>(Spec::parse(spec));
    for (const Named<D>& p : properties<D>()) {
      const std::string name = std::string(p.name) + " " + spec + " " + std::to_string(D) + "D";
      SCOPED_TRACE(name);
      const auto run = [&] {
        RapidCheckDraw draw;
        p.property([&](ImpactScene<D>& s) { s.step(*solver); }, draw);
      };
      if (declares<D>(spec, p.name)) {
        expectFalsified(name, run, kRuns);
      } else {
        check(name, run, kRuns);
      }
    }
  }
  ASSERT_GE(subjects, 6);
}

// Planted resolvers run alone, without a velocity resolver.
template <int D>
Step<D> alone(PositionResolver<D>& twin) {
  return [&twin](ImpactScene<D>& s) {
    twin.correct({s.dt, s.bodies, s.manifolds, s.active, s.joints, s.model, s.work, s.profiler});
    for (Manifold<D>& m : s.manifolds) {
      ContactPoint<D>& c = m.points[0];
      c.separation = separationNow(m, c, s.pose(m.bodyA), s.pose(m.bodyB));
    }
  };
}

// Resolvers alone; solver_test.cpp checks the momenta of whole steps.
template <int D>
void momentaStay() {
  for (const Registered* entry : Registry::instance().list(StageKind::position, D)) {
    if (!competes(*entry)) continue;
    const auto resolver = createStage<PositionResolver<D>>({entry->info.name, {}});
    const std::string property = "PositionError.KeepsAngularMomentum";
    const std::string name = property + " " + entry->info.name + " " + std::to_string(D) + "D";
    const Step<D> step = alone<D>(*resolver);
    const auto run = [&] {
      RapidCheckDraw draw;
      keepsAngularMomentum<D>(step, draw);
    };
    if (declares(*entry, {entry->info.name, {}}, property)) {
      expectFalsified(name, run, kRuns);
    } else {
      check(name, run, kRuns);
    }
  }
}

template <int D>
void plantedBugs() {
  PushesTheWrongBody<D> wrongBody;
  WrongSign<D> wrongSign;
  const auto caught = [](const char* name, const auto& property, PositionResolver<D>& twin) {
    const Step<D> step = alone<D>(twin);
    expectFalsified(
        name,
        [&] {
          RapidCheckDraw draw;
          property(step, draw);
        },
        kRuns);
  };
  caught("shrinks, wrong sign", errorShrinks<D>, wrongSign);
  caught("joint shrinks, wrong sign", jointErrorShrinks<D>, wrongSign);
  caught("fixed stays, wrong body", fixedBodiesStay<D>, wrongBody);
  caught("pinned turns, wrong body", turnsPinnedBodies<D>, wrongBody);
  // Baumgarte leaves velocity, and all methods that move bodies change angular momentum. The methods declare these
  // failures, which serve as the planted bugs of these properties.
}

TEST(PositionConformance, EveryResolver2) { testAll<2>(); }
TEST(PositionConformance, EveryResolver3) { testAll<3>(); }
TEST(PositionConformance, MomentaStay2) { momentaStay<2>(); }
TEST(PositionConformance, MomentaStay3) { momentaStay<3>(); }
TEST(PositionConformance, PlantedBugsAreCaught2) { plantedBugs<2>(); }
TEST(PositionConformance, PlantedBugsAreCaught3) { plantedBugs<3>(); }

// `factor` is the share of the depth beyond the slop that a step removes, for one contact through both centres.
template <int D>
double depthAfterAStep(const std::string& position, double factor, double depth) {
  ImpactScene<D> s;
  s.add(2, Ang<D>::Constant(Real(0.5)), {Vec<D>::Zero(), {}});
  s.add(3, Ang<D>::Constant(Real(0.5)), {Vec<D>::Unit(0), {}});
  s.touch(0, 1, Vec<D>::Unit(0), Vec<D>::Unit(0) / 2, static_cast<Real>(-depth), 0, 0);
  s.step(*createStage<Solver<D>>(
      Spec::parse("split_solver{position=" + position + "{factor=" + std::to_string(factor) + "}}")));
  return -double(s.manifolds[0].points[0].separation);
}
template <int D>
void removesItsShare() {
  constexpr double kDepth = 0.05, kRelative = sizeof(Real) == 8 ? 1e-9 : 1e-4, kSlop = double(kLinearSlop);
  for (const char* position : {"linear", "split_impulse", "baumgarte"}) {
    for (double factor : {0.25, 0.5, 1.0}) {
      EXPECT_NEAR(depthAfterAStep<D>(position, factor, kDepth), kDepth - factor * (kDepth - kSlop), kRelative * kDepth)
          << position << " " << factor;
    }
  }
  // Planted bug: the share of the whole depth, including the slop.
  EXPECT_GT(std::abs(depthAfterAStep<D>("linear", 0.5, kDepth) - 0.5 * kDepth), 0.1 * kSlop);
}
TEST(PositionConformance, FactorIsTheShareRemoved) { removesItsShare<2>(), removesItsShare<3>(); }

TEST(PositionConformance, NonlinearsSearchesAgree) {
  const auto scan = createStage<Solver<3>>(Spec::parse("split_solver{position=nonlinear{search=scan}}"));
  const auto tree = createStage<Solver<3>>(Spec::parse("split_solver{position=nonlinear{search=tree}}"));
  check("scan = tree, positions", [&] {
    RapidCheckDraw draw;
    auto a = drawImpact<3>(draw, {.fixed = true, .gap = Real(0.2), .joints = 1});
    auto b = a;
    a.step(*scan), b.step(*tree);
    for (int i = 0; i < a.bodies.size(); ++i) {
      RC_ASSERT(a.pose(i).p == b.pose(i).p);
      RC_ASSERT(a.pose(i).q.matrix() == b.pose(i).q.matrix());
    }
  });
}

}  // namespace position_test
}}}  // namespace lpc::LPC_PRECISION::test
