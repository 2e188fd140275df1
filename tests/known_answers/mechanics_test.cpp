// SPDX-License-Identifier: Zlib
// Standard problems of a course in mechanics: bodies that slide, roll, swing and fly, each by its formula, under every
// solver.
#include <array>
#include <memory>

#include "tests/known_answers/known_answer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace mechanics_test { namespace {

constexpr Real kDt = Real(1) / 240;
const char* const kSolvers[] = {"split_solver", "soft_step", "tgs", "tgs_ngs", "xpbd", "avbd"};

template <int D>
BodyDef<D> rubbing(BodyDef<D> def, double mu) {
  for (ShapeDef<D>& s : def.shapes) s.friction = Real(mu);
  return def;
}
template <int D>
BodyDef<D> floorOf(double mu) {
  Vec<D> half = Vec<D>::Constant(50);
  half[1] = 1;
  return rubbing(body<D>(Shape<D>::box(half), at<D>(0, -1), BodyType::fixed), mu);
}
template <int D>
void steps(World<D>& world, double seconds) {
  for (long i = std::lround(seconds / double(kDt)); i > 0; --i) world.step(kDt);
}

// w = T t / I, for a ball of a millimetre and for one of a kilometre, at 1 kg/m^D.
template <int D>
void spinsUp() {
  for (const auto& [r, name] : {std::pair(1e-3, "1 mm"), std::pair(1.0, "1 m"), std::pair(1e3, "1 km")}) {
    World<D> world = worldOf<D>("split_solver", Vec<D>::Zero());
    const BodyHandle ball = world.add(body<D>(Shape<D>::sphere(Real(r)), at<D>(0, 0)));
    const double inertia = D == 2 ? kPi * std::pow(r, 4) / 2 : 8 * kPi * std::pow(r, 5) / 15;
    for (int i = 0; i < 240; ++i) {
      world.applyTorque(ball, Real(inertia) * Ang<D>::Unit(kAngDim<D> - 1));
      world.step(kDt);
    }
    known(in<D>("r = " + std::string(name) + ": turns with, rad/s"), "split_solver", 1,
          double(world.motion(ball).w[kAngDim<D> - 1]));
  }
}
TEST_F(KnownAnswer, spin_up) { spinsUp<2>(), spinsUp<3>(); }

// A box laid on a belt of speed v slips back by v^2 / (2 mu g).
template <int D>
void rides() {
  const double v = 2, mu = 0.4;
  for (const char* solver : kSolvers) {
    World<D> world = worldOf<D>(solver);
    BodyDef<D> belt = floorOf<D>(mu);
    belt.type = BodyType::kinematic, belt.velocity = at<D>(v, 0);
    world.add(belt);
    Vec<D> half = Vec<D>::Constant(Real(0.5));
    half[1] = Real(0.1);
    const BodyHandle box = world.add(rubbing(body<D>(Shape<D>::box(half), at<D>(0, 0.1)), mu));
    steps(world, 1);
    known(in<D>("slips back by, m"), solver, v * v / (2 * mu * kG), v - double(world.pose(box).p[0]));
    known(in<D>("speed at last, m/s"), solver, v, double(world.motion(box).v[0]));
  }
}
TEST_F(KnownAnswer, conveyor_belt) { rides<2>(), rides<3>(); }

// A block of 1 kg on the slope of a wedge of 3 kg, without friction: the wedge accelerates away at m g sin cos / (M + m
// sin^2).
TEST_F(KnownAnswer, sliding_wedge) {
  const double angle = 30 * kDegree, s = std::sin(angle), c = std::cos(angle), length = 4, height = length * s / c;
  for (const char* solver : kSolvers) {
    World<2> world = worldOf<2>(solver);
    world.add(floorOf<2>(0));
    const std::array<Vec<2>, 3> corners = {at<2>(0, 0), at<2>(length, 0), at<2>(0, height)};
    BodyDef<2> wedge = rubbing(body<2>(Shape<2>::polytope(corners), at<2>(0, 0)), 0);
    wedge.shapes[0].density = Real(3 / (length * height / 2));
    const BodyHandle under = world.add(wedge);
    BodyDef<2> block = rubbing(
        body<2>(Shape<2>::box({Real(0.2), Real(0.1)}), at<2>(length / 3 + 0.1 * s, height * 2 / 3 + 0.1 * c)), 0);
    block.X_WB.q = Rot<2>::angle(Real(-angle));
    block.shapes[0].density = Real(1 / 0.08);
    world.add(block);
    steps(world, 0.5);
    known("wedge's speed after 0.5 s, m/s", solver, -0.5 * kG * s * c / (3 + s * s), double(world.motion(under).v[0]));
  }
}

