// SPDX-License-Identifier: Zlib
// Well-known scenes with closed forms behave as these predict.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/experiments/scene_play.h"

namespace lpc { inline namespace LPC_PRECISION { namespace field_scenes_test { namespace {

using test::Play;

/// Positions of the bodies at the start and at the end.
template <int D>
struct Played {
  std::vector<Vec<D>> from, to;

  Played(const std::string& name, const ParameterValues& values, long steps, const std::string& pipeline = "") {
    Play<D> play(name, values, pipeline);
    play.steps(steps);
    for (std::size_t i = 0; i < play.scene.spawns.size(); ++i) {
      from.push_back(play.scene.spawns[i].body.X_WB.p);
      const BodyHandle body = play.director.body(static_cast<int>(i));
      to.push_back(play.world.valid(body) ? play.world.pose(body).p : from.back());
    }
  }
  Real moved(std::size_t i) const { return (to[i] - from[i]).norm(); }
  Real farthest() const {
    Real most = 0;
    for (std::size_t i = 0; i < to.size(); ++i) most = std::max(most, moved(i));
    return most;
  }
};

// The harmonic series: an overhang 1 % smaller stands, one 1 % larger falls.
TEST(FieldScenes, OverhangIsTheHarmonicSeries) {
  const std::string many = "solver=split_solver{velocity=catto{iterations=300}}";
  EXPECT_LT((Played<2>("overhang", {{"n", 6}, {"factor", 0.99}}, 300, many).farthest()), 0.02);
  EXPECT_GT((Played<2>("overhang", {{"n", 6}, {"factor", 1.01}}, 300, many).farthest()), 0.1);
}

// Couplet's arch: 17 stones stand by themselves at thickness / radius = 0.12 and fall at 0.1.
TEST(FieldScenes, TheArchStandsByItsThickness) {
  const std::string many = "solver=split_solver{velocity=catto{iterations=200}}";
  EXPECT_LT((Played<2>("arch", {{"thickness", 0.12}, {"load", 0}}, 600, many).farthest()), 0.002);
  EXPECT_GT((Played<2>("arch", {{"thickness", 0.1}, {"load", 0}}, 100, many).farthest()), 0.25);
}

// solver2d's arch, shaped as its own weight requires, stands under its four boxes.
TEST(FieldScenes, TheArchOfPointsStands) {
  const std::string many = "solver=split_solver{velocity=catto{iterations=200}}";
  EXPECT_LT((Played<2>("arch_solver2d", {}, 300, many).farthest()), 0.02);
  EXPECT_GT((Played<2>("arch_solver2d", {{"friction", 0.0}}, 60, many).farthest()), 0.2);
}

// The plate accelerates at 0.7385 m/s^2 and each ball at 0.211: the distance after a second is half of that.
TEST(FieldScenes, RollingIsTheClosedForm) {
  const Played<3> p("rolling", {}, 1000);
  EXPECT_NEAR(p.moved(1), 0.7385 / 2, 0.7385 / 2 * 0.01);
  for (std::size_t ball = 2; ball < p.to.size(); ++ball) EXPECT_NEAR(p.moved(ball), 0.211 / 2, 0.211 / 2 * 0.03);
}

/// By how much the distance of each of the last n bodies grows from one half second to the next, after `first` steps.
template <int D, std::size_t n>
std::array<double, n> farther(const std::string& scene, long first) {
  Play<D> play(scene, {});
  std::array<std::array<Vec<D>, n>, 3> at;
  for (std::size_t k = 0; k < 3; ++k) {
    play.steps(k == 0 ? first : 30);
    for (std::size_t i = 0; i < n; ++i) {
      at[k][i] = play.world.pose(play.director.body(static_cast<int>(play.scene.spawns.size() - n + i))).p;
    }
  }
  std::array<double, n> out;
  for (std::size_t i = 0; i < n; ++i) out[i] = (at[2][i] - at[1][i]).norm() - (at[1][i] - at[0][i]).norm();
  return out;
}

// PEEL's eight boxes, once on their ramps, slide with a = g (sin - mu cos): each half second they go a / 4 farther than
// in the one before. tan(42 deg) is between 6/7 and 1: the last box sticks.
TEST(FieldScenes, RampsHoldByCoulombsLaw) {
  const auto ways = farther<3, 8>("ramps_peel", 40);
  for (std::size_t i = 0; i < 8; ++i) {
    const double angle = 0.7330382858376184, mu = static_cast<double>(i) / 7;
    EXPECT_NEAR(ways[i], std::max(0.0, 9.81 * (std::sin(angle) - mu * std::cos(angle))) / 4, 0.005) << i;
  }
}

// The same holds for solver2d's five boxes on their upper ramp, where those with friction 0.75, 0.5 and, barely, 0.35
// slow down. mu is the geometric mean of the box's friction and the ramp's 0.2.
TEST(FieldScenes, FrictionRampParts) {
  const auto ways = farther<2, 5>("friction_ramp", 90);
  const double frictions[] = {0.75, 0.5, 0.35, 0.1, 0};
  for (std::size_t i = 0; i < 5; ++i) {
    const double mu = std::sqrt(frictions[i] * 0.2);
    EXPECT_NEAR(ways[i], 10 * (std::sin(0.25) - mu * std::cos(0.25)) / 4, 0.002) << i;
  }
}

// w^2 r / g = 0.408: with more friction the box turns with the table, with less it slides off. A step moves along the
// tangent, so each step multiplies the radius by sqrt(1 + (w dt)^2).
TEST(FieldScenes, TurntableHoldsByItsFriction) {
  const auto radius = [](double friction) {
    const Vec<3> p = Played<3>("turntable", {{"friction", friction}}, 300).to[1];
    return std::hypot(p[0], p[2]);
  };
  EXPECT_NEAR(radius(0.5), std::pow(1 + 0.02 * 0.02, 150), 1e-3);
  EXPECT_GT(radius(0.38), 1.5);
}

// The top of n boxes of 0.5 m rests at 0.5 (n - 0.5). A pull of 2 N does not move a box that friction holds with 9.81
// N.
TEST(FieldScenes, DartsStackAndPull) {
  EXPECT_NEAR((Played<3>("dart_stack", {}, 300).to.back()[1]), 0.5 * (5 - 0.5), 1e-3);
  EXPECT_LT((Played<2>("friction_hold", {}, 500).moved(1)), 1e-6);
  EXPECT_GT((Played<2>("friction_hold", {{"pull", 12}}, 500).moved(1)), 0.1);
}

// The block slides M v^2 / (2 mu g (m + M)) along the plank, within half a step's motion; then both move at m v / (m +
// M).
template <int D>
void stopsOnThePlank(Real heading) {
  Play<D> play("plank", {{"heading", double(heading)}, {"mass", 2.0}});
  play.steps(60);
  const BodyHandle plank = play.body("plank"), block = play.body("block");
  Vec<D> ahead = Vec<D>::Unit(0);
  if constexpr (D == 3) ahead = {std::cos(heading), 0, std::sin(heading)};
  const Vec<D> way = play.world.pose(block).p - play.world.pose(plank).p - Vec<D>::Unit(1) * Real(0.625);
  EXPECT_LT((way - 0.6 * ahead).norm(), 0.03);
  EXPECT_LT((play.world.motion(plank).v - ahead).norm(), 1e-6);
  EXPECT_LT((play.world.motion(block).v - ahead).norm(), 1e-6);
}
TEST(FieldScenes, ThePlankTakesTheBlocksMomentum) { stopsOnThePlank<2>(0), stopsOnThePlank<3>(0.4); }

// When the heavy box is removed, the two below must not jump by more than its weight had pressed them in.
TEST(FieldScenes, WarmStartEnergyDoesNotPop) {
  const Played<2> before("warm_start_energy", {{"remove", 1000}}, 120),
      after("warm_start_energy", {{"remove", 120}}, 240);
  EXPECT_LT(after.to[2][1], 1.5 + 0.01);
  EXPECT_GT(after.to[2][1], before.to[2][1] - 0.01);
}

// The spin about the middle axis has the period 4 K(m) / r and passes zero twice in it; without the gyroscopic term it
// never reverses.
TEST(FieldScenes, TheHandleTurnsOverInItsTime) {
  const auto passages = [](const std::string& integrator) {
    std::vector<double> times;
    Play<3> play("dzhanibekov", {}, "solver=split_solver{integrator=" + integrator + "}");
    play.scene.dt /= 4;
    double before = 7.5;
    for (int i = 0; i < 4 * 300; ++i) {
      play.step();
      const BodyHandle handle = play.body("handle");
      const double now = (play.world.pose(handle).q.inverse() * Vec<3>(play.world.motion(handle).w))[0];
      if (before * now <= 0) times.push_back((i + before / (before - now)) * double(play.scene.dt));
      before = now;
    }
    return times;
  };
  // Two boxes: the bar along y, the stem along x.
  const double bar = 1.0 / 12, stem = 0.2 / 12, center = stem * 0.1 / 0.1;
  const double across = bar * center * center + stem * (0.1 - center) * (0.1 - center);
  const double x = bar * 0.2525 / 3 + stem * 0.005 / 3, y = bar * 0.005 / 3 + stem * 0.0125 / 3 + across;
  const double z = bar * 0.2525 / 3 + stem * 0.0125 / 3 + across;
  const double energy2 = x * 7.5 * 7.5 + y * 5.025 * 5.025, l2 = x * x * 7.5 * 7.5 + y * y * 5.025 * 5.025;
  const double rate = std::sqrt((x - y) * (energy2 * z - l2) / (x * y * z));
  double a = 1, b = std::sqrt(1 - (z - x) * (l2 - energy2 * y) / ((x - y) * (energy2 * z - l2)));
  for (int i = 0; i < 6; ++i) a = (a + b) / 2, b = std::sqrt((2 * a - b) * b);  // K(m) = pi / 2 a
  const double half = 2 * 3.141592653589793 / (2 * a) / rate;
  const std::vector<double> times = passages("rk4");
  ASSERT_EQ(times.size(), static_cast<std::size_t>(5 / half + 0.5));  // the first after a quarter period
  EXPECT_NEAR((times.back() - times.front()) / static_cast<double>(times.size() - 1), half, 1e-4 * half);
  EXPECT_EQ(passages("semi_implicit_euler"), std::vector<double>{});
}

// Steady precession, without nutation, at the slow root of I1 cos(tilt) W^2 - I3 spin W + m g l = 0: one revolution.
TEST(FieldScenes, TheTopGoesRoundSteadily) {
  Play<3> play("spinning_top", {});
  double turned = 0, last = 0, low = 1, high = 0;
  for (int i = 0; i < 7200; ++i) {
    play.step();
    const Vec<3> p = play.world.pose(play.body("top")).p;
    const double heading = std::atan2(-p[2], p[0]), tilt = std::atan2(std::hypot(p[0], p[2]), p[1]);
    turned += std::remainder(heading - last, 2 * 3.141592653589793), last = heading;
    low = std::min(low, tilt), high = std::max(high, tilt);
  }
  EXPECT_NEAR(turned / 1.8, 3.50025873124901, 3.5 * 1e-3);
  EXPECT_LT(high - low, 0.002);
}

// Its springs carry it from the start. Motors of 100 N m per axle on wheels of 0.4 m pull with 500 N until the wheels
// reach their target speed. A wheel counts as m + I / r^2.
template <int D>
void drives(double inertia) {
  Play<D> still("car", {{"speed", 0}, {"bump", 0}});
  still.steps(120);
  EXPECT_NEAR(still.world.pose(still.body("chassis")).p[1], 0.9, 0.002);
  Play<D> level("car", {{"bump", 0}});
  level.steps(60);
  EXPECT_NEAR(level.world.motion(level.body("chassis")).v[0], 500 / (120 + 20 * inertia), 0.12);
  level.steps(240);
  EXPECT_NEAR(level.world.motion(level.body("chassis")).v[0], 12 * 0.4, 0.05);
  Play<D> waves("car", {});
  waves.steps(300);
  const Pose<D>& X = waves.world.pose(waves.body("chassis"));
  EXPECT_GT(X.p[0], 15);
  EXPECT_GT((X.q * Vec<D>(Vec<D>::Unit(1)))[1], 0.9) << "it lies on its side, or its roof";
}
TEST(FieldScenes, TheCarDrives) { drives<2>(0.5), drives<3>(0.4); }

// A ragdoll falls down the stairs: joints and their limits hold.
template <int D>
void fallsInOnePiece() {
  Play<D> play("ragdoll", {{"n", 2}});
  JointError most;
  for (int i = 0; i < 300; ++i) {
    play.step();
    for (const JointRecord<D>& joint : play.world.joints()) {
      JointRows<D> rows;
      jointRows(joint, play.world.bodies(), rows);
      const JointError now = jointError<D>(rows.all());
      most.linear = std::max(most.linear, now.linear), most.angular = std::max(most.angular, now.angular);
    }
  }
  EXPECT_LT(most.linear, 0.03);
  EXPECT_LT(most.angular, 0.3);
  EXPECT_LT(play.world.pose(play.body("head")).p[1], 0.5);
}
TEST(FieldScenes, RagdollsFallInOnePiece) { fallsInOnePiece<2>(), fallsInOnePiece<3>(); }

// proximal_newton holds structures that ten sweeps let collapse within two seconds: the tower of 100 boxes without
// gaps, a box with 10,000 times its mass on top, five levels of cards (in 2D) and the arch. `within` is the farthest
// allowed motion: the boxes on the arch fall through their gaps, the cards close the 4 mm between them.
TEST(FieldScenes, ProximalNewtonHoldsWhatSweepsDrop) {
  const std::string newton = "solver=split_solver{velocity=proximal_newton}";
  const std::string sweeps = "solver=split_solver{velocity=catto{iterations=10}}";
  struct Question {
    const char* scene;
    ParameterValues values;
    long steps;
    Real within;
  };
  const Question tower{"vertical_stack", {{"n", 100}, {"gap", 0}}, 300, Real(1e-3)};
  const Question ratio{"mass_ratio", {{"ratio", 10000}}, 600, Real(1e-3)};
  for (const Question& q : {tower, ratio, {"card_house", {}, 120, Real(0.02)}, {"arch", {}, 120, Real(0.07)}}) {
    EXPECT_LT((Played<2>(q.scene, q.values, q.steps, newton).farthest()), q.within) << q.scene;
    EXPECT_GT((Played<2>(q.scene, q.values, q.steps, sweeps).farthest()), 0.2) << q.scene;
  }
  EXPECT_LT((Played<3>(tower.scene, tower.values, 60, newton).farthest()), tower.within);
  EXPECT_LT((Played<3>(ratio.scene, ratio.values, 60, newton).farthest()), ratio.within);
}

// With many more contacts than bodies need, a resting structure takes few row updates a step.
TEST(FieldScenes, ProximalNewtonIsFastAtRest) {
  for (const auto& [scene, most] : {std::pair("card_house", 100000u), {"arch", 4000u}}) {
    Play<3> play(scene, {}, "solver=split_solver{velocity=proximal_newton}");
    play.steps(70);
    EXPECT_LT(play.world.profiler().frame().work[WorkCount::rowUpdates], most) << scene;
  }
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::field_scenes_test
