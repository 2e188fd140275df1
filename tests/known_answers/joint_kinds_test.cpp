// SPDX-License-Identifier: Zlib
// Hinges, welds, springs, slides, wheels, motors, cones, gears and pointers with a formula.
#include "tests/known_answers/known_answer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace joint_kinds_test { namespace {

const char* const kSolvers[] = {"split_solver", "split_solver{position=baumgarte}", "split_solver{velocity=millington}",
                                "soft_step"};

/// A rod along -y from the origin, 1 m long, 0.1 m thick, of 1 kg.
template <int D>
BodyDef<D> rod() {
  Vec<D> half = Vec<D>::Constant(Real(0.05));
  half[1] = Real(0.5);
  BodyDef<D> def = body<D>(Shape<D>::box(half), at<D>(0, -0.5));
  def.shapes[0].density = Real(D == 2 ? 10 : 100);
  return def;
}
constexpr double kRodInertia = 1.01 / 12 + 0.25;  // about its end, kg m^2

Rot<3> aboutX(double angle) { return Rot<3>::vector(Vec<3>(Real(angle), 0, 0)); }
Rot<3> aboutZ(double angle) { return Rot<3>::vector(Vec<3>(0, 0, Real(angle))); }

// A gate with its axis 30 degrees from the horizontal, so that g cos 30 acts on it; released at 90 degrees. A pivot
// would leave the plane.
TEST_F(KnownAnswer, hinged_gate) {
  const double lean = 30 * kDegree, amplitude = 90 * kDegree;
  const double period =
      4 * std::sqrt(kRodInertia / (0.5 * kG * std::cos(lean))) * ellipticK(std::pow(std::sin(amplitude / 2), 2));
  for (const char* solver : kSolvers) {
    World<3> world = worldOf<3>(solver);
    BodyDef<3> def = rod<3>();
    const Rot<3> q = aboutX(lean) * aboutZ(amplitude);
    def.X_WB = {q * def.X_WB.p, q};
    const BodyHandle gate = world.add(def);
    world.add(JointDef<3>{.kind = "hinge", .bodyB = gate, .X_WJ = {Vec<3>::Zero(), aboutX(lean)}});
    double first = 0, found = 0, previous = 1, off = 0;
    while (world.time() < 10 && found == 0) {
      world.step(Real(1) / 480);
      const Vec<3> p = aboutX(-lean) * world.pose(gate).p;  // in the plane of the swing: z = 0
      const double x = double(p[0]);
      off = std::max(off, std::abs(double(p[2])));
      if (previous > 0 && x <= 0) {
        const double t = double(world.time()) - x / (x - previous) / 480;
        if (first > 0) found = t - first;
        first = t;
      }
      previous = x;
    }
    known("period", solver, period, found);
    known("off its plane, m", solver, 0, off);
  }
}

// Ten boxes of 0.2 m and 1 kg in a row, welded to the world at one end. The root carries the weight W, and W times half
// of the length as its moment.
template <int D>
void cantilever(double seconds) {
  constexpr int n = 10;
  const double side = 0.2, weight = n * kG, moment = weight * n * side / 2;
  for (const char* solver : {"split_solver{velocity=catto{iterations=200}}", "soft_step{substeps=100}"}) {
    World<D> world = worldOf<D>(solver);
    BodyHandle last{};
    for (int i = 0; i < n; ++i) {
      BodyDef<D> def = body<D>(Shape<D>::box(Vec<D>::Constant(Real(side / 2))), at<D>((i + 0.5) * side, 0));
      def.shapes[0].density = Real(1 / std::pow(side, D));
      const BodyHandle next = world.add(def);
      world.add(JointDef<D>{.kind = "weld", .bodyA = last, .bodyB = next, .X_WJ = {at<D>(i * side, 0), {}}});
      last = next;
    }
    while (world.time() < Real(seconds)) world.step(Real(1) / 60);
    const auto& impulse = world.joints()[0].impulse;
    known(in<D>("root carries, of W"), solver, 1, double(impulse[1]) * 60 / weight);
    known(in<D>("root moment, of W L / 2"), solver, 1, double(impulse[D == 2 ? 2 : 5]) * 60 / moment);
    known(in<D>("tip sinks, m"), solver, 0, -double(world.pose(last).p[1]));
  }
}
TEST_F(KnownAnswer, welded_cantilever) {
  cantilever<2>(5);
  cantilever<3>(5);
}

