// SPDX-License-Identifier: Zlib
// Pendulums by the elliptic integral, chains and tops on pivots.
#include <array>
#include <memory>

#include "framework/world/invariants.h"
#include "tests/known_answers/known_answer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace joint_test { namespace {

const std::vector<std::string> kSolvers = [] {
  std::vector<std::string> solvers = {"split_solver", "split_solver{integrator=rk4}",
                                      "split_solver{position=baumgarte}", "split_solver{velocity=millington}",
                                      "soft_step"};
  for (const Methods& methods : andOthers({})) solvers.push_back(methods.name);
  return solvers;
}();

TEST(Pendulum, EllipticIntegralIsRight) {  // 4 sqrt(l/g) K: the figures of a point pendulum of 1 m
  EXPECT_NEAR(4 * std::sqrt(1 / kG) * ellipticK(std::pow(std::sin(kPi / 36), 2)), 2.009892627298601, 1e-12);
  EXPECT_NEAR(4 * std::sqrt(1 / kG) * ellipticK(0.5), 2.3678419475762373, 1e-12);
}

template <int D>
BodyHandle addPost(World<D>& world, const Vec<D>& p) {
  return world.add(body<D>(Shape<D>::sphere(Real(0.01)), p, BodyType::fixed));
}

struct Swing {
  double period = 0;   // s
  double tension = 0;  // at the first passage of the bottom, over m g
};

// Impulse of the rows that hold a point, along the world's axes, N s.
template <int D>
Vec<D> pointImpulse(const JointRecord<D>& joint) {
  return Eigen::Map<const Vec<D>>(joint.impulse.data());
}

// A body on a pivot at height 5, released: the time between its first two passages of the bottom in the same direction.
template <int D>
Swing swing(const std::string& solver, const BodyDef<D>& def, Real dt) {
  World<D> world = worldOf<D>(solver);
  const BodyHandle post = addPost<D>(world, at<D>(0, 5)), bob = world.add(def);
  world.add(pivot<D>(post, bob, at<D>(0, 5)));
  Swing s;
  double first = 0, previous = 1;
  while (world.time() < 20) {
    world.step(dt);
    const double x = double((world.pose(bob) * world.bodies().center[static_cast<std::size_t>(bob.slot)])[0]);
    if (previous > 0 && x <= 0) {
      const double t = double(world.time()) - double(dt) * x / (x - previous);
      if (first > 0) {
        s.period = t - first;
        break;
      }
      first = t;
      s.tension = double(pointImpulse(world.joints()[0]).norm()) / double(dt) / (double(world.mass(bob)) * kG);
    }
    previous = x;
  }
  return s;
}

