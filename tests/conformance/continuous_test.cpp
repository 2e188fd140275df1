// SPDX-License-Identifier: Zlib
// Every registered method of continuous collision, in worlds where bodies move far in a step. A failure that
// info().failures declares must be observed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/conformance/surface_across.h"
#include "tests/expect_caught.h"
#include "tests/planted_bugs/continuous_bugs.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace continuous_test {

constexpr Real kDt = Real(1) / 60;

template <int D>
WorldSettings<D> weightless() {
  WorldSettings<D> settings;
  settings.gravity = Vec<D>::Zero();
  return settings;
}

template <int D>
struct Range {
  World<D> world;
  double lost = 0;  // s, during which bodies were stopped

  explicit Range(const std::string& method, const WorldSettings<D>& settings = weightless<D>())
      : world(Pipeline::parse("continuous=" + method), settings) {}

  BodyHandle add(const Shape<D>& shape, const Vec<D>& place, const Vec<D>& velocity, double turn = 0, double spin = 0) {
    BodyDef<D> def = body<D>(shape, place);
    def.velocity = velocity;
    def.angularVelocity[kAngDim<D> - 1] = static_cast<Real>(spin);
    Ang<D> angle = Ang<D>::Zero();
    angle[kAngDim<D> - 1] = static_cast<Real>(turn);
    def.X_WB.q = integrateRotation({}, angle);
    return world.add(def);
  }
  // A wall of half thickness `half` and half height `high` in the other directions.
  BodyHandle wall(const Vec<D>& place, double half, double high = 4) {
    Vec<D> size = Vec<D>::Constant(static_cast<Real>(high));
    size[0] = static_cast<Real>(half);
    return world.add(body<D>(Shape<D>::box(size), place, BodyType::fixed));
  }
  void steps(int n) {
    for (int i = 0; i < n; ++i) world.step(kDt), lost += world.profiler().frame().lostTime;
  }
  double x(BodyHandle h) const { return double(world.pose(h).p[0]); }
};

// The projectiles: a ball, a box on its edge, a lying capsule, and two balls on one bar.
template <int D>
std::vector<Shape<D>> bullets() {
  const Shape<D> ball = Shape<D>::sphere(Real(0.1));
  Pose<D> left, right;
  left.p[0] = Real(-0.2), right.p[0] = Real(0.2);
  const std::vector<ShapePart<D>> dumbbell = {{ball, left}, {ball, right}};
  std::vector<Shape<D>> out = {ball, Shape<D>::box(Vec<D>::Constant(Real(0.1))),
                               Shape<D>::capsule(Real(0.3), Real(0.05)), Shape<D>::compound(dumbbell)};
  if constexpr (D == 2) out.push_back(Shape<D>::segment(Real(0.3)));  // it has no inner ball
  return out;
}

// --- properties of every method; each returns whether it holds, so that planted bugs can fail ------------------------

// No body passes through a wall of any thickness from any place in front of it, also when it turns about the place of
// impact.
template <int D>
bool areStopped(const std::string& method, const std::vector<Shape<D>>& shot) {
  for (const Shape<D>& bullet : shot) {
    // A segment has no inner ball, and depth does not tell on which side of a wall of 1 mm it is.
    const bool thick = bullet.convex() && bullet.kind() == ShapeKind::segment;
    for (const double half : {thick ? 0.01 : 0.0005, 0.02}) {
      for (int phase = 0; phase < 8; ++phase) {
        Range<D> w(method);
        w.wall(Vec<D>::Zero(), half);
        const BodyHandle h = w.add(bullet, at<D>(-9 - 0.83 * phase, 0.3), at<D>(400, 3), 0.7);
        w.steps(8);
        if (!(w.x(h) < 0)) return false;
      }
    }
  }
  return true;
}

template <int D>
bool ballIsStopped(const std::string& method) {
  return areStopped<D>(method, {Shape<D>::sphere(Real(0.1))});
}
template <int D>
bool bulletIsStopped(const std::string& method) {
  return areStopped<D>(method, bullets<D>());
}