// A motor has half the torque that would hold the rod level. It lifts the rod from hanging until its work equals that
// of the weight: T a = m g l (1 - cos a).
template <int D>
void stalledMotor() {
  const double share = 0.5, torque = share * kG * 0.5;
  double low = 0.5, high = 2;
  for (int i = 0; i < 60; ++i) {
    const double a = (low + high) / 2;
    (share * a > 1 - std::cos(a) ? low : high) = a;
  }
  for (const char* solver : kSolvers) {
    World<D> world = worldOf<D>(solver);
    const BodyHandle arm = world.add(rod<D>());
    world.add(JointDef<D>{.kind = "hinge{motor_speed=1000,motor_torque=" + std::to_string(torque) + "}", .bodyB = arm});
    double highest = 0;
    while (world.time() < 2) {
      world.step(Real(1) / 480);
      highest = std::max(highest, double(world.joints()[0].state[0]));
    }
    known(in<D>("stalls at, degrees"), solver, low / kDegree, highest / kDegree);
  }
}
TEST_F(KnownAnswer, stalled_motor) {
  stalledMotor<2>();
  stalledMotor<3>();
}

// A weight on a damped spring comes to rest m g / k below the rest length, whatever the method's own stiffness.
template <int D>
void hangingSpring() {
  for (const char* solver : kSolvers) {
    World<D> world = worldOf<D>(solver);
    const BodyHandle bob = world.add(rod<D>());
    world.add(JointDef<D>{.kind = "distance{mode=spring,length=1,stiffness=50,damping=5}",
                          .bodyB = bob,
                          .X_WJ = {at<D>(0, 1), {}},
                          .X_WJb = Pose<D>{at<D>(0, 0), {}}});
    while (world.time() < 10) world.step(Real(1) / 60);
    known(in<D>("stretch, m"), solver, kG / 50, -0.5 - double(world.pose(bob).p[1]));
  }
}
TEST_F(KnownAnswer, hanging_spring) {
  hangingSpring<2>();
  hangingSpring<3>();
}

const char* const kBoth[] = {"split_solver", "soft_step"};

/// A cube of 1 kg and 0.2 m with its centre at the given point.
template <int D>
BodyDef<D> cube(const Vec<D>& place) {
  BodyDef<D> def = body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.1))), place);
  def.shapes[0].density = Real(1 / std::pow(0.2, D));
  return def;
}
/// Turned about z.
template <int D>
Rot<D> turned(double angle) {
  if constexpr (D == 2) {
    return Rot<2>::angle(angle);
  } else {
    return aboutZ(angle);
  }
}
/// The angle by which b is turned relative to a, rad.
template <int D>
double between(const Rot<D>& a, const Rot<D>& b) {
  return double(turnOf(a.inverse() * b).norm());
}

// A body slides with g sin a on a rail tilted by 30 degrees. The rail carries its weight and the moment of the weight.
template <int D>
void railSlider() {
  const double lean = 30 * kDegree;
  for (const char* solver : kBoth) {
    World<D> world = worldOf<D>(solver);
    const Rot<D> q = turned<D>(-lean);
    const BodyHandle car = world.add(cube<D>(q * at<D>(0.5, 0)));
    world.add(JointDef<D>{.kind = "prismatic", .bodyB = car, .X_WJ = {Vec<D>::Zero(), q}});
    while (world.stepCount() < 120) world.step(Real(1) / 60);
    const Vec<D> p = q.inverse() * world.pose(car).p, v = q.inverse() * world.motion(car).v;
    known(in<D>("speed, m/s"), solver, 2 * kG * std::sin(lean), double(v[0]));
    known(in<D>("off the rail, m"), solver, 0, double(p[1]));
    known(in<D>("moment, of m g cos times the arm"), solver, 1,
          std::abs(double(world.joints()[0].impulse[D == 2 ? 1 : 4])) * 60 / (kG * std::cos(lean) * 0.5));
  }
}
TEST_F(KnownAnswer, rail_slider) { railSlider<2>(), railSlider<3>(); }

