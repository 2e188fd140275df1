// SPDX-License-Identifier: Zlib
// Slopes, sliding and rolling against the formulas of a first physics course. Gravity is turned instead of the slope.
// So the heading can be turned against the axes, which would show a friction pyramid.
#include "tests/known_answers/known_answer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace friction_test { namespace {

constexpr Real kDt = Real(1) / 60;

// Forces of rest may differ by method; these methods accumulate and obey Coulomb's law.
const std::vector<Methods> kAccumulating =
    andOthers({{"split_solver, any position resolver",
                {"split_solver", "split_solver{position=none}", "split_solver{position=linear}",
                 "split_solver{position=nonlinear}", "split_solver{position=baumgarte}", "split_solver{order=random}"}},
               {"soft_step", {"soft_step"}}});
const char* const kTwo[] = {"split_solver", "soft_step"};

template <int D>
struct Slide {
  World<D> world;
  BodyHandle body;

  Slide(const std::string& solver, double degrees, double heading, double mu, const Shape<D>& shape, double height)
      : Slide(solver, degrees, heading, mu, test::body<D>(shape, at<D>(0, height))) {}
  Slide(const std::string& solver, double degrees, double heading, double mu, BodyDef<D> slider)
      : world(Pipeline::parse("solver=" + solver), settings(degrees, heading)) {
    Vec<D> half = Vec<D>::Constant(200);
    half[1] = 1;
    BodyDef<D> ground = test::body<D>(Shape<D>::box(half), at<D>(0, -1), BodyType::fixed);
    ground.shapes[0].friction = Real(mu);
    world.add(ground);
    for (ShapeDef<D>& s : slider.shapes) s.friction = Real(mu);
    body = world.add(slider);
  }
  static Vec<D> direction(double heading) { return at<D>(std::cos(heading * kDegree), 0, std::sin(heading * kDegree)); }
  static WorldSettings<D> settings(double degrees, double heading) {
    WorldSettings<D> s;
    s.gravity = Real(kG * std::sin(degrees * kDegree)) * direction(heading);
    s.gravity[1] = Real(-kG * std::cos(degrees * kDegree));
    return s;
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds / double(kDt))); ++i) world.step(kDt);
  }
  double along(double heading) const { return double(world.pose(body).p.dot(direction(heading))); }
  double speed(double heading) const { return double(world.motion(body).v.dot(direction(heading))); }
  /// Speed perpendicular to the heading.
  double aside(double heading) const {
    return double((world.motion(body).v - Real(speed(heading)) * direction(heading)).norm());
  }
  /// Speed over the ground of the lowest point of a ball with this radius.
  double slip(double radius) const {
    const Motion<D> m = world.motion(body);
    Vec<D> v = m.v + cross(m.w, at<D>(0, -radius));
    v[1] = 0;
    return double(v.norm());
  }
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

// a = g (sin - mu cos) at 30 degrees and mu 0.3, straight down the slope for any heading.
struct Sliding {
  double speed, aside, way;
};
constexpr double kSlideMu = 0.3;
const double kSlideSpeed = kG * (std::sin(30 * kDegree) - kSlideMu * std::cos(30 * kDegree)),
             kSlideWay = kSlideSpeed / 2;  // m/s and m, after 1 s
template <int D>
Sliding slide(const std::string& solver, double heading) {
  Slide<D> s(solver, 30, heading, kSlideMu, lowBox<D>(), 0.2);
  s.run(1);
  return {s.speed(heading), s.aside(heading), s.along(heading)};
}

template <int D>
void slides() {
  for (const Methods& methods : kAccumulating) {
    Sliding worst{kSlideSpeed, 0, kSlideWay};
    for (const std::string& solver : methods.solvers) {
      for (double heading : headings<D>()) {
        const Sliding s = slide<D>(solver, heading);
        worst = {worse(s.speed, worst.speed, kSlideSpeed), std::max(s.aside, worst.aside),
                 worse(s.way, worst.way, kSlideWay)};
      }
    }
    known(in<D>("v after 1 s"), methods.name, kSlideSpeed, worst.speed);
    known(in<D>("way in 1 s, m"), methods.name, kSlideWay, worst.way);
    if (D == 3) known("v off the heading, m/s", methods.name, 0, worst.aside);
  }
}
TEST_F(KnownAnswer, slope_slide_acceleration) { slides<2>(), slides<3>(); }

