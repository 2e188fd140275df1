// SPDX-License-Identifier: Zlib
// Where laws of restitution differ: touching balls, unequal e, an oblique rod with friction.
#include <array>

#include "framework/shape/mass.h"
#include "tests/known_answers/known_answer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace impact_laws_test { namespace {

constexpr Real kDt = Real(1) / 60;
using Velocities = std::vector<double>;

/// Balls of 1 m and 1 kg in a row, `gap` apart, after `time`. The first `arriving` balls start at 1 m/s.
template <int D>
Velocities row(const std::string& solver, const std::vector<double>& restitution, int arriving, double gap, Real dt,
               double time) {
  World<D> world = worldOf<D>(solver, Vec<D>::Zero());
  std::vector<BodyHandle> balls;
  for (std::size_t i = 0; i < restitution.size(); ++i) {
    BodyDef<D> ball = body<D>(Shape<D>::sphere(Real(0.5)), at<D>((1 + gap) * double(i), 0));
    ball.velocity[0] = static_cast<int>(i) < arriving ? Real(1) : Real(0);
    ball.shapes[0].restitution = Real(restitution[i]);
    balls.push_back(world.add(ball));
  }
  for (int i = 0; i < static_cast<int>(time / double(dt)); ++i) world.step(dt);
  Velocities out;
  for (const BodyHandle h : balls) out.push_back(double(world.motion(h).v[0]));
  return out;
}
double distance(const Velocities& a, const Velocities& b) {
  double squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(squares);
}

// Sequential impacts: as many balls leave as arrive. Simultaneous impacts: one ball against four. All contacts but the
// first have velocity 0 and keep it, so balls 1 to 4 move as one. With e = 1 the first ball returns from a mass of 4
// with -3/5; momentum and energy leave 2/5 for the others. Poisson's impulses of compression, 4/5, 3/5, 2/5 and 1/5,
// give the common velocity 1/5; the same impulses again give the same result.
TEST_F(KnownAnswer, newton_cradle_touching) {
  const Velocities elastic(5, 1);
  for (const int k : {1, 2, 3}) {
    double worst = 0;
    Velocities leave(5, 0);
    for (int i = 5 - k; i < 5; ++i) leave[static_cast<std::size_t>(i)] = 1;
    for (const std::string& solver : everyVelocity("impact=sequential,")) {
      worst = std::max(worst, distance(row<2>(solver, elastic, k, 0, kDt, 0.1), leave));
      worst = std::max(worst, distance(row<3>(solver, elastic, k, 0, kDt, 0.1), leave));
    }
    known("k = " + std::to_string(k) + ": norm of the error over v", "impact=sequential", 0, worst);
  }
  const Velocities atOnce = {-0.6, 0.4, 0.4, 0.4, 0.4};
  double worst = 0;
  for (const std::string& solver : everyVelocity("impact=poisson,")) {
    worst = std::max(worst, distance(row<2>(solver, elastic, 1, 0, kDt, 0.1), atOnce));
    worst = std::max(worst, distance(row<3>(solver, elastic, 1, 0, kDt, 0.1), atOnce));
  }
  known("k = 1, at once: norm of the error over v", "impact=poisson", 0, worst);
  const std::string newton = "split_solver{velocity=catto{iterations=100,warm_start=false}}";
  worst = std::max(distance(row<2>(newton, elastic, 1, 0, kDt, 0.1), atOnce),
                   distance(row<3>(newton, elastic, 1, 0, kDt, 0.1), atOnce));
  known("k = 1, at once: norm of the error over v", newton, 0, worst);
}

// With gaps of a thousandth of a ball the impacts occur one after another, and all laws agree if steps are shorter than
// the gap.
TEST_F(KnownAnswer, newton_cradle_gaps) {
  for (const int k : {1, 2, 3}) {
    Velocities leave(5, 0);
    for (int i = 5 - k; i < 5; ++i) leave[static_cast<std::size_t>(i)] = 1;
    const auto measure = [&](const std::string& method, const std::string& solver) {
      const auto balls = row<2>(solver, Velocities(5, 1), k, 1e-3, Real(1) / 16000, 0.02);
      known("k = " + std::to_string(k) + ": norm of the error over v", method, 0, distance(balls, leave));
    };
    for (const char* law : {"newton", "poisson", "sequential"}) {
      measure(std::string("impact=") + law, std::string("split_solver{impact=") + law + "}");
    }
    for (const Methods& methods : andSolvers({{"soft_step", {"soft_step"}}})) measure(methods.name, methods.name);
  }
}

// Three touching balls, 1 m/s arrives. The middle ball and the first have e = 0, the last e = 1, so the contacts have e
// = 0 and 1/2. Newton: both contacts end with velocity 0, the first by e = 0, the second because it did not approach:
// all have 1/3. Poisson: compression also ends with 1/3, by the impulses 2/3 and 1/3. The second contact gives back
// 1/6: 1/3, 1/6, 1/2. Now the first approaches and stops: 1/4, 1/4, 1/2. Sequential: 1/2, 1/2, 0; then 1/2, 1/8, 3/8;
// then 5/16, 5/16, 3/8, which separate.
TEST_F(KnownAnswer, impact_unequal_restitution) {
  const std::tuple<const char*, double, double> expected[] = {
      {"newton", 1. / 3, 1. / 3}, {"poisson", 0.25, 0.5}, {"sequential", 5. / 16, 3. / 8}};
  for (const auto& [law, first, last] : expected) {
    const std::string solver =
        std::string("split_solver{impact=") + law + ",velocity=catto{iterations=100,warm_start=false}}";
    const Velocities balls = row<2>(solver, {0, 0, 1}, 1, 0, kDt, 1.5 * double(kDt));
    known("first ball, m/s", std::string("impact=") + law, first, balls[0]);
    known("last ball, m/s", std::string("impact=") + law, last, balls[2]);
  }
}

