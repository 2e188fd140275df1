// SPDX-License-Identifier: Zlib
// Laws of restitution, for solvers with a choice of them, and the Painleve rod for every solver: whole steps without a
// world.
#include <gtest/gtest.h>

#include "tests/check_property.h"
#include "tests/conformance/scene_change.h"
#include "tests/every_solver.h"
#include "tests/planted_bugs/solver_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace impact_law_test {

constexpr bool kDouble = sizeof(Real) == 8;

// A rod that touches the floor with its lower end, to the right of its centre.
template <int D>
ImpactScene<D> tiltedRod(Real half, Real mass, Real angle, const Vec<D>& v, Real mu, Real e) {
  ImpactScene<D> s;
  s.add(0, Ang<D>::Zero(), {});
  Vec<D> end = Vec<D>::Zero();
  end[0] = half * std::cos(angle), end[1] = -half * std::sin(angle);
  s.add(mass, Ang<D>::Constant(mass * half * half / 3), {-end, {}}, {v, Ang<D>::Zero()});
  s.touch(0, 1, Vec<D>::Unit(1), Vec<D>::Zero(), 0, mu, e);
  return s;
}

// R3 where Newton's law does not promise it. One case has several contacts with friction and different e. The other has
// the single contact of a rod that falls obliquely and starts to slide back during the impact (Kane and Levinson 1985).
template <int D>
void addsNoEnergy(const Step<D>& step, Draw& draw) {
  ImpactScene<D> before;
  if (draw.coin()) {
    const Vec<D> v = -draw.real(0.4, 0.6) * Vec<D>::Unit(0) - Vec<D>::Unit(1);
    before = tiltedRod<D>(Real(0.5), 1, draw.real(0.8, 0.95), v, draw.real(0.7, 1), draw.real(0.9, 1));
  } else {
    before =
        drawImpact<D>(draw, {.fixed = draw.coin(), .friction = true, .approaching = true, .joints = draw.below(2)});
    for (Manifold<D>& m : before.manifolds) m.restitution = draw.real(0, 1);
  }
  auto after = before;
  step(after);
  const Real gain = after.energy() - before.energy();
  require<D>(gain <= (kDouble ? Real(1e-9) : Real(1e-3)) * (1 + before.energy()), before, after, gain);
}

// A body that cannot turn, on a static one: normal and tangential motion are independent. It leaves with e v_n, and
// slides mu (1 + e) v_n slower, or stops sliding.
template <int D>
void rubsWhileItBounces(const Step<D>& step, Draw& draw) {
  ImpactScene<D> before;
  before.add(0, Ang<D>::Zero(), {});
  const Vec<D> n = drawDirection<D>(draw);
  const auto t = tangents(n);
  const Real fall = draw.real(0.5, 3), mu = draw.real(0, 1), e = draw.real(0, 1);
  RealMatrix<D - 1, 1> slide;
  for (int d = 0; d < D - 1; ++d) slide[d] = 3 * draw.signedUnit();
  before.add(draw.real(1, 5), Ang<D>::Zero(), {n, {}}, {t * slide - fall * n, Ang<D>::Zero()});
  before.touch(0, 1, n, Real(0.5) * n, 0, mu, e);
  auto after = before;
  step(after);
  const Real was = slide.norm(), is = std::max(was - mu * (1 + e) * fall, Real(0));
  const Vec<D> expected = e * fall * n + (was > 0 ? is / was : Real(0)) * (t * slide);
  const Real error = (after.motion(1).v - expected).norm();
  require<D>(error <= (kDouble ? Real(1e-9) : Real(1e-3)), before, after, error);
}

// R1, and R2 in a plane (see Solver.KeepsAngularMomentum).
template <int D>
void keepsMomenta(const Step<D>& step, Draw& draw) {
  auto before = drawImpact<D>(draw, {.friction = true, .approaching = true});
  for (Manifold<D>& m : before.manifolds) m.restitution = draw.real(0, 1);
  before.dt = Real(1e-4);
  auto after = before;
  step(after);
  const Real linear = (after.momentum() - before.momentum()).norm();
  const Real angular = D == 2 ? (after.angularMomentum() - before.angularMomentum()).norm() : Real(0);
  require<D>(linear <= (kDouble ? Real(1e-9) : Real(5e-3)) * before.speed(), before, after, linear);
  require<D>(angular <= Real(4e-3) * before.speed(), before, after, angular);
}

// A rod slides on its tip, with the tip ahead. For mu > 4/3 there are angles at which no forces can either keep the tip
// on the floor or let it lift off (Painleve 1895); impulses can. The result must be finite, without more energy.
template <int D>
void painleve(const Step<D>& step, Draw& draw) {
  const Real half = draw.real(0.2, 2), mass = draw.real(0.5, 5);
  const Real mu = draw.coin() ? Real(1.6) : draw.real(1.34, 4);
  const Real angle = draw.coin() ? Real(1.1071487177940904) : draw.real(0.8, 1.4);  // the first: mu = 4/3 is enough
  Vec<D> v = draw.real(0.5, 10) * Vec<D>::Unit(0);
  if (draw.coin()) v[1] = -draw.real(0, 1);
  auto before = tiltedRod<D>(half, mass, angle, v, mu, 0);
  before.field.gravity[1] = Real(-9.81);
  auto after = before;
  const auto energy = [&](const ImpactScene<D>& s) { return s.energy() + mass * Real(9.81) * s.pose(1).p[1]; };
  for (int i = 0; i < 3; ++i) {
    step(after);
    require<D>(after.finite(), before, after, 0);
    // The energy that an Euler step of free fall adds, and rounding.
    const Real fallen = mass * std::pow(Real(9.81) * before.dt, Real(2)) * static_cast<Real>(i + 1);
    const Real gain = energy(after) - energy(before);
    require<D>(gain <= fallen + (kDouble ? Real(1e-9) : Real(1e-3)) * (1 + energy(before)), before, after, gain);
  }
}