// A body sliding at v at an angle to the tangents stops straight ahead after v^2 / (2 mu g). Under a friction pyramid
// each component stops on its own after v_i^2 / (2 mu g): at 45 degrees too early by sqrt(2), at other angles also off
// the line. The body cannot turn, so it does not tip. A step of dt shortens each distance by v dt / 2.
TEST(Friction, APyramidDeflectsSlidingBodiesAConeDoesNot) {
  constexpr double kSpeed = 4, kMu = 0.3, kFull = kSpeed * kSpeed / (2 * kMu * kG);
  for (const double heading : {0., 30., 45.}) {
    const double c = std::cos(heading * kDegree), s = std::sin(heading * kDegree);
    for (const bool pyramid : {false, true}) {
      BodyDef<3> ball = body<3>(Shape<3>::sphere(Real(0.2)), at<3>(0, 0.2));
      ball.rotatable = false, ball.velocity = Real(kSpeed) * Slide<3>::direction(heading);
      Slide<3> slide(pyramid ? "split_solver{velocity=catto{friction=pyramid}}" : "split_solver", 0, 0, kMu, ball);
      slide.run(2);
      const Vec<3> p = slide.world.pose(slide.body).p;
      EXPECT_NEAR(double(p[0]), kFull * (pyramid ? c * c : c), kSpeed * double(kDt)) << pyramid << heading;
      EXPECT_NEAR(double(p[2]), kFull * (pyramid ? s * s : s), kSpeed * double(kDt)) << pyramid << heading;
    }
  }
}

// A failure to slide boxes straight must be declared in info().failures; a declared failure must be observed.
TEST(Slope, SlidesOrSaysThatItDoesNot) {
  for (const Registered* r : Registry::instance().list(StageKind::velocity, 3)) {
    if (r->info.role != AlgorithmRole::competitor) continue;
    const bool told = declares(*r, {r->info.name, {}}, "Slope.SlidesOrSaysThatItDoesNot");
    const Sliding s = slide<3>("split_solver{velocity=" + r->info.name + "}", 15);
    const bool right = std::abs(s.speed - kSlideSpeed) < 0.01 * kSlideSpeed && s.aside < 0.01 * kSlideSpeed;
    EXPECT_EQ(right, !told) << r->info.name;
  }
}

// mu 0.7 > tan 30: the box stays where it has settled, for ten seconds.
template <int D>
void holds() {
  for (const Methods& methods : kAccumulating) {
    double creep = 0;
    for (const std::string& solver : methods.solvers) {
      for (double heading : headings<D>()) {
        Slide<D> s(solver, 30, heading, 0.7, lowBox<D>(), 0.2);
        s.run(1);
        const double from = s.along(heading);
        s.run(10);
        creep = worse(s.along(heading) - from, creep, 0);
      }
    }
    known(in<D>("creep in 10 s, m"), methods.name, 0, creep);
  }
}
TEST_F(KnownAnswer, slope_hold) { holds<2>(), holds<3>(); }

// Creep in five seconds at 0.9 of the critical slope, m.
template <int D>
double creepOnSlope(const std::string& solver) {
  Slide<D> s(solver, std::atan(0.45) / kDegree, 0, 0.5, lowBox<D>(), 0.2);
  s.run(5);
  return std::abs(s.along(0));
}

// Every solver with every part; a solver that declares in info().failures that it creeps must creep in 2D or 3D.
TEST(Slope, HoldsOrSaysThatItDoesNot) {
  EXPECT_EQ(everySolver<2>(true), everySolver<3>(true));
  for (const std::string& solver : everySolver<3>(true)) {
    const bool told = declares<3>(solver, "Slope.HoldsOrSaysThatItDoesNot");
    const double plane = creepOnSlope<2>(solver), space = creepOnSlope<3>(solver);
    EXPECT_EQ(plane < 0.01 && space < 0.01, !told) << solver << ' ' << plane << ' ' << space;
  }
}