// Thin surfaces hold balls, boxes, capsules and pointed bodies that turn, at any angle of impact. A body that gets
// behind is not pushed back.
template <int D>
bool surfaceIsNotPassed(const std::string& method) {
  std::vector<Vec<D>> corners = {at<D>(-0.1, -0.1, -0.1), at<D>(0.2, -0.1, 0.1), at<D>(-0.1, 0.2, 0.1)};
  if constexpr (D == 3) corners.push_back(at<D>(0.1, 0.1, -0.2));
  std::vector<Shape<D>> shot = bullets<D>();
  shot.resize(3), shot.push_back(Shape<D>::polytope(corners));
  const Shape<D> surface = surfaceAcross<D>();
  Random random(28);
  for (int k = 0; k < 20; ++k) {
    for (const Shape<D>& bullet : shot) {
      Range<D> w(method);
      w.world.add(body<D>(surface, Vec<D>(Vec<D>::Zero()), BodyType::fixed));
      // One after the other: compilers differ in the order of arguments.
      const double y = random.uniform(-2, 2), x = random.uniform(-0.9, -0.4);
      const double along = random.uniform(0, 2), into = random.uniform(1, 2);
      const double spin = random.uniform(-10, 10), angle = random.uniform(-3, 3);
      const Vec<D> velocity = at<D>(std::pow(10, into), std::pow(10, along));
      const BodyHandle h = w.add(bullet, at<D>(x, y, 0.1 * k), velocity, angle, spin);
      w.steps(12);
      if (!(w.x(h) < 0.05)) return false;
    }
  }
  return true;
}

// The centre passes above the end of a wall that the body hits with its lowest tenth.
template <int D>
bool edgeIsMet(const std::string& method) {
  Range<D> w(method);
  w.wall(at<D>(0, -2), 0.01, 2);
  Vec<D> half = Vec<D>::Constant(Real(0.5));
  half[1] = 1;
  const BodyHandle h = w.add(Shape<D>::box(half), at<D>(-8.1, 0.9), at<D>(300, 0));
  w.steps(4);
  return (w.world.motion(h).v - at<D>(300, 0)).norm() > 1;
}

// The end of a rod moves 0.6 m a step, past a post of 2 cm. The rod's centre does not move.
template <int D>
bool spinningRodIsStopped(const std::string& method) {
  Range<D> w(method);
  Vec<D> half = Vec<D>::Constant(Real(0.02));
  half[0] = 2;
  BodyDef<D> rod = body<D>(Shape<D>::box(half), Vec<D>(Vec<D>::Zero()));
  rod.angularVelocity[kAngDim<D> - 1] = 18, rod.pinned = true;
  const BodyHandle h = w.world.add(rod);
  // 0.94 rad further, between the start and the end of the third step.
  w.world.add(
      body<D>(Shape<D>::sphere(Real(0.02)), at<D>(1.5 * std::cos(0.78), 1.5 * std::sin(0.78)), BodyType::fixed));
  for (int i = 0; i < 8; ++i) {
    w.steps(1);
    const Vec<D> along = w.world.pose(h).q * Vec<D>::Unit(0);
    if (std::atan2(double(along[1]), double(along[0])) > 0.79) return false;
  }
  return true;
}

// Two projectiles that meet head on, and a fast one behind a slower one.
template <int D>
bool fastOnesMeet(const std::string& method) {
  for (const double speed : {-300.0, 40.0}) {
    for (int phase = 0; phase < 6; ++phase) {
      Range<D> w(method);
      const Shape<D> ball = Shape<D>::sphere(Real(0.1));
      w.add(ball, at<D>(-2.2 - 0.7 * phase, 0), at<D>(310, 0));
      const BodyHandle b = w.add(ball, at<D>(2, 0.02), at<D>(speed, 0));
      w.steps(6);
      if (!((w.world.motion(b).v - at<D>(speed, 0)).norm() > 1)) return false;
    }
  }
  return true;
}

// A heavy ball hits a light one, which flies off within the same step, towards a wall.
template <int D>
bool sentOnItsWayIsStopped(const std::string& method) {
  Range<D> w(method);
  w.wall(at<D>(1, 0), 0.005);
  BodyDef<D> heavy = body<D>(Shape<D>::sphere(Real(0.2)), at<D>(-0.205, 0));
  heavy.shapes[0].density = 1000, heavy.velocity = at<D>(200, 0);
  BodyDef<D> light = body<D>(Shape<D>::sphere(Real(0.1)), at<D>(0.1, 0));
  heavy.shapes[0].restitution = light.shapes[0].restitution = 1;
  w.world.add(heavy);
  const BodyHandle h = w.world.add(light);
  w.steps(1);
  return w.x(h) < 1 && w.x(h) > 0.5;
}

