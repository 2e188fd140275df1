// SPDX-License-Identifier: Zlib
// The weight of a rolling ball according to the loads that solvers report, and where rolling resistance, which uses
// these loads, stops the ball.
#include <limits>

#include "tests/expect_caught.h"
#include "tests/known_answers/known_answer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace rolling_test { namespace {

constexpr Real kDt = Real(1) / 60;
constexpr double kRadius = 0.5, kSpeed = 1, kLever = 0.02;  // m, m/s, m

/// How the load of a contact is read.
enum class Load {
  asBorne,
  lastSubstep  // a planted bug: the impulses with which the next step starts
};

template <int D>
double loadOf(const Manifold<D>& m, Load load) {
  double sum = 0;
  for (int k = 0; k < m.count; ++k) {
    const ContactPoint<D>& c = m.points[static_cast<std::size_t>(k)];
    sum += double(load == Load::asBorne ? c.load : c.impulse[0]);
  }
  return sum;
}

/// A ball that rolls on a floor without slipping.
template <int D>
struct Roll {
  World<D> world;
  BodyHandle ball;

  explicit Roll(const std::string& solver) : world(worldOf<D>(solver)) {
    BodyDef<D> floor = body<D>(Shape<D>::plane(), at<D>(0, 0), BodyType::fixed);
    floor.shapes[0].friction = 1;
    world.add(floor);
    BodyDef<D> def = body<D>(Shape<D>::sphere(Real(kRadius)), at<D>(0, kRadius));
    def.velocity = at<D>(kSpeed, 0), def.shapes[0].friction = 1;
    def.angularVelocity = Ang<D>::Unit(kAngDim<D> - 1) * Real(-kSpeed / kRadius);
    ball = world.add(def);
  }
  double speed() const { return std::abs(double(world.motion(ball).v[0])); }  // x only: some balls fall by g dt
  double weight() const { return kG * double(world.bodies().mass[static_cast<std::size_t>(ball.slot)]); }
};

/// A rolling resistance computed with a possibly wrong load.
template <int D>
class Resistance final : public ForceGenerator<D> {
 public:
  Resistance(BodyHandle ball, Load load) : m_ball(static_cast<std::size_t>(ball.slot)), m_load(load) {}
  void apply(const ForceState<D>& state, Real, std::span<Wrench<D>> out) const override {
    if (!(state.contactDt > 0)) return;
    const Ang<D>& w = state.motion[m_ball].w;
    const Real speed = w.norm(), inertia = 1 / state.bodies.invInertiaBody[m_ball](0, 0);
    for (const Manifold<D>& m : state.contacts) {
      const Real torque = Real(kLever * loadOf(m, m_load)) / state.contactDt;
      if (speed > 0) out[m_ball].torque -= std::min(torque, speed * inertia / state.dt) / speed * w;
    }
  }

 private:
  std::size_t m_ball;
  Load m_load;
};

/// The mean load over the weight, while the ball rolls for a second.
template <int D>
double meanLoad(const std::string& solver, Load load) {
  Roll<D> roll(solver);
  for (int i = 0; i < 30; ++i) roll.world.step(kDt);
  double sum = 0;
  for (int i = 0; i < 60; ++i) {
    roll.world.step(kDt);
    for (const Manifold<D>& m : roll.world.manifolds()) sum += loadOf(m, load);
  }
  return sum / (60 * double(kDt) * roll.weight());
}
template <int D>
bool loadIsTheWeight(const std::string& solver, Load load = Load::asBorne) {
  return std::abs(meanLoad<D>(solver, load) - 1) < 0.02;
}

/// The stopping distance over v^2 / (2 a), a = c g / (r (1 + k)), k = I / (m r^2); infinite if the ball does not stop.
template <int D>
double way(Roll<D>& roll) {
  const double k = D == 2 ? 0.5 : 0.4, a = kLever * kG / (kRadius * (1 + k));
  for (double t = 0; t < 3 * kSpeed / a; t += double(kDt)) roll.world.step(kDt);
  if (!(roll.speed() < 1e-4 * kSpeed)) return std::numeric_limits<double>::infinity();
  return double(roll.world.pose(roll.ball).p[0]) / (kSpeed * kSpeed / (2 * a));
}
bool isRight(double way) { return std::abs(way - 1) < 0.02; }  // the first step has no load: v dt / 2 is 0.4 % of it

template <int D>
double wayUnder(const std::string& solver) {
  Roll<D> roll(solver);
  roll.world.add(ForceDef<D>{.kind = forceKind("rolling_resistance", {{"coefficient", kLever}})});
  return way(roll);
}
template <int D>
double wayBy(Load load) {
  Roll<D> roll("soft_step");
  roll.world.add(ForceDef<D>{.kind = "rolling_resistance{coefficient=0}"});  // makes the world provide contacts
  roll.world.add(std::make_shared<Resistance<D>>(roll.ball, load));
  return way(roll);
}

// Every solver with every part; a failure that info().failures declares must be observed.
template <int D>
void everyLoad() {
  const std::string name = "Rolling.LoadIsTheWeightOrTheyDeclareIt";
  for (const std::string& solver : everySolver<D>(true)) {
    EXPECT_EQ(loadIsTheWeight<D>(solver), !declares<D>(solver, name))
        << solver << ' ' << D << "D " << meanLoad<D>(solver, Load::asBorne);
  }
  expectCaught("the impulse of the last sub-step for the load", loadIsTheWeight<D>("soft_step", Load::lastSubstep));
}
TEST(Rolling, LoadIsTheWeightOrTheyDeclareIt) { everyLoad<2>(), everyLoad<3>(); }

template <int D>
void everyWay() {
  const std::string name = "Rolling.StopsOrSaysThatItDoesNot";
  for (const std::string& solver : everySolver<D>()) {
    const double way = wayUnder<D>(solver);
    EXPECT_EQ(isRight(way), !declares<D>(solver, name)) << solver << ' ' << D << "D " << way;
  }
  EXPECT_TRUE(isRight(wayUnder<D>("tgs_ngs{arms=detection}"))) << "the ablation of what tgs_ngs declares";
  EXPECT_TRUE(isRight(wayBy<D>(Load::asBorne)));
  expectCaught("resistance by the impulse of the last sub-step", isRight(wayBy<D>(Load::lastSubstep)));
}
TEST(Rolling, StopsOrSaysThatItDoesNot) { everyWay<2>(), everyWay<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::rolling_test