// The ball turns with its arm. The equivalent point pendulum has the length l + I / (m l). In the tension m g (3 - 2
// cos a), the part 2 (1 - cos a) is divided by that length.
template <int D>
void pendulum(double degrees, Real dt, const std::string& which) {
  const double length = 1 + (D == 2 ? 0.5 : 0.4) * 0.01, angle = degrees * kDegree;
  const double m = std::pow(std::sin(angle / 2), 2), period = 4 * std::sqrt(length / kG) * ellipticK(m);
  const BodyDef<D> bob = body<D>(Shape<D>::sphere(Real(0.1)), at<D>(std::sin(angle), 5 - std::cos(angle)));
  for (const std::string& solver : kSolvers) {
    const Swing s = swing<D>(solver, bob, dt);
    known(in<D>(which + "period"), solver, period, s.period);
    if (which.empty() && D == 2) {
      known("tension over m g", solver, 1 + 2 * (1 - std::cos(angle)) / length, s.tension);
    }
  }
}
// Energy after 100 periods relative to the start, measured from the bottom, and the largest distance of the bob from
// its circle.
void swingsLong(double degrees) {
  const double length = 1 + 0.5 * 0.01, angle = degrees * kDegree;
  const double period = 4 * std::sqrt(length / kG) * ellipticK(std::pow(std::sin(angle / 2), 2));
  for (const char* solver : {"split_solver", "split_solver{position=baumgarte}", "soft_step"}) {
    World<2> world = worldOf<2>(solver);
    const BodyHandle bob = world.add(body<2>(Shape<2>::sphere(Real(0.1)), at<2>(std::sin(angle), 5 - std::cos(angle))));
    world.add(pivot<2>(addPost<2>(world, at<2>(0, 5)), bob, at<2>(0, 5)));
    const double weight = double(world.mass(bob)) * kG;
    const auto energy = [&] {
      const StateInvariants<2> now = stateInvariants<2>(world);
      return now.kinetic + now.potential - weight * 4;
    };
    const double from = energy();
    double off = 0;
    for (long i = std::lround(100 * period * 480); i > 0; --i) {
      world.step(Real(1) / 480);
      off = worse(double((world.pose(bob).p - at<2>(0, 5)).norm()) - 1, off, 0);
    }
    known("100 periods: energy after over before", solver, 1, energy() / from);
    known("100 periods: off its circle, m", solver, 0, off);
  }
}
TEST_F(KnownAnswer, pendulum_10) {
  swingsLong(10);
  pendulum<2>(10, Real(1) / 480, "");
  pendulum<3>(10, Real(1) / 480, "");
}
TEST_F(KnownAnswer, pendulum_90) {
  swingsLong(90);
  pendulum<2>(90, Real(1) / 480, "");
  pendulum<3>(90, Real(1) / 480, "");
}
// From 170 degrees the period depends on the last per cent of the energy. A joint solved at the velocity level loses a
// share of it in proportion to dt: the error must vanish with dt.
TEST_F(KnownAnswer, pendulum_170) {
  swingsLong(170);
  pendulum<2>(170, Real(1) / 480, "dt = 1/480: ");
  pendulum<2>(170, Real(1) / 2400, "dt = 1/2400: ");
}

// T = 4 sqrt(2 L / 3 g) K(sin^2(a/2)) at a = 2 degrees; for a box of height L and width w the length grows by w^2 / 2
// L.
TEST_F(KnownAnswer, rod_pendulum) {
  const double angle = 2 * kDegree, width = 0.02, length = 2.0 / 3 * (1 + width * width / 4);
  BodyDef<2> rod =
      body<2>(Shape<2>::box({Real(width / 2), Real(0.5)}), at<2>(std::sin(angle) / 2, 5 - std::cos(angle) / 2));
  rod.X_WB.q = Rot<2>::angle(angle);
  const double period = 4 * std::sqrt(length / kG) * ellipticK(std::pow(std::sin(angle / 2), 2));
  for (const std::string& solver : kSolvers)
    known("period", solver, period, swing<2>(solver, rod, Real(1) / 480).period);
}

// Two point masses of 1 kg on massless arms of 1 m, both horizontal. Reference: an eighth-order Runge-Kutta at
// tolerance 1e-13. Chaotic: compared up to 2 s only.
TEST_F(KnownAnswer, double_pendulum) {
  const std::array<double, 3> times[] = {{0.5, 0.570472051, 1.203875111},
                                         {1, -0.6250877, -1.034585086},
                                         {1.5, -1.674797345, -1.344971968},
                                         {2, -0.482971534, -1.324048712}};
  for (const char* solver : {"split_solver", "split_solver{integrator=rk4}", "soft_step"}) {
    World<2> world = worldOf<2>(solver);
    const double radius = 0.001;  // the ball's own inertia is 5e-7 of that of its arm
    const BodyHandle post = addPost<2>(world, at<2>(0, 5));
    BodyDef<2> def = body<2>(Shape<2>::sphere(Real(radius)), at<2>(1, 5));
    def.shapes[0].density = Real(1 / (kPi * radius * radius));
    const BodyHandle inner = world.add(def);
    def.X_WB.p = at<2>(2, 5);
    const BodyHandle outer = world.add(def);
    world.add(pivot<2>(post, inner, at<2>(0, 5)));
    world.add(pivot<2>(inner, outer, at<2>(1, 5)));
    for (const auto& [until, theta1, theta2] : times) {
      while (double(world.time()) < until - 1e-6) world.step(Real(1) / 4000);
      const Vec<2> p = world.pose(inner).p - at<2>(0, 5), q = world.pose(outer).p - world.pose(inner).p;
      const std::string when = " after " + std::to_string(until).substr(0, until == std::floor(until) ? 1 : 3) + " s";
      known("inner angle" + when, solver, theta1, std::atan2(double(p[0]), -double(p[1])));
      known("outer angle" + when, solver, theta2, std::atan2(double(q[0]), -double(q[1])));
      double energy = 0;  // 0 at the start, about the pivot
      for (BodyHandle h : {inner, outer}) {
        energy += double(world.motion(h).v.squaredNorm()) / 2 + kG * (double(world.pose(h).p[1]) - 5);
      }
      known("energy" + when + ", J", solver, 0, energy);
    }
  }
}