// A ball that passes a corner at 6 cm is not affected.
template <int D>
bool passesBy(const std::string& method) {
  Range<D> w(method);
  w.wall(at<D>(0, -2), 0.5, 2);
  const BodyHandle h = w.add(Shape<D>::sphere(Real(0.2)), at<D>(-3, 1.2), at<D>(300, -80));
  w.steps(3);
  return (w.world.motion(h).v - at<D>(300, -80)).norm() < 1e-3 && w.lost == 0;
}

// A box slides over the seams of a tiled floor, at 30 and at 300 m/s, as if the floor were one box.
template <int D>
bool slidesOverSeams(const std::string& method) {
  for (const int fast : {1, 10}) {
    Range<D> w(method, WorldSettings<D>{});
    for (int i = 0; i < 48; ++i) {
      BodyDef<D> tile = body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(i, -0.5), BodyType::fixed);
      tile.shapes[0].friction = 0;
      w.world.add(tile);
    }
    BodyDef<D> slider = body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.2))), at<D>(0, 0.2));
    slider.velocity = at<D>(30 * fast, 0);
    const BodyHandle h = w.world.add(slider);
    const int steps = fast == 1 ? 28 : 8;
    w.steps(steps);
    const double way = 0.5 * fast * steps;
    if (!(std::abs(w.x(h) - way) < way / 100)) return false;
  }
  return true;
}

// A body that starts at a wall, or slightly inside it, and flies off is not held.
template <int D>
bool leavesAtOnce(const std::string& method) {
  for (const double gap : {0.0, -0.004, 0.0005}) {
    Range<D> w(method);
    w.wall(at<D>(-0.01, 0), 0.01);
    const BodyHandle h = w.add(Shape<D>::box(Vec<D>::Constant(Real(0.1))), at<D>(0.1 + gap, 0), at<D>(100, 10));
    w.steps(1);
    if (!(std::abs(w.x(h) - (0.1 + gap + 100.0 / 60)) < 0.02)) return false;
  }
  return true;
}

// A row of five reaches the wall. Either each body is faster than the one ahead and presses on it, or all speeds are
// equal: then bodies collide only because the first was stopped.
template <int D>
bool queueIsStopped(const std::string& method) {
  for (const double faster : {40.0, 0.0}) {
    Range<D> w(method);
    w.wall(Vec<D>::Zero(), 0.01);
    std::vector<BodyHandle> row;
    for (int i = 0; i < 5; ++i) {
      row.push_back(w.add(Shape<D>::sphere(Real(0.1)), at<D>(-3 - 0.31 * i, 0.01 * i), at<D>(250 + faster * i, 0)));
    }
    for (int step = 0; step < 12; ++step) {
      w.steps(1);
      for (std::size_t i = 0; i < row.size(); ++i) {
        if (!(w.x(row[i]) < 0)) return false;
        for (std::size_t k = 0; k < i; ++k) {
          if ((w.world.pose(row[i]).p - w.world.pose(row[k]).p).norm() < 0.16) return false;  // overlap of a fifth
        }
      }
    }
  }
  return true;
}

// A plate that is stopped by a post blocks the projectile behind it.
template <int D>
bool stoppedOnesStandInTheWay(const std::string& method) {
  for (const double ahead : {1.0, 0.6}) {
    Range<D> w(method);
    Vec<D> half = Vec<D>::Constant(1);
    half[0] = Real(0.02);
    w.world.add(body<D>(Shape<D>::sphere(Real(0.05)), at<D>(0, 0.9), BodyType::fixed));
    w.world.add(body<D>(Shape<D>::sphere(Real(0.05)), at<D>(2, -0.5), BodyType::fixed));
    const BodyHandle plate = w.add(Shape<D>::box(half), at<D>(-ahead, 0), at<D>(300, 0));
    const BodyHandle bullet =
        w.add(Shape<D>::sphere(Real(0.1)), at<D>(-ahead - 0.3, -0.5), at<D>(ahead < 1 ? 313 : 300, 0));
    w.steps(1);
    if (!(w.x(bullet) < w.x(plate))) return false;
  }
  return true;
}