// Slips if and only if mu < tan(angle) = 0.57735.
template <int D>
void slips() {
  const double expected = std::tan(30 * kDegree);
  for (const auto& [name, solvers] : allMethods()) {
    const std::string& solver = solvers[0];
    double found = expected;
    for (double heading : headings<D>()) {
      double stays = 0.6, slips = 0.55;
      while (stays - slips > 1e-4) {
        const double mu = (stays + slips) / 2;
        Slide<D> s(solver, 30, heading, mu, lowBox<D>(), 0.2);
        s.run(1);
        const double from = s.along(heading);
        s.run(3);
        (s.along(heading) - from > 1e-3 ? slips : stays) = mu;
      }
      found = worse((stays + slips) / 2, found, expected);
    }
    known(in<D>("mu"), name, expected, found);
  }
}
TEST_F(KnownAnswer, slope_slip_threshold) { slips<2>(), slips<3>(); }

// d = v^2 / (2 mu g), less v dt / 2 by semi-implicit Euler; t = v / (mu g). The box does not turn while it stops.
template <int D>
void stops() {
  const double speed = 5, mu = 0.5, distance = speed * speed / (2 * mu * kG), time = speed / (mu * kG);
  for (const auto& [name, solvers] : allMethods()) {
    const std::string& solver = solvers[0];
    double way = distance, stopped = time, aside = 0;
    for (double heading : headings<D>()) {
      Slide<D> s(solver, 0, heading, mu, lowBox<D>(), 0.2);
      s.world.setMotion(s.body, {Real(speed) * Slide<D>::direction(heading), Ang<D>::Zero()});
      double last = 0;
      while (s.speed(heading) > 1e-3 && s.world.stepCount() < 200) {
        s.world.step(kDt);
        aside = std::max(aside, s.aside(heading));
        last = double(s.world.time());
      }
      way = worse(s.along(heading), way, distance), stopped = worse(last, stopped, time);
    }
    known(in<D>("distance"), name, distance, way);
    known(in<D>("time"), name, time, stopped);
    if (D == 3) known("v off the heading, m/s", name, 0, aside);
  }
}
TEST_F(KnownAnswer, flat_stop) { stops<2>(), stops<3>(); }

// A body that rolls with radius 0.5: an outer shape without mass, and small masses without contacts, at `arm` from the
// centre on each axis. I = k m r^2 holds by the choice of `arm`.
template <int D>
BodyDef<D> hollow(double k) {
  const double r = 0.5, small = 0.05;
  BodyDef<D> def = body<D>(Shape<D>::sphere(Real(r)), at<D>(0, r));
  def.shapes[0].density = 0;
  // 2D: I / m = arm^2 + small^2 / 2. 3D: four of the six balls lie off each axis, I / m = 2/3 arm^2 + 2/5 small^2.
  const double own = small * small * (D == 2 ? 0.5 : 0.4);
  const double arm = std::sqrt((k * r * r - own) * (D == 2 ? 1 : 1.5));
  for (int axis = 0; axis < D; ++axis) {
    for (double side : {-1.0, 1.0}) {
      ShapeDef<D> mass;
      mass.shape = Shape<D>::sphere(Real(small));
      mass.X_BS.p[axis] = static_cast<Real>(side * arm);
      mass.mask = 0;
      def.shapes.push_back(mass);
    }
  }
  return def;
}