// A force F acts on the lower of two boxes, on a smooth floor. The upper one stays on it if and only if F <= mu g (m +
// M); otherwise it accelerates at mu g.
TEST_F(KnownAnswer, block_on_block) {
  const double mu = 0.5, limit = mu * kG * 3;  // 1 kg on 2 kg
  for (const char* solver : kSolvers) {
    for (const bool slips : {false, true}) {
      World<2> world = worldOf<2>(solver);
      world.add(floorOf<2>(0));
      BodyDef<2> def = rubbing(body<2>(Shape<2>::box({2, Real(0.1)}), at<2>(0, 0.1)), mu);
      def.shapes[0].density = Real(2 / 0.8);
      const BodyHandle lower = world.add(def);
      def = rubbing(body<2>(Shape<2>::box({Real(0.5), Real(0.1)}), at<2>(0, 0.3)), mu);
      def.shapes[0].density = Real(1 / 0.2);
      const BodyHandle upper = world.add(def);
      const double force = limit * (slips ? 1.5 : 0.9);
      for (int i = 0; i < 120; ++i) {
        world.applyForce(lower, at<2>(force, 0), world.pose(lower).p);
        world.step(kDt);
      }
      const std::string which = slips ? "F = 1.5: " : "F = 0.9: ";
      known(which + "upper, m/s", solver, 0.5 * (slips ? mu * kG : force / 3), double(world.motion(upper).v[0]));
      known(which + "lower, m/s", solver, 0.5 * (slips ? (force - mu * kG) / 2 : force / 3),
            double(world.motion(lower).v[0]));
    }
  }
}

// A rod on a pivot falls from 10 degrees off the top: w^2 = 2 m g l (cos a - cos b) / I at the angle b.
TEST_F(KnownAnswer, falling_rod) {
  const double half = 0.5, width = 0.02, angle = 10 * kDegree, inertia = (4 * half * half + width * width) / 12 + 0.25;
  for (const char* solver : kSolvers) {
    World<2> world = worldOf<2>(solver);
    BodyDef<2> rod =
        body<2>(Shape<2>::box({Real(width / 2), Real(half)}), at<2>(half * std::sin(angle), half * std::cos(angle)));
    rod.X_WB.q = Rot<2>::angle(Real(-angle));
    const BodyHandle h = world.add(rod);
    world.add(pivot<2>(BodyHandle{}, h, at<2>(0, 0)));
    double before = 0, speed = 0;
    for (double lean = angle; lean < kPi / 2 && world.stepCount() < 2000;) {
      before = lean, world.step(kDt), lean = -double(world.pose(h).q.radians());
      speed = (lean - before) / double(kDt);  // in the middle of the step
    }
    const double middle = before + speed * double(kDt) / 2;
    known("turns with, rad/s, when level", solver,
          std::sqrt(2 * kG * half * (std::cos(angle) - std::cos(middle)) / inertia), speed);
  }
}