// A pinned rod that turns once in a step meets a post at 0.4 rad.
template <int D>
bool wholeTurnsAreSeen(const std::string& method) {
  Range<D> w(method);
  Vec<D> half = Vec<D>::Constant(Real(0.02));
  half[0] = 2;
  BodyDef<D> rod = body<D>(Shape<D>::box(half), Vec<D>(Vec<D>::Zero()));
  rod.angularVelocity[kAngDim<D> - 1] = 377, rod.pinned = true;
  const BodyHandle h = w.world.add(rod);
  w.world.add(body<D>(Shape<D>::sphere(Real(0.02)), at<D>(1.5 * std::cos(0.4), 1.5 * std::sin(0.4)), BodyType::fixed));
  w.steps(1);
  const Vec<D> along = w.world.pose(h).q * Vec<D>::Unit(0);
  const double angle = std::atan2(double(along[1]), double(along[0]));
  return angle > 0.3 && angle < 0.41;
}

// Two welded balls, 1.5 m apart: one of them hits a wall.
template <int D>
bool weldedStayTogether(const std::string& method) {
  Range<D> w(method);
  w.wall(Vec<D>::Zero(), 0.01);
  const BodyHandle first = w.add(Shape<D>::sphere(Real(0.1)), at<D>(-3, 0), at<D>(300, 0));
  const BodyHandle second = w.add(Shape<D>::sphere(Real(0.1)), at<D>(-4.5, 0), at<D>(300, 0));
  w.world.add(JointDef<D>{.kind = "weld", .bodyA = first, .bodyB = second, .X_WJ = {at<D>(-3.7, 0), {}}});
  for (int i = 0; i < 4; ++i) {
    w.steps(1);
    if (!(std::abs((w.world.pose(first).p - w.world.pose(second).p).norm() - 1.5) < 0.05)) return false;
  }
  return true;
}

// A body at rest or slow is not examined.
template <int D>
bool restIsFree(const std::string& method) {
  Range<D> w(method, WorldSettings<D>{});
  addGround(w.world);
  for (int i = 0; i < 4; ++i) {
    w.add(Shape<D>::box(Vec<D>::Constant(Real(0.5))), at<D>(0.02 * i, 0.5 + i), Vec<D>(Vec<D>::Zero()));
  }
  std::uint64_t swept = 0;
  for (int i = 0; i < 30; ++i) w.steps(1), swept += w.world.profiler().frame().work[WorkCount::sweptPairs];
  return swept == 0;
}

template <int D>
struct Duty {
  const char* name;
  bool (*holds)(const std::string&);
};
template <int D>
constexpr Duty<D> kDuties[] = {{"Continuous.BallIsStopped", ballIsStopped<D>},
                               {"Continuous.BulletIsStopped", bulletIsStopped<D>},
                               {"Continuous.SurfaceIsNotPassed", surfaceIsNotPassed<D>},
                               {"Continuous.EdgeIsMet", edgeIsMet<D>},
                               {"Continuous.SpinningRodIsStopped", spinningRodIsStopped<D>},
                               {"Continuous.FastOnesMeet", fastOnesMeet<D>},
                               {"Continuous.SentOnItsWayIsStopped", sentOnItsWayIsStopped<D>},
                               {"Continuous.PassesBy", passesBy<D>},
                               {"Continuous.SlidesOverSeams", slidesOverSeams<D>},
                               {"Continuous.LeavesAtOnce", leavesAtOnce<D>},
                               {"Continuous.QueueIsStopped", queueIsStopped<D>},
                               {"Continuous.StoppedOnesStandInTheWay", stoppedOnesStandInTheWay<D>},
                               {"Continuous.WholeTurnsAreSeen", wholeTurnsAreSeen<D>},
                               {"Continuous.WeldedStayTogether", weldedStayTogether<D>},
                               {"Continuous.RestIsFree", restIsFree<D>}};

