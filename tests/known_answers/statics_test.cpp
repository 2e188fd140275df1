// SPDX-License-Identifier: Zlib
// Forces at rest: under tables, in grooves and under ladders; and a stack, for a minute.
#include <array>

#include "tests/known_answers/known_answer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace statics_test { namespace {

constexpr Real kDt = Real(1) / 60;
const char* const kSolvers[] = {"split_solver", "soft_step", "tgs", "tgs_ngs", "xpbd", "avbd"};

template <int D>
BodyDef<D> rubbing(BodyDef<D> def, double mu) {
  for (ShapeDef<D>& s : def.shapes) s.friction = Real(mu);
  return def;
}
// Force along the normal and across it, N.
template <int D>
std::array<double, 2> force(const Manifold<D>& m) {
  double push = 0;
  RealMatrix<D - 1, 1> friction = RealMatrix<D - 1, 1>::Zero();
  for (int k = 0; k < m.count; ++k) {
    const auto& impulse = m.points[static_cast<std::size_t>(k)].impulse;
    push += double(impulse[0]);
    for (int d = 0; d < D - 1; ++d) friction[d] += impulse[static_cast<std::size_t>(d) + 1];
  }
  return {push / double(kDt), double(friction.norm()) / double(kDt)};
}

// A table of 20 kg on four legs without friction, with 10 kg at 0.3 m to the right. Only the sum of the legs' forces
// and two moments are determined; by symmetry the two legs of a side are equal.
TEST_F(KnownAnswer, four_legged_table) {
  for (const char* solver :
       {"split_solver", "split_solver{velocity=catto{block=true}}", "split_solver{velocity=jacobi}",
        "split_solver{velocity=nncg}", "split_solver{velocity=direct_lcp}", "split_solver{velocity=admm}",
        "split_solver{velocity=shock_propagation}", "soft_step", "tgs", "tgs_ngs", "xpbd", "avbd"}) {
    World<3> world = worldOf<3>(solver);
    world.add(rubbing(body<3>(Shape<3>::box({5, 1, 5}), at<3>(0, -1), BodyType::fixed), 0));
    BodyDef<3> table;
    table.X_WB.p = at<3>(0, 0.7);
    const auto part = [&](const Vec<3>& half, const Vec<3>& place, double kilograms) {
      ShapeDef<3> s{.shape = Shape<3>::box(half)};
      s.X_BS.p = place, s.friction = 0, s.density = Real(kilograms) / (8 * half.prod());
      table.shapes.push_back(s);
    };
    part({Real(0.8), Real(0.02), Real(0.5)}, at<3>(0, 0.02), 20);
    for (const int x : {-1, 1}) {
      for (const int z : {-1, 1}) part({Real(0.03), Real(0.35), Real(0.03)}, at<3>(x * 0.7, -0.35, z * 0.4), 0);
    }
    part({Real(0.1), Real(0.1), Real(0.1)}, at<3>(0.3, 0.14), 10);
    world.add(table);
    for (int i = 0; i < 300; ++i) world.step(kDt);
    double sum = 0, right = 0, front = 0, leg = 0;  // N, N m about the middle, N
    for (const Manifold<3>& m : world.manifolds()) {
      for (int k = 0; k < m.count; ++k) {
        const ContactPoint<3>& c = m.points[static_cast<std::size_t>(k)];
        const double push = double(c.impulse[0]) / double(kDt);
        const Vec<3> p = world.bodies().pose[1] * c.localB;
        sum += push, right += double(p[0]) * push, front += double(p[2]) * push;
        leg += p[0] > 0 && p[2] > 0 ? push : 0;
      }
    }
    const double weight = 30 * kG, moment = 10 * kG * 0.3;
    known("sum over weight", solver, 1, sum / weight);
    known("moment, of the load's", solver, 1, right / moment);
    known("moment to the front, of the load's", solver, 0, front / moment);
    known("front right leg, of the weight", solver, 0.25 + 0.25 * moment / (weight * 0.7), leg / weight);
  }
}

// A disc between smooth planes at 30 and 60 degrees: m g sin b / sin(a + b), m g sin a / sin(a + b).
TEST_F(KnownAnswer, ball_in_a_groove) {
  for (const char* solver : kSolvers) {
    World<2> world = worldOf<2>(solver);
    for (const double degrees : {-30., 60.}) {  // rotation of the plane: the left plane descends to the right
      BodyDef<2> plane = rubbing(body<2>(Shape<2>::plane(), at<2>(0, 0), BodyType::fixed), 0);
      plane.X_WB.q = Rot<2>::angle(Real(degrees * kDegree));
      world.add(plane);
    }
    // The distance r to both planes.
    const double s = std::sin(30 * kDegree), c = std::cos(30 * kDegree), r = 0.5;
    const BodyHandle ball = world.add(rubbing(body<2>(Shape<2>::sphere(Real(r)), at<2>(r * (s - c), r * (c + s))), 0));
    for (int i = 0; i < 300; ++i) world.step(kDt);
    double left = 0, right = 0;
    for (const Manifold<2>& m : world.manifolds()) (m.bodyA == 0 ? left : right) += force(m)[0];
    const double weight = double(world.mass(ball)) * kG;
    known("on 30 degrees, of the weight", solver, c, left / weight);
    known("on 60 degrees, of the weight", solver, s, right / weight);
  }
}

