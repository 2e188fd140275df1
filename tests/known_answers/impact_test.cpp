// SPDX-License-Identifier: Zlib
// Impacts against formulas: balls head on, off centre, in a row, and on the floor.
#include <algorithm>
#include <array>
#include <memory>

#include "tests/known_answers/known_answer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace impact_test { namespace {

const Methods kLaws{"split_solver, any law of restitution",
                    {"split_solver", "split_solver{impact=poisson}", "split_solver{impact=sequential}"}};
std::vector<Methods> all() {
  Methods impulsive{"split_solver, any velocity resolver and law", kLaws.solvers};
  for (const std::string& solver : everyVelocity()) impulsive.solvers.push_back(solver);
  return andSolvers({impulsive, {"soft_step", {"soft_step"}}});
}

// v1' = ((m1 - e m2) v1 + (1 + e) m2 v2) / (m1 + m2), and likewise v2'; m 1 : 3, v 2 and -1. Returns the largest error
// of a velocity, and of the momentum over m1.
template <int D>
std::array<double, 2> headOn(const std::string& solver) {
  std::array<double, 2> worst{};
  const double expected[][3] = {{0, -0.25, -0.25}, {0.5, -1.375, 0.125}, {1, -2.5, 0.5}};
  for (const auto& [e, v1, v2] : expected) {
    World<D> world = worldOf<D>(solver, Vec<D>::Zero());
    BodyDef<D> a = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(-1, 0));
    BodyDef<D> b = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(1, 0));
    b.shapes[0].density = 3;
    a.velocity = at<D>(2, 0), b.velocity = at<D>(-1, 0);
    a.shapes[0].restitution = b.shapes[0].restitution = Real(e);
    const BodyHandle first = world.add(a), second = world.add(b);
    for (int i = 0; i < 60; ++i) world.step(Real(1) / 60);
    const double u1 = double(world.motion(first).v[0]), u2 = double(world.motion(second).v[0]);
    worst[0] = std::max({worst[0], std::abs(u1 - v1), std::abs(u2 - v2)});
    worst[1] = std::max(worst[1], std::abs(u1 + 3 * u2 + 1));
  }
  return worst;
}
TEST_F(KnownAnswer, collide_1d) {
  for (const Methods& methods : all()) {
    std::array<double, 2> worst{};
    for (const std::string& solver : methods.solvers) {
      for (const auto& here : {headOn<2>(solver), headOn<3>(solver)}) {
        for (std::size_t i = 0; i < 2; ++i) worst[i] = std::max(worst[i], here[i]);
      }
    }
    known("e = 0, 0.5, 1: worst v, m/s", methods.name, 0, worst[0]);
    known("e = 0, 0.5, 1: momentum over m1, m/s", methods.name, 0, worst[1]);
  }
}

// A ball hits a free rod at b = 0.4 from its middle, e = 1: j = (1 + e) v / (1/m + 1/M + b^2/I).
TEST_F(KnownAnswer, collide_offcentre_rod) {
  const double inertia = 2 * (1 + 0.02 * 0.02) / 12, j = 2 * 3 / (1 + 0.5 + 0.16 / inertia), turn = -0.4 * j / inertia;
  for (const Methods& methods : all()) {
    double impulse = j, omega = turn;
    for (const std::string& solver : methods.solvers) {
      World<2> world = worldOf<2>(solver, {0, 0});
      BodyDef<2> rod = body<2>(Shape<2>::box({Real(0.5), Real(0.01)}), {0, 0});
      rod.shapes[0].density = 2 / Real(0.02);  // M = 2
      BodyDef<2> ball = body<2>(Shape<2>::sphere(Real(0.05)), {Real(0.4), Real(0.2)});
      ball.shapes[0].density = Real(1 / (kPi * 0.0025));  // m = 1
      ball.velocity = {0, -3};
      rod.shapes[0].restitution = ball.shapes[0].restitution = 1;
      rod.shapes[0].friction = ball.shapes[0].friction = 0;
      const BodyHandle r = world.add(rod), b = world.add(ball);
      for (int k = 0; k < 12; ++k) world.step(Real(1) / 60);
      impulse = worse(double(world.motion(b).v[1]) + 3, impulse, j);
      omega = worse(double(world.motion(r).w[0]), omega, turn);
    }
    known("impulse, N s", methods.name, j, impulse);
    known("angular velocity, rad/s", methods.name, turn, omega);
  }
}

// Five balls with gaps: k arrive, k leave, one impact after another.
TEST_F(KnownAnswer, newton_cradle_5) {
  for (const Methods& methods : all()) {
    for (int arriving : {1, 2, 3}) {
      double worst = 0;
      for (const std::string& solver : methods.solvers) {
        World<2> world = worldOf<2>(solver, {0, 0});
        std::vector<BodyHandle> balls;
        for (int i = 0; i < 5; ++i) {
          // Gaps wider than the motion of a step plus the margin: one impact at a time.
          BodyDef<2> ball = body<2>(Shape<2>::sphere(Real(0.5)), at<2>(1.1 * i - (i < arriving ? 0.5 : 0), 0));
          ball.velocity = {Real(i < arriving ? 1 : 0), 0};
          ball.shapes[0].restitution = 1;
          balls.push_back(world.add(ball));
        }
        for (int i = 0; i < 180; ++i) world.step(Real(1) / 60);
        double squares = 0;
        for (int i = 0; i < 5; ++i) {
          const double v = double(world.motion(balls[static_cast<std::size_t>(i)]).v[0]), leaves = i >= 5 - arriving;
          squares += (v - leaves) * (v - leaves);
        }
        worst = std::max(worst, std::sqrt(squares));
      }
      known("k = " + std::to_string(arriving) + ": norm of the error over v", methods.name, 0, worst);
    }
  }
}

