// SPDX-License-Identifier: Zlib
// External engines through Simulation. Each must give the results of a first physics course with the scene's masses,
// friction and restitution. Each check fails for its planted adapter.
#include <gtest/gtest.h>

#include <sstream>

#include "framework/scene/director.h"
#include "framework/scene/recording.h"
#include "framework/world/invariants.h"
#include "framework/world/pose_penetration.h"
#include "tests/engines/engine_checks.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace {

// --- checks: hold for a correct adapter ------------------------------------------------------------------------------

template <int D>
bool falls(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  const BodyHandle ball = s->add(body<D>(Shape<D>::sphere(Real(0.5)), at<D>(1, 30)));
  run(*s, 2);
  const double n = 120, dt = double(kDt);  // semi-implicit Euler, the integrator of all engines
  return near(double(s->bodies().motion[0].v[1]), -kG * n * dt, 1e-4) &&
         near(double(s->pose(ball).p[1]), 30 - kG * dt * dt * n * (n + 1) / 2, 1e-3) &&
         near(double(s->pose(ball).p[0]), 1, 1e-6);
}

// One ball at rest, and one with a third of gravity. Gravity begins after a second.
template <int D>
bool fallsLater(const Start<D>& start) {
  const auto s = start(gravity<D>(0, 0));
  BodyDef<D> a = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(-2, 0)), b = a;
  b.X_WB.p[0] = 2, b.gravityScale = Real(1) / 3;
  s->add(a), s->add(b);
  run(*s, 1);
  if (!s->bodies().motion[0].v.isZero()) return false;
  changeGravity<D>(*s, at<D>(3, -kG));
  run(*s, 1);
  const Motion<D>&whole = s->bodies().motion[0], &third = s->bodies().motion[1];
  return near((whole.v - at<D>(3, -kG)).norm(), 0, 1e-4) && near((3 * third.v - at<D>(3, -kG)).norm(), 0, 1e-4) &&
         s->settings().gravity == at<D>(3, -kG);
}

// Two balls collide head on with the pair's restitution e = (1 + 0.5) / 2.
template <int D>
bool collides(const Start<D>& start) {
  const auto s = start(gravity<D>(0, 0));
  const double m1 = 1, m2 = 3, v1 = 2, v2 = -1, e = 0.75;
  BodyDef<D> a = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(-2, 0)),
             b = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(2, 0));
  a.velocity = at<D>(v1, 0), b.velocity = at<D>(v2, 0);
  a.shapes[0].density = Real(m1), b.shapes[0].density = Real(m2);
  a.shapes[0].restitution = 1, b.shapes[0].restitution = Real(0.5);
  s->add(a), s->add(b);
  run(*s, 3);
  const double mean = (m1 * v1 + m2 * v2) / (m1 + m2), u = v1 - v2;
  return near(double(s->bodies().motion[0].v[0]), mean - e * u * m2 / (m1 + m2), 2e-3) &&
         near(double(s->bodies().motion[1].v[0]), mean + e * u * m1 / (m1 + m2), 2e-3);
}

// A block on a slope of 26.6 degrees (gravity is turned, not the ground) stays at mu = sqrt(0.9 * 0.4) = 0.6. At
// sqrt(0.9 * 0.1) = 0.3 it slides with g (sin - mu cos).
template <int D>
bool slides(const Start<D>& start) {
  const double angle = std::atan(0.5);
  const auto way = [&](double mu) {
    const auto s = start(gravity<D>(kG * std::sin(angle), -kG * std::cos(angle)));
    BodyDef<D> floor = ground<D>(), block = body<D>(cube<D>(), at<D>(0, 0.5));
    floor.shapes[0].friction = Real(0.9), block.shapes[0].friction = Real(mu * mu / 0.9);
    s->add(floor);
    const BodyHandle h = s->add(block);
    run(*s, 2);
    return double(s->pose(h).p[0]);
  };
  const double a = kG * (std::sin(angle) - 0.3 * std::cos(angle));
  return near(way(0.6), 0, 0.02) && near(way(0.3), a * 2 * 2 / 2, 0.03 * 2 * a);
}

