// SPDX-License-Identifier: Zlib
// Where solvers that integrate themselves differ: soft joints, light ropes, contacts that roll, spinning tops.
#include "tests/known_answers/known_answer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace substep_test { namespace {

constexpr Real kDt = Real(1) / 240;

/// Distance joint between two points; bodyA {}: the world.
template <int D>
JointDef<D> rod(BodyHandle a, BodyHandle b, const Vec<D>& from, const Vec<D>& to) {
  return {.kind = "distance", .bodyA = a, .bodyB = b, .X_WJ = {from, {}}, .X_WJb = Pose<D>{to, {}}};
}
template <int D>
BodyDef<D> ball(double radius, double mass, const Vec<D>& p) {
  BodyDef<D> def = body<D>(Shape<D>::sphere(Real(radius)), p);
  const double r2 = radius * radius;
  def.shapes[0].density = Real(mass / (D == 2 ? kPi * r2 : 4 * kPi / 3 * r2 * radius));
  return def;
}

// Half a period of the ball's motion along `d`, s.
template <int D>
double halfPeriod(World<D>& world, BodyHandle ball, const Vec<D>& d) {
  double previous = 0, last = 0;
  while (world.stepCount() < 1000) {
    world.step(kDt);
    const double x = double(d.dot(world.pose(ball).p));
    if (previous * x < 0) {
      const double t = double(world.time()) - double(kDt) * x / (x - previous);
      if (last > 0) return t - last;
      last = t;
    }
    previous = x;
  }
  return 0;
}

// A ball on a massless arm swings on a hinge's spring: T = 2 pi sqrt((m l^2 + I) / k). The arm turns the ball through
// the pivot, so a pivot that is a spring is in series with the hinge's. On a slider T = 2 pi sqrt(m / k), and the arm
// loads the row that keeps the ball from turning.
template <int D>
void torsionPendulum() {
  const double arm = 4, k = 20, r = 0.25, m = 0.1, inertia = (D == 2 ? 0.5 : 0.4) * m * r * r;
  const double period = 2 * kPi * std::sqrt((m * arm * arm + inertia) / k);
  std::vector<std::string> solvers = {"split_solver", "soft_step", "soft_step{joints=rigid}"};
  if (kAllMethods) {
    for (const char* s : {"pgs_soft", "pgs_soft{joints=rigid}", "tgs", "tgs_ngs", "xpbd", "avbd"}) solvers.push_back(s);
  }
  for (const std::string& solver : solvers) {
    World<D> world = worldOf<D>(solver, Vec<D>::Zero());
    BodyDef<D> def = ball<D>(r, m, at<D>(arm, 0));
    def.velocity = at<D>(0, 0.2 * arm);
    def.angularVelocity[kAngDim<D> - 1] = Real(0.2);
    const BodyHandle h = world.add(def);
    world.add(JointDef<D>{.kind = "hinge{stiffness=20}", .bodyB = h});
    known(in<D>("period, s"), solver, period, 2 * halfPeriod<D>(world, h, at<D>(0, 1)));
    if (D == 3) continue;
    World<D> rail = worldOf<D>(solver, Vec<D>::Zero());
    def.velocity = at<D>(0.2, 0), def.angularVelocity.setZero(), def.X_WB.p = at<D>(0, arm);
    const BodyHandle slider = rail.add(def);
    rail.add(JointDef<D>{.kind = "prismatic{stiffness=20}", .bodyB = slider});
    known("period on a slider, s", solver, 2 * kPi * std::sqrt(m / k), 2 * halfPeriod<D>(rail, slider, at<D>(1, 0)));
  }
}
TEST_F(KnownAnswer, torsion_pendulum) { torsionPendulum<2>(), torsionPendulum<3>(); }