// A ball without spin hits the floor in the middle of a step, at 3 m/s along it and 2 across, e = 0.8. It slides on
// with v - mu (1 + e) u, or rolls with v / (1 + k). Returns its velocity afterwards, from `gap` above the floor.
template <int D>
Vec<D> skipped(const std::string& solver, double mu, double gap) {
  World<D> world = worldOf<D>(solver, Vec<D>::Zero());
  BodyDef<D> floor = floorOf<D>(mu), ball = rubbing(body<D>(Shape<D>::sphere(Real(0.25)), at<D>(0, 0.25 + gap)), mu);
  floor.shapes[0].restitution = ball.shapes[0].restitution = Real(0.8), ball.velocity = at<D>(3, -2);
  world.add(floor);
  const BodyHandle h = world.add(ball);
  steps(world, 0.5);
  return world.motion(h).v;
}
template <int D>
void skips() {
  const double k = D == 2 ? 0.5 : 0.4, lost = 0.1 * 1.8 * 2;
  std::vector<const char*> solvers(std::begin(kSolvers), std::end(kSolvers));
  solvers.push_back("soft_step{bounce_friction=true}"), solvers.push_back("pgs_soft");
  for (const char* solver : solvers) {
    for (const bool grips : {false, true}) {
      const Vec<D> v = skipped<D>(solver, grips ? 1 : 0.1, 0.502);
      const std::string which = grips ? "grips: " : "slides: ";
      known(in<D>(which + "along, m/s"), solver, grips ? 3 / (1 + k) : 3 - lost, double(v[0]));
      known(in<D>(which + "across, m/s"), solver, 2 * 0.8, double(v[1]));
    }
    double least = 1, most = 0;  // share of the expected friction, for ten phases of the impact within a step of 1/30 m
    for (int phase = 0; phase < 10; ++phase) {
      const double share = (3 - double(skipped<D>(solver, 0.1, 0.502 + phase / 300.0)[0])) / lost;
      least = std::min(least, share), most = std::max(most, share);
    }
    known(in<D>("least friction of ten phases, of what there should be"), solver, 1, least);
    known(in<D>("most friction of ten phases, of what there should be"), solver, 1, most);
  }
}
TEST_F(KnownAnswer, skipping_ball) { skips<2>(), skips<3>(); }

// A ball of 1 kg follows one of 3 kg towards the floor, e = 1. The light one returns with (3 M - m) / (M + m) v, the
// heavy one with (M - 3 m) / (M + m) v, which is 0.
TEST_F(KnownAnswer, galilean_cannon) {
  for (const char* solver : {"split_solver", "soft_step", "tgs", "tgs_ngs"}) {
    World<2> world = worldOf<2>(solver, {0, 0});
    BodyDef<2> floor = floorOf<2>(0), ball = body<2>(Shape<2>::sphere(Real(0.25)), at<2>(0, 1));
    ball.velocity = at<2>(0, -1), floor.shapes[0].restitution = ball.shapes[0].restitution = 1;
    ball.shapes[0].density = 3;
    world.add(floor);
    const BodyHandle heavy = world.add(ball);
    ball.X_WB.p = at<2>(0, 1.7), ball.shapes[0].density = 1;
    const BodyHandle light = world.add(ball);
    steps(world, 1.5);
    known("light, m/s", solver, 2, double(world.motion(light).v[1]));
    known("heavy, m/s", solver, 0, double(world.motion(heavy).v[1]));
  }
}

// A ball on an arm l circles at a degrees from the vertical with W^2 = g / (l cos a).
TEST_F(KnownAnswer, conical_pendulum) {
  const double angle = 40 * kDegree, rate = std::sqrt(kG / std::cos(angle));
  for (const char* solver : kSolvers) {
    World<3> world = worldOf<3>(solver);
    BodyDef<3> def = body<3>(Shape<3>::sphere(Real(0.1)), at<3>(std::sin(angle), -std::cos(angle)));
    def.angularVelocity = at<3>(0, rate), def.velocity = at<3>(0, 0, -rate * std::sin(angle));
    const BodyHandle ball = world.add(def);
    world.add(pivot<3>(BodyHandle{}, ball, at<3>(0, 0)));
    double turned = 0, last = 0, low = angle, high = angle;
    for (int i = 0; i < 480; ++i) {
      world.step(kDt);
      const Vec<3> p = world.pose(ball).p;
      const double heading = std::atan2(-double(p[2]), double(p[0]));
      turned += std::remainder(heading - last, 2 * kPi), last = heading;
      const double now = std::atan2(std::hypot(double(p[0]), double(p[2])), -double(p[1]));
      low = std::min(low, now), high = std::max(high, now);
    }
    known("goes round, rad/s", solver, rate, turned / 2);
    known("nodding, degrees", solver, 0, (high - low) / kDegree);
  }
}