// Every rule of mixing: for friction down a slope of 45 degrees, for restitution head on.
template <int D>
bool mixes(const Start<D>& start) {
  const double half = std::sqrt(0.5);
  bool all = true;
  for (std::size_t i = 0; i < kMixRuleNames.size(); ++i) {
    WorldSettings<D> slope = gravity<D>(kG * half, -kG * half), space = gravity<D>(0, 0);
    slope.mixing.friction = space.mixing.restitution = static_cast<MixRule>(i);
    const auto slides = start(slope), meets = start(space);
    BodyDef<D> floor = ground<D>(), block = body<D>(cube<D>(), at<D>(0, 0.5));
    floor.shapes[0].friction = Real(0.6), block.shapes[0].friction = Real(0.2);
    slides->add(floor);
    const BodyHandle h = slides->add(block);
    run(*slides, 2);
    const double way = kG * half * (1 - double(mix(static_cast<MixRule>(i), Real(0.6), Real(0.2)))) * 2 * 2 / 2;
    BodyDef<D> a = body<D>(Shape<D>::sphere(Real(0.5)), at<D>(-2, 0)), b = a;
    a.velocity = at<D>(2, 0), b.velocity = at<D>(-1, 0), b.X_WB.p = at<D>(2, 0);
    a.shapes[0].restitution = Real(0.9), b.shapes[0].restitution = Real(0.5);
    meets->add(a), meets->add(b);
    run(*meets, 2);
    const double e = double(mix(static_cast<MixRule>(i), Real(0.9), Real(0.5)));
    all = all && near(double(slides->pose(h).p[0]), way, 0.03 * way) &&
          near(double(meets->bodies().motion[1].v[0]), 0.5 + 1.5 * e, 2e-3);
  }
  return all;
}

// A flat block holds on a slope of 85.2 degrees (12 in 1) with a friction of 20.
template <int D>
bool sticks(const Start<D>& start) {
  const double angle = std::atan(12.0);
  const auto s = start(gravity<D>(kG * std::sin(angle), -kG * std::cos(angle)));
  Vec<D> half = Vec<D>::Constant(1);
  half[1] = Real(0.02);
  BodyDef<D> floor = ground<D>(), block = body<D>(Shape<D>::box(half), at<D>(0, 0.02));
  floor.shapes[0].friction = block.shapes[0].friction = 20;
  s->add(floor);
  const BodyHandle h = s->add(block);
  run(*s, 1);
  return near(double(s->pose(h).p[0]), 0, 0.1);  // with a friction of 10 it slides 0.8 m
}

template <int D>
bool rests(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  s->add(ground<D>());
  std::vector<BodyHandle> boxes;
  for (int i = 0; i < 5; ++i) boxes.push_back(s->add(body<D>(cube<D>(), at<D>(0, 0.5 + i))));
  run(*s, 5);
  const StateInvariants<D> now = stateInvariants<D>(*s);
  for (int i = 0; i < 5; ++i) {
    if (!near(double(s->pose(boxes[static_cast<std::size_t>(i)]).p[1]), 0.5 + i, 0.02 * (i + 1))) return false;
  }
  return now.maxSpeed < 0.01 && PosePenetration<D>().of(*s).max < 0.02;
}

// A force that carries the ball's weight, evaluated once a step.
template <int D>
struct Lift final : ForceGenerator<D> {
  Real force = 0;
  void apply(const ForceState<D>&, Real, std::span<Wrench<D>> out) const override { out[0].force[1] += force; }
};
template <int D>
bool bears(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  BodyDef<D> ball = body<D>(cube<D>(), at<D>(0, 5));
  ball.shapes[0].density = 7;
  const BodyHandle h = s->add(ball);
  auto lift = std::make_shared<Lift<D>>();
  lift->force = Real(7 * kG);
  s->add(lift);
  run(*s, 2);
  return near(double(s->pose(h).p[1]), 5, 1e-3);
}