template <int D>
struct Named {
  const char* name;
  void (*property)(const Step<D>&, Draw&);
  Step<D> bug;
  bool ofAll;  // false: of solvers with a choice of laws only
};

// Poisson's law with one change.
template <int D>
Step<D> spoilt(const std::function<void(ImpactScene<D>&)>& spoil) {
  const std::shared_ptr<Solver<D>> solver = createStage<Solver<D>>(Spec::parse("split_solver{impact=poisson}"));
  return [=](ImpactScene<D>& s) { spoil(s), s.step(*solver); };
}
template <int D>
Step<D> spoiledStep(Bug bug) {
  const auto solver = std::make_shared<TwinSolver<D>>(bug, 5);
  return [=](ImpactScene<D>& s) { s.step(*solver); };
}

template <int D>
std::vector<Named<D>> properties() {
  const auto givesBackTooMuch = spoilt<D>([](ImpactScene<D>& s) {
    for (Manifold<D>& m : s.manifolds) m.restitution = Real(1.5);
  });
  const auto forgetsFriction = spoilt<D>([](ImpactScene<D>& s) { s.model.friction = false; });
  return {{"Impact.AddsNoEnergy", addsNoEnergy<D>, givesBackTooMuch, false},
          {"Impact.RubsWhileItBounces", rubsWhileItBounces<D>, forgetsFriction, false},
          {"Impact.KeepsMomenta", keepsMomenta<D>, spoiledStep<D>(Bug::oneBodyOnly), false},
          {"Painleve.AddsNoEnergy", painleve<D>, spoiledStep<D>(Bug::frictionForward), true}};
}

constexpr int kRuns = 25;  // cases of each property, and of each planted bug

/// Is the law of impacts one of those designed to avoid the faults of the default?
bool hasOtherLaw(const std::string& spec) {
  const Spec parsed = Spec::parse(spec);
  const Spec* law = parsed.find("impact");
  return law && law->name != "newton";
}
template <int D>
bool hasLaws(const std::string& spec) {
  const Spec parsed = Spec::parse(spec);
  const auto& params = Registry::instance().find(StageKind::solver, D, parsed.name).params;
  const bool choice = std::any_of(params.begin(), params.end(), [](const ParamInfo& p) { return p.name == "impact"; });
  return choice && (parsed.find("impact") || parsed == Spec{parsed.name, {}});
}

template <int D>
void testAll() {
  for (const std::string& text : everySolver<D>()) {
    const auto solver = createStage<Solver<D>>(Spec::parse(text));
    for (const Named<D>& p : properties<D>()) {
      if (!p.ofAll && !hasLaws<D>(text)) continue;
      const std::string name = std::string(p.name) + " " + text + " " + std::to_string(D) + "D";
      SCOPED_TRACE(name);
      const auto run = [&] {
        RapidCheckDraw draw;
        p.property([&](ImpactScene<D>& s) { s.step(*solver); }, draw);
      };
      if (declares<D>(text, p.name) && !hasOtherLaw(text)) {
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
    expectFalsified(
        std::string(p.name) + " planted bug",
        [&] {
          RapidCheckDraw draw;
          p.property(p.bug, draw);
        },
        kRuns);
  }
}

TEST(ImpactLaws, EverySolver2) { testAll<2>(); }
TEST(ImpactLaws, EverySolver3) { testAll<3>(); }
TEST(ImpactLaws, PlantedBugsAreCaught2) { plantedBugs<2>(); }
TEST(ImpactLaws, PlantedBugsAreCaught3) { plantedBugs<3>(); }

// Limits that end an impact early are counted. Two balls hit three touching balls: the middle pair collides twice.
TEST(ImpactLaws, LimitsAreCounted) {
  const auto limits = [](const std::string& text) {
    ImpactScene<2> s;
    for (int i = 0; i < 5; ++i) {
      s.add(1, Ang<2>::Ones(), {static_cast<Real>(i) * Vec<2>::Unit(0), {}},
            {Vec<2>(i < 2 ? 1 : 0, 0), Ang<2>::Zero()});
      if (i > 0) s.touch(i - 1, i, Vec<2>::Unit(0), (static_cast<Real>(i) - Real(0.5)) * Vec<2>::Unit(0), 0, 0, 1);
    }
    s.step(*createStage<Solver<2>>(Spec::parse(text)));
    return s.work[WorkCount::impactLimits];
  };
  EXPECT_EQ(limits("split_solver{impact=poisson}"), 0u);
  EXPECT_GT(limits("split_solver{impact=poisson,impact_limit=5}"), 0u);
  EXPECT_EQ(limits("split_solver{impact=sequential}"), 0u);
  EXPECT_GT(limits("split_solver{impact=sequential,impact_limit=1}"), 0u);
}

}  // namespace impact_law_test
}}}  // namespace lpc::LPC_PRECISION::test
