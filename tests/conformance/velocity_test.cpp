// SPDX-License-Identifier: Zlib
// Every registered velocity resolver, in both dimensions, on drawn sets of contacts and joints. A failure that
// info().failures declares must be observed.
#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "tests/check_property.h"
#include "tests/conformance/scene_change.h"
#include "tests/every_solver.h"
#include "tests/planted_bugs/solver_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace velocity_test {

// Rounding of one solve over a few contacts, relative to the speeds in it.
constexpr Real kTolerance = sizeof(Real) == 8 ? Real(1e-11) : Real(2e-4);
// Residual after many sweeps.
constexpr Real kConverged = sizeof(Real) == 8 ? Real(1e-6) : Real(2e-3);

// A resolver with its defaults, and one with so many iterations that only its principle matters.
template <int D>
struct Subject {
  std::unique_ptr<VelocityResolver<D>> normal, patient;
};

template <int D>
using Property = std::function<void(VelocityResolver<D>&, VelocityResolver<D>&, Draw&)>;

template <int D>
void keepsLinearMomentum(VelocityResolver<D>& r, VelocityResolver<D>&, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.friction = true, .restitution = Real(0.3), .gap = Real(0.1), .joints = 2});
  const auto after = solved(before, r);
  const Real error = (after.momentum() - before.momentum()).norm();
  require<D>(error <= kTolerance * 20 * before.speed(), before, after, error);
}

template <int D>
void keepsAngularMomentum(VelocityResolver<D>& r, VelocityResolver<D>&, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.friction = true, .restitution = Real(0.3), .gap = Real(0.1), .joints = 2});
  const auto after = solved(before, r);
  const Real error = (after.angularMomentum() - before.angularMomentum()).norm();
  require<D>(error <= kTolerance * 100 * before.speed(), before, after, error);
}

template <int D>
void elasticKeepsEnergy(VelocityResolver<D>& r, VelocityResolver<D>&, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.restitution = 1, .approaching = true, .contacts = 1});
  const Manifold<D>& m = before.manifolds[0];
  RC_PRE(before.contactVelocity(m, m.points[0]).dot(m.normal) < -Real(0.21));
  const auto after = solved(before, r);
  const Real error = after.energy() - before.energy();
  require<D>(std::abs(error) <= kTolerance * 100 * before.energy(), before, after, error);
}

// With several contacts, Newton's law with restitution guarantees this only if all of them are closing. With friction
// it does so only without restitution (Kane's paradox).
template <int D>
void addsNoEnergy(VelocityResolver<D>&, VelocityResolver<D>& patient, Draw& draw) {
  const bool friction = draw.coin();
  const Real e = friction ? Real(0) : draw.real(0, 1);
  const auto before =
      drawImpact<D>(draw, {.fixed = draw.coin(), .friction = friction, .restitution = e, .approaching = true});
  const auto after = solved(before, patient);
  const Real gain = after.energy() - before.energy();
  require<D>(gain <= kConverged * (1 + before.energy()), before, after, gain);
}

template <int D>
void staysInTheCone(VelocityResolver<D>& r, VelocityResolver<D>&, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.fixed = draw.coin(),
                                           .friction = true,
                                           .restitution = draw.real(0, 1),
                                           .gap = Real(0.1),
                                           .joints = draw.below(2)});
  const auto after = solved(before, r);
  for (const Manifold<D>& m : after.manifolds) {
    const auto& impulse = m.points[0].impulse;
    Real sideways = 0;
    for (std::size_t d = 1; d < D; ++d) sideways += impulse[d] * impulse[d];
    sideways = std::sqrt(sideways);
    require<D>(impulse[0] >= 0, before, after, impulse[0]);
    const Real excess = sideways - m.friction * impulse[0];
    require<D>(excess <= kTolerance * (1 + impulse[0]), before, after, excess);
  }
}

template <int D>
void opposesSliding(VelocityResolver<D>& r, VelocityResolver<D>&, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.fixed = draw.coin(), .friction = true, .approaching = true, .contacts = 1});
  const auto after = solved(before, r);
  const Manifold<D>& m = after.manifolds[0];
  const Vec<D> v = after.contactVelocity(m, m.points[0]);
  Real power = 0;
  for (int d = 0; d < D - 1; ++d) {
    power += m.points[0].impulse[static_cast<std::size_t>(d) + 1] * v.dot(tangents(m.normal).col(d));
  }
  require<D>(power <= kConverged * before.speed() * before.speed(), before, after, power);
}