// A built-in spring of 1 Hz acts until it is removed. Its force is constant within a step, so the oscillation gains up
// to 0.2 % per step.
template <int D>
bool swingsOnASpring(const Start<D>& start) {
  const auto s = start(gravity<D>(0, 0));
  BodyDef<D> ball = body<D>(cube<D>(), at<D>(0.5, 0));
  ball.shapes[0].density = 7;
  const BodyHandle h = s->add(ball);
  const double w = 6.283185307179586;
  const ForceHandle spring =
      s->add(ForceDef<D>{.kind = "spring{stiffness=" + std::to_string(7 * w * w) + "}", .bodyB = h});
  run(*s, 0.5);
  if (!near(double(s->pose(h).p[0]), -0.5, 0.05)) return false;
  run(*s, 0.25);
  s->remove(spring);
  const double v = double(s->bodies().motion[static_cast<std::size_t>(h.slot)].v[0]), x = double(s->pose(h).p[0]);
  run(*s, 0.5);
  return near(v, 0.5 * w, 0.4) && near(double(s->pose(h).p[0]), x + 0.5 * v, 0.01);
}

// An L-shaped body far from its frame's origin, thrown and spinning. Momentum computed with the scene's masses is
// conserved only if the engine uses these masses.
template <int D>
bool tumbles(const Start<D>& start) {
  const auto s = start(gravity<D>(0, 0));
  BodyDef<D> l = body<D>(cube<D>(), at<D>(0, 0));
  l.shapes.push_back(l.shapes[0]);
  l.shapes[0].X_BS.p = at<D>(1, 1), l.shapes[1].X_BS.p = at<D>(1.5, 2);
  if constexpr (D == 3) l.shapes[1].X_BS.p[2] = Real(0.7);  // none of its axes is a principal axis
  l.velocity = at<D>(1, 2);
  l.angularVelocity = Ang<D>::Constant(Real(0.4));
  s->add(l);
  const StateInvariants<D> before = stateInvariants<D>(*s);
  run(*s, 2);
  const StateInvariants<D> after = stateInvariants<D>(*s);
  const double size = before.angularMomentum.norm();
  return (after.momentum - before.momentum).norm() < 1e-4 * before.momentum.norm() &&
         (after.angularMomentum - before.angularMomentum).norm() < 5e-3 * size &&
         near(after.kinetic, before.kinetic, 5e-3 * before.kinetic);
}

template <int D>
bool swings(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  const BodyHandle post = s->add(body<D>(Shape<D>::sphere(Real(0.1)), at<D>(0, 0), BodyType::fixed));
  const BodyHandle bob = s->add(body<D>(cube<D>(), at<D>(1, 0)));
  JointDef<D> pivot;
  pivot.bodyA = post, pivot.bodyB = bob;
  const JointHandle joint = s->add(pivot);
  double lowest = 0;
  for (int i = 0; i < 120; ++i) {
    s->step(kDt);
    if (!(stateInvariants<D>(*s).jointError < 0.02)) return false;
    lowest = std::min(lowest, double(s->pose(bob).p[1]));
  }
  s->remove(joint);
  run(*s, 2);
  return near(lowest, -1, 0.02) && s->pose(bob).p[1] < -5;  // fell after the joint was removed
}

// --- the engines -----------------------------------------------------------------------------------------------------

TEST(Engines, AtLeastOneIsBuilt) {
  EXPECT_FALSE(Registry::instance().list(StageKind::engine, 2).empty());
  EXPECT_FALSE(Registry::instance().list(StageKind::engine, 3).empty());
  EXPECT_FALSE(engines<2>().empty() && engines<3>().empty()) << "none has its library";
}
TEST(Engines, BallsFall) {
  everywhere("falls", falls<2>, falls<3>), everywhere("falls later", fallsLater<2>, fallsLater<3>);
}
TEST(Engines, BallsCollideByTheScenesMassesAndRestitution) { everywhere("collides", collides<2>, collides<3>); }
TEST(Engines, BlocksSlideByTheScenesFriction) { everywhere("slides", slides<2>, slides<3>); }
TEST(Engines, CoefficientsMixByTheScenesRules) {
  everywhere("mixes", mixes<2>, mixes<3>), everywhere("sticks", sticks<2>, sticks<3>);
}
TEST(Engines, StacksRest) { everywhere("rests", rests<2>, rests<3>); }
TEST(Engines, ForcesAct) {
  everywhere("bears", bears<2>, bears<3>), everywhere("spring", swingsOnASpring<2>, swingsOnASpring<3>);
}
TEST(Engines, ForcesByLoadsAreRefused) {
  for (const auto& e : engines<3>()) {
    const auto s = e.start({});
    EXPECT_THROW(s->add(ForceDef<3>{.kind = "rolling_resistance"}), UserError);
    EXPECT_EQ(s->forces()[0].kind, nullptr) << "no trace";
  }
}
TEST(Engines, FreeBodiesKeepTheirMomenta) { everywhere("tumbles", tumbles<2>, tumbles<3>); }
TEST(Engines, PivotsHoldUntilTheyAreRemoved) { everywhere("swings", swings<2>, swings<3>); }

