// SPDX-License-Identifier: Zlib
// Every registered kind of force, with the parameters that change its behaviour: a pure function, equal and opposite at
// two ends, no effect on other bodies, finite.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/check_property.h"
#include "tests/draw.h"
#include "tests/expect_caught.h"
#include "tests/planted_bugs/force_bugs.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace force_kinds_test { namespace {

constexpr int kRuns = 60;

template <int D>
using Kind = std::shared_ptr<const ForceKind<D>>;

/// Five bodies, the last two of which forces do not move, and the contacts of the previous step.
template <int D>
struct Scene {
  Bodies<D> bodies;
  std::vector<Manifold<D>> contacts;
  ForceRecord<D> force;
  Real t = 0;

  ForceState<D> state() const { return {bodies, bodies.pose, bodies.motion, Real(0.01), contacts, Real(0.02)}; }
  std::vector<Wrench<D>> wrenches() const {
    std::vector<Wrench<D>> out(bodies.pose.size());
    force.kind->apply(force, state(), t, out);
    return out;
  }
};

// `spread`: of positions and speeds (m, m/s); `apart`: no two bodies in one place.
template <int D>
Scene<D> drawScene(Draw& draw, const Kind<D>& kind, double spread, bool apart) {
  Scene<D> s;
  Bodies<D>& b = s.bodies;
  b.type = {BodyType::dynamic, BodyType::dynamic, BodyType::dynamic, BodyType::fixed, BodyType::kinematic};
  const std::size_t n = b.type.size();
  b.used.assign(n, 1), b.awake.assign(n, 1), b.pinned.assign(n, 0), b.mass.assign(n, 0), b.generation.assign(n, 0);
  b.center.assign(n, Vec<D>::Zero()), b.pose.resize(n), b.motion.resize(n);
  b.invInertiaBody.assign(n, Inertia<D>::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    b.pose[i] = drawPose<D>(draw, Real(spread));
    if (apart) b.pose[i].p[0] += Real(20) * Real(i);
    if (!apart && i > 0 && draw.coin()) b.pose[i] = b.pose[0];
    if (b.type[i] == BodyType::fixed) continue;
    b.motion[i].v = Real(spread) * drawVector<D>(draw), b.motion[i].w.setConstant(Real(spread) * draw.signedUnit());
    if (b.type[i] != BodyType::dynamic) continue;
    b.mass[i] = draw.real(0.5, 4);
    for (int k = 0; k < kAngDim<D>; ++k) b.invInertiaBody[i](k, k) = draw.real(0.5, 4);
  }
  for (std::int32_t i = 0; i + 1 < static_cast<std::int32_t>(n); ++i) {
    Manifold<D>& m = s.contacts.emplace_back();
    m.bodyA = i, m.bodyB = i + 1, m.count = 1, m.normal = Vec<D>::Unit(draw.below(D));
    m.points[0].load = draw.real(0, 2);
  }
  const ForceEnds ends = kind->ends();
  s.force.kind = kind, s.t = draw.real(0, 3);
  s.force.bodyA = ends.from ? draw.pick({1, -1}) : -1, s.force.bodyB = ends.all ? draw.pick({0, -1}) : 0;
  if (ends.anchors) s.force.localA = drawVector<D>(draw), s.force.localB = drawVector<D>(draw);
  try {
    kind->begin(s.force, Pose<D>{}, Pose<D>{at<D>(9, 9), {}});
  } catch (const UserError&) {
    s.force.bodyA = -1;  // such a force does not act from a body on all
  }
  return s;
}

template <int D>
bool same(const std::vector<Wrench<D>>& a, const std::vector<Wrench<D>>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x.force == y.force && x.torque == y.torque; });
}

// A repeated evaluation gives the same result, also after another evaluation.
template <int D>
void isPure(const Kind<D>& kind, Draw& draw) {
  const Scene<D> s = drawScene<D>(draw, kind, 3, true), other = drawScene<D>(draw, kind, 3, true);
  const auto first = s.wrenches();
  other.wrenches();
  RC_ASSERT(same<D>(first, s.wrenches()));
}

// Forces at both ends are equal and opposite, and the total torque about the origin is zero.
template <int D>
void isEqualAndOpposite(const Kind<D>& kind, Draw& draw) {
  Scene<D> s = drawScene<D>(draw, kind, 3, true);
  if (!kind->ends().from && !kind->readsContacts()) return;
  if (kind->ends().from) s.force.bodyA = 1, s.force.bodyB = 0;
  if (kind->readsContacts()) s.contacts.resize(2);  // between bodies that forces move
  const auto out = s.wrenches();
  Vec<D> force = Vec<D>::Zero();
  Ang<D> torque = Ang<D>::Zero();
  Real size = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    force += out[i].force, torque += out[i].torque + cross(s.bodies.pose[i].p, out[i].force);
    size += out[i].force.norm() + out[i].torque.norm();
  }
  RC_ASSERT(force.norm() <= 8 * kEps * size);
  RC_ASSERT(torque.norm() <= 1000 * kEps * size);
}

