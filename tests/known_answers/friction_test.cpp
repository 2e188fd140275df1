// SPDX-License-Identifier: Zlib
// Slopes, sliding and rolling against the formulas of a first physics course. The slope is made by turning gravity, so
// that its heading can be turned against the axes: a friction pyramid would show.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/small_worlds.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

constexpr double kG = 9.81, kDegree = 0.017453292519943295;
constexpr bool kDouble = sizeof(Real) == 8;
constexpr Real kDt = Real(1) / 60;

// What rests on contacts may differ by method; these accumulate and hold to Coulomb's law.
const char* const kSolvers[] = {"split_solver",
                                "split_solver{position=none}",
                                "split_solver{position=linear}",
                                "split_solver{position=nonlinear}",
                                "split_solver{position=baumgarte}",
                                "split_solver{order=random}",
                                "soft_step"};
const char* const kAlsoMillingtonAndNaive[] = {"split_solver", "soft_step", "split_solver{velocity=millington}",
                                               "split_solver{velocity=naive}"};

template <int D>
struct Slide {
  World<D> world;
  Handle body;

  Slide(const std::string& solver, double degrees, double heading, double mu, const Shape<D>& shape, double height)
      : world(Pipeline::parse("solver=" + solver), settings(degrees, heading)) {
    Vec<D> half = Vec<D>::Constant(200);
    half[1] = 1;
    BodyDef<D> ground = test::body<D>(Shape<D>::box(half), at<D>(0, -1), BodyType::fixed);
    ground.shapes[0].friction = Real(mu);
    world.add(ground);
    BodyDef<D> slider = test::body<D>(shape, at<D>(0, height));
    slider.shapes[0].friction = Real(mu);
    body = world.add(slider);
  }
  static Vec<D> direction(double heading) { return at<D>(std::cos(heading * kDegree), 0, std::sin(heading * kDegree)); }
  static WorldSettings<D> settings(double degrees, double heading) {
    WorldSettings<D> s;
    s.gravity = Real(kG * std::sin(degrees * kDegree)) * direction(heading);
    s.gravity[1] = Real(-kG * std::cos(degrees * kDegree));
    return s;
  }
  void run(double seconds, Real dt = kDt) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds / double(dt))); ++i) world.step(dt);
  }
  double along(double heading) const { return double(world.pose(body).p.dot(direction(heading))); }
  double speed(double heading) const { return double(world.motion(body).v.dot(direction(heading))); }
};

template <int D>
Shape<D> lowBox() {
  Vec<D> half = Vec<D>::Constant(Real(0.5));
  half[1] = Real(0.2);
  return Shape<D>::box(half);
}
template <int D>
std::vector<double> headings() {
  if (D == 2) return {0};
  return {0, 15, 30, 45};
}

// a = g (sin - mu cos): 2.35629 m/s^2 at 30 degrees and mu 0.3, straight down the slope.
template <int D>
bool slidesRight(const std::string& solver, double heading) {
  Slide<D> s(solver, 30, heading, 0.3, lowBox<D>(), 0.2);
  s.run(1);
  const double expected = kG * (std::sin(30 * kDegree) - 0.3 * std::cos(30 * kDegree));
  const Vec<D> aside = s.world.motion(s.body).v - Real(s.speed(heading)) * Slide<D>::direction(heading);
  return std::abs(s.speed(heading) - expected) < 0.01 * expected && double(aside.norm()) < 0.01 * expected;
}
template <int D>
void slides() {
  for (const char* solver : kSolvers) {
    for (double heading : headings<D>()) EXPECT_TRUE(slidesRight<D>(solver, heading)) << solver << ' ' << heading;
  }
}
TEST(Slope, Slides2) { slides<2>(); }
TEST(Slope, Slides3) { slides<3>(); }

// Who says in info().failures that boxes do not slide straight must be seen to fail; a new resolver must not.
TEST(Slope, SlidesOrSaysThatItDoesNot) {
  for (const Registered* r : Registry::instance().list(StageKind::velocity, 3)) {
    bool known = false;
    for (const FailureMode& f : r->info.failures) known = known || f.test == "Slope.SlidesOrSaysThatItDoesNot";
    EXPECT_EQ(slidesRight<3>("split_solver{velocity=" + r->info.name + "}", 15), !known) << r->info.name;
  }
}

// mu 0.7 > tan 30: it stays, for ten seconds, to a thousandth of a millimetre a second.
template <int D>
void holds() {
  for (const char* solver : kSolvers) {
    for (double heading : headings<D>()) {
      Slide<D> s(solver, 30, heading, 0.7, lowBox<D>(), 0.2);
      s.run(1);  // settles on its slop
      const double from = s.along(heading);
      s.run(10);
      EXPECT_NEAR(s.along(heading), from, kDouble ? 1e-5 : 1e-3) << solver << ' ' << heading << ' ' << D;
    }
  }
}
TEST(Slope, Holds2) { holds<2>(); }
TEST(Slope, Holds3) { holds<3>(); }