template <int D>
void twinsAreCaught() {
  for (const auto& e : engines<D>()) {
    EXPECT_FALSE(falls<D>(upsideDown<D>(e.start))) << e.name;
    EXPECT_FALSE(rests<D>(upsideDown<D>(e.start))) << e.name;
    EXPECT_FALSE(fallsLater<D>(deafToGravity<D>(e.start))) << e.name;
    EXPECT_FALSE(collides<D>(ownMass<D>(e.start))) << e.name;
    EXPECT_FALSE(bears<D>(ownMass<D>(e.start))) << e.name;
    EXPECT_FALSE(swingsOnASpring<D>(ownMass<D>(e.start))) << e.name;
    EXPECT_FALSE(collides<D>(largerRestitution<D>(e.start))) << e.name;
    EXPECT_FALSE(slides<D>(productOfFriction<D>(e.start))) << e.name;
    EXPECT_FALSE(mixes<D>(oneRuleOfFriction<D>(e.start))) << e.name;
    EXPECT_FALSE(mixes<D>(oneRuleOfRestitution<D>(e.start))) << e.name;
    EXPECT_FALSE(sticks<D>(cappedFriction<D>(e.start))) << e.name;
  }
}
TEST(Engines, PlantedAdaptersAreCaught) { twinsAreCaught<2>(), twinsAreCaught<3>(); }

// Our own world passes the same checks: they need nothing that only engines have. In 3D, resting boxes and the momentum
// of a tumbling body depend on the resolver and the integrator: tests/known_answers tests these.
template <int D>
void worldPasses() {
  const Start<D> start = [](const WorldSettings<D>& s) { return std::make_unique<World<D>>(Pipeline{}, s); };
  EXPECT_TRUE(falls<D>(start) && fallsLater<D>(start) && collides<D>(start) && slides<D>(start) && mixes<D>(start) &&
              bears<D>(start) && swings<D>(start) && swingsOnASpring<D>(start));
  if constexpr (D == 2) {
    EXPECT_TRUE(rests<D>(start) && tumbles<D>(start));
  }
}
TEST(Engines, WorldsPassToo) { worldPasses<2>(), worldPasses<3>(); }

// --- director, recorder, refusals ------------------------------------------------------------------------------------

template <int D>
SceneSpec<D> comingAndGoing() {
  SceneSpec<D> scene;
  scene.spawns = {{0, ground<D>(), -1},
                  {0, body<D>(cube<D>(), at<D>(0, 0.5)), 40},
                  {10, body<D>(cube<D>(), at<D>(0, 3)), -1},
                  {50, body<D>(Shape<D>::sphere(Real(0.5)), at<D>(0.1, 6)), -1}};
  return scene;
}
template <int D>
std::string recorded(Simulation<D>& s) {
  std::ostringstream out;
  Recorder<D> recorder(out);
  Director<D> director(comingAndGoing<D>());
  for (int i = 0; i < 180; ++i) {
    director.advance(s);
    s.step(kDt);
    recorder.frame(s);
    if (i == 45) {
      EXPECT_FALSE(s.valid(director.body(1)));
    }
  }
  EXPECT_EQ(s.bodyCount(), 3);
  EXPECT_NEAR(double(s.pose(director.body(2)).p[1]), 0.5, 0.03) << "what it lay on is gone";
  EXPECT_NEAR(double(s.pose(director.body(3)).p[1]), 1.5, 0.05);
  return out.str();
}
template <int D>
void directs() {
  for (const auto& e : engines<D>()) {
    SCOPED_TRACE(e.name);
    const auto first = e.start({}), second = e.start({});
    const std::string bytes = recorded<D>(*first);
    EXPECT_EQ(bytes, recorded<D>(*second)) << "the same calls, the same bits";
    EXPECT_EQ(first->hash(), second->hash());
    std::istringstream in(bytes);
    const Recording<D> r = Recording<D>::read(in);
    ASSERT_EQ(r.frames.size(), 180u);
    EXPECT_FALSE(r.torn);
    EXPECT_EQ(r.frames[0].bodies.size(), 2u);
    EXPECT_EQ(r.frames[20].bodies.size(), 3u);
    EXPECT_EQ(r.frames[45].bodies.size(), 2u);
    const Profiler::Frame& f = first->profiler().frame();
    EXPECT_EQ(f.bodies, 3);
    EXPECT_EQ(f.awake, 2);
    EXPECT_GE(f.points, D == 2 ? 2 : 4) << "the box on the ground";
    EXPECT_FALSE(first->contacts());
    EXPECT_TRUE(std::isnan(invariants<D>(*first).maxPenetration)) << "not told is not 0";
  }
}
TEST(Engines, DirectorAndRecorderWorkWithThem) { directs<2>(), directs<3>(); }