// Acts on B and A only, or on all bodies that forces move.
template <int D>
void actsOnItsBodies(const Kind<D>& kind, Draw& draw) {
  const Scene<D> s = drawScene<D>(draw, kind, 3, true);
  const auto out = s.wrenches();
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto slot = static_cast<std::int32_t>(i);
    const bool touching = kind->readsContacts() && i == 1;  // B is 0
    const bool its = s.force.bodyB < 0 || slot == s.force.bodyA || slot == s.force.bodyB || touching;
    if (its && movedByForces(s.bodies, i)) continue;
    RC_ASSERT(out[i].force.norm() == 0 && out[i].torque.norm() == 0);
  }
}

// Far, fast, and coincident.
template <int D>
void isFinite(const Kind<D>& kind, Draw& draw) {
  for (const Wrench<D>& w : drawScene<D>(draw, kind, draw.pick({0.0, 1.0, 1e6}), false).wrenches()) {
    RC_ASSERT(w.force.allFinite() && w.torque.allFinite());
  }
}

template <int D>
struct Property {
  const char* name;
  void (*holds)(const Kind<D>&, Draw&);
};
template <int D>
constexpr Property<D> kProperties[] = {{"is pure", isPure<D>},
                                       {"gives what it takes", isEqualAndOpposite<D>},
                                       {"acts on its bodies", actsOnItsBodies<D>},
                                       {"is finite", isFinite<D>}};

/// Every kind with its defaults and with other parameters.
template <int D>
std::vector<std::string> everyKind() {
  std::vector<std::string> specs;
  for (const Registered* r : Registry::instance().list(StageKind::force, D)) specs.push_back(r->info.name);
  for (const char* more : {"spring{stiffness=30,damping=2,rest_length=1}", "attraction{strength=-3,exponent=3}",
                           "attraction{exponent=0}", "torque{mode=speed,speed=-2,torque=3}",
                           "wind{x=3,quadratic=1,gust=0.5,period=0.7}", "rolling_resistance{coefficient=2}"}) {
    specs.emplace_back(more);
  }
  return specs;
}

template <int D>
void conforms() {
  for (const std::string& spec : everyKind<D>()) {
    SCOPED_TRACE(spec);
    const Kind<D> kind = createStage<ForceKind<D>>(Spec::parse(spec));
    for (const Property<D>& p : kProperties<D>) {
      check(
          "a force " + std::string(p.name) + ", " + spec,
          [&] {
            RapidCheckDraw draw;
            p.holds(kind, draw);
          },
          kRuns);
    }
    int acts = 0;  // a force that never acts would have all of these properties
    check(
        "a force acts, " + spec,
        [&] {
          RapidCheckDraw draw;
          for (const Wrench<D>& w : drawScene<D>(draw, kind, 3, true).wrenches()) {
            acts += w.force.norm() + w.torque.norm() > 0;
          }
        },
        kRuns);
    EXPECT_GT(acts, kRuns / 4);
  }
  const auto twin = [](const std::string& spec, ForceBug bug, const Property<D>& p) {
    const Kind<D> kind = std::make_shared<SpoiledForce<D>>(createStage<ForceKind<D>>(Spec::parse(spec)), bug);
    expectFalsified(
        "a force " + std::string(p.name) + ", spoiled " + std::to_string(static_cast<int>(bug)) + ", " + spec,
        [&] {
          RapidCheckDraw draw;
          p.holds(kind, draw);
        },
        kRuns);
  };
  twin("drag", ForceBug::remembers, kProperties<D>[0]);
  twin("spring", ForceBug::oneEnd, kProperties<D>[1]);
  twin("attraction", ForceBug::oneEnd, kProperties<D>[1]);
  twin("torque", ForceBug::oneEnd, kProperties<D>[1]);
  twin("spring", ForceBug::noArm, kProperties<D>[1]);
  twin("rolling_resistance", ForceBug::noArm, kProperties<D>[1]);
  twin("wind", ForceBug::movesAll, kProperties<D>[2]);
  twin("wind", ForceBug::strays, kProperties<D>[2]);
  twin("attraction", ForceBug::dividesByGap, kProperties<D>[3]);
}
TEST(ForceConformance, EveryKind2) { conforms<2>(); }
TEST(ForceConformance, EveryKind3) { conforms<3>(); }