// Kane and Levinson 1985. A rod of 1 kg and 1 m at 50 degrees has its lower end to the left of its centre. It falls on
// that end with 1 m/s while it moves to the right with 1/2 m/s; mu = 0.7, e = 1, no gravity. Let (x, y) lead from the
// centre to the contact. Then the response (dv_n, dv_t) = G (normal, tangential impulse) at the contact is
//   G = [1/m + x^2/I, -x y/I; -x y/I, 1/m + y^2/I].
// Friction is strong enough to end sliding in each phase, which the test checks. So
//   Newton:   impulse G^-1 ((1 + e) |v_n|, -v_t), after which v_n = e |v_n| and v_t = 0;
//   Poisson:  compression c = G^-1 (|v_n|, -v_t) ends all motion of the contact; restitution is e c_n, and, to keep the
//             contact from sliding, -G_tn / G_tt e c_n.
// The energy grows by (v before + v after) . impulse / 2. By Newton's law the contact slides back before the impact
// ends, and the friction that stopped it then does work on the rod.
struct Blow {
  double gain;    // of energy, relative to the start
  double normal;  // velocity of the contact after it, m/s
  double omega;   // rad/s
};
constexpr double kTilt = 50 * kDegree, kMu = 0.7, kRadius = 0.01, kFall = 1, kSlide = 0.5;
template <int D>
Shape<D> kaneRod() {
  return Shape<D>::capsule(Real(0.5), Real(kRadius));
}
template <int D>
double inertiaOfRod() {
  const MassProperties<D> rod = massProperties(kaneRod<D>(), Real(1));
  return double(rod.inertia(kAngDim<D> - 1, kAngDim<D> - 1) / rod.mass);
}

template <int D>
Blow derived(bool poisson) {
  const double x = -0.5 * std::cos(kTilt), y = -0.5 * std::sin(kTilt) - kRadius, inertia = inertiaOfRod<D>();
  const double nn = 1 + x * x / inertia, nt = -x * y / inertia, tt = 1 + y * y / inertia, det = nn * tt - nt * nt;
  const double wanted = poisson ? kFall : 2 * kFall;
  std::array<double, 2> impulse = {(tt * wanted + nt * kSlide) / det, (-nn * kSlide - nt * wanted) / det};
  EXPECT_LT(std::abs(impulse[1]), kMu * impulse[0]);
  if (poisson) {
    EXPECT_LT(std::abs(nt / tt), kMu);
    impulse[1] -= nt / tt * impulse[0];
    impulse[0] *= 2;
  }
  const double n = -kFall + nn * impulse[0] + nt * impulse[1], t = kSlide + nt * impulse[0] + tt * impulse[1];
  const double before = (kFall * kFall + kSlide * kSlide) / 2;
  return {((n - kFall) * impulse[0] + (t + kSlide) * impulse[1]) / 2 / before, n,
          (x * impulse[0] - y * impulse[1]) / inertia};
}
template <int D>
Blow measured(const std::string& solver) {
  World<D> world = worldOf<D>(solver, Vec<D>::Zero());
  BodyDef<D> ground = body<D>(Shape<D>::plane(), Vec<D>::Zero(), BodyType::fixed);
  BodyDef<D> def = body<D>(kaneRod<D>(), at<D>(0, 0.5 * std::sin(kTilt) + kRadius));
  Ang<D> turn = Ang<D>::Zero();
  turn[kAngDim<D> - 1] = Real(kTilt);
  def.X_WB.q = integrateRotation(Rot<D>{}, turn);
  def.velocity = at<D>(kSlide, -kFall);
  def.shapes[0].density = 1 / massProperties(kaneRod<D>(), Real(1)).mass;
  for (BodyDef<D>* b : {&ground, &def}) b->shapes[0].friction = Real(kMu), b->shapes[0].restitution = 1;
  world.add(ground);
  const BodyHandle rod = world.add(def);
  world.step(kDt / 1000);
  const Motion<D> after = world.motion(rod);
  const double w = double(after.w[kAngDim<D> - 1]), before = (kFall * kFall + kSlide * kSlide) / 2;
  const double energy = double(after.v.squaredNorm()) / 2 + inertiaOfRod<D>() * w * w / 2;
  return {energy / before - 1, double(after.v[1]) - 0.5 * std::cos(kTilt) * w, w};
}

template <int D>
void kane() {
  for (const char* law : {"newton", "poisson", "sequential"}) {
    const std::string name = std::string("impact=") + law;
    const Blow expected = derived<D>(law != std::string("newton"));
    const Blow blow = measured<D>("split_solver{" + name + ",velocity=catto{iterations=200}}");
    EXPECT_EQ(blow.gain > 0, law == std::string("newton")) << law;
    known(in<D>("energy gained"), name, expected.gain, blow.gain);
    known(in<D>("end leaves with, m/s"), name, expected.normal, blow.normal);
    known(in<D>("turns with, rad/s"), name, expected.omega, blow.omega);
  }
}
TEST_F(KnownAnswer, kane_rod) { kane<2>(), kane<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::impact_laws_test