// a = g sin / (1 + k), k = I / (m r^2).
TEST_F(KnownAnswer, roll_slope) {
  const auto measure = [&]<int D>(const std::string& what, double k, const BodyDef<D>& def) {
    const double expected = kG * std::sin(30 * kDegree) / (1 + k);
    for (const Methods& methods :
         andSolvers({{"split_solver, any velocity resolver", everyVelocity()}, {"soft_step", {"soft_step"}}})) {
      double speed = expected, slip = 0;
      for (const std::string& solver : methods.solvers) {
        for (double heading : headings<D>()) {
          Slide<D> s(solver, 30, heading, 0.8, def);
          s.run(1);
          speed = worse(s.speed(heading), speed, expected), slip = std::max(slip, s.slip(0.5));
        }
      }
      known(what + ": v after 1 s", methods.name, expected, speed);
      known(what + ": slip, m/s", methods.name, 0, slip);
    }
  };
  measure("disc, 2D", 0.5, body<2>(Shape<2>::sphere(Real(0.5)), at<2>(0, 0.5)));
  measure("thin hoop, 2D", 1, hollow<2>(1));
  measure("ball, 3D", 0.4, body<3>(Shape<3>::sphere(Real(0.5)), at<3>(0, 0.5)));
  measure("thin shell, 3D", 2.0 / 3, hollow<3>(2.0 / 3));
}

// A body rolls without slip if and only if mu >= tan k / (1 + k).
TEST_F(KnownAnswer, roll_slip_threshold) {
  const auto measure = [&]<int D>(const std::string& what, double k, const BodyDef<D>& def) {
    const double expected = std::tan(30 * kDegree) * k / (1 + k);
    for (const char* solver : {"split_solver", "soft_step", "tgs", "tgs_ngs", "xpbd", "avbd"}) {
      double rolls = 1.2 * expected, slips = 0.8 * expected;
      while (rolls - slips > 2e-3 * expected) {
        const double mu = (rolls + slips) / 2;
        Slide<D> s(solver, 30, 0, mu, def);
        s.run(1);
        const double before = s.slip(0.5);
        s.run(1);
        (s.slip(0.5) < before + 0.05 ? rolls : slips) = mu;
      }
      known(what + ": mu", solver, expected, (rolls + slips) / 2);
    }
  };
  measure("disc, 2D", 0.5, body<2>(Shape<2>::sphere(Real(0.5)), at<2>(0, 0.5)));
  measure("thin hoop, 2D", 1, hollow<2>(1));
  measure("ball, 3D", 0.4, body<3>(Shape<3>::sphere(Real(0.5)), at<3>(0, 0.5)));
  measure("thin shell, 3D", 2.0 / 3, hollow<3>(2.0 / 3));
}

// Below mu = tan k / (1 + k) a sphere slides while it rolls: a = g (sin - mu cos).
TEST(Rolling, SlipsWhenFrictionIsTooSmall) {
  const double mu = 0.1;
  Slide<3> s("split_solver", 30, 0, mu, Shape<3>::sphere(Real(0.5)), 0.5);
  s.run(1);
  const double expected = kG * (std::sin(30 * kDegree) - mu * std::cos(30 * kDegree));
  EXPECT_NEAR(s.speed(0), expected, 0.01 * expected);
}

// Thrown without spin, a ball rolls after t = 2 v / (7 mu g) with 5/7 of its speed, a disc after v / (3 mu g) with 2/3.
template <int D>
void bowls() {
  const double v = 7, mu = 0.2, time = D == 2 ? v / (3 * mu * kG) : 2 * v / (7 * mu * kG);
  const double last = D == 2 ? v * 2 / 3 : v * 5 / 7;
  for (const auto& [name, solvers] : allMethods()) {
    Slide<D> s(solvers[0], 0, 0, mu, Shape<D>::sphere(Real(0.5)), 0.5);
    s.world.setMotion(s.body, {at<D>(v, 0), Ang<D>::Zero()});
    while (s.slip(0.5) > 0.02 * v && s.world.stepCount() < 200) s.world.step(kDt);
    known(in<D>("time"), name, time, double(s.world.time()));
    known(in<D>("way, m"), name, (v + last) / 2 * time, s.along(0));
    s.run(1);
    known(in<D>("speed"), name, last, s.speed(0));
  }
}
TEST_F(KnownAnswer, bowling_slide_to_roll) { bowls<2>(), bowls<3>(); }