template <int D>
void conform() {
  int methods = 0;
  for (const Registered* r : Registry::instance().list(StageKind::continuous, D)) {
    if (r->info.role != AlgorithmRole::competitor) continue;
    ++methods;
    for (const FailureMode& f : r->info.failures) {
      const bool known = std::any_of(std::begin(kDuties<D>), std::end(kDuties<D>),
                                     [&](const Duty<D>& duty) { return f.test == duty.name; });
      EXPECT_TRUE(known) << r->info.name << " names " << f.test;
    }
    for (const Duty<D>& duty : kDuties<D>) {
      const bool declared = std::any_of(r->info.failures.begin(), r->info.failures.end(),
                                        [&](const FailureMode& f) { return f.test == duty.name; });
      EXPECT_EQ(duty.holds(r->info.name), !declared) << r->info.name << " in " << D << "D: " << duty.name;
    }
  }
  EXPECT_GE(methods, 4);
  for (const Duty<D>& duty : kDuties<D>) {
    EXPECT_TRUE(duty.holds("cast{method=bilateral}")) << D << "D: " << duty.name;
    EXPECT_TRUE(duty.holds("planted_continuous")) << D << "D, without a bug: " << duty.name;
  }
}
TEST(Continuous, EveryMethod2) { conform<2>(); }
TEST(Continuous, EveryMethod3) { conform<3>(); }

template <int D>
void twinsFail() {
  const auto bug = [](const std::string& name) { return "planted_continuous{bug=" + name + "}"; };
  const std::string in = " in " + std::to_string(D) + "D";
  expectCaught("late" + in, bulletIsStopped<D>(bug("late")));
  expectCaught("nobody looks: a surface" + in, surfaceIsNotPassed<D>("none"));
  expectCaught("pairs of fast bodies are nobody's" + in, fastOnesMeet<D>(bug("blind_to_fast")));
  expectCaught("who touches at the start is stopped" + in, leavesAtOnce<D>(bug("stops_at_once")));
  expectCaught("whoever is near the way stops" + in, passesBy<D>(bug("stops_all")));
  expectCaught("shapes are their inner balls" + in, edgeIsMet<D>(bug("only_centres")));
  expectCaught("shapes are their inner balls, turning" + in, spinningRodIsStopped<D>(bug("only_centres")));
  expectCaught("everyone is fast" + in, restIsFree<D>(bug("everyone")));
  expectCaught("touching is stopping" + in, slidesOverSeams<D>("cast{depth=0}"));
  EXPECT_TRUE(leavesAtOnce<D>("cast{depth=0}")) << in;
  expectCaught("nobody looks: a queue" + in, queueIsStopped<D>("none"));
}
TEST(Continuous, TwinsFail2) { twinsFail<2>(); }
TEST(Continuous, TwinsFail3) { twinsFail<3>(); }

// A part that is deeper in another than its inner ball goes no deeper, whatever its speed, and may leave.
template <int D>
void deepParts() {
  const Shape<D> box = Shape<D>::box(Vec<D>::Constant(Real(0.1))), wall = Shape<D>::box(Vec<D>::Constant(2));
  for (const char* method : {"cast", "cast{method=bilateral}"}) {
    const auto cast = createStage<ContinuousCollision<D>>(Spec::parse(method));
    for (const double speed : {60.0, -60.0}) {
      FastPair<D> p{{wall.view(), box.view(), {}, {}}, {}, {}, false, true};
      p.b.inner = Real(0.1), p.b.outer = Real(0.2);
      p.pair.B.X_WC.p = at<D>(-1.95, 0), p.pair.B.motion.v = at<D>(speed, 0);  // 0.15 m deep
      Real t = -1;
      WorkDone work;
      cast->timesOfImpact({&p, 1}, kDt, {&t, 1}, work);
      EXPECT_EQ(t * Real(60) < Real(0.01), speed > 0) << method << ": " << t;
    }
  }
}
TEST(Continuous, DeepPartsGoNoDeeper) { deepParts<2>(), deepParts<3>(); }

// --- duties of the world, whatever the method ------------------------------------------------------------------------

template <int D>
class Vetoes final : public ContactListener<D> {
  bool begin(const World<D>&, const Manifold<D>&) override { return false; }
  bool persist(const World<D>&, const Manifold<D>&) override { return false; }
};

