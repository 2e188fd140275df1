// SPDX-License-Identifier: Zlib
// What moves bodies besides contacts: inertia, forces.
#include <gtest/gtest.h>

#include "tests/check_property.h"
#include "tests/draw.h"
#include "tests/planted_bugs/force_twins.h"

namespace lpc::inline LPC_PRECISION::test::force_test {
namespace {

// The angular momentum of a turned body is the turned angular momentum.
void turnsWithItsBody(Inertia<3> (*turned)(const Rot<3>&, const Inertia<3>&)) {
  RapidCheckDraw draw;
  Inertia<3> inertia = Inertia<3>::Zero();
  for (int k = 0; k < 3; ++k) inertia(k, k) = draw.real(0.5, 2);
  inertia = rotateInertia(drawRotation<3>(draw), inertia);  // not only a diagonal
  const Rot<3> q = drawRotation<3>(draw);
  const Ang<3> w = drawVector<3>(draw);
  const Ang<3> error = turned(q, inertia) * (q * w) - q * Ang<3>(inertia * w);
  RC_ASSERT(error.norm() <= 64 * kEps);
}

TEST(Inertia, TurnsWithItsBody) {
  check("inertia turns with its body", [] { turnsWithItsBody(rotateInertia); });
  expectFalsified(
      "inertia turned back", [] { turnsWithItsBody(inertiaTurnedBack); }, 100);
  expectFalsified(
      "inertia not turned", [] { turnsWithItsBody(inertiaNotTurned); }, 100);
}

template <int D>
struct TwoBodies {
  Bodies<D> bodies;
  std::vector<Wrench<D>> out;
  TwoBodies() : out(2) {
    bodies.pose.resize(2), bodies.motion.resize(2), bodies.generation = {1, 1}, bodies.used = {1, 1};
    bodies.type = {BodyType::dynamic, BodyType::dynamic};
  }
  void apply(const ForceGenerator<D>& f) { f.apply({bodies, bodies.pose, bodies.motion}, 0, out); }
};

// One force on one line: what one end gets the other gives, and there is no torque about the origin in all.
template <int D, class Spoil>
void pullsBothEnds(const Spoil& spoil) {
  RapidCheckDraw draw;
  TwoBodies<D> s;
  Spring<D> spring;
  spring.bodyA = {0, 1}, spring.bodyB = {1, 1};
  spring.localA = drawVector<D>(draw), spring.localB = drawVector<D>(draw);
  spring.stiffness = 10, spring.damping = 2, spring.restLength = draw.real(0, 2);
  for (std::size_t i = 0; i < 2; ++i) {
    s.bodies.pose[i] = drawPose<D>(draw, 3);
    s.bodies.motion[i].v = drawVector<D>(draw), s.bodies.motion[i].w.setConstant(draw.signedUnit());
  }
  s.apply(spoil(spring));
  RC_ASSERT((s.out[0].force + s.out[1].force).norm() == 0);
  const Ang<D> total = s.out[0].torque + cross(s.bodies.pose[0].p, s.out[0].force) + s.out[1].torque +
                       cross(s.bodies.pose[1].p, s.out[1].force);
  RC_ASSERT(total.norm() <= 1000 * kEps * (1 + s.out[0].force.norm()));
}

template <int D>
void spring() {
  check("a spring pulls both ends", [] { pullsBothEnds<D>([](const Spring<D>& s) { return s; }); });
  for (const auto bug : {SpoiledSpring<D>::Bug::oneEnd, SpoiledSpring<D>::Bug::noArm}) {
    expectFalsified(
        "a spring pulls both ends, spoiled",
        [bug] { pullsBothEnds<D>([bug](const Spring<D>& s) { return SpoiledSpring<D>(s, bug); }); }, 100);
  }
  TwoBodies<D> s;
  s.bodies.pose[1].p[0] = 3;
  s.bodies.motion[1].v[0] = 2;
  Spring<D> spring;
  spring.bodyA = {0, 1}, spring.bodyB = {1, 1};
  spring.stiffness = 10, spring.restLength = 1, spring.damping = 5;
  s.apply(spring);
  EXPECT_EQ(s.out[0].force[0], 30) << "stretched by 2, and getting longer";
  s.out.assign(2, {});
  spring.bodyA = {};
  spring.localA[0] = 5;  // now a point of the world
  s.apply(spring);
  EXPECT_EQ(s.out[1].force[0], 10 + -5 * 2);
  s.out.assign(2, {});
  spring.bodyB = {1, 2};  // another tenant of that slot
  s.apply(spring);
  EXPECT_EQ(s.out[1].force.norm(), 0);
}
TEST(Force, Spring) { spring<2>(), spring<3>(); }

TEST(Force, Drag) {
  TwoBodies<3> s;
  s.bodies.type[1] = BodyType::kinematic;
  s.bodies.motion[0].v = Vec<3>(3, 0, 4), s.bodies.motion[0].w = Ang<3>(0, 2, 0);
  s.bodies.motion[1].v = Vec<3>(1, 1, 1);
  Drag<3> drag;
  drag.linear = 1, drag.quadratic = Real(0.5);
  s.apply(drag);
  EXPECT_EQ(s.out[0].force, Vec<3>(Vec<3>(3, 0, 4) * Real(-3.5)));
  EXPECT_EQ(s.out[0].torque, Ang<3>(0, -4, 0));
  EXPECT_EQ(s.out[1].force.norm(), 0);
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test::force_test