// Rolling resistance and motors stop at their target speed, whatever the step: they never reverse the motion.
template <int D>
void stopsInTime(const std::string& spec, ForceBug bug, Draw& draw) {
  const Kind<D> kind = std::make_shared<SpoiledForce<D>>(createStage<ForceKind<D>>(Spec::parse(spec)), bug);
  Scene<D> s = drawScene<D>(draw, kind, 3, true);
  s.force.bodyA = -1, s.force.bodyB = 0, s.contacts.assign(1, s.contacts[0]);
  s.contacts[0].bodyB = 3, s.contacts[0].normal = Vec<D>::Unit(1);  // a ball on a static body
  s.contacts.push_back(s.contacts[0]);                              // by two parts
  s.bodies.invInertiaBody[0] = Inertia<D>::Identity() * draw.real(0.5, 4);
  const Ang<D> before = s.bodies.motion[0].w;
  const Ang<D> after = before + s.bodies.invInertiaBody[0](0, 0) * s.state().dt * s.wrenches()[0].torque;
  const Real target = kind->readsContacts() ? 0 : 1;
  for (int k = 0; k < kAngDim<D>; ++k) {
    const Real from = before[k] - target, to = after[k] - target;
    const bool meant = D == 2 || (kind->readsContacts() ? k != 1 : k == 2);
    if (meant) RC_ASSERT(std::abs(to) <= std::abs(from) + 8 * kEps && from * to >= -8 * kEps * std::abs(from));
  }
}
template <int D>
void everyBrake() {
  for (const std::string spec : {"rolling_resistance{coefficient=1000}", "torque{mode=speed,torque=1e6}"}) {
    const auto property = [&](ForceBug bug) {
      return [&spec, bug] {
        RapidCheckDraw draw;
        stopsInTime<D>(spec, bug, draw);
      };
    };
    check("a brake stops in time, " + spec, property(ForceBug::none));
    expectFalsified("a brake that grows, " + spec, property(ForceBug::grows));
  }
}
TEST(ForceConformance, BrakesTurnNothingRound) { everyBrake<2>(), everyBrake<3>(); }

// Known answers: a spring stretched by 2 that lengthens; the report's drag; a body in gusts.
TEST(ForceConformance, Figures) {
  World<2> world;
  BodyDef<2> def = body<2>(Shape<2>::sphere(Real(0.5)), at<2>(3, 0));
  def.velocity = at<2>(2, 0);
  const BodyHandle a = world.add(def);
  const auto on = [&](const ForceDef<2>& force, Real t) {
    const ForceRecord<2> record = makeForce(force, world.bodies());
    std::vector<Wrench<2>> out(1);
    record.kind->apply(record, {world.bodies(), world.bodies().pose, world.bodies().motion}, t, out);
    return out[0].force[0];
  };
  EXPECT_EQ(on({.kind = springKind(10, 1, 5), .bodyB = a}, 0), -30);
  EXPECT_EQ(on({.kind = springKind(10, 1, 5), .bodyB = a, .anchorA = at<2>(5, 0)}, 0), 10 - 5 * 2);
  EXPECT_EQ(on({.kind = springKind(10, 0, 5), .bodyB = a, .anchorA = at<2>(3, 0)}, 0), 0) << "no direction";
  EXPECT_EQ(on({.kind = dragKind(1, 0.5)}, 0), -4);
  const std::string gusts = "wind{x=4,linear=1,gust=0.5,period=4}";
  EXPECT_EQ(on({.kind = gusts}, 0), 2);
  EXPECT_EQ(on({.kind = gusts}, 1), 4);
  EXPECT_EQ(on({.kind = gusts}, 2), 2);
  EXPECT_EQ(on({.kind = gusts}, 7), 0);
  const std::string pull = "attraction{strength=36,mass=1,floor=0.5}";
  const Real m = world.bodies().mass[0];
  EXPECT_NEAR(on({.kind = pull, .bodyB = a}, 0), -4 * m, 1e-5);
  EXPECT_NEAR(on({.kind = pull, .bodyB = a, .anchorA = at<2>(3.25, 0)}, 0), 36 * m / 0.5, 1e-4) << "half the floor";
}

// Records are removed with their bodies, wake the bodies on which they act, and have handles that a new record in the
// slot invalidates.
TEST(ForceConformance, RecordsComeAndGo) {
  World<2> world(Pipeline::parse("sleep=split_average"));
  addGround(world);
  const BodyHandle box = world.add(body<2>(Shape<2>::box({Real(0.5), Real(0.5)}), at<2>(0, 0.5)));
  const BodyHandle other = world.add(body<2>(Shape<2>::box({Real(0.5), Real(0.5)}), at<2>(5, 0.5)));
  for (int i = 0; i < 300 && world.awake(box); ++i) world.step(Real(1) / 60);
  ASSERT_FALSE(world.awake(box));
  ASSERT_FALSE(world.awake(other));
  const ForceHandle pull =
      world.add(ForceDef<2>{.kind = "spring{stiffness=1000}", .bodyB = box, .anchorA = at<2>(0, 9)});
  EXPECT_TRUE(world.awake(box));
  EXPECT_FALSE(world.awake(other));
  world.step(Real(1) / 60);
  EXPECT_GT(world.motion(box).v[1], 1);
  world.remove(pull);
  EXPECT_THROW(world.remove(pull), UserError);
  const ForceHandle next = world.add(ForceDef<2>{.kind = "attraction", .bodyA = box, .bodyB = other});
  EXPECT_EQ(next.slot, pull.slot);
  EXPECT_NE(next.generation, pull.generation);
  EXPECT_THROW(world.remove(pull), UserError);
  world.remove(other);
  EXPECT_EQ(world.forces()[static_cast<std::size_t>(next.slot)].kind, nullptr);
  world.step(Real(1) / 60);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::force_kinds_test