template <int D>
void inelasticStops(VelocityResolver<D>&, VelocityResolver<D>& patient, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.fixed = draw.coin(), .approaching = true, .contacts = 1});
  const auto after = solved(before, patient);
  const Manifold<D>& m = after.manifolds[0];
  const Real v = after.contactVelocity(m, m.points[0]).dot(m.normal);
  require<D>(std::abs(v) <= kTolerance * 100, before, after, v);
}

template <int D>
void takesBack(VelocityResolver<D>&, VelocityResolver<D>& patient, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.approaching = true});
  // The closer the directions of two contacts of one pair, the slower sweeps distinguish them: such pairs need more
  // sweeps than `patient` has.
  for (const Manifold<D>& m : before.manifolds) {
    for (const Manifold<D>& o : before.manifolds) {
      const bool pair = &m != &o && m.bodyA == o.bodyA && m.bodyB == o.bodyB;
      RC_PRE(!pair || std::abs(m.normal.dot(o.normal)) < Real(0.99));
    }
  }
  const auto after = solved(before, patient);
  for (const Manifold<D>& m : after.manifolds) {
    const Real v = after.contactVelocity(m, m.points[0]).dot(m.normal);
    require<D>(v >= -kConverged * 100 * before.speed(), before, after, v);
    const Real residual = std::min(v, m.points[0].impulse[0]);
    require<D>(residual <= kConverged * 100 * before.speed(), before, after, residual);
  }
}

template <int D>
void secondSolveChangesNothing(VelocityResolver<D>&, VelocityResolver<D>& patient, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.fixed = draw.coin(), .contacts = 3});
  auto once = solved(before, patient);
  for (const Manifold<D>& m : once.manifolds) {  // contacts that are not yet solved may still change
    RC_PRE(once.contactVelocity(m, m.points[0]).dot(m.normal) > -kConverged / 1000);
  }
  for (Manifold<D>& m : once.manifolds) m.points[0].impulse.fill(0);
  for (JointRecord<D>& j : once.joints) j.impulse.fill(0);
  const auto twice = solved(once, patient);
  Real change = 0;
  for (int i = 0; i < once.bodies.size(); ++i) change = std::max(change, (twice.motion(i).v - once.motion(i).v).norm());
  require<D>(change <= kConverged * 10 * before.speed(), before, twice, change);
}

template <int D>
void turnsWithTheFrame(VelocityResolver<D>&, VelocityResolver<D>& patient, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.fixed = draw.coin(), .friction = true, .contacts = 2});
  const Pose<D> X{drawVector<D>(draw), drawRotation<D>(draw)};
  const Vec<D> boost = drawVector<D>(draw);
  const auto here = solved(before, patient), there = solved(moved(before, X, boost), patient);
  Real error = 0;
  for (int i = 0; i < here.bodies.size(); ++i) {
    error = std::max(error, (X.q * (here.motion(i).v + boost) - there.motion(i).v).norm());
  }
  require<D>(error <= kConverged * 20 * before.speed(), before, there, error);
}

template <int D>
void fixedBodiesStay(VelocityResolver<D>& r, VelocityResolver<D>&, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.fixed = true, .friction = true, .restitution = Real(0.5), .joints = 1});
  const auto after = solved(before, r);
  require<D>(after.motion(0).v == before.motion(0).v && after.motion(0).w == before.motion(0).w, before, after, 0);
}

// Momentum comes from other bodies or from the one of infinite mass: the impulses of its contacts sum to the change of
// momentum.
template <int D>
void groundGivesTheMomentum(VelocityResolver<D>& r, VelocityResolver<D>&, Draw& draw) {
  const auto before =
      drawImpact<D>(draw, {.fixed = true, .friction = true, .restitution = Real(0.3), .gap = Real(0.1), .contacts = 8});
  const auto after = solved(before, r);
  Vec<D> given = Vec<D>::Zero();
  for (const Manifold<D>& m : after.manifolds) {
    if (m.bodyA != 0) continue;
    const auto& impulse = m.points[0].impulse;
    given += impulse[0] * m.normal;
    for (int d = 0; d < D - 1; ++d) given += impulse[static_cast<std::size_t>(d) + 1] * tangents(m.normal).col(d);
  }
  const Real error = (after.momentum() - before.momentum() - given).norm();
  require<D>(error <= kTolerance * 20 * before.speed(), before, after, error);
}