// 10 m of n rigid links hang over a span of 8 m. In the exact polygon each link lies along the force at its middle.
// With weight w of a link and tension H sideways, link i (from the lowest) rises by (i - 1/2) w / H or, for odd n, i w
// / H.
struct HangingChain {
  double pull, sag;  // over the chain's weight per metre (N/(N/m) = m); m
};
HangingChain hangingChain(int n, double length, double span) {
  const double link = length / n;
  const auto shape = [&](double pull) {
    double x = 0, y = 0;
    for (int i = 0; i < n / 2; ++i) {
      const double tilt = std::atan((i + 0.5) * link / pull);
      x += link * std::cos(tilt), y += link * std::sin(tilt);
    }
    return std::pair(2 * x, y);
  };
  double lo = 1e-3, hi = 1e3;
  for (int i = 0; i < 200; ++i) {
    const double mid = (lo + hi) / 2;
    (shape(mid).first < span ? lo : hi) = mid;
  }
  return {lo, shape(lo).second};
}

TEST_F(KnownAnswer, catenary) {
  EXPECT_NEAR(hangingChain(4, 10, 8).pull, 3.328591173217264, 1e-9);
  EXPECT_NEAR(hangingChain(4, 10, 8).sag, 2.7486015881405073, 1e-9);
  EXPECT_NEAR(hangingChain(50, 10, 8).pull, 3.3816573058468893, 1e-9);
  EXPECT_NEAR(hangingChain(50, 10, 8).sag, 2.654940420342973, 1e-9);
  for (const auto& [name, solvers] : allMethods()) {
    const std::string& solver = solvers[0];
    for (int n : {4, 10, 20, 50}) {
      if (solver != "split_solver" && solver != "soft_step" && n != 4 && n != 20) continue;
      const HangingChain exact = hangingChain(n, 10, 8);
      const double half = 5.0 / n, width = 0.02, weight = kG * width;  // N/m at 1 kg/m^2
      World<2> world = worldOf<2>(solver);
      // Motion halves in 1.4 s; the drag is small enough to be stable for rotations.
      world.add(ForceDef<2>{.kind = dragKind(0.5 * width * 2 * half, 0)});
      BodyHandle last = addPost<2>(world, at<2>(-4, 0)), middle;
      Vec<2> end = at<2>(-4, 0);
      // Starts as a V, near the end state.
      const double tilt = std::acos(0.8);
      for (int i = 0; i < n; ++i) {
        const double side = i < n / 2 ? -1 : 1;
        const Vec<2> along = at<2>(2 * half * std::cos(tilt), 2 * half * side * std::sin(tilt));
        BodyDef<2> link = body<2>(Shape<2>::box({Real(half), Real(width / 2)}), end + along / 2);
        link.X_WB.q = Rot<2>::angle(side * tilt);
        link.shapes[0].mask = 0;
        const BodyHandle next = world.add(link);
        world.add(pivot<2>(last, next, end));
        last = next, end += along;
        if (i == n / 2 - 1) middle = next;
      }
      world.add(pivot<2>(last, addPost<2>(world, end), end));
      // Links that swing to and fro have w^2 = 12 T / (m l), 133 / s at the ends of 50. So w dt < 2 needs more than 60
      // steps.
      const int rate = n == 50 ? 120 : 60;
      for (int i = 0; i < 60 * 60; ++i) world.step(Real(1) / static_cast<Real>(rate));
      const Vec<2> pull = pointImpulse(world.joints()[static_cast<std::size_t>(n / 2)]) * static_cast<Real>(rate);
      const std::string which = std::to_string(n) + " links: ";
      known(which + "sag, m", name, exact.sag, -double((world.pose(middle) * at<2>(half, 0))[1]));
      known(which + "pull over weight, m", name, exact.pull, std::abs(double(pull[0])) / weight);
      const double hook = double(pointImpulse(world.joints()[0]).norm()) * rate;  // carries half the chain
      known(which + "pull at an end, m", name, std::hypot(exact.pull, 5), hook / weight);
    }
  }
}