// A motor with one and a half times the weight lifts at g / 2, and is stopped by the limit.
template <int D>
void lift() {
  for (const char* solver : kBoth) {
    World<D> world = worldOf<D>(solver);
    const BodyHandle car = world.add(cube<D>(at<D>(0, 0)));
    world.add(JointDef<D>{.kind = "prismatic{upper=3,motor_speed=1000,motor_force=" + std::to_string(1.5 * kG) + "}",
                          .bodyB = car,
                          .X_WJ = {Vec<D>::Zero(), turned<D>(kPi / 2)}});
    while (world.stepCount() < 60) world.step(Real(1) / 60);
    known(in<D>("speed after 1 s, m/s"), solver, kG / 2, double(world.motion(car).v[1]));
    while (world.stepCount() < 240) world.step(Real(1) / 60);
    known(in<D>("height at the stop, m"), solver, 3, double(world.pose(car).p[1]));
  }
}
TEST_F(KnownAnswer, motor_lift) { lift<2>(), lift<3>(); }

// A wheel under a static chassis swings on its suspension and keeps its spin.
template <int D>
void suspension() {
  const double k = 50, period = 2 * kPi / std::sqrt(k);
  for (const char* solver : kBoth) {
    World<D> world = worldOf<D>(solver);
    BodyDef<D> def = cube<D>(at<D>(0, 0));
    def.angularVelocity[kAngDim<D> - 1] = 3;
    const BodyHandle wheel = world.add(def);
    world.add(JointDef<D>{
        .kind = "wheel{stiffness=50,damping=0}", .bodyB = wheel, .X_WJ = {Vec<D>::Zero(), turned<D>(kPi / 2)}});
    double first = 0, last = 0, previous = 1, lowest = 0;
    int crossings = 0;
    while (crossings < 4) {
      world.step(Real(1) / 480);
      const double y = double(world.pose(wheel).p[1]) + kG / k;
      lowest = std::min(lowest, y);
      if (previous > 0 && y <= 0) {
        last = double(world.time()) - y / (y - previous) / 480;
        if (crossings++ == 0) first = last;
      }
      previous = y;
    }
    known(in<D>("period, s"), solver, period, (last - first) / 3);
    known(in<D>("lowest, of 2 m g / k"), solver, 1, (kG / k - lowest) / (2 * kG / k));
    known(in<D>("spin, rad/s"), solver, 3, double(world.motion(wheel).w[kAngDim<D> - 1]));
  }
}
TEST_F(KnownAnswer, wheel_suspension) { suspension<2>(), suspension<3>(); }