// A push on every slot, whether it holds a body or not.
template <int D>
struct Everywhere final : ForceGenerator<D> {
  void apply(const ForceState<D>& state, Real, std::span<Wrench<D>> out) const override {
    for (std::size_t i = 0; i < state.pose.size(); ++i) out[i].force[0] += 1;
  }
};

template <int D>
void refuses(const std::string& name, const BodyDef<D>& def, const std::string& why) {
  for (const auto& e : engines<D>()) {
    if (e.name != name) continue;
    const auto s = e.start({});
    const BodyHandle first = s->add(ground<D>());
    s->add(std::make_shared<Everywhere<D>>());
    const std::uint64_t before = s->hash();
    try {
      s->add(def);
      ADD_FAILURE() << name << " took what it has no shape for";
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
    EXPECT_EQ(s->hash(), before);
    EXPECT_EQ(s->bodyCount(), 1);
    EXPECT_TRUE(s->valid(first));
    s->step(kDt);
  }
}
TEST(Engines, UnsupportedBodiesAreRefusedWithoutTrace) {
  refuses<2>("box2d", body<2>(Shape<2>::capsule(1, Real(0.5)), at<2>(0, 5)), "box2d: no shape of kind capsule");
  std::vector<Vec<2>> corners;
  for (int i = 0; i < 9; ++i) corners.push_back({Real(std::cos(0.69 * i)), Real(std::sin(0.69 * i))});
  refuses<2>("box2d", body<2>(Shape<2>::polytope(corners), at<2>(0, 5)), "at most 8 corners");
  refuses<3>("bullet", body<3>(Shape<3>::box(Vec<3>::Ones(), Real(0.1)), at<3>(0, 5)), "no shape of kind rounded box");
  BodyDef<3> odd = body<3>(cube<3>(), at<3>(0, 5));
  odd.shapes.push_back(odd.shapes[0]), odd.shapes[1].friction = Real(0.1);
  refuses<3>("bullet", odd, "one friction");
}

// Every kind that Bullet supports lies on the ground at the height of its size.
TEST(Engines, BulletKeepsSizes) {
  const Real sizes[] = {1, Real(0.5)};  // a cylinder's half length along x, and radius
  const std::vector<Vec<3>> corners = {{-1, -1, -1}, {1, -1, -1}, {0, -1, 1}, {0, 1, 0}};
  const std::pair<Shape<3>, double> shapes[] = {
      {Shape<3>::sphere(Real(0.7)), 0.7},     {Shape<3>::box({Real(0.4), Real(0.3), Real(0.6)}), 0.3},
      {Shape<3>::capsule(1, Real(0.5)), 0.5}, {Shape<3>::curved(ShapeKind::cylinder, sizes), 0.5},
      {Shape<3>::polytope(corners), 1},       {Shape<3>::polytope(corners, Real(0.1)), 1.1}};
  for (const auto& e : engines<3>()) {
    for (const bool plane : {false, true}) {
      for (const auto& [shape, height] : shapes) {
        const auto s = e.start(gravity<3>(0, -kG));
        s->add(plane ? body<3>(Shape<3>::plane(), at<3>(0, 0), BodyType::fixed) : ground<3>());
        const BodyHandle h = s->add(body<3>(shape, at<3>(0, height)));
        run(*s, 2);
        EXPECT_NEAR(double(s->pose(h).p[1]), height, 0.015) << e.name << ", plane " << plane << ", height " << height;
      }
    }
  }
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::test