// Whether a projectile passes a wall that it starts 1 cm before. `change` lets it pass, or not.
template <int D, class Change>
bool passes(const Change& change, const PhysicsModel& model = {}) {
  WorldSettings<D> settings = weightless<D>();
  settings.model = model;
  Range<D> w("cast", settings);
  const BodyHandle wall = w.wall(Vec<D>::Zero(), 0.01);
  BodyDef<D> bullet = body<D>(Shape<D>::sphere(Real(0.1)), at<D>(-0.12, 0));
  bullet.velocity = at<D>(200, 0);
  const BodyHandle h = change(w, bullet, wall);
  w.steps(2);
  return w.x(h) > 1;
}

template <int D>
void worldsPart() {
  EXPECT_FALSE(passes<D>([](Range<D>& w, const BodyDef<D>& bullet, BodyHandle) { return w.world.add(bullet); }));
  PhysicsModel off;
  off.continuous = false;
  EXPECT_TRUE(passes<D>(
      [](Range<D>& w, BodyDef<D> bullet, BodyHandle) {
        bullet.X_WB.p[0] = -2;
        return w.world.add(bullet);
      },
      off))
      << "the feature is off";
  EXPECT_TRUE(passes<D>([](Range<D>& w, BodyDef<D> bullet, BodyHandle) {
    bullet.shapes[0].mask = 2;
    return w.world.add(bullet);
  })) << "filters";
  EXPECT_TRUE(passes<D>([](Range<D>& w, const BodyDef<D>& bullet, BodyHandle) {
    static Vetoes<D> vetoes;
    w.world.addListener(&vetoes);
    return w.world.add(bullet);
  })) << "a listener's veto";
  EXPECT_TRUE(passes<D>([](Range<D>& w, const BodyDef<D>& bullet, BodyHandle wall) {
    const BodyHandle h = w.world.add(bullet);
    w.world.add(JointDef<D>{.kind = "distance{mode=rope,length=9}", .bodyA = wall, .bodyB = h});
    return h;
  })) << "a joint that forbids it";
}
TEST(Continuous, FiltersVetoesAndJointsAreKept) {
  worldsPart<2>();
  worldsPart<3>();
}

// Speculative contacts end with the step that needed them. A world saved while they exist continues.
template <int D>
void savedAndLoaded() {
  for (const char* method : {"speculative", "cast", "ray"}) {
    Range<D> w(method), other(method);
    w.wall(Vec<D>::Zero(), 0.01);
    for (int i = 0; i < 3; ++i) {
      w.add(bullets<D>()[static_cast<std::size_t>(i)], at<D>(-11 - i, 0.5 * i), at<D>(300, 5 * i), 0.3 * i, 4);
    }
    w.steps(2);
    for (int i = 0; i < 4; ++i) {  // thick, so slow: a method must not keep its memory of these bodies
      other.add(Shape<D>::sphere(20), at<D>(100 * i, 500), at<D>(1000, 0));
    }
    other.steps(1);
    std::istringstream in(saved(w.world));
    other.world.load(in);
    for (int i = 0; i < 6; ++i) {
      EXPECT_EQ(w.world.hash(), other.world.hash()) << method << ", step " << i;
      w.steps(1), other.steps(1);
    }
  }
}
TEST(Continuous, SavedWorldsContinue) {
  savedAndLoaded<2>();
  savedAndLoaded<3>();
}

// If a method's query does not support a kind, it refuses the body; the message names the method and the kind.
TEST(Continuous, RefusesUnsupportedKinds) {
  Range<3> w("cast{method=conservative_advancement{query=closed_form}}");
  w.add(Shape<3>::sphere(Real(0.1)), at<3>(0, 0), at<3>(0, 0));
  try {
    w.add(Shape<3>::box(Vec<3>::Constant(1)), at<3>(3, 0), at<3>(0, 0));
    ADD_FAILURE() << "a box was taken";
  } catch (const UserError& e) {
    EXPECT_NE(std::string(e.what()).find("continuous=cast does not support"), std::string::npos) << e.what();
  }
}

}}}}  // namespace lpc::LPC_PRECISION::test::continuous_test