// Two bodies on a spring joint, without external forces: T = 2 pi sqrt(m M / (m + M) k), and the centre of mass stays.
TEST_F(KnownAnswer, two_on_a_spring) {
  const double period = 2 * kPi * std::sqrt(0.75 / 50);
  for (const char* solver : kSolvers) {
    World<2> world = worldOf<2>(solver, {0, 0});
    BodyDef<2> def = body<2>(Shape<2>::box({Real(0.5), Real(0.5)}), at<2>(-2, 0));
    const BodyHandle light = world.add(def);
    def.X_WB.p = at<2>(2, 0), def.shapes[0].density = 3;
    const BodyHandle heavy = world.add(def);
    world.add(JointDef<2>{.kind = "distance{mode=spring,length=3.5,stiffness=50,damping=0}",
                          .bodyA = light,
                          .bodyB = heavy,
                          .X_WJ = {at<2>(-2, 0), {}},
                          .X_WJb = Pose<2>{at<2>(2, 0), {}}});
    double previous = 0.5, first = 0, measured = 0;
    while (measured == 0 && world.stepCount() < 2000) {
      world.step(kDt);
      const double x = double(world.pose(heavy).p[0] - world.pose(light).p[0]) - 3.5;
      if (previous > 0 && x <= 0) {
        const double t = double(world.time()) - double(kDt) * x / (x - previous);
        (first > 0 ? measured : first) = first > 0 ? t - first : t;
      }
      previous = x;
    }
    known("period, s", solver, period, measured);
    known("centre moves by, m", solver, 0, double(world.pose(light).p[0] + 3 * world.pose(heavy).p[0]) / 4 - 1);
  }
}

// Drag (a + b v) v: a body falls at the speed v where this equals m g.
TEST_F(KnownAnswer, terminal_velocity) {
  const double a = 0.5, b = 0.25, v = (std::sqrt(a * a + 4 * b * kG) - a) / (2 * b);
  for (const char* solver : kSolvers) {
    World<2> world = worldOf<2>(solver);
    world.add(ForceDef<2>{.kind = dragKind(a, b)});
    const BodyHandle box = world.add(body<2>(Shape<2>::box({Real(0.5), Real(0.5)}), at<2>(0, 0)));
    steps(world, 10);
    known("speed, m/s", solver, v, -double(world.motion(box).v[1]));
  }
}

// Attraction to the origin with 1 / r^2, as a user's force: T = 2 pi a^1.5, here for an ellipse of a = 1 and e = 0.5.
template <int D>
struct Sun final : ForceGenerator<D> {
  void apply(const ForceState<D>& state, Real, std::span<Wrench<D>> out) const override {
    const Real r = state.pose[0].p.norm();
    out[0].force -= state.bodies.mass[0] / (r * r * r) * state.pose[0].p;
  }
};
TEST_F(KnownAnswer, kepler_orbit) {
  for (const char* solver : {"split_solver", "split_solver{integrator=velocity_verlet}", "split_solver{integrator=rk4}",
                             "soft_step", "tgs", "xpbd", "avbd"}) {
    World<2> world = worldOf<2>(solver, {0, 0});
    BodyDef<2> def = body<2>(Shape<2>::sphere(Real(0.1)), at<2>(1.5, 0));
    def.velocity = at<2>(0, std::sqrt(1 / 3.0));
    const BodyHandle planet = world.add(def);
    world.add(std::make_shared<const Sun<2>>());
    double previous = 1, period = 0;
    while (period == 0 && world.stepCount() < 3000) {
      world.step(kDt);
      const double y = double(world.pose(planet).p[1]);
      if (previous < 0 && y >= 0) period = double(world.time()) - double(kDt) * y / (y - previous);
      previous = y;
    }
    known("period, s", solver, 2 * kPi, period);
    known("farthest, m", solver, 1.5, double(world.pose(planet).p.norm()));
  }
}

// A ball rolls on a turntable turning at W: its velocity turns at 2/7 W, with constant speed.
TEST_F(KnownAnswer, ball_on_turntable) {
  const double rate = 2, v = 0.3, r = 0.1;
  for (const char* solver : kSolvers) {
    World<3> world = worldOf<3>(solver);
    BodyDef<3> table = floorOf<3>(1);
    table.type = BodyType::kinematic, table.angularVelocity = at<3>(0, rate);
    world.add(table);
    BodyDef<3> def = rubbing(body<3>(Shape<3>::sphere(Real(r)), at<3>(0, r)), 1);
    def.velocity = at<3>(v, 0), def.angularVelocity = at<3>(0, 0, -v / r);
    const BodyHandle ball = world.add(def);
    steps(world, 3);
    const Vec<3> now = world.motion(ball).v;
    known("turned by, rad", solver, 2.0 / 7 * rate * 3, std::atan2(-double(now[2]), double(now[0])));
    known("speed, m/s", solver, v, double(now.norm()));
  }
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::mechanics_test