template <int D>
void jointsStopDrifting(VelocityResolver<D>&, VelocityResolver<D>& patient, Draw& draw) {
  const auto before = drawImpact<D>(draw, {.fixed = draw.coin(), .joints = 2, .contacts = 0});
  RC_PRE(before.joints[0].bodyA != before.joints[1].bodyA || before.joints[0].bodyB != before.joints[1].bodyB);
  const auto after = solved(before, patient);
  for (const JointRecord<D>& j : after.joints) {
    const Real v = after.jointVelocity(j);
    require<D>(v <= kConverged * 100 * before.speed(), before, after, v);
  }
}

template <int D>
void degenerateIsFinite(VelocityResolver<D>& r, VelocityResolver<D>& patient, Draw& draw) {
  auto s = drawImpact<D>(draw, {.fixed = true, .friction = true, .restitution = 1, .gap = Real(0.2), .joints = 2});
  for (Manifold<D>& m : s.manifolds) m.friction = draw.pick({Real(0), Real(1e6)});
  for (int i = 1; i < s.bodies.size(); ++i) {  // bodies that cannot move, cannot turn, or are nearly weightless
    const auto k = static_cast<std::size_t>(i);
    const int what = draw.below(5);
    if (what == 1 || what == 3) s.bodies.invMass[k] = 0;
    if (what == 2 || what == 3) s.bodies.invInertia[k].setZero();
    if (what == 4) s.bodies.invMass[k] *= Real(1e6);
  }
  if (draw.coin()) {  // several points at one place, at the centre of a body
    for (Manifold<D>& m : s.manifolds) {
      m.points[0].localA.setZero(), m.points[0].localB.setZero();
      m.points[0].separation = s.pose(m.bodyB).p == s.pose(m.bodyA).p ? Real(0) : m.points[0].separation;
      m.points[1] = m.points[0], m.count = 2;
    }
  }
  const auto once = solved(s, r), often = solved(s, patient);
  require<D>(once.finite(), s, once, 0);
  require<D>(often.finite(), s, often, 0);
}

// A light body on the ground carries a heavy one: both contacts must carry the weight above them, within one per cent.
template <int D>
void carriesHeavyOnLight(VelocityResolver<D>& r, VelocityResolver<D>&, Draw& draw) {
  const Real ratio = draw.real(80, 120);
  ImpactScene<D> before;
  before.add(0, Ang<D>::Zero(), {});
  const Vec<D> up = Vec<D>::Unit(1);
  for (int i = 1; i <= 2; ++i) {
    const auto height = static_cast<Real>(i);
    before.add(i == 1 ? Real(1) : ratio, Ang<D>::Ones(), {height * up, {}}, {-up, Ang<D>::Zero()});
    before.touch(i - 1, i, up, (height - Real(0.5)) * up, 0, 0, 0);
  }
  const auto after = solved(before, r);
  for (std::size_t i = 0; i < 2; ++i) {
    const Real weight = i == 0 ? 1 + ratio : ratio;
    const Real error = after.manifolds[i].points[0].impulse[0] / weight - 1;
    require<D>(std::abs(error) <= Real(0.01), before, after, error);
  }
}

template <int D>
struct Named {
  const char* name;
  Property<D> property;
  Bug bug;              // that the property must catch
  int iterations = 10;  // that a correct solver needs
};