// A critically damped drive from rest has covered 1 - (1 + w t) e^(-w t) of its path, w = 5/s, at t = 0.4 s. A drive at
// its force limit accelerates with F / m. A brake stops within m v^2 / 2 F. Positions use the new velocities, so paths
// at constant force are longer or shorter by the motion of half a step.
template <int D>
void drives() {
  const auto way = [](const char* solver, const std::string& kind, double speed, int steps) {
    World<D> world = worldOf<D>(solver, Vec<D>::Zero());
    BodyDef<D> def = cube<D>(at<D>(0, 0));
    def.velocity = at<D>(speed, 0);
    const BodyHandle car = world.add(def);
    world.add(JointDef<D>{.kind = kind, .bodyB = car});
    while (world.stepCount() < steps) world.step(Real(1) / 480);
    return std::pair(double(world.pose(car).p[0]), double(turnOf(world.pose(car).q)[kAngDim<D> - 1]));
  };
  for (const char* solver : kBoth) {
    const double wt = 5 * 0.4, h = 1.0 / (std::string(solver) == "soft_step" ? 4 * 480 : 480);
    known(in<D>("way of a critically damped drive, m"), solver, 1 - (1 + wt) * std::exp(-wt),
          way(solver, "motor{x=1,stiffness=25,damping=10}", 0, 192).first);
    known(in<D>("place at last, m"), solver, 1, way(solver, "motor{x=1,stiffness=25,damping=10}", 0, 4800).first);
    known(in<D>("angle at last, rad"), solver, 0.5, way(solver, "motor{angle=0.5}", 0, 4800).second);
    known(in<D>("way of one of 1 N in 1 s, m"), solver, 0.5 + h / 2,
          way(solver, "motor{x=100,stiffness=1000,damping=1,max_force=1}", 0, 480).first);
    known(in<D>("stops within, m"), solver, 0.5 - 2 * h / 2,
          way(solver, "motor{mode=friction,max_force=4}", 2, 960).first);
  }
}
TEST_F(KnownAnswer, motor_drive) { drives<2>(), drives<3>(); }

// A rod on springs at one end sinks by m g / k, and turns until the spring balances the moment of its weight.
template <int D>
void softBeam() {
  const double k = 100, turn = 20;
  double angle = 0;
  for (int i = 0; i < 100; ++i) angle = kG * 0.5 * std::cos(angle) / turn;
  for (const char* solver : kBoth) {
    World<D> world = worldOf<D>(solver);
    BodyDef<D> def = rod<D>();
    def.X_WB = {at<D>(0.5, 0), turned<D>(kPi / 2)};
    const BodyHandle beam = world.add(def);
    world.add(
        JointDef<D>{.kind = "spring{stiffness=100,damping=10,angular_stiffness=20,angular_damping=5}", .bodyB = beam});
    while (world.stepCount() < 1200) world.step(Real(1) / 60);
    const Pose<D>& X = world.pose(beam);
    known(in<D>("sinks by, m"), solver, kG / k, -double((X * at<D>(0, 0.5))[1]));
    known(in<D>("turns by, degrees"), solver, angle / kDegree, between<D>(turned<D>(kPi / 2), X.q) / kDegree);
  }
}
TEST_F(KnownAnswer, soft_beam) { softBeam<2>(), softBeam<3>(); }

// A torque T turns the larger of two wheels, and through gears the smaller one: T / (I + I' / ratio^2). After many
// turns the ratio of the angles still holds.
template <int D>
void gearPair() {
  const double ratio = -2.5, torque = 3;
  for (const char* solver : kBoth) {
    World<D> world = worldOf<D>(solver);
    const auto wheel = [&](double x, double side, const std::string& kind) {
      BodyDef<D> def = body<D>(Shape<D>::box(Vec<D>::Constant(Real(side / 2))), at<D>(x, 0));
      const BodyHandle h = world.add(def);
      world.add(JointDef<D>{.kind = kind, .bodyB = h, .X_WJ = {at<D>(x, 0), {}}});
      return h;
    };
    const BodyHandle a = wheel(0, 1, "hinge{motor_speed=1000,motor_torque=" + std::to_string(torque) + "}");
    const BodyHandle b = wheel(2, 0.5, "hinge");
    world.add(JointDef<D>{.kind = "gear{ratio=" + std::to_string(ratio) + "}", .bodyA = a, .bodyB = b});
    while (world.stepCount() < 60) world.step(Real(1) / 60);
    const auto spin = [&](BodyHandle h) { return double(world.motion(h).w[kAngDim<D> - 1]); };
    const double inertia = 1.0 / 6, small = std::pow(0.5, D) * 0.25 / 6;
    known(in<D>("speed of A after 1 s, rad/s"), solver, torque / (inertia + small / (ratio * ratio)), spin(a));
    known(in<D>("speed of A over that of B"), solver, -ratio, spin(a) / spin(b));
    while (world.stepCount() < 240) world.step(Real(1) / 60);
    const auto turned = [&](std::size_t joint) { return double(world.joints()[joint].state[0]); };
    known(in<D>("off after 4 s, rad"), solver, 0, turned(0) + ratio * turned(1));
  }
}
TEST_F(KnownAnswer, gear_pair) { gearPair<2>(), gearPair<3>(); }