// A box of width 0.4 and height 1 topples from tan(angle) = 0.4 on. On a steeper slope it slides at any mu below
// tan(angle); there it topples if and only if mu > 0.4.
template <int D>
void topples() {
  Vec<D> half = Vec<D>::Constant(Real(0.2));
  half[1] = Real(0.5);
  for (const char* solver : kTwo) {
    const auto falls = [&](double degrees, double mu) {
      Slide<D> s(solver, degrees, 0, mu, Shape<D>::box(half), 0.5);
      s.run(4);
      return double(s.world.pose(s.body).q.matrix()(1, 1)) < 0.7;
    };
    const auto between = [](double stands, double tips, double width, const auto& fell) {
      while (tips - stands > width) (fell((stands + tips) / 2) ? tips : stands) = (stands + tips) / 2;
      return (stands + tips) / 2;
    };
    known(in<D>("angle, degrees"), solver, std::atan(0.4) / kDegree,
          between(20, 24, 0.02, [&](double degrees) { return falls(degrees, 2); }));
    known(in<D>("on 26 degrees: mu"), solver, 0.4, between(0.3, 0.45, 5e-4, [&](double mu) { return falls(26, mu); }));
  }
}
TEST_F(KnownAnswer, topple_slope) { topples<2>(), topples<3>(); }

// Euler's disk in its steady spin: its centre rests and its point of contact goes round at W. Without slip, w lies
// along the line to that point. For half a thickness h: W^2 sin a (I1 cos a - I3 h / R sin a) = m g (R cos a - h sin
// a).
double diskRate(double radius, double half, double alpha) {
  const double i1 = radius * radius / 4 + half * half / 3, i3 = radius * radius / 2;
  const double s = std::sin(alpha), c = std::cos(alpha);
  return std::sqrt(kG * (radius * c - half * s) / (s * (i1 * c - i3 * half / radius * s)));
}

TEST_F(KnownAnswer, euler_disk) {
  const double radius = 0.04, half = 0.0005, alpha = 10 * kDegree, s = std::sin(alpha), c = std::cos(alpha);
  EXPECT_NEAR(diskRate(radius, 0, alpha), 75.16218360295225, 1e-9);  // thin: W^2 sin a = 4 g / R
  const double rate = diskRate(radius, half, alpha), turn = rate * s;
  const auto spin = [&](const std::string& solver, int steps) {
    World<3> world(Pipeline::parse("contacts=query_clip solver=" + solver));
    BodyDef<3> table = body<3>(Shape<3>::plane(), at<3>(0, 0), BodyType::fixed);
    const Real sizes[2] = {Real(half), Real(radius)};
    BodyDef<3> def = body<3>(Shape<3>::curved(ShapeKind::cylinder, sizes), at<3>(0, radius * s + half * c));
    table.shapes[0].friction = def.shapes[0].friction = 1;
    def.X_WB.q = Rot<3>::vector({0, 0, Real(kPi / 2 - alpha)});  // its axis is its x; its lowest point is towards +x
    def.angularVelocity = at<3>(turn * (c - half / radius * s), -turn * (s + half / radius * c));
    world.add(table);
    const BodyHandle disk = world.add(def);
    double turned = 0, last = 0;
    Vec<3> axis;
    for (int i = 0; i < steps; ++i) {
      world.step(Real(1) / static_cast<Real>(steps));
      axis = world.pose(disk).q * Vec<3>(1, 0, 0);
      const double heading = std::atan2(-double(axis[2]), double(axis[0]));
      turned += std::remainder(heading - last, 2 * kPi), last = heading;
    }
    const std::string dt = "dt = 1/" + std::to_string(steps) + ": ";
    known(dt + "goes round, rad/s", solver, rate, std::abs(turned));
    const double tilt = std::atan2(std::hypot(double(axis[0]), double(axis[2])), double(axis[1]));
    known(dt + "angle after 1 s, degrees", solver, 10, tilt / kDegree);
  };
  spin("split_solver", 4000), spin("soft_step", 4000);
  for (const int steps : {4000, 16000}) spin("split_solver{integrator=rk4}", steps);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::friction_test
