// SPDX-License-Identifier: Zlib
// Hinges, welds and springs with a formula.
#include "tests/known_answers/known_answer.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

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

// A gate: its axis leans by 30 degrees from the horizontal, so that g cos 30 pulls it; let go at 90 degrees. A pivot
// would fall off the plane.
TEST_F(KnownAnswer, hinged_gate) {
  const double lean = 30 * kDegree, amplitude = 90 * kDegree;
  const double period =
      4 * std::sqrt(kRodInertia / (0.5 * kG * std::cos(lean))) * ellipticK(std::pow(std::sin(amplitude / 2), 2));
  for (const char* solver : kSolvers) {
    World<3> world = worldOf<3>(solver);
    BodyDef<3> def = rod<3>();
    const Rot<3> q = aboutX(lean) * aboutZ(amplitude);
    def.X_WB = {q * def.X_WB.p, q};
    const Handle gate = world.add(def);
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

// Ten boxes of 0.2 m and 1 kg in a row, welded to the world at one end: the root carries the weight W, and W times half
// of the length.
template <int D>
void cantilever(double seconds) {
  constexpr int n = 10;
  const double side = 0.2, weight = n * kG, moment = weight * n * side / 2;
  for (const char* solver : {"split_solver{velocity=catto{iterations=200}}", "soft_step{substeps=100}"}) {
    World<D> world = worldOf<D>(solver);
    Handle last{};
    for (int i = 0; i < n; ++i) {
      BodyDef<D> def = body<D>(Shape<D>::box(Vec<D>::Constant(Real(side / 2))), at<D>((i + 0.5) * side, 0));
      def.shapes[0].density = Real(1 / std::pow(side, D));
      const Handle next = world.add(def);
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

// A motor of half the torque that would hold the rod out level lifts it from hanging until it has done as much work as
// the weight has taken: T a = m g l (1 - cos a).
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
    const Handle arm = world.add(rod<D>());
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

// A weight on a damped spring comes to rest m g / k below its length, whatever the method's own stiffness is.
template <int D>
void hangingSpring() {
  for (const char* solver : kSolvers) {
    World<D> world = worldOf<D>(solver);
    const Handle bob = world.add(rod<D>());
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

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