// Slips if and only if mu < tan(angle) = 0.57735.
template <int D>
void threshold() {
  for (const char* solver : {"split_solver", "soft_step"}) {
    for (double heading : headings<D>()) {
      double stays = 0.8, slips = 0.4;
      while (stays - slips > 1e-3) {
        const double mu = (stays + slips) / 2;
        Slide<D> s(solver, 30, heading, mu, lowBox<D>(), 0.2);
        s.run(1);
        const double from = s.along(heading);
        s.run(3);
        (s.along(heading) - from > 1e-3 ? slips : stays) = mu;
      }
      EXPECT_NEAR(stays, std::tan(30 * kDegree), 2e-3) << solver << ' ' << heading << ' ' << D;
    }
  }
}
TEST(Slope, Threshold2) { threshold<2>(); }
TEST(Slope, Threshold3) { threshold<3>(); }

// d = v^2 / (2 mu g) = 2.54842 m, and v dt / 2 less by semi-implicit Euler; soft_step's dt is that of a sub-step. It
// does not turn while it stops.
template <int D>
void stops() {
  for (const char* solver : {"split_solver", "soft_step"}) {
    for (double heading : headings<D>()) {
      Slide<D> s(solver, 0, heading, 0.5, lowBox<D>(), 0.2);
      s.world.setMotion(s.body, {5 * Slide<D>::direction(heading), Ang<D>::Zero()});
      s.run(2);
      const double h = solver[1] == 'o' ? double(kDt) / 4 : double(kDt);
      const double expected = 25 / (2 * 0.5 * kG) - 5 * h / 2;
      EXPECT_NEAR(s.along(heading), expected, 4e-3) << solver << ' ' << heading << ' ' << D;
      const Vec<D> p = s.world.pose(s.body).p - at<D>(0, double(s.world.pose(s.body).p[1]));
      EXPECT_LT(double((p - Real(s.along(heading)) * Slide<D>::direction(heading)).norm()), 4e-3) << solver << heading;
      EXPECT_LT(double(s.world.motion(s.body).v.norm()), 1e-3) << solver << ' ' << heading;
    }
  }
}
TEST(Flat, StopDistance2) { stops<2>(); }
TEST(Flat, StopDistance3) { stops<3>(); }

// a = g sin / (1 + k), k = I / (m r^2): 1/2 for a disc in 2D, 2/5 for a sphere.
template <int D>
void rolls() {
  const double k = D == 2 ? 0.5 : 0.4, expected = kG * std::sin(30 * kDegree) / (1 + k);
  for (const char* solver : kAlsoMillingtonAndNaive) {
    for (double heading : headings<D>()) {
      Slide<D> s(solver, 30, heading, 0.8, Shape<D>::sphere(Real(0.5)), 0.5);
      s.run(1);
      EXPECT_NEAR(s.speed(heading), expected, 0.01 * expected) << solver << ' ' << heading << ' ' << D;
      const Motion<D> m = s.world.motion(s.body);
      const Vec<D> slip = m.v + cross(m.w, Vec<D>(at<D>(0, -0.5)));
      // The anchors of a step turn with the ball, by w dt: that is an arm too long by r (w dt)^2.
      const double w = double(m.w.norm()), arm = 0.5 * w * w * double(kDt) * double(kDt);
      const double slipping = double((slip - at<D>(0, double(slip[1]))).norm());
      EXPECT_LT(slipping, 0.005 * expected + w * arm) << solver << ' ' << heading;
    }
  }
}
TEST(Rolling, DownASlope2) { rolls<2>(); }
TEST(Rolling, DownASlope3) { rolls<3>(); }

// Below mu = tan k / (1 + k) a sphere slides while it rolls: a = g (sin - mu cos).
TEST(Rolling, SlipsWhenFrictionIsTooSmall) {
  const double mu = 0.1;
  Slide<3> s("split_solver", 30, 0, mu, Shape<3>::sphere(Real(0.5)), 0.5);
  s.run(1);
  const double expected = kG * (std::sin(30 * kDegree) - mu * std::cos(30 * kDegree));
  EXPECT_NEAR(s.speed(0), expected, 0.01 * expected);
}

// A ball thrown without spin ends up rolling with 5/7 of its speed, a disc with 2/3.
template <int D>
void bowls() {
  for (const char* solver : {"split_solver", "soft_step"}) {
    Slide<D> s(solver, 0, 0, 0.2, Shape<D>::sphere(Real(0.5)), 0.5);
    s.world.setMotion(s.body, {Vec<D>(at<D>(7, 0)), Ang<D>::Zero()});
    s.run(3);
    const double expected = D == 2 ? 7 * 2.0 / 3 : 5;
    EXPECT_NEAR(s.speed(0), expected, 0.01 * expected) << solver << ' ' << D;
  }
}
TEST(Rolling, SlidesThenRolls2) { bowls<2>(); }
TEST(Rolling, SlidesThenRolls3) { bowls<3>(); }

// A box of width 0.4 and height 1 topples from tan(angle) = 0.4 on.
template <int D>
void topples() {
  Vec<D> half = Vec<D>::Constant(Real(0.2));
  half[1] = Real(0.5);
  for (const char* solver : {"split_solver", "soft_step"}) {
    for (double degrees : {21.3, 22.3}) {
      Slide<D> s(solver, degrees, 0, 2, Shape<D>::box(half), 0.5);
      s.run(4);
      const bool fell = double(s.world.pose(s.body).q.matrix()(1, 1)) < 0.7;
      EXPECT_EQ(fell, degrees > 21.801409) << solver << ' ' << degrees << ' ' << D;
    }
  }
}
TEST(Slope, Topples2) { topples<2>(); }
TEST(Slope, Topples3) { topples<3>(); }

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