template <int D>
std::vector<Named<D>> properties() {
  return {{"Impulse.KeepsLinearMomentum", keepsLinearMomentum<D>, Bug::oneBodyOnly},
          {"Impulse.KeepsAngularMomentum", keepsAngularMomentum<D>, Bug::twoPoints},
          {"Impulse.ElasticKeepsEnergy", elasticKeepsEnergy<D>, Bug::addsEnergy},
          {"Impulse.AddsNoEnergy", addsNoEnergy<D>, Bug::addsEnergy},
          {"Impulse.StaysInTheCone", staysInTheCone<D>, Bug::frictionUnbounded},
          {"Impulse.PushesOnly", staysInTheCone<D>, Bug::pulls},
          {"Impulse.OpposesSliding", opposesSliding<D>, Bug::frictionForward},
          {"Impulse.InelasticStops", inelasticStops<D>, Bug::addsEnergy},
          {"Accumulation.TakesBack", takesBack<D>, Bug::keepsFirstImpulse},
          {"Impulse.SecondSolveChangesNothing", secondSolveChangesNothing<D>, Bug::hastens},
          {"Impulse.TurnsWithTheFrame", turnsWithTheFrame<D>, D == 3 ? Bug::squareFriction : Bug::slowsInTheWorld},
          {"Impulse.FixedBodiesStay", fixedBodiesStay<D>, Bug::movesFixed},
          {"Impulse.GroundGivesTheMomentum", groundGivesTheMomentum<D>, Bug::oneBodyOnly},
          {"Impulse.JointsStopDrifting", jointsStopDrifting<D>, Bug::stopsEarly},
          {"Impulse.CarriesHeavyOnLight", carriesHeavyOnLight<D>, Bug::givesUp, 2000},
          {"Impulse.DegenerateIsFinite", degenerateIsFinite<D>, Bug::dividesByNothing}};
}

template <int D>
class VelocityConformance : public testing::Test {};

constexpr int kRuns = 60;  // cases of each property, and of each planted bug

template <int D>
void testOne(const Registered& entry, const Spec& spec) {
  Spec often = withIterations(entry, 2000, 500);
  for (const auto& [key, value] : spec.fields) often.set(key, value);
  const auto normal = createStage<VelocityResolver<D>>(spec);
  const auto patient = createStage<VelocityResolver<D>>(often);
  for (const Named<D>& p : properties<D>()) {
    const std::string name = std::string(p.name) + " " + spec.text() + " " + std::to_string(D) + "D";
    SCOPED_TRACE(name);
    const auto run = [&] {
      RapidCheckDraw draw;
      p.property(*normal, *patient, draw);
    };
    if (declares(entry, spec, p.name)) {
      expectFalsified(name, run, 10 * kRuns);  // some faults are rare; the first one ends the search
    } else {
      check(name, run, kRuns);
    }
  }
}

template <int D>
void testAll() {
  const auto entries = Registry::instance().list(StageKind::velocity, D);
  ASSERT_GE(entries.size(), 3u);
  for (const Registered* entry : entries) {
    if (!competes(*entry)) continue;
    testOne<D>(*entry, {entry->info.name, {}});
    for (const std::string& manner : otherManners(*entry)) {
      testOne<D>(*entry, Spec::parse(entry->info.name + "{" + manner + "}"));
    }
  }
}

template <int D>
void plantedBugs() {
  TwinResolver<D> rightPatient(Bug::none, 600);
  for (const Named<D>& p : properties<D>()) {
    SCOPED_TRACE(p.name);
    TwinResolver<D> right(Bug::none, p.iterations);
    check(
        std::string(p.name) + " twin",
        [&] {
          RapidCheckDraw draw;
          p.property(right, rightPatient, draw);
        },
        30);
    TwinResolver<D> wrong(p.bug, p.iterations), wrongPatient(p.bug, 600);
    expectFalsified(
        std::string(p.name) + " planted bug",
        [&] {
          RapidCheckDraw draw;
          p.property(wrong, wrongPatient, draw);
        },
        kRuns);
  }
}

TEST(VelocityConformance, EveryResolver2) { testAll<2>(); }
TEST(VelocityConformance, EveryResolver3) { testAll<3>(); }
TEST(VelocityConformance, PlantedBugsAreCaught2) { plantedBugs<2>(); }
TEST(VelocityConformance, PlantedBugsAreCaught3) { plantedBugs<3>(); }

