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

// A ball on a massless arm swings on a hinge's spring: T = 2 pi sqrt((m l^2 + I) / k). The arm turns the ball through
// the pivot, so a pivot that is a spring is in series with the hinge's.
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
    double previous = 0, last = 0, half = 0;
    while (half == 0 && world.stepCount() < 1000) {
      world.step(kDt);
      const double y = double(world.pose(h).p[1]);
      if (previous * y < 0) {
        const double t = double(world.time()) - double(kDt) * y / (y - previous);
        (last > 0 ? half : last) = last > 0 ? t - last : t;
      }
      previous = y;
    }
    known(in<D>("period, s"), solver, period, 2 * half);
  }
}
TEST_F(KnownAnswer, torsion_pendulum) { torsionPendulum<2>(), torsionPendulum<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::substep_test