template <int D>
struct Drop {
  World<D> world;
  BodyHandle ball;
  // From a gap of 1 m.
  Drop(const std::string& solver, double e, const WorldSettings<D>& settings = {})
      : world(Pipeline::parse("solver=" + solver), settings) {
    BodyDef<D> ground = body<D>(Shape<D>::box(Vec<D>::Ones()), at<D>(0, -1), BodyType::fixed);
    BodyDef<D> def = body<D>(Shape<D>::sphere(Real(0.25)), at<D>(0, 1.25));
    ground.shapes[0].restitution = def.shapes[0].restitution = Real(e);
    world.add(ground);
    ball = world.add(def);
  }
  double gap() const { return double(world.pose(ball).p[1]) - 0.25; }
  double v() const { return double(world.motion(ball).v[1]); }
};

// Heights of bounces, h e^(2n); a step of dt blurs an impact by v dt. Impacts below the restitution threshold do not
// bounce: the fifth at e = 0.5 would fall from 4 mm.
template <int D>
std::vector<double> summits(const std::string& solver, double e, int count, Real dt) {
  Drop<D> drop(solver, e);
  std::vector<double> heights;
  double previous = 0;
  while (static_cast<int>(heights.size()) < count && drop.world.stepCount() < 200000) {
    drop.world.step(dt);
    if (previous > 0 && drop.v() <= 0) heights.push_back(drop.gap());
    previous = drop.v();
  }
  return heights;
}

TEST_F(KnownAnswer, bounce) {
  for (const Methods& methods : all()) {
    for (const auto& [e, name, last] :
         {std::tuple(0.5, "e = 0.5", 3), std::tuple(0.8, "e = 0.8", 5), std::tuple(0.95, "e = 0.95", 5)}) {
      for (int n : {1, last}) {
        const double expected = std::pow(e, 2 * n);
        double worst = expected;
        for (const std::string& solver : methods.solvers) {
          for (const auto& heights :
               {summits<2>(solver, e, n, Real(1) / 2000), summits<3>(solver, e, n, Real(1) / 2000)}) {
            ASSERT_EQ(heights.size(), static_cast<std::size_t>(n)) << solver;
            worst = worse(heights.back(), worst, expected);
          }
        }
        known(name + (": height " + std::to_string(n)), methods.name, expected, worst);
      }
    }
  }
}

// A ball that bounces for ever rests after sqrt(2 h / g) (1 + e) / (1 - e); here measured until it has 2 cm/s.
TEST_F(KnownAnswer, bounce_time) {
  WorldSettings<2> settings;
  settings.restitutionThreshold = Real(0.01);
  for (const auto& [e, name] : {std::tuple(0.5, "e = 0.5"), std::tuple(0.8, "e = 0.8"), std::tuple(0.95, "e = 0.95")}) {
    const double expected = std::sqrt(2 / kG) * (1 + e) / (1 - e);
    const double length = (1 + e * e) / (1 - e * e);
    double worst = expected, path = length;
    for (const std::string& solver : kLaws.solvers) {
      Drop<2> drop(solver, e, settings);
      double moved = 0, way = 0;
      for (int i = 1; i < 1.2 * expected * 2000; ++i) {
        drop.world.step(Real(1) / 2000);
        way += std::abs(drop.v()) / 2000;
        if (std::abs(drop.v()) > 0.02) moved = i / 2000.;
      }
      worst = worse(moved, worst, expected), path = worse(way, path, length);
    }
    known(std::string(name) + ": path, m", kLaws.name, length, path);
    known(std::string(name) + ": at rest after, s", kLaws.name, expected, worst);
  }
}

// e = 1: the energy must not rise. soft_step ends a bounce within the step of contact, which loses energy.
TEST_F(KnownAnswer, bounce_elastic_energy) {
  for (const Methods& methods : all()) {
    const std::size_t count = methods.name.starts_with("split_solver") ? 1000 : 25;
    double highest = 1, last = 1;
    for (const std::string& solver : methods.solvers) {
      const auto heights = summits<2>(solver, 1, static_cast<int>(count), Real(1) / 120);
      ASSERT_EQ(heights.size(), count) << solver;
      highest = worse(*std::max_element(heights.begin(), heights.end()), highest, 1);
      last = worse(heights.back() / heights.front(), last, 1);
    }
    known("highest of " + std::to_string(count), methods.name, 1, highest);
    known("last of " + std::to_string(count) + " over first", methods.name, 1, last);
  }
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::impact_test