// A body held by a pointer hangs m g / k below it; with a stiffness given as a frequency f, g / (2 pi f)^2 below for
// any mass. With half the weight as the largest force it falls at g / 2.
template <int D>
void mouseHold() {
  const double hertz = 1, hang = kG / std::pow(2 * kPi * hertz, 2);
  for (const char* solver : kBoth) {
    for (const double mass : {1.0, 1000.0}) {
      World<D> world = worldOf<D>(solver);
      BodyDef<D> def = cube<D>(at<D>(0, 0));
      def.shapes[0].density *= Real(mass);
      const BodyHandle held = world.add(def);
      world.add(JointDef<D>{.kind = "mouse{hertz=1,damping_ratio=0.7,max_force=1e6}", .bodyB = held});
      while (world.stepCount() < 600) world.step(Real(1) / 60);
      known(in<D>(mass > 1 ? "1000 kg hang below, m" : "1 kg hangs below, m"), solver, hang,
            -double(world.pose(held).p[1]));
    }
    World<D> world = worldOf<D>(solver);
    const BodyHandle held = world.add(cube<D>(at<D>(0, 0)));
    world.add(JointDef<D>{.kind = "mouse{max_force=" + std::to_string(kG / 2) + "}", .bodyB = held});
    while (world.stepCount() < 60) world.step(Real(1) / 60);
    known(in<D>("speed of a fall at half the weight, m/s"), solver, kG / 2, -double(world.motion(held).v[1]));
  }
}
TEST_F(KnownAnswer, mouse_hold) { mouseHold<2>(), mouseHold<3>(); }

// A level rod on a cone of 30 degrees falls to the rim and rests there: the rim carries the moment of the weight. A
// body beside the bone twists it to its limit.
template <int D>
void coneRim(double seconds) {
  for (const char* solver : kBoth) {
    World<D> world = worldOf<D>(solver);
    BodyDef<D> def = rod<D>();
    def.X_WB = {at<D>(0.5, 0), turned<D>(kPi / 2)};
    const BodyHandle arm = world.add(def);
    world.add(JointDef<D>{.kind = "cone_twist{swing=0.5235987755982988}", .bodyB = arm});
    while (world.time() < Real(seconds)) world.step(Real(1) / 60);
    known(in<D>("swing, degrees"), solver, 30, between<D>(turned<D>(kPi / 2), world.pose(arm).q) / kDegree);
    const double moment = kG * 0.5 * std::cos(30 * kDegree);
    const auto& impulse = world.joints()[0].impulse;
    known(in<D>("moment at the rim, of the weight's"), solver, 1, std::abs(double(impulse[D])) * 60 / moment);
  }
}
TEST_F(KnownAnswer, cone_rim) {
  coneRim<2>(5), coneRim<3>(5);
  for (const char* solver : kBoth) {
    World<3> world = worldOf<3>(solver);
    const BodyHandle arm = world.add(cube<3>({0, 0, Real(0.5)}));
    world.add(JointDef<3>{.kind = "cone_twist{swing=0.1,twist=0.25}", .bodyB = arm});
    while (world.time() < 5) world.step(Real(1) / 60);
    known("twist, rad", solver, 0.25, double(turnOf(world.pose(arm).q)[0]));
    known("moment of the twist, of the weight's", solver, 1,
          std::abs(double(world.joints()[0].impulse[4])) * 60 / (kG * 0.5 * std::cos(0.25)));
  }
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::joint_kinds_test
