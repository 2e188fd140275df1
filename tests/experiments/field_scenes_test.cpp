// SPDX-License-Identifier: Zlib
// Scenes of the field with closed forms do what these say, and no more than they say.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/runner/locations.h"
#include "experiments/trial/scene_file.h"
#include "framework/director.h"
#include "framework/world.h"

namespace lpc::inline LPC_PRECISION {
namespace {

/// Where the bodies are in the end, and where they were.
template <int D>
struct Played {
  std::vector<Vec<D>> from, to;

  Played(const std::string& name, const ParameterValues& values, long steps, const std::string& pipeline = "") {
    const SceneFile file = SceneFile::load(findToml("scenes", name));
    const SceneSpec<D> scene = file.build<D>(values, file.defaultSeed());
    World<D> world(Pipeline::parse(pipeline), scene.settings);
    Director<D> director(scene);
    for (long i = 0; i < steps; ++i) director.advance(world), world.step(scene.dt);
    for (std::size_t i = 0; i < scene.spawns.size(); ++i) {
      from.push_back(scene.spawns[i].body.X_WB.p);
      const Handle body = director.body(static_cast<int>(i));
      to.push_back(world.valid(body) ? world.pose(body).p : from.back());
    }
  }
  Real moved(std::size_t i) const { return (to[i] - from[i]).norm(); }
  Real farthest() const {
    Real most = 0;
    for (std::size_t i = 0; i < to.size(); ++i) most = std::max(most, moved(i));
    return most;
  }
};

// The harmonic series: a hundredth inside of it stands, a hundredth outside falls.
TEST(FieldScenes, OverhangIsTheHarmonicSeries) {
  const std::string many = "solver=split_solver{velocity=catto{iterations=300}}";
  EXPECT_LT((Played<2>("overhang", {{"n", 6}, {"factor", 0.99}}, 300, many).farthest()), 0.02);
  EXPECT_GT((Played<2>("overhang", {{"n", 6}, {"factor", 1.01}}, 300, many).farthest()), 0.1);
}

// The plate has 0.7385 m/s^2 and each ball 0.211: half of it, after a second.
TEST(FieldScenes, RollingIsTheClosedForm) {
  const Played<3> p("rolling", {}, 1000);
  EXPECT_NEAR(p.moved(1), 0.7385 / 2, 0.7385 / 2 * 0.01);
  for (std::size_t ball = 2; ball < p.to.size(); ++ball) EXPECT_NEAR(p.moved(ball), 0.211 / 2, 0.211 / 2 * 0.03);
}

// tan(42 deg) is between 6/7 and 1: of eight boxes the last stays.
TEST(FieldScenes, RampsHoldByCoulombsLaw) {
  const Played<3> p("ramps_peel", {}, 120);
  for (std::size_t i = 0; i < 8; ++i) {
    const double sine = std::sin(0.7330382858376184), cosine = std::cos(0.7330382858376184);
    const double a = std::max(0.0, 9.81 * (sine - static_cast<double>(i) / 7 * cosine));
    EXPECT_NEAR(p.moved(1 + i), a * 2, 0.02 + 0.03 * a) << i;  // 2 s
  }
}

// w^2 r / g = 0.408: above it the box goes round with the table, below it slides off. A step goes along the tangent, so
// that each makes the radius longer by sqrt(1 + (w dt)^2).
TEST(FieldScenes, TurntableHoldsByItsFriction) {
  const auto radius = [](double friction) {
    const Vec<3> p = Played<3>("turntable", {{"friction", friction}}, 300).to[1];
    return std::hypot(p[0], p[2]);
  };
  EXPECT_NEAR(radius(0.5), std::pow(1 + 0.02 * 0.02, 150), 1e-3);
  EXPECT_GT(radius(0.38), 1.5);
}

// The highest of n boxes of 0.5 m rests at 0.5 (n - 0.5); 2 N do not move what friction holds with 9.81.
TEST(FieldScenes, DartsStackAndPull) {
  EXPECT_NEAR((Played<3>("dart_stack", {}, 300).to.back()[1]), 0.5 * (5 - 0.5), 1e-3);
  EXPECT_LT((Played<2>("friction_hold", {}, 500).moved(1)), 1e-6);
  EXPECT_GT((Played<2>("friction_hold", {{"pull", 12}}, 500).moved(1)), 0.1);
}

// solver2d's ramps: 0.75, 0.5 and 0.35 with 0.2 are above tan(0.25), 0.1 and 0 are not.
TEST(FieldScenes, FrictionRampParts) {
  const Played<2> p("friction_ramp", {}, 120);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(p.moved(4 + i) < 0.05, i < 3) << i << ": " << p.moved(4 + i) << " m";
}

// When the heavy one is gone, the two below must not jump: not by more than the depth that its weight had pressed.
TEST(FieldScenes, WarmStartEnergyDoesNotPop) {
  const Played<2> before("warm_start_energy", {{"remove", 1000}}, 120),
      after("warm_start_energy", {{"remove", 120}}, 240);
  EXPECT_LT(after.to[2][1], 1.5 + 0.01);
  EXPECT_GT(after.to[2][1], before.to[2][1] - 0.01);
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
