// SPDX-License-Identifier: Zlib
// Kinds of force with a formula. Springs and drag are tested in the files of their scenes.
#include "framework/world/invariants.h"
#include "tests/known_answers/known_answer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace force_kinds_test { namespace {

constexpr Real kDt = Real(1) / 60;
const char* const kSolvers[] = {"split_solver", "soft_step", "avbd"};

// A lever of c times the weight resists rolling: a = c g / (r (1 + k)), k = I / (m r^2), until the body rests.
template <int D>
void rollingStop() {
  const double c = 0.01, r = 0.5, v = 1, k = D == 2 ? 0.5 : 0.4, a = c * kG / (r * (1 + k));
  for (const char* solver : kSolvers) {
    World<D> world = worldOf<D>(solver);
    BodyDef<D> floor = body<D>(Shape<D>::plane(), at<D>(0, 0), BodyType::fixed);
    floor.shapes[0].friction = 1;
    world.add(floor);
    BodyDef<D> def = body<D>(Shape<D>::sphere(Real(r)), at<D>(0, r));
    def.velocity = at<D>(v, 0), def.shapes[0].friction = 1;
    def.angularVelocity = Ang<D>::Unit(kAngDim<D> - 1) * Real(-v / r);
    const BodyHandle ball = world.add(def);
    world.add(ForceDef<D>{.kind = forceKind("rolling_resistance", {{"coefficient", c}})});
    const auto roll = [&](double seconds) {
      for (const double until = double(world.time()) + seconds - 0.5 * double(kDt); double(world.time()) < until;) {
        world.step(kDt);
      }
    };
    roll(3);
    known(in<D>("speed after 3 s, m/s"), solver, v - 3 * a, double(world.motion(ball).v[0]));
    roll(2 * v / a - 3);
    known(in<D>("way to rest, m"), solver, v * v / (2 * a), double(world.pose(ball).p[0]));
    known(in<D>("speed at rest, m/s"), solver, 0, double(world.motion(ball).v.norm()));
  }
}
TEST_F(KnownAnswer, rolling_stop) { rollingStop<2>(), rollingStop<3>(); }

// Two isolated bodies of 1 and 3 kg on a circle about their centre of mass: w^2 = G (m + M) / d^3.
TEST_F(KnownAnswer, two_body_circle) {
  const double m = 1, heavy = 3, d = 2, strength = 4, w = std::sqrt(strength * (m + heavy) / (d * d * d));
  for (const char* solver : {"split_solver", "split_solver{integrator=rk4}", "soft_step"}) {
    World<2> world = worldOf<2>(solver, {0, 0});
    const double density = 1 / (kPi * 0.01);
    BodyDef<2> def = body<2>(Shape<2>::sphere(Real(0.1)), at<2>(d * heavy / (m + heavy), 0));
    def.shapes[0].density = Real(density), def.velocity = at<2>(0, w * d * heavy / (m + heavy));
    const BodyHandle light = world.add(def);
    def.X_WB.p = at<2>(-d * m / (m + heavy), 0), def.velocity = at<2>(0, -w * d * m / (m + heavy));
    def.shapes[0].density = Real(heavy * density);
    const BodyHandle other = world.add(def);
    world.add(ForceDef<2>{.kind = forceKind("attraction", {{"strength", strength}}), .bodyA = light, .bodyB = other});
    const Invariants<2> from = invariants(world);
    double previous = 1, period = 0;
    while (period == 0 && world.stepCount() < 1000) {
      world.step(kDt);
      const double y = double(world.pose(light).p[1]);
      if (previous < 0 && y >= 0) period = double(world.time()) - double(kDt) * y / (y - previous);
      previous = y;
    }
    const Invariants<2> now = invariants(world);
    known("period, s", solver, 2 * kPi / w, period);
    known("change of p, kg m/s", solver, 0, double((now.momentum - from.momentum).norm()));
    known("change of L over L", solver, 0,
          double((now.angularMomentum - from.angularMomentum).norm() / from.angularMomentum.norm()));
  }
}

// A motor of torque T accelerates a body to T t / I until the target speed, and the other body backwards: L stays.
template <int D>
void motorSpeed() {
  const double torque = 0.5, speed = 6;
  for (const char* solver : kSolvers) {
    World<D> world = worldOf<D>(solver, Vec<D>::Zero());
    const Shape<D> box = Shape<D>::box(Vec<D>::Constant(Real(0.5)));  // 1 kg, I = 1/6
    const BodyHandle a = world.add(body<D>(box, at<D>(0, 0))), b = world.add(body<D>(box, at<D>(3, 0)));
    const std::string kind = "torque{mode=speed,torque=0.5,speed=6}";
    world.add(ForceDef<D>{.kind = kind, .bodyA = a, .bodyB = b});
    const auto spin = [&](BodyHandle h) { return double(world.motion(h).w[kAngDim<D> - 1]); };
    for (int i = 0; i < 30; ++i) world.step(kDt);
    known(in<D>("speed after 0.5 s, rad/s"), solver, torque * 6 * 0.5, spin(b));
    for (int i = 0; i < 90; ++i) world.step(kDt);
    known(in<D>("speed against each other, rad/s"), solver, speed, spin(b) - spin(a));
    known(in<D>("sum of both, rad/s"), solver, 0, spin(b) + spin(a));
  }
}
TEST_F(KnownAnswer, motor_speed) { motorSpeed<2>(), motorSpeed<3>(); }

// In wind W with linear drag a, under g: terminal speeds W along and m g / a down, from rest as 1 - e^(-a t / m).
TEST_F(KnownAnswer, wind_speed) {
  const double a = 2, wind = 5;
  for (const char* solver : kSolvers) {
    World<2> world = worldOf<2>(solver);
    const BodyHandle box = world.add(body<2>(Shape<2>::box({Real(0.5), Real(0.5)}), at<2>(0, 0)));
    world.add(ForceDef<2>{.kind = forceKind("wind", {{"x", wind}, {"linear", a}}), .bodyB = box});
    for (int i = 0; i < 30; ++i) world.step(kDt);
    known("along after 0.5 s, m/s", solver, wind * (1 - std::exp(-a * 0.5)), double(world.motion(box).v[0]));
    for (int i = 0; i < 600; ++i) world.step(kDt);
    known("along, m/s", solver, wind, double(world.motion(box).v[0]));
    known("down, m/s", solver, kG / a, -double(world.motion(box).v[1]));
  }
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::force_kinds_test