// A ball on a pivot at its tip, so with isotropic inertia, spinning fast. On a root of I1 cos(th) O^2 - I3 w3 O + M g l
// = 0 it precesses without nutation. I about the tip 0.003, own 0.0005 kg m^2.
void goesRound(bool fast) {
  const double arm = 0.05, own = 0.0005, i1 = own + arm * arm, spin = 300, tilt = 20 * kDegree;
  const double b = own * spin, a = i1 * std::cos(tilt);
  // I3 w3 is the whole angular momentum along the axis: w3 is the spin along it, including precession.
  const double rate = (b + (fast ? 1 : -1) * std::sqrt(b * b - 4 * a * kG * arm)) / (2 * a);
  EXPECT_NEAR(rate, fast ? 49.70862989254659 : 3.50025873124901, 1e-9);
  const double radius = std::sqrt(own * 2.5);  // of a ball of 1 kg
  for (const char* solver : {"split_solver", "split_solver{integrator=rk4}", "soft_step"}) {
    World<3> world = worldOf<3>(solver);
    const Vec<3> axis = at<3>(std::sin(tilt), std::cos(tilt)), tip = at<3>(0, 1);
    BodyDef<3> def = body<3>(Shape<3>::sphere(Real(radius)), tip + Real(arm) * axis);
    def.shapes[0].density = Real(1 / (4.0 / 3 * kPi * radius * radius * radius));
    // The angular velocity has `spin` along the axis, and turns the axis by `rate` about the vertical.
    const Vec<3> up = at<3>(0, 1);
    const double along = spin - rate * std::cos(tilt);
    def.angularVelocity = Real(along) * axis + Real(rate) * up;
    def.velocity = cross(def.angularVelocity, Vec<3>(Real(arm) * axis));
    const BodyHandle top = world.add(def);
    world.add(pivot<3>(addPost<3>(world, tip), top, tip));
    const double turns = fast ? 20 : 10;
    const auto energy = [&] {
      const StateInvariants<3> now = stateInvariants<3>(world);
      return now.kinetic + now.potential;
    };
    const double from = energy();
    double turned = 0, last = 0, low = tilt, high = tilt;
    while (turned < 2 * kPi * turns && world.time() < 30) {
      world.step(Real(1) / 4000);
      const Vec<3> p = world.pose(top).p - tip;
      const double heading = std::atan2(-double(p[2]), double(p[0]));
      turned += std::remainder(heading - last, 2 * kPi), last = heading;
      const double now = std::atan2(std::hypot(double(p[0]), double(p[2])), double(p[1]));
      low = std::min(low, now), high = std::max(high, now);
    }
    const std::string which = fast ? "fast root: " : "";
    known(which + "precession, rad/s", solver, rate, turned / double(world.time()));
    known(which + "nodding, degrees", solver, 0, (high - low) / kDegree);
    known(which + "energy gained, of M g l", solver, 0, (energy() - from) / (kG * arm));
  }
}
TEST_F(KnownAnswer, top_steady_precession) { goesRound(false), goesRound(true); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::joint_test