// 1 kg at the end of a chain of 9 beads of 10 g, 1 m, swings from half a radian: v = sqrt(2 g l (1 - cos a)) at the
// bottom if the beads have no mass, 0.3 % more at most with them.
template <int D>
void lightChain() {
  constexpr int n = 10;
  const double angle = 0.5, speed = std::sqrt(2 * kG * (1 - std::cos(angle)));
  for (const char* solver : {"avbd", "avbd{iterations=50}"}) {
    World<D> world = worldOf<D>(solver);
    const auto place = [&](int i) { return at<D>(std::sin(angle) * i / n, -std::cos(angle) * i / n); };
    BodyHandle last;
    for (int i = 1; i <= n; ++i) {
      const BodyHandle next = world.add(ball<D>(0.01, i == n ? 1 : 0.01, place(i)));
      world.add(rod<D>(last, next, place(i - 1), place(i)));
      last = next;
    }
    double fastest = 0, reach = 0;
    while (world.stepCount() < 120) {
      world.step(Real(1) / 120);
      fastest = std::max(fastest, double(world.motion(last).v.norm()));
      reach = std::max(reach, double(world.pose(last).p.norm()));
    }
    known(in<D>("speed at the bottom, m/s"), solver, speed, fastest);
    known(in<D>("longest, m"), solver, 1, reach);
  }
}
TEST_F(KnownAnswer, light_chain) { lightChain<2>(), lightChain<3>(); }

// A rope round a post, 24 discs of 7.9 g over a = 6.02 rad, held by 1 N: it slips if it is pulled by more than e^(mu a)
// = 6.1 N. By 10 N it begins with mu (F - e^(mu a)) a / m (e^(mu a) - 1) = 7.4 m/s^2, and has 1.8 m/s after a quarter
// of a second; half of that counts as slipping. Without friction it moves with (F - 1 N) t / m, before its end leaves
// the post.
TEST_F(KnownAnswer, capstan) {
  constexpr int n = 24;
  const double r = 0.05, mass = kPi * r * r;
  const auto speed = [&](const std::string& solver, double mu, double pull, int steps) {
    World<2> world = worldOf<2>(solver, {0, 0});
    BodyDef<2> post = body<2>(Shape<2>::sphere(1), at<2>(0, 0), BodyType::fixed);
    post.shapes[0].friction = Real(mu), post.shapes[0].category = 1;
    world.add(post);
    std::vector<BodyHandle> rope;
    const auto place = [&](int i) {
      const double a = (i + 0.5) * 2 * kPi / n;
      return at<2>((1 + r) * std::cos(a), (1 + r) * std::sin(a));
    };
    for (int i = 0; i < n; ++i) {
      BodyDef<2> def = ball<2>(r, mass, place(i));
      def.rotatable = false;
      def.shapes[0].friction = Real(mu), def.shapes[0].category = 2, def.shapes[0].mask = 1;
      rope.push_back(world.add(def));
      if (i > 0) world.add(rod<2>(rope[i - 1], rope[i], place(i - 1), place(i)));
    }
    for (int i = 0; i < steps; ++i) {
      world.applyForce(rope[0], at<2>(0, -1), world.pose(rope[0]).p);
      world.applyForce(rope[n - 1], at<2>(0, pull), world.pose(rope[n - 1]).p);
      world.step(kDt);
    }
    double fastest = 0;
    for (const BodyHandle h : rope) fastest = std::max(fastest, double(world.motion(h).v.norm()));
    return fastest;
  };
  for (const char* solver :
       {"split_solver{velocity=direct_lcp}", "soft_step", "tgs", "tgs_ngs", "xpbd", "avbd", "avbd{tries=5}"}) {
    known("without friction: speed after 1/12 s, m/s", solver, 9 / (n * mass) / 12, speed(solver, 0, 10, 20));
    known("pulled by 4 N: slips", solver, 0, speed(solver, 0.3, 4, 60) > 0.9);
    known("pulled by 10 N: slips", solver, 1, speed(solver, 0.3, 10, 60) > 0.9);
  }
  for (const char* solver : {"avbd", "avbd{iterations=50}"}) {
    known("without friction, 40 N, 1 s: faster than 400 m/s", solver, 0, speed(solver, 0, 40, 240) > 400);
  }
}