// An impulse is a force times dt: half the step needs half the impulse.
TEST(VelocityConformance, WarmStartScalesWithTheStep) {
  ImpactScene<2> s;
  s.add(0, Ang<2>::Zero(), {});
  s.add(2, Ang<2>::Constant(1), {{0, 1}, {}});
  s.touch(0, 1, {0, 1}, {0, Real(0.5)}, 0, 0, 0);
  s.manifolds[0].points[0].impulse[0] = 4;
  s.lastDt = 2 * s.dt;
  const auto resolver = createStage<VelocityResolver<2>>(Spec::parse("catto{iterations=0,warm_factor=0.5}"));
  const auto after = solved(s, *resolver);
  EXPECT_NEAR(after.motion(1).v[1], 4 * 0.5 * 0.5 / 2, 1e-6);
  const auto cold = createStage<VelocityResolver<2>>(Spec::parse("catto{iterations=0,warm_start=false}"));
  EXPECT_EQ(solved(s, *cold).motion(1).v[1], 0);
}

// Both searches for the worst contact must give the same bits.
TEST(VelocityConformance, MillingtonsSearchesAgree) {
  const auto scan = createStage<VelocityResolver<3>>(Spec::parse("millington{search=scan}"));
  const auto tree = createStage<VelocityResolver<3>>(Spec::parse("millington{search=tree}"));
  check("scan = tree", [&] {
    RapidCheckDraw draw;
    const auto before = drawImpact<3>(draw, {.fixed = true, .friction = true, .restitution = Real(0.4)});
    const auto a = solved(before, *scan), b = solved(before, *tree);
    for (int i = 0; i < a.bodies.size(); ++i) {
      RC_ASSERT(a.motion(i).v == b.motion(i).v);
      RC_ASSERT(a.motion(i).w == b.motion(i).w);
    }
  });
}

// A body lands on its face. Three sweeps of blocks must give the result of three thousand sweeps of single points. The
// same holds with four corners in a plane, where the distribution of load is not unique.
template <int D>
void blocksAreSolvedAtOnce(const std::string& few) {
  const auto block = createStage<VelocityResolver<D>>(Spec::parse(few));
  const auto single = createStage<VelocityResolver<D>>(Spec::parse("catto{iterations=3000}"));
  RapidCheckDraw draw;
  ImpactScene<D> s;
  s.add(0, Ang<D>::Zero(), {});
  Motion<D> motion{3 * drawVector<D>(draw), {}};
  for (int k = 0; k < kAngDim<D>; ++k) motion.w[k] = 3 * draw.signedUnit();
  s.add(draw.real(1, 5), Ang<D>::Constant(draw.real(0.2, 1)), {Vec<D>::Unit(1), {}}, motion);
  const Vec<D> n = (Vec<D>::Unit(1) + Real(0.2) * drawVector<D>(draw)).normalized();
  const auto t = tangents(n);
  for (int i = 0; i < kManifoldPoints<D>; ++i) {
    Vec<D> p = Vec<D>::Unit(1) / 2;
    for (int d = 0; d < D - 1; ++d) p += ((i >> d) % 2 == 0 ? Real(1) : Real(-1)) * draw.real(0.3, 0.6) * t.col(d);
    if (i == 0) s.touch(0, 1, n, p, 0, 0, 0);
    if (i > 0) s.addPoint(s.manifolds[0], p, 0);
  }
  const auto together = solved(s, *block), apart = solved(s, *single);
  const Real error =
      std::max((together.motion(1).v - apart.motion(1).v).norm(), (together.motion(1).w - apart.motion(1).w).norm());
  require<D>(error <= kConverged * s.speed(), s, together, error);
}

TEST(VelocityConformance, BlocksAreSolvedAtOnce) {
  check(
      "block 2D", [] { blocksAreSolvedAtOnce<2>("catto{iterations=3,block=true}"); }, 60);
  check(
      "block 3D", [] { blocksAreSolvedAtOnce<3>("catto{iterations=3,block=true}"); }, 60);
  expectFalsified(
      "single points 2D", [] { blocksAreSolvedAtOnce<2>("catto{iterations=3}"); }, 60);
  expectFalsified(
      "single points 3D", [] { blocksAreSolvedAtOnce<3>("catto{iterations=3}"); }, 60);
}

}  // namespace velocity_test
}}}  // namespace lpc::LPC_PRECISION::test
