// SPDX-License-Identifier: Zlib
// Scenes of joints, including those of the 2009 report, behave as described.
#include <gtest/gtest.h>

#include <cmath>

#include "framework/world/invariants.h"
#include "tests/experiments/scene_play.h"

namespace lpc { inline namespace LPC_PRECISION { namespace joint_scenes_test { namespace {

using test::Play;

constexpr double kPi = 3.141592653589793;

/// Steps, and returns the largest joint error (m) after any step.
template <int D>
double worstJoint(Play<D>& play, long steps) {
  double worst = 0;
  for (long i = 0; i < steps; ++i) {
    play.step();
    worst = std::max(worst, stateInvariants<D>(play.world).jointError);
  }
  return worst;
}
template <int D>
double energy(const Play<D>& play) {
  const StateInvariants<D> now = stateInvariants<D>(play.world);
  return now.kinetic + now.potential;
}
/// Rotation of a body about z, rad.
double turn(const Rot<2>& q) { return angleOf(q.s, q.c); }
double turn(const Rot<3>& q) { return 2 * angleOf(q.z, q.w); }

/// Period (s) between the first and last upward zero crossing of the value that step() returns, by the number of
/// periods between them.
template <class Step>
double period(const Step& step, double dt, int steps) {
  double first = 0, last = 0, before = step();
  int swings = -1;
  for (int i = 1; i < steps; ++i) {
    const double now = step();
    if (before < 0 && now >= 0) {
      last = (i - now / (now - before)) * dt;
      if (++swings == 0) first = last;
    }
    before = now;
  }
  return swings > 0 ? (last - first) / swings : 0;
}

// Bernoulli's slowest mode of a hanging chain has the shape J0(2.4048 sqrt(s / length)), with s from the lower end.
// Other modes do not contribute to this product. Links of a twentieth of the length make the period differ by less than
// a hundredth.
template <int D>
void swingsAsAChain() {
  Play<D> play("chain", {{"n", 20}, {"link", 0.2}, {"angle", 0.02}});
  play.scene.dt /= 4;
  const double dt = double(play.scene.dt), found = period(
                                               [&] {
                                                 play.step();
                                                 double sum = 0;
                                                 for (int i = 0; i < 20; ++i) {
                                                   const double s = 4 - 0.2 * (i + 0.5);
                                                   const BodyHandle link = play.director.body(i);
                                                   sum += double(play.world.pose(link).p[0]) *
                                                          std::cyl_bessel_j(0.0, 2.404825557695773 * std::sqrt(s / 4));
                                                 }
                                                 return sum;
                                               },
                                               dt, 2400);
  EXPECT_NEAR(found / (2 * kPi / (2.404825557695773 / 2 * std::sqrt(9.8 / 4))), 1, 0.01);
  Play<D> level("chain", {});
  EXPECT_LT(worstJoint(level, 600), 0.15);
}
TEST(JointScenes, TheChainSwingsAsBernoulliSays) { swingsAsAChain<2>(), swingsAsAChain<3>(); }

// A double pendulum with short steps keeps its energy; 1 is the energy lost from horizontal to hanging.
template <int D>
void keepsItsEnergy() {
  Play<D> play("double_pendulum", {});
  play.scene.dt /= 32;
  const double before = energy(play);
  play.step();
  const double scale = double(play.world.mass(play.body("upper"))) * 9.8 * 2;
  EXPECT_LT(worstJoint(play, 32 * 120), 0.001);
  EXPECT_NEAR((energy(play) - before) / scale, 0, 0.02);
}
TEST(JointScenes, TheDoublePendulumKeepsItsEnergy) { keepsItsEnergy<2>(), keepsItsEnergy<3>(); }

// The law of the lever.
template <int D>
void balances() {
  const auto angle = [](const ParameterValues& values) {
    Play<D> play("see_saw", values);
    EXPECT_LT(worstJoint(play, 300), 0.02);
    return turn(play.world.pose(play.body("plank")).q);
  };
  EXPECT_NEAR(angle({}), 0, 0.02);
  EXPECT_LT(angle({{"right", 1.2}}), -0.1);
  EXPECT_GT(angle({{"left", 2.4}}), 0.1);
  EXPECT_LT(angle({{"left_arm", 0.8}}), -0.1);
}
TEST(JointScenes, TheSeeSawIsALever) { balances<2>(), balances<3>(); }

template <int D>
void swings() {
  Play<D> play("swing", {});
  play.step();
  const BodyHandle plank = play.body("plank"), load = play.body("load");
  double most = 0, apart = 0;
  const double found = period(
      [&] {
        play.step();
        const Pose<D>& X = play.world.pose(plank);
        most = std::max(most, std::abs(turn(X.q)));
        apart = std::max(apart, std::abs(double(play.world.pose(load).p[0] - X.p[0])));
        return double(X.p[0]);
      },
      double(play.scene.dt), 600);
  const double angle = 0.3, heavy = 4, chains = 1;
  const double expected = 2 * kPi * std::sqrt((heavy + chains / 3) / (heavy + chains / 2) * 2 / 9.8);
  EXPECT_NEAR(found / (expected * (1 + angle * angle / 16)), 1, 0.02);
  EXPECT_LT(most, 0.05) << "the plank stays level";
  EXPECT_LT(apart, 0.02) << "the load stays on its place";
  Play<D> slips("swing", {{"friction", 0.15}});
  EXPECT_LT(worstJoint(slips, 60), 0.05);
  EXPECT_GT(std::abs(double(slips.world.pose(slips.body("load")).p[0] - slips.world.pose(slips.body("plank")).p[0])),
            0.02);
}
TEST(JointScenes, TheSwingIsAPendulumThatStaysLevel) { swings<2>(), swings<3>(); }

// From bank to bank.
template <int D>
void crosses() {
  Play<D> play("rope_bridge", {});
  EXPECT_LT(worstJoint(play, 420), 0.05);
  const Pose<D>& X = play.world.pose(play.body("chassis"));
  EXPECT_GT(X.p[0], 6);
  EXPECT_NEAR(X.p[1], 0.9, 0.1);
  EXPECT_GT((X.q * Vec<D>(Vec<D>::Unit(1)))[1], 0.99);
}
TEST(JointScenes, TheCarCrossesTheRopeBridge) { crosses<2>(), crosses<3>(); }

// Clock hands with ratios 60 and 12, over ten turns of the first.
template <int D>
void tellsTheTime() {
  Play<D> play("gear_clock", {});
  double turned[3] = {}, last[3] = {};
  const char* const hands[] = {"second", "minute", "hour"};
  for (int i = 0; i < 600; ++i) {
    play.step();
    for (int k = 0; k < 3; ++k) {
      const double now = turn(play.world.pose(play.body(hands[k])).q);
      turned[k] += std::remainder(now - last[k], 2 * kPi), last[k] = now;
    }
  }
  EXPECT_NEAR(turned[0], -20 * kPi, 0.2);
  EXPECT_NEAR(turned[1], turned[0] / 60, 1e-3);
  EXPECT_NEAR(turned[2], turned[0] / 720, 1e-4);
}
TEST(JointScenes, TheClocksHandsKeepTheirRatios) { tellsTheTime<2>(), tellsTheTime<3>(); }

// Lifted by its end and carried: the end hangs g / (2 pi f)^2 below the pointer when nearly still. After release it
// lies. A force below half the weight, which the end carries, does not lift it.
template <int D>
void carries() {
  const auto end = [](const Play<D>& play) -> Vec<D> {
    return play.world.pose(play.body("plank")) * Vec<D>(Real(0.9) * Vec<D>::Unit(0));
  };
  Play<D> play("pointer", {{"hertz", 1}, {"drop", 10000}});
  play.steps(1800);
  const Vec<D> away = play.world.pose(play.body("hand")).p - end(play);
  EXPECT_NEAR(away[0], 0, 0.02);
  EXPECT_NEAR(away[1], 9.8 / (4 * kPi * kPi), 0.01);
  Play<D> drops("pointer", {});
  drops.steps(480);
  EXPECT_GT(end(drops)[1], 2.9);
  EXPECT_NEAR(end(drops)[0], 2.9, 0.1);
  drops.steps(120);
  EXPECT_LT(end(drops)[1], 0.3);
  const double weight = 9.8 * double(drops.world.mass(drops.body("plank")));
  Play<D> weak("pointer", {{"force", 0.4 * weight}});
  weak.steps(120);
  EXPECT_NEAR(end(weak)[1], 0.1, 0.01);
}
TEST(JointScenes, ThePointerCarriesByItsForce) { carries<2>(), carries<3>(); }

// Closed and pulled for two seconds, each tooth stays in place to a tenth of a head. Without the slider the rows
// separate.
TEST(JointScenes, TheZipCloses) {
  const auto worst = [](const ParameterValues& values) {
    Play<2> play("zip", values);
    EXPECT_LT(worstJoint(play, 600), 0.05);
    double out = 0;
    for (int i = 0; i < 12; ++i) {  // the left row from body 2 on, then the right row
      const bool left = i < 6;
      const Vec<2> closed(Real(left ? -0.9 : 0.9), Real((left ? 1 : 1.5) + i % 6));
      out = std::max(out, double((play.world.pose(play.director.body(2 + i)).p - closed).norm()));
    }
    return out;
  };
  EXPECT_LT(worst({}), 0.15);
  EXPECT_GT(worst({{"speed", 0}}), 3);
}

// All of preset 8: the pendulum swings through, the cradle releases one ball for each that hits, the seesaw tips to the
// heavier side, the vehicle crosses the bridge.
TEST(JointScenes, Preset8BehavesAsInTheReport) {
  Play<2> play("preset_8", {}, "solver=split_solver{impact=sequential}");
  const auto x = [&](int body) { return double(play.world.pose(play.director.body(body)).p[0]); };
  constexpr int kPendulum = 4, kBall = 7, kChassis = 28;
  ASSERT_EQ(play.scene.spawns[kChassis].body.name, "chassis");
  EXPECT_LT(worstJoint(play, 108), 0.1);  // the cradle's second turning point
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(x(kBall + i), i - 7, 0.05) << i;
  EXPECT_GT(x(kBall + 4) - (4 - 7), 0.9 * 3 * std::sin(0.8));
  EXPECT_LT(x(kPendulum), -18.5);
  EXPECT_LT(worstJoint(play, 492), 0.1);
  EXPECT_GT(turn(play.world.pose(play.body("see_saw")).q), 0.2);
  EXPECT_GT(x(kChassis), 10.7);
  // The springs hold two boxes and one box of 1 kg each; after ten seconds they still swing about these positions.
  const auto height = [&](const char* name) { return double(play.world.pose(play.body(name)).p[1]); };
  EXPECT_NEAR(height("hung"), 10 - 3 - 2 * 9.8 / 40, 0.1);
  EXPECT_NEAR(height("hung_below"), height("hung") - 2 - 9.8 / 40, 0.1);
}

// Parameters that depart from a method's source change what their names say.
TEST(Variants, ShortenedXpbdCorrectionsLeaveMoreError) {
  Play<2> whole("pendulum", {}, "solver=xpbd"), half("pendulum", {}, "solver=xpbd{joint_share=0.5}");
  EXPECT_GT(worstJoint(half, 120), 1000 * worstJoint(whole, 120));
}
TEST(Variants, AvbdRowsOfTheStartKeepMoreAngularMomentum) {
  const auto lost = [](const std::string& solver) {
    Play<2> play("turning_cluster", {}, "solver=" + solver);
    play.step();  // so that the bodies exist
    const double before = invariants(play.world).angularMomentum[0];
    play.steps(59);
    return std::abs(invariants(play.world).angularMomentum[0] - before);
  };
  EXPECT_LT(lost("avbd{rows=start}"), 0.1 * lost("avbd"));
}
TEST(Variants, TgsRelaxesAfterEachSubstepOrTheLast) {
  const auto rows = [](const std::string& solver) {
    Play<2> play("vertical_stack", {{"n", 3}}, "solver=" + solver);
    play.steps(60);
    return double(play.world.profiler().frame().work[WorkCount::rowUpdates]);
  };
  // Four sub-steps of one sweep each, with two relaxation sweeps after each or once.
  EXPECT_GT(rows("tgs"), 0);
  EXPECT_EQ(rows("tgs") / 12, rows("tgs{relax_at=end}") / 6);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::joint_scenes_test