// A plank of half thickness b rocks on a fixed ball of radius R without slipping: T = 2 pi sqrt((k^2 + b^2) / g (R
// - b)), k^2 = (w^2 + b^2) / 3, and its amplitude stays. Contacts of a whole step make n sub-steps explicit by (n - 1)
// / 2n of the step, so that the amplitude grows by e^(W^2 dt t (n - 1) / 4n), W = 2 pi / T.
template <int D>
void rockingPlank() {
  const double R = 0.5, b = 0.1, w = 0.6, dt = 1.0 / 60, inertia = (w * w + b * b) / 3 + b * b;
  const double rate = std::sqrt(kG * (R - b) / inertia), spin = 0.3;
  for (const char* solver :
       {"split_solver", "avbd", "pgs_soft", "soft_step", "soft_step{contacts=substep}", "tgs", "tgs{contacts=substep}",
        "tgs_ngs", "tgs_ngs{contacts=substep}", "xpbd", "xpbd{contacts=substep}"}) {
    World<D> world = worldOf<D>(solver);
    BodyDef<D> def = body<D>(Shape<D>::sphere(Real(R)), at<D>(0, 0), BodyType::fixed);
    def.shapes[0].friction = 2;
    world.add(def);
    Vec<D> half = Vec<D>::Constant(Real(0.4));
    half[0] = Real(w), half[1] = Real(b);
    def = body<D>(Shape<D>::box(half), at<D>(0, R + b));
    def.shapes[0].friction = 2, def.velocity = at<D>(-spin * b, 0);
    def.angularVelocity[kAngDim<D> - 1] = Real(spin);
    const BodyHandle plank = world.add(def);
    double highest = 0, previous = 0, first = 0, last = 0;
    int crossings = 0;
    const int steps = 480;
    for (int i = 0; i < steps; ++i) {
      world.step(Real(dt));
      const double a = double(turnOf(world.pose(plank).q)[kAngDim<D> - 1]);
      if (previous * a < 0) {
        last = double(world.time()) - dt * a / (a - previous);
        if (crossings++ == 0) first = last;
      }
      if (i >= steps - 90) highest = std::max(highest, std::abs(a));
      previous = a;
    }
    known(in<D>("period, s"), solver, 2 * kPi / rate, 2 * (last - first) / (crossings - 1));
    known(in<D>("amplitude after 8 s, rad"), solver, spin / rate, highest);
  }
}
TEST_F(KnownAnswer, rocking_plank) { rockingPlank<2>(), rockingPlank<3>(); }

// The axis of a free symmetric top goes round its angular momentum at L / I1, at a constant angle. Without the
// gyroscopic term it goes round the angular velocity.
TEST_F(KnownAnswer, free_precession) {
  std::vector<std::string> solvers;
  for (const char* s : {"soft_step", "tgs", "tgs_ngs", "pgs_soft", "xpbd", "avbd"}) {
    solvers.push_back(s), solvers.push_back(std::string(s) + "{gyroscopic=true}");
  }
  for (const std::string& solver : solvers) {
    World<3> world = worldOf<3>(solver, Vec<3>::Zero());
    const double thin = 0.1, wide = 0.5;
    BodyDef<3> def = body<3>(Shape<3>::box({Real(wide), Real(thin), Real(wide)}), at<3>(0, 0));
    def.angularVelocity = {1, 5, 0};
    const BodyHandle top = world.add(def);
    const double across = (thin * thin + wide * wide) / 3, along = 2 * wide * wide / 3;
    const Vec<3> L(Real(across * 1), Real(along * 5), 0);
    const Vec<3> up = L.normalized(), side = Vec<3>(0, 0, 1), ahead = cross(side, up);
    double turned = 0, heading = 0, tilt = std::acos(double(up[1])), least = tilt, most = tilt;
    for (int i = 0; i < 240; ++i) {
      world.step(kDt);
      const Vec<3> axis = world.pose(top).q * Vec<3>(0, 1, 0);
      const double now = std::atan2(double(axis.dot(side)), -double(axis.dot(ahead)));
      if (i > 0) turned += std::remainder(now - heading, 2 * kPi);
      heading = now;
      tilt = std::acos(std::clamp(double(axis.dot(up)), -1.0, 1.0));
      least = std::min(least, tilt), most = std::max(most, tilt);
    }
    known("goes round, rad/s", solver, double(L.norm()) / across, std::abs(turned) * 240 / 239);
    known("nodding, degrees", solver, 0, (most - least) / kDegree);
  }
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::substep_test