// A box on a slope of 30 degrees, mu 0.7: normal force m g cos, friction m g sin.
template <int D>
void rests() {
  for (const char* solver : kSolvers) {
    WorldSettings<D> settings;
    settings.gravity = at<D>(kG * std::sin(30 * kDegree), -kG * std::cos(30 * kDegree));
    World<D> world(Pipeline::parse("solver=" + std::string(solver)), settings);
    Vec<D> half = Vec<D>::Constant(5), low = Vec<D>::Constant(Real(0.5));
    half[1] = 1, low[1] = Real(0.2);
    world.add(rubbing(body<D>(Shape<D>::box(half), at<D>(0, -1), BodyType::fixed), 0.7));
    const BodyHandle box = world.add(rubbing(body<D>(Shape<D>::box(low), at<D>(0, 0.2)), 0.7));
    for (int i = 0; i < 300; ++i) world.step(kDt);
    ASSERT_EQ(world.manifolds().size(), 1u) << solver;
    const auto [push, friction] = force(world.manifolds()[0]);
    const double weight = double(world.mass(box)) * kG;
    known(in<D>("across, of the weight"), solver, std::cos(30 * kDegree), push / weight);
    known(in<D>("along, of the weight"), solver, 0.5, friction / weight);
  }
}
TEST_F(KnownAnswer, slope_forces) { rests<2>(), rests<3>(); }

// A ladder at 55 degrees against a smooth wall holds if and only if mu >= cot / 2 at the floor. Against a wall as rough
// as the floor it holds if and only if mu >= sqrt(1 + tan^2) - tan. Friction has an arm at ends of radius r = k L. Then
// the limits are mu >= c / 2 (s + k) and mu^2 (c + 2 k) + 2 mu (s + k) = c.
TEST_F(KnownAnswer, ladder) {
  const double angle = 55 * kDegree, half = 1, radius = 0.02, c = std::cos(angle), k = radius / (2 * half);
  const double s = std::sin(angle) + k, least = (std::sqrt(s * s + c * (c + 2 * k)) - s) / (c + 2 * k);
  for (const char* solver : kSolvers) {
    for (const bool rough : {false, true}) {
      const auto stands = [&](double mu) {
        World<2> world = worldOf<2>(solver);
        world.add(rubbing(body<2>(Shape<2>::box({10, 1}), at<2>(0, -1), BodyType::fixed), mu * mu));
        world.add(rubbing(body<2>(Shape<2>::box({1, 10}), at<2>(-1, 10), BodyType::fixed), rough ? mu * mu : 0));
        BodyDef<2> def = rubbing(body<2>(Shape<2>::capsule(Real(half), Real(radius)),
                                         at<2>(half * std::cos(angle) + radius, half * std::sin(angle) + radius)),
                                 1);
        def.X_WB.q = Rot<2>::angle(Real(-angle));
        const BodyHandle rod = world.add(def);
        for (int i = 0; i < 300; ++i) world.step(kDt);
        return double(world.pose(rod).p[1]) > half * std::sin(angle) - 0.1;
      };
      const double expected = rough ? least : c / 2 / s;
      double yes = 1.4 * expected, no = 0.6 * expected;
      while (yes - no > 5e-4 * expected) (stands((yes + no) / 2) ? yes : no) = (yes + no) / 2;
      known(std::string(rough ? "rough" : "smooth") + " wall: mu", solver, expected, (yes + no) / 2);
    }
  }
}

// Ten cubes for a minute: the top one does not move.
TEST_F(KnownAnswer, ten_cubes) {
  for (const char* solver : {"split_solver", "soft_step", "avbd"}) {
    World<3> world = worldOf<3>(solver);
    addGround(world);
    BodyHandle top;
    for (int i = 0; i < 10; ++i) {
      top = world.add(body<3>(Shape<3>::box(Vec<3>::Constant(Real(0.5))), at<3>(0, 0.5 + i)));
    }
    for (int i = 0; i < 3600; ++i) world.step(kDt);
    const Vec<3> p = world.pose(top).p;
    known("top is aside by, m", solver, 0, std::hypot(double(p[0]), double(p[2])));
    known("top is at, m", solver, 9.5, double(p[1]));
  }
}

// A sleeping top, half a degree off the vertical, stays up if and only if (I3 w3)^2 > 4 I1 M g l: 153 rad/s.
TEST_F(KnownAnswer, sleeping_top) {
  const double arm = 0.05, own = 0.0005, i1 = own + arm * arm, tilt = 0.5 * kDegree;
  const double limit = std::sqrt(4 * i1 * kG * arm) / own;
  EXPECT_NEAR(limit, 153.44054223053308, 1e-9);
  const double radius = std::sqrt(own * 2.5);
  for (const char* solver : {"split_solver", "soft_step"}) {
    const auto stays = [&](double spin) {
      World<3> world = worldOf<3>(solver);
      const Vec<3> axis = at<3>(std::sin(tilt), std::cos(tilt));
      BodyDef<3> def = body<3>(Shape<3>::sphere(Real(radius)), Real(arm) * axis);
      def.shapes[0].density = Real(1 / (4.0 / 3 * kPi * radius * radius * radius));
      def.angularVelocity = Real(spin) * axis;
      const BodyHandle top = world.add(def);
      world.add(pivot<3>(BodyHandle{}, top, at<3>(0, 0)));
      for (int i = 0; i < 4000; ++i) {
        world.step(Real(1) / 2000);
        const Vec<3> p = world.pose(top).p;
        if (std::hypot(double(p[0]), double(p[2])) > 0.2 * double(p[1])) return false;
      }
      return true;
    };
    double yes = 200, no = 100;
    while (yes - no > 0.5) (stays((yes + no) / 2) ? yes : no) = (yes + no) / 2;
    known("least spin, rad/s", solver, limit, (yes + no) / 2);
  }
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::statics_test
